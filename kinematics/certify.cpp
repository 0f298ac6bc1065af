#include "kinematics/certify.hpp"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "kinematics/box_limits.hpp"
#include "kinematics/clearance.hpp"
#include "kinematics/limits.hpp"
#include "kinematics/point_machine.hpp"

namespace polyglide {
namespace {

constexpr double kSmallest = 0x1p-40;  // share of an edge below which splitting shows nothing new

/// What one box came to.
struct Finding {
  enum class Kind { good, open, broken } kind = Kind::open;
  std::string limit;
  double condition = 0;  // upper bound of κ, good boxes
  int axis = 0;          // to split along, open boxes
};

struct Part {
  PoseBox box;
  BoxLimits::Mask open;
  BoxLimits::BranchPointer branch;
  double share = 1;
};

Pose pose_at(const PoseBox& box) {
  Eigen::Matrix<double, 6, 1> coordinates;
  for (int i = 0; i < 6; ++i) coordinates[i] = middle(box[i]);
  return pose_of(coordinates);
}

class Prover {
 public:
  Prover(const BoxLimits& limits, int side, double condition)
      : limits_(limits), side_(side), condition_(condition) {}

  /// Clears the limits proved to hold in part.open.
  Finding examine(Part& part) const {
    std::vector<LimitBound> whole, centre;
    const PoseBox point = middle_of(part.box);
    part.branch = limits_.follow(part.box, part.branch);
    limits_.enclose(part.box, part.open, whole, part.branch);
    limits_.enclose(point, part.open, centre, part.branch);
    Finding finding;
    std::array<double, 6> blame{};
    for (std::size_t i = 0; i < limits_.size(); ++i) {
      if (!part.open[i]) continue;
      if (centre[i].value.lower() > 0) return {Finding::Kind::broken, limits_.name(i), 0, 0};
      Interval value = centre[i].value;
      std::array<double, 6> swing{};
      for (int k = 0; k < 6; ++k) {
        const double half = radius(part.box[k]);
        if (half == 0) continue;
        const Interval change = whole[i].gradient[k] * Interval(-half, half);
        value += change;
        swing[k] = magnitude(change);
      }
      value = std::isfinite(value.upper()) ? common(whole[i].value, value) : whole[i].value;
      if (value.upper() <= 0) {
        part.open.reset(i);
        continue;
      }
      // Where nothing is known, the widest edge.
      const bool known = std::isfinite(value.upper());
      for (int k = 0; k < 6; ++k)
        blame[k] += !known ? radius(part.box[k]) : std::isfinite(swing[k]) ? swing[k] : 0;
    }
    const bool within = part.open.none();
    if (within && regular(part, point, finding)) {
      finding.kind = Finding::Kind::good;
      return finding;
    }
    if (finding.kind == Finding::Kind::broken) return finding;
    if (within || *std::max_element(blame.begin(), blame.end()) <= 0) blame = jacobian_blame(part);
    finding.axis = static_cast<int>(std::max_element(blame.begin(), blame.end()) - blame.begin());
    return finding;
  }

 private:
  /// Whether J is regular with home's sign and κ within the bound all over the box.
  bool regular(const Part& part, const PoseBox& point, Finding& finding) const {
    const auto bounds = [&](const PoseBox& where, int& sign) {
      const IntervalMatrix jacobian = limits_.jacobian(where, part.branch);
      sign = side_ == 0 ? 0 : determinant_sign(jacobian);
      return singular_value_bounds(jacobian);
    };
    int sign = 0;
    const SingularValues on_box = bounds(part.box, sign);
    const bool proved = on_box.least_lower > 0 && sign == side_;
    if (proved) {
      finding.condition = (Interval(on_box.greatest_upper) / on_box.least_lower).upper();
      if (condition_ <= 0 || finding.condition <= condition_) return true;
    }
    // Is it wrong in the middle already?
    const SingularValues at = bounds(point, sign);
    if (side_ != 0 && sign == -side_) {
      finding.kind = Finding::Kind::broken;
      finding.limit = "singularity";
    } else if (condition_ > 0 && at.least_lower > 0 && sign == side_ &&
               at.greatest_upper / at.least_lower > condition_ * (1 + 1e-9)) {
      // For one matrix the bounds differ by rounding only.
      finding.kind = Finding::Kind::broken;
      finding.limit = "condition";
    }
    return false;
  }

  /// How much the Jacobian changes along each axis of the box.
  std::array<double, 6> jacobian_blame(const Part& part) const {
    const PoseBox& box = part.box;
    std::array<double, 6> blame{};
    for (int k = 0; k < 6; ++k) {
      if (radius(box[k]) == 0) continue;
      PoseBox line = middle_of(box);
      line[k] = box[k];
      const IntervalMatrix jacobian = limits_.jacobian(line, part.branch);
      for (int i = 0; i < jacobian.rows(); ++i)
        for (int j = 0; j < jacobian.cols(); ++j) {
          const double width = radius(jacobian(i, j));
          blame[k] += std::isfinite(width) ? width : 1e6 * radius(box[k]);
        }
    }
    return blame;
  }

  const BoxLimits& limits_;
  int side_;
  double condition_;
};

/// Why there are no enclosures.
std::string no_enclosure(const Machine& machine, const std::vector<std::string>& ignored) {
  const Mechanism& mechanism = machine.model.mechanism;
  for (const ExpressionLimit& limit : mechanism.expressions)
    if (!is_ignored(limit.name, ignored))
      return fmt::format("the expression of limit \"{}\" cannot be enclosed by intervals",
                         limit.name);
  for (const WatchedPair& pair : watched_pairs(mechanism, ignored))
    for (const int shape : pair.shapes)
      if (mechanism.shapes[shape].form == BodyShape::Form::mesh)
        return fmt::format("the mesh in \"{}\" cannot be enclosed by intervals", pair.name);
  if (const auto pairs = watched_pairs(mechanism, ignored); !pairs.empty())
    return fmt::format("\"{}\" cannot be enclosed by intervals where there is no closed form",
                       pairs.front().name);
  return "where this machine's joints are cannot be enclosed by intervals, even at home";
}

BoxCertificate undecided(const std::string& reason) {
  BoxCertificate result;
  result.reason = reason;
  return result;
}

void check_region(const PoseRegion& region) {
  if (!region.size.allFinite() || !region.centre.allFinite() || !(region.size.minCoeff() >= 0))
    throw std::invalid_argument("the box to be certified must have finite edges, none negative");
  if (!(region.tilt >= 0 && region.tilt <= M_PI / 2))
    throw std::invalid_argument("the tilt to be certified must be between 0 and 90 degrees");
  if (!(region.condition == 0 || (region.condition >= 1 && std::isfinite(region.condition))))
    throw std::invalid_argument("a condition number is never below 1");
}

BoxCertificate prove(const Prover& prover, const Part& start, int budget) {
  BoxCertificate result;
  std::vector<Part> parts{start};
  constexpr std::size_t kRound = 4096;
  // The last parts first: bounded memory, and a broken pose deep in one corner is met early.
  while (!parts.empty() && result.boxes < budget) {
    const std::size_t take =
        std::min({kRound, parts.size(), static_cast<std::size_t>(budget - result.boxes)});
    std::vector<Part> round(parts.end() - static_cast<std::ptrdiff_t>(take), parts.end());
    parts.resize(parts.size() - take);
    std::vector<Finding> findings(take);
    tbb::parallel_for(std::size_t{0}, (take + 15) / 16, [&](std::size_t block) {
      const UpwardRounding rounding;
      for (std::size_t i = 16 * block; i < std::min(take, 16 * block + 16); ++i)
        findings[i] = prover.examine(round[i]);
    });
    result.boxes += static_cast<int>(take);
    bool stuck = false;
    for (std::size_t i = 0; i < take; ++i) {
      const Finding& finding = findings[i];
      if (finding.kind == Finding::Kind::broken) {
        result.verdict = CertifyVerdict::fails;
        result.limit = finding.limit;
        result.at = pose_at(round[i].box);
        result.reason = fmt::format("a pose in the box is stopped by {}", finding.limit);
        return result;
      }
      if (finding.kind == Finding::Kind::good) {
        result.proved += round[i].share;
        result.worst_condition = std::max(result.worst_condition, finding.condition);
        continue;
      }
      const Interval edge = round[i].box[finding.axis];
      const Interval whole = start.box[finding.axis];
      if (!(edge.upper() - edge.lower() > kSmallest * (whole.upper() - whole.lower()))) {
        stuck = true;
        result.at = pose_at(round[i].box);
        continue;
      }
      Part low = round[i];
      low.share /= 2;
      Part high = low;
      low.box[finding.axis] = Interval(edge.lower(), middle(edge));
      high.box[finding.axis] = Interval(middle(edge), edge.upper());
      parts.push_back(low);
      parts.push_back(high);
    }
    if (stuck) {
      result.reason =
          "a pose is neither allowed nor forbidden within rounding: the box touches a "
          "limit or a singularity";
      return result;
    }
  }
  if (parts.empty()) {
    result.verdict = CertifyVerdict::certified;
    result.proved = 1;
    result.reason = "every pose of the box obeys every limit and is regular";
    return result;
  }
  const auto widest = std::max_element(
      parts.begin(), parts.end(), [](const Part& a, const Part& b) { return a.share < b.share; });
  result.at = pose_at(widest->box);
  result.reason = fmt::format("the budget of {} boxes was spent", budget);
  return result;
}

}  // namespace

BoxCertificate certify_box(const Machine& machine, const PoseRegion& region,
                           const std::vector<std::string>& ignored, int budget) {
  check_region(region);
  if (const auto point = point_machine(machine))
    return certify_box(*point, region, ignored, budget);
  const auto clock = std::chrono::steady_clock::now();
  const std::vector<int>& axes = machine.task.axes;
  const auto commanded = [&](int axis) {
    return std::find(axes.begin(), axes.end(), axis) != axes.end();
  };
  for (int k = 0; k < 3; ++k)
    if (!commanded(k) && (region.size[k] > 0 || region.centre[k] != 0)) {
      if (!machine.task.pure)
        return undecided(
            fmt::format("{} follows from what this machine can be commanded", "xyz"[k]));
      BoxCertificate result;
      result.verdict = CertifyVerdict::fails;
      result.limit = "motion";
      result.at = Pose{region.centre + region.size / 2, Eigen::Quaterniond::Identity()};
      result.reason = fmt::format("the machine cannot move along {}", "xyz"[k]);
      return result;
    }
  std::unique_ptr<const BoxLimits> limits;
  int side = 0;
  Part start;
  {
    const UpwardRounding rounding;
    limits = make_box_limits(machine, ignored, Eigen::Quaterniond::Identity(), region.tilt > 0);
    if (!limits) return undecided(no_enclosure(machine, ignored));
    PoseBox home;
    home.fill(Interval(0.0));
    const IntervalMatrix jacobian = limits->jacobian(home, limits->follow(home, nullptr));
    if (jacobian.rows() < jacobian.cols()) return undecided("fewer drives than freedoms");
    if (jacobian.rows() == jacobian.cols()) {
      side = determinant_sign(jacobian);
      if (side == 0) return undecided("home is singular, or too near to it to tell");
    }
    for (std::size_t i = 0; i < limits->size(); ++i) start.open.set(i);
    for (int k = 0; k < 3; ++k) {
      const Interval half = Interval(region.size[k]) / 2.0;
      start.box[k] = Interval((region.centre[k] - half).lower(), (region.centre[k] + half).upper());
      start.box[3 + k] = commanded(3 + k) ? Interval(-region.tilt, region.tilt) : Interval(0.0);
    }
  }
  // Where joints are followed from box to box, one takes longer.
  constexpr double kWork = 1e7, kFewest = 300;
  if (limits->effort() > 0)
    budget = std::min(budget, static_cast<int>(std::max(kFewest, kWork / limits->effort())));
  BoxCertificate result = prove(Prover(*limits, side, region.condition), start, budget);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - clock).count();
  return result;
}

nlohmann::ordered_json to_json(const BoxCertificate& certificate) {
  using Json = nlohmann::ordered_json;
  static constexpr std::array<const char*, 3> kWords{"certified", "fails", "undecided"};
  Json json{{"verdict", kWords[static_cast<std::size_t>(certificate.verdict)]},
            {"reason", certificate.reason},
            {"limit", certificate.limit.empty() ? Json() : Json(certificate.limit)}};
  if (certificate.at) {
    const auto& q = certificate.at->rotation;
    const Vector3& p = certificate.at->position;
    json["pose"] = {{"position", {p.x(), p.y(), p.z()}},
                    {"quaternion", {q.w(), q.x(), q.y(), q.z()}}};
  } else {
    json["pose"] = nullptr;
  }
  json["proved"] = certificate.proved;
  json["worst_condition"] =
      certificate.worst_condition > 0 ? Json(certificate.worst_condition) : Json();
  json["boxes"] = certificate.boxes;
  json["seconds"] = certificate.seconds;
  return json;
}

}  // namespace polyglide
