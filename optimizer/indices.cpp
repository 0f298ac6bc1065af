#include "optimizer/indices.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <stdexcept>

#include "optimizer/envelope.hpp"

namespace polyglide {
namespace {

/// A pose counts when the machine holds it firmly enough on the right side of
/// singularities; one that is reached badly earns up to half.
struct Judge {
  double bound;      ///< of 1/κ
  signed char side;  ///< sign of det J that counts; 0 = any

  [[nodiscard]] bool accepts(const BatchResult& result, std::size_t i) const {
    return result.limit[i] < 0 && on_side(result, i) && result.inverse_condition[i] >= bound;
  }
  [[nodiscard]] double credit(const BatchResult& result, std::size_t i) const {
    if (result.limit[i] >= 0) return 0;
    if (!on_side(result, i)) return 0.1;
    const double value = result.inverse_condition[i];
    return value >= bound ? 1 : 0.2 + 0.3 * value / bound;
  }

 private:
  [[nodiscard]] bool on_side(const BatchResult& result, std::size_t i) const {
    return side == 0 || result.orientation[i] == side;
  }
};

PoseBatch shifted(const std::vector<Vector3>& positions, const Vector3& center) {
  PoseBatch batch;
  for (const Vector3& position : positions) {
    batch.x.push_back(center.x() + position.x());
    batch.y.push_back(center.y() + position.y());
    batch.z.push_back(center.z() + position.z());
  }
  return batch;
}

/// Points of the additive sequence with the generalised golden ratio, which fills a
/// box evenly for any count (Roberts, The unreasonable effectiveness of quasirandom
/// sequences, 2018).
PoseBatch sample_box(const Eigen::AlignedBox3d& box, int count) {
  constexpr double kRatio = 1.2207440846057596;  // root of x^4 = x + 1
  PoseBatch batch;
  batch.x.resize(count);
  batch.y.resize(count);
  batch.z.resize(count);
  const auto part = [](double step, int i) { return std::fmod(0.5 + step * (i + 1), 1.0); };
  const Vector3 size = box.sizes();
  for (int i = 0; i < count; ++i) {
    batch.x[i] = box.min().x() + size.x() * part(1 / kRatio, i);
    batch.y[i] = box.min().y() + size.y() * part(1 / (kRatio * kRatio), i);
    batch.z[i] = box.min().z() + size.z() * part(1 / (kRatio * kRatio * kRatio), i);
  }
  return batch;
}

signed char side_at(const Evaluator& evaluator, const Vector3& center) {
  BatchResult result;
  evaluator.evaluate(shifted({Vector3::Zero()}, center), result);
  return result.orientation[0];
}

void measure_zone(const Evaluator& evaluator, const Judge& judge, PoseBatch batch,
                  const std::vector<Eigen::Quaterniond>& turns, Measures& measures) {
  double worst = 1;
  std::size_t accepted = 0;
  BatchResult result;
  for (const Eigen::Quaterniond& turn : turns) {
    batch.rotation = turn;
    evaluator.evaluate(batch, result);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      accepted += judge.accepts(result, i) ? 1 : 0;
      measures.credit += judge.credit(result, i);
      measures.conditioning += result.inverse_condition[i];
      worst = std::min(worst, result.inverse_condition[i]);
    }
    measures.poses += batch.size();
  }
  const auto poses = static_cast<double>(measures.poses);
  measures.coverage = static_cast<double>(accepted) / poses;
  measures.credit = accepted == measures.poses ? 1 : measures.credit / poses;
  measures.conditioning /= poses;
  measures.worst_conditioning = worst;
}

/// The usable workspace, by a sample of the box that holds it.
struct Usable {
  double volume = 0;
  std::vector<Vector3>
      extent;  ///< lower and upper corner of the accepted points; empty when there are none
};

Usable measure_usable(const Evaluator& evaluator, const Judge& judge, int points) {
  Usable usable;
  const Eigen::AlignedBox3d box = reach_box(evaluator.machine());
  if (box.isEmpty()) return usable;
  const PoseBatch batch = sample_box(box, points);
  BatchResult result;
  evaluator.evaluate(batch, result);
  Eigen::AlignedBox3d extent;
  std::size_t inside = 0;
  for (int i = 0; i < points; ++i) {
    if (!judge.accepts(result, i)) continue;
    ++inside;
    extent.extend(Vector3(batch.x[i], batch.y[i], batch.z[i]));
  }
  usable.volume = box.volume() * static_cast<double>(inside) / points;
  if (inside > 0) usable.extent = {extent.min(), extent.max()};
  return usable;
}

}  // namespace

const std::vector<Index>& indices() {
  static const std::vector<Index> list{
      {"workspace", "Workspace for its size", "%", 100, true,
       "Volume of tool positions reached untilted, within all limits, with 1/κ above the bound and "
       "without crossing a singularity, divided by the volume of the machine's envelope: the box "
       "around all joints over their strokes, with the platform wherever that volume and the work "
       "zone put it.",
       true},
      {"conditioning", "Mean conditioning in the zone", "", 1, true,
       "Mean of 1/κ over all positions and tilts of the work zone; κ is the condition number of "
       "the map from "
       "tool speeds to drive speeds, where a rotation counts by half the mean plan edge of the "
       "work zone. "
       "1: alike in every direction, 0: singular.",
       true},
      {"worst_conditioning", "Worst conditioning in the zone", "", 1, true,
       "Least 1/κ over all positions and tilts of the work zone.", true},
      {"compactness", "Work zone for its size", "%", 100, true,
       "Volume of the work zone divided by the volume of the machine's envelope.", true},
      {"coverage", "Work zone covered", "%", 100, true,
       "Part of the work zone's positions and tilts that are reached within all limits, with 1/κ "
       "above the bound and without crossing a singularity.",
       false},
      {"volume", "Usable workspace", "dm³", 1000, true,
       "Volume of tool positions reached untilted, within all limits, with 1/κ above the bound.",
       false},
      {"envelope", "Envelope", "dm³", 1000, false,
       "Box around all joints over their strokes, with the platform wherever the usable workspace "
       "and "
       "the work zone put it.",
       false}};
  return list;
}

std::vector<std::string> objective_words() {
  std::vector<std::string> words;
  for (const Index& index : indices())
    if (index.weighable) words.push_back(index.key);
  return words;
}

std::string label_of(const std::string& key) {
  const auto index = std::ranges::find(indices(), key, &Index::key);
  return index == indices().end() ? key : index->label;
}

std::string lowered(std::string label) {
  if (!label.empty())
    label[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(label[0])));
  return label;
}

nlohmann::ordered_json indices_json() {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Index& index : indices())
    list.push_back({{"key", index.key},
                    {"label", index.label},
                    {"unit", index.unit},
                    {"scale", index.scale},
                    {"better", index.higher ? "higher" : "lower"},
                    {"about", index.about}});
  return list;
}

Machine machine_for(const Mechanism& mechanism, const TaskSpace& task, const Zone& zone) {
  Machine machine = prepare(mechanism, task);
  machine.task.characteristic_length = lever(zone);
  return machine;
}

double Measures::operator[](const std::string& key) const {
  if (key == "workspace") return workspace;
  if (key == "conditioning") return conditioning;
  if (key == "worst_conditioning") return worst_conditioning;
  if (key == "compactness") return compactness;
  if (key == "coverage") return coverage;
  if (key == "volume") return volume;
  if (key == "envelope") return envelope;
  throw std::invalid_argument("Measures: there is no index \"" + key + '"');
}

Measures measure(const Evaluator& evaluator, const Requirements& requirements,
                 const Vector3& center, const Fineness& fineness) {
  const Machine& machine = evaluator.machine();
  const Zone& zone = requirements.zone;
  const auto positions =
      zone_positions(zone, machine.task.rotation_axis, fineness.across, fineness.up);
  const auto turns = zone_turns(zone, machine.task, fineness.tilts);
  const Judge judge{requirements.condition > 0 ? 1 / requirements.condition : 0,
                    side_at(evaluator, center)};

  Measures measures;
  measure_zone(evaluator, judge, shifted(positions, center), turns, measures);
  if (measures.coverage < 1 && !fineness.whole) return measures;
  const Usable usable = measure_usable(evaluator, judge, fineness.volume_points);
  measures.volume = usable.volume;
  std::vector<Vector3> places = usable.extent;
  for (const Vector3& position : positions) places.push_back(center + position);
  measures.envelope = requirements.envelope ? requirements.envelope->prod()
                                            : envelope(machine, places, turns).volume();
  measures.workspace = measures.volume / measures.envelope;
  measures.compactness = volume(zone) / measures.envelope;
  measures.poses += static_cast<std::size_t>(fineness.volume_points) + 1;
  return measures;
}

double score(const Measures& measures,
             const std::vector<std::pair<std::string, double>>& objectives) {
  if (measures.coverage < 1) return measures.credit - 1;
  double sum = 0, weights = 0;
  for (const auto& [key, weight] : objectives) {
    sum += weight * std::log(measures[key]);
    weights += weight;
  }
  return std::exp(sum / weights);
}

}  // namespace polyglide
