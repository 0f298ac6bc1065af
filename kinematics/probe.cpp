#include "kinematics/probe.hpp"

#include <algorithm>

namespace polyglide {
namespace {

constexpr double kSingular = 1e-6;  // 1/κ at which a posture counts as singular

}  // namespace

Probe::Probe(const Evaluator& evaluator, const Eigen::Quaterniond& rotation)
    : Probe(evaluator, std::vector<Eigen::Quaterniond>{rotation}) {}

Probe::Probe(const Evaluator& evaluator, std::vector<Eigen::Quaterniond> rotations)
    : evaluator_(evaluator), rotations_(std::move(rotations)), names_(evaluator.limit_names()) {
  names_.push_back("singularity");
  names_.push_back("search box");
  for (int axis : evaluator.machine().task.axes)
    if (axis < 3) active_[axis] = true;
  square_ = evaluator.machine().model.drives.size() == evaluator.machine().task.axes.size();
  PoseBatch home;
  home.x = home.y = home.z = {0};
  BatchResult result;
  evaluator.evaluate(home, result);
  if (result.limit[0] < 0 && result.inverse_condition[0] > kSingular) side_ = result.orientation[0];
}

/// Slow poses in pieces, so that they can be counted; of a size that leaves the evaluator's blocks
/// and with them every bit as they are.
BatchResult Probe::evaluate(const PoseBatch& poses) const {
  constexpr std::size_t kPiece = 256;
  BatchResult result;
  if (!counter_ || evaluator_.closed_form() || poses.size() <= kPiece) {
    evaluator_.evaluate(poses, result);
    poses_ += poses.size();
    if (counter_) counter_(poses_);
    return result;
  }
  for (std::size_t first = 0; first < poses.size(); first += kPiece) {
    const auto count = static_cast<std::ptrdiff_t>(std::min(kPiece, poses.size() - first));
    const auto piece = [&](const std::vector<double>& all) {
      if (all.empty()) return all;
      const auto begin = all.begin() + static_cast<std::ptrdiff_t>(first);
      return std::vector<double>(begin, begin + count);
    };
    PoseBatch part{piece(poses.x), piece(poses.y), piece(poses.z), poses.rotation, poses.wanted};
    for (std::size_t k = 0; k < 3; ++k) part.angles[k] = piece(poses.angles[k]);
    for (std::size_t k = 0; k < 4; ++k) part.quaternion[k] = piece(poses.quaternion[k]);
    BatchResult answers;
    evaluator_.evaluate(part, answers);
    const auto append = [](auto& all, const auto& some) {
      all.insert(all.end(), some.begin(), some.end());
    };
    append(result.limit, answers.limit);
    append(result.inverse_condition, answers.inverse_condition);
    append(result.orientation, answers.orientation);
    poses_ += part.size();
    counter_(poses_);
  }
  return result;
}

Probe::Answers Probe::ask(PoseBatch poses, bool conditioning) const {
  // Where J is square its determinant tells what is singular, and costs less.
  poses.wanted =
      !conditioning && square_ ? Wanted::orientation : Wanted::condition | Wanted::orientation;
  BatchResult result = evaluate(poses);
  if (crosses_) std::ranges::fill(result.orientation, 0);
  for (std::size_t i = 0; i < poses.size() && !crosses_; ++i) {
    const bool across = side_ != 0 && result.orientation[i] != side_;
    const bool regular = (poses.wanted & Wanted::condition) != 0
                             ? result.inverse_condition[i] > kSingular
                             : result.orientation[i] != 0;
    const bool walled = wall_ && wall_->beyond({poses.x[i], poses.y[i], poses.z[i]}) >= 0;
    if (result.limit[i] < 0 && (across || walled || !regular)) result.limit[i] = singularity();
  }
  return {std::move(result.limit), std::move(result.inverse_condition),
          std::move(result.orientation)};
}

Probe::Answers Probe::ask(const Points& points, bool conditioning) const {
  Answers answers = ask({points.x, points.y, points.z, rotations_.front()}, conditioning);
  if (rotations_.size() == 1) return answers;
  std::vector<std::size_t> left;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (answers.inside(i)) left.push_back(i);
  for (std::size_t r = 1; r < rotations_.size() && !left.empty(); ++r) {
    Points some;
    for (std::size_t i : left) some.add(points[i]);
    const Answers turned = ask({some.x, some.y, some.z, rotations_[r]}, conditioning);
    std::vector<std::size_t> still;
    for (std::size_t k = 0; k < left.size(); ++k) {
      const std::size_t i = left[k];
      answers.limit[i] = turned.limit[k];
      if (!turned.inverse_condition.empty())
        answers.inverse_condition[i] =
            std::min(answers.inverse_condition[i], turned.inverse_condition[k]);
      if (turned.inside(k)) still.push_back(i);
    }
    left = std::move(still);
  }
  return answers;
}

bool Probe::beyond_reach(const Vector3& place) const {
  return reach_ && ((place.array() < reach_->lower.array()).any() ||
                    (place.array() > reach_->upper.array()).any());
}

bool Probe::all_inside(const Points& points) const {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (beyond_reach(points[i])) return false;
  return std::all_of(rotations_.begin(), rotations_.end(), [&](const auto& rotation) {
    const Answers answers = ask({points.x, points.y, points.z, rotation}, false);
    return std::all_of(answers.limit.begin(), answers.limit.end(),
                       [](int limit) { return limit < 0; });
  });
}

}  // namespace polyglide
