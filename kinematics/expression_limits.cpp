#include "kinematics/expression_limits.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "catalog/expression.hpp"
#include "kinematics/limits.hpp"

namespace polyglide {
namespace {

constexpr std::size_t kBlock = 256;
constexpr double kSlack = 1e-9;  ///< of the bound, at least of one unit of the file

bool within(double value, const Range& range) {
  const auto room = [](double bound) { return kSlack * std::max(1.0, std::abs(bound)); };
  return (std::isinf(range.min) ? !std::isnan(value) : value >= range.min - room(range.min)) &&
         (std::isinf(range.max) ? !std::isnan(value) : value <= range.max + room(range.max)) &&
         std::isfinite(value);
}

/// The words of expressions over a model: x y z a b c q1 q2 ….
std::vector<std::string> words_of(const Model& model) {
  std::vector<std::string> words{"x", "y", "z", "a", "b", "c"};
  for (std::size_t d = 0; d < model.drives.size(); ++d) words.push_back(fmt::format("q{}", d + 1));
  return words;
}

/// What one unit of each word is in SI.
std::vector<double> units_of(const Model& model) {
  const Units& units = model.mechanism.units;
  std::vector<double> result(3, units.metres);
  result.resize(6, units.radians);
  for (const int freedom : model.drives) {
    const auto& [joint, index, screw, translational] = model.freedoms[freedom];
    const bool length = is_translation(model.mechanism.joints[joint].type, index);
    result.push_back(length ? units.metres : units.radians);
  }
  return result;
}

}  // namespace

std::string broken_expression(const Model& model, const Posture& posture,
                              const std::vector<std::string>& ignored) {
  const Mechanism& mechanism = model.mechanism;
  if (mechanism.expressions.empty()) return "";
  const auto pose = coordinates_of(platform_pose(model, posture.bodies[mechanism.platform]));
  const Eigen::VectorXd drives = drive_positions(model, posture);
  const std::vector<std::string> words = words_of(model);
  const std::vector<double> units = units_of(model);
  std::vector<double> values(words.size());
  Columns columns;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    values[k] = (k < 6 ? pose[i] : drives[i - 6]) / units[k];
    columns.emplace_back(words[k], &values[k]);
  }
  for (const ExpressionLimit& limit : mechanism.expressions) {
    if (is_ignored(limit.name, ignored)) continue;
    double value = 0;
    evaluate(limit.expression, mechanism.units.angle != "rad", columns, 1, &value);
    if (!within(value, limit.range)) return limit.name;
  }
  return "";
}

BatchExpressions::BatchExpressions(const Model& model, const std::vector<std::string>& ignored,
                                   const std::vector<std::string>& limit_names)
    : words_(words_of(model)),
      units_(units_of(model)),
      degrees_(model.mechanism.units.angle != "rad") {
  for (const ExpressionLimit& limit : model.mechanism.expressions) {
    if (is_ignored(limit.name, ignored)) continue;
    const auto name = std::find(limit_names.begin(), limit_names.end(), limit.name);
    Limit& mine = limits_.emplace_back();
    mine.limit = limit;
    mine.index = static_cast<int>(name - limit_names.begin());
    for (const std::string& word : names_in(limit.expression)) {
      const auto at = std::find(words_.begin(), words_.end(), word);
      const int column = static_cast<int>(at - words_.begin());
      if (std::count(mine.columns.begin(), mine.columns.end(), column) == 0)
        mine.columns.push_back(column);
    }
  }
}

void BatchExpressions::check(const PoseBatch& poses, std::size_t first, std::size_t last,
                             BatchResult& result) const {
  static thread_local std::vector<std::size_t> block;
  block.clear();
  for (std::size_t i = first; i < last; ++i) {
    if (result.limit[i] < 0) block.push_back(i);
    if (block.size() < kBlock && i + 1 < last) continue;
    check_block(poses, block, result);
    block.clear();
  }
}

void BatchExpressions::check_block(const PoseBatch& poses, const std::vector<std::size_t>& block,
                                   BatchResult& result) const {
  static thread_local std::vector<double> values;
  values.resize((words_.size() + 1) * kBlock);
  double* outcome = &values[words_.size() * kBlock];
  std::vector<bool> known(words_.size(), false);
  const auto fill = [&](int column) {
    if (known[column]) return;
    known[column] = true;
    double* to = &values[column * kBlock];
    for (std::size_t i = 0; i < block.size(); ++i) {
      const std::size_t pose = block[i];
      to[i] = column < 3   ? (column == 0   ? poses.x
                              : column == 1 ? poses.y
                                            : poses.z)[pose]
              : column < 6 ? coordinates_of(pose_at(poses, pose))[column]
                           : result.drives[(column - 6) * poses.size() + pose];
      to[i] /= units_[column];
    }
  };
  for (const Limit& mine : limits_) {
    Columns columns;
    for (const int column : mine.columns) {
      fill(column);
      columns.emplace_back(words_[column], &values[column * kBlock]);
    }
    evaluate(mine.limit.expression, degrees_, columns, block.size(), outcome);
    for (std::size_t i = 0; i < block.size(); ++i)
      if (int& limit = result.limit[block[i]]; limit < 0 && !within(outcome[i], mine.limit.range))
        limit = mine.index;
  }
}

}  // namespace polyglide
