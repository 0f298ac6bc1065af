#include "kinematics/clearance.hpp"

#include <algorithm>
#include <cmath>

#include "kinematics/clearance_kernel.hpp"
#include "kinematics/limits.hpp"
#include "kinematics/mesh_tree.hpp"

namespace polyglide {
namespace {

using Pieces = std::vector<pieces::Piece<double>>;

/// The pieces of a shape where `place` puts its points.
template <typename Place>
Pieces pieces_of(const BodyShape& shape, const Place& place) {
  Pieces result;
  for (const clearance::PieceData& part : cut(shape)) {
    pieces::Piece<double>& piece = result.emplace_back();
    piece.corners = part.corners;
    for (int k = 0; k < part.corners; ++k) {
      const Vector3 at = place(shape.points[part.corner[k]]);
      piece.corner[k] = {at.x(), at.y(), at.z()};
    }
  }
  return result;
}

double distance_of(const Pieces& a, const Pieces& b) {
  double least = pieces::kFar;
  for (const auto& one : a)
    for (const auto& other : b) least = std::min(least, pieces::squared_distance(one, other));
  return std::sqrt(least);
}

/// Distance of two shapes without their radii.
double bare_distance(const Model& model, const Posture& posture, const std::array<int, 2>& pair) {
  const auto is_mesh = [&](int shape) {
    return model.mechanism.shapes[shape].form == BodyShape::Form::mesh;
  };
  const auto parts = [&](int shape) {
    return pieces_of(model.mechanism.shapes[shape], [&](const BodyPoint& point) {
      return Vector3(posture.bodies[point.body] * point.at);
    });
  };
  const auto displacement = [&](int shape) -> const Transform& {
    return posture.bodies[model.mechanism.shapes[shape].body];
  };
  const auto [a, b] = pair;
  if (!is_mesh(a) && !is_mesh(b)) return distance_of(parts(a), parts(b));
  if (is_mesh(a) && is_mesh(b))
    return model.meshes[a]->distance(displacement(a), *model.meshes[b], displacement(b));
  const auto [mesh, other] = is_mesh(a) ? std::pair(a, b) : std::pair(b, a);
  return model.meshes[mesh]->distance(displacement(mesh), parts(other));
}

double radii(const Mechanism& mechanism, const std::array<int, 2>& pair) {
  return mechanism.shapes[pair[0]].radius + mechanism.shapes[pair[1]].radius;
}

bool same(const LegPlace& a, const LegPlace& b) {
  return a.kind == b.kind && a.leg == b.leg && a.part == b.part && a.at == b.at;
}

}  // namespace

std::vector<clearance::PieceData> cut(const BodyShape& shape) {
  const int count = static_cast<int>(shape.points.size());
  if (count <= 2) return {{count, {0, 1, 0}}};
  std::vector<clearance::PieceData> result;
  for (int k = 2; k < count; ++k) result.push_back({3, {0, k - 1, k}});
  return result;
}

double clearance_of(const Model& model, const Posture& posture, const std::array<int, 2>& pair) {
  return bare_distance(model, posture, pair) - radii(model.mechanism, pair);
}

std::vector<WatchedPair> watched_pairs(const Mechanism& mechanism,
                                       const std::vector<std::string>& ignored) {
  std::vector<WatchedPair> pairs;
  for (const ClearanceLimit& limit : mechanism.clearances) {
    if (is_ignored(limit.name, ignored)) continue;
    for (const auto& pair : limit.pairs) {
      std::string name = clearance_name(mechanism, pair);
      if (!is_ignored(name, ignored))
        pairs.push_back({pair, std::move(name), limit.distance + radii(mechanism, pair)});
    }
  }
  return pairs;
}

std::string broken_clearance(const Model& model, const Posture& posture,
                             const std::vector<std::string>& ignored) {
  for (const WatchedPair& pair : watched_pairs(model.mechanism, ignored))
    if (bare_distance(model, posture, pair.shapes) < pair.apart - kClearanceSlack) return pair.name;
  return "";
}

/// Poses that are looked at together, and where the platform is at each.
struct BatchClearances::Block {
  int count = 0;
  bool turning = false;
  std::array<std::size_t, clearance::kBlock> pose;
  double t[3][clearance::kBlock];
  double turn[9][clearance::kBlock];  ///< rotation, row by row, where they differ
  Eigen::Matrix3d common = Eigen::Matrix3d::Identity();
  const double* drives = nullptr;
  std::size_t stride = 0;

  void add(const PoseBatch& poses, std::size_t index) {
    pose[count] = index;
    t[0][count] = poses.x[index];
    t[1][count] = poses.y[index];
    t[2][count] = poses.z[index];
    if (turning) {
      const Eigen::Matrix3d r = pose_at(poses, index).rotation.toRotationMatrix();
      for (int k = 0; k < 9; ++k) turn[k][count] = r(k / 3, k % 3);
    }
    ++count;
  }

  /// Repeats the last pose until the block fills registers.
  void pad(int lanes) {
    while (count % lanes != 0) {
      pose[count] = pose[count - 1];
      for (auto& row : t) row[count] = row[count - 1];
      for (auto& row : turn) row[count] = row[count - 1];
      ++count;
    }
  }

  [[nodiscard]] double drive(int index, int i) const { return drives[index * stride + pose[i]]; }
};

BatchClearances::BatchClearances(const Machine& machine, const std::vector<std::string>& ignored,
                                 const std::vector<std::string>& limit_names)
    : machine_(machine.model),
      legs_(*machine.legs),
      pieces_of_shape_(machine.model.mechanism.shapes.size(), {-1, -1}) {
  const std::vector<BodyShape>& shapes = machine_.mechanism.shapes;
  for (const WatchedPair& pair : watched_pairs(machine_.mechanism, ignored)) {
    const double bound = pair.apart - kClearanceSlack;
    const auto at = std::find(limit_names.begin(), limit_names.end(), pair.name);
    const int limit = static_cast<int>(at - limit_names.begin());
    const auto [a, b] = pair.shapes;
    if (bound <= 0) continue;
    const bool first_is_mesh = shapes[a].form == BodyShape::Form::mesh;
    if (first_is_mesh || shapes[b].form == BodyShape::Form::mesh) {
      meshes_.push_back({first_is_mesh ? a : b, first_is_mesh ? b : a, bound, limit});
      add_pieces(machine, meshes_.back().other);
      continue;
    }
    const auto [first, last] = add_pieces(machine, a);
    const auto [other_first, other_last] = add_pieces(machine, b);
    model_.pairs.push_back({first, last, other_first, other_last, bound * bound, limit});
  }
}

int BatchClearances::add_column(const LegPlace& place) {
  using Kind = LegPlace::Kind;
  Column column{place, -1, -1};
  if (place.kind == Kind::rod || place.kind == Kind::lower || place.kind == Kind::upper) {
    const Leg& leg = legs_.legs[place.leg];
    const Kind carrier = leg.kind == Leg::Kind::strut       ? Kind::fixed
                         : leg.kind == Leg::Kind::crank_rod ? Kind::crank
                                                            : Kind::carriage;
    column.base = add_column({carrier, leg.base_point, carrier == Kind::fixed ? -1 : place.leg, 0});
    column.platform = add_column({Kind::platform, leg.platform_point, -1, 0});
    if (place.part == 0) return place.kind == Kind::upper ? column.platform : column.base;
    if (place.kind == Kind::rod && place.part == 1) return column.platform;
  }
  for (std::size_t i = 0; i < columns_.size(); ++i)
    if (same(columns_[i].place, place)) return static_cast<int>(i);
  columns_.push_back(column);
  return static_cast<int>(columns_.size()) - 1;
}

std::pair<int, int> BatchClearances::add_pieces(const Machine& machine, int index) {
  auto& known = pieces_of_shape_[index];
  if (known.first >= 0) return known;
  const BodyShape& shape = machine_.mechanism.shapes[index];
  if (shape.form == BodyShape::Form::mesh) return known;
  known.first = static_cast<int>(model_.pieces.size());
  for (clearance::PieceData piece : cut(shape)) {
    for (int k = 0; k < piece.corners; ++k)
      piece.corner[k] =
          add_column(*leg_place(machine_.mechanism, *machine.legs, shape.points[piece.corner[k]]));
    model_.pieces.push_back(piece);
  }
  known.second = static_cast<int>(model_.pieces.size());
  return known;
}

void BatchClearances::fill(const Column& column, const Block& block, double* places,
                           double* out) const {
  using Kind = LegPlace::Kind;
  const LegPlace& place = column.place;
  const Leg* leg = place.leg < 0 ? nullptr : &legs_.legs[place.leg];
  const Vector3& tool = machine_.mechanism.tool;
  const auto row = [out](int k) { return out + k * clearance::kBlock; };
  if (place.kind == Kind::fixed) {
    for (int k = 0; k < 3; ++k) std::fill_n(row(k), block.count, place.at[k]);
  } else if (place.kind == Kind::platform) {
    const Vector3 arm = place.at - tool, common = tool + block.common * arm;
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < block.count; ++i)
        row(k)[i] = block.t[k][i] + (block.turning ? tool[k] + block.turn[3 * k][i] * arm[0] +
                                                         block.turn[3 * k + 1][i] * arm[1] +
                                                         block.turn[3 * k + 2][i] * arm[2]
                                                   : common[k]);
  } else if (place.kind == Kind::carriage) {
    for (int i = 0; i < block.count; ++i) {
      const double q = block.drive(leg->drive, i);
      for (int k = 0; k < 3; ++k) row(k)[i] = place.at[k] + q * leg->direction[k];
    }
  } else if (place.kind == Kind::crank) {
    const Vector3 from = place.at - leg->centre, along = leg->direction.dot(from) * leg->direction;
    const Vector3 outward = from - along, onward = leg->direction.cross(from);
    for (int i = 0; i < block.count; ++i) {
      const double q = block.drive(leg->drive, i), c = std::cos(q), s = std::sin(q);
      for (int k = 0; k < 3; ++k)
        row(k)[i] = leg->centre[k] + along[k] + c * outward[k] + s * onward[k];
    }
  } else {
    const double* base = places + 3 * clearance::kBlock * column.base;
    const double* platform = places + 3 * clearance::kBlock * column.platform;
    const double* from = place.kind == Kind::upper ? platform : base;
    for (int i = 0; i < block.count; ++i) {
      double way[3], square = 0;
      for (int k = 0; k < 3; ++k) {
        way[k] = platform[k * clearance::kBlock + i] - base[k * clearance::kBlock + i];
        square += way[k] * way[k];
      }
      const double part = place.kind == Kind::rod ? place.part : place.part / std::sqrt(square);
      for (int k = 0; k < 3; ++k) row(k)[i] = from[k * clearance::kBlock + i] + part * way[k];
    }
  }
}

void BatchClearances::check_block(const PoseBatch& poses, const clearance::Kernel& kernel,
                                  Block& block, BatchResult& result) const {
  static thread_local std::vector<double> places;
  places.resize(columns_.size() * 3 * clearance::kBlock);
  const int used = block.count;
  block.pad(kernel.lanes);
  for (std::size_t c = 0; c < columns_.size(); ++c)
    fill(columns_[c], block, places.data(), &places[3 * clearance::kBlock * c]);
  double limit[clearance::kBlock];
  std::fill_n(limit, clearance::kBlock, -1.0);
  kernel.check(model_, places.data(), limit, block.count);
  block.count = used;
  if (!meshes_.empty()) check_meshes(poses, block, places.data(), limit);
  for (int i = 0; i < used; ++i) result.limit[block.pose[i]] = static_cast<int>(limit[i]);
  block.count = 0;
}

void BatchClearances::check_meshes(const PoseBatch& poses, const Block& block, const double* places,
                                   double* limit) const {
  const auto parts = [&](int shape, int i) {
    Pieces result;
    for (int p = pieces_of_shape_[shape].first; p < pieces_of_shape_[shape].second; ++p)
      result.push_back(clearance::piece_at<double>(model_.pieces[p], places, i));
    return result;
  };
  for (int i = 0; i < block.count; ++i) {
    if (limit[i] >= 0) continue;
    const Transform platform = platform_transform(machine_, pose_at(poses, block.pose[i]));
    Eigen::VectorXd drives(static_cast<Eigen::Index>(machine_.drives.size()));
    for (Eigen::Index d = 0; d < drives.size(); ++d)
      drives[d] = block.drive(static_cast<int>(d), i);
    const auto displacement = [&](int shape) {
      return body_displacement(machine_.mechanism, legs_, machine_.mechanism.shapes[shape].body,
                               platform, drives);
    };
    for (const MeshPair& pair : meshes_) {
      const MeshTree& mesh = *machine_.meshes[pair.mesh];
      const bool both = machine_.meshes[pair.other] != nullptr;
      const double apart =
          both ? mesh.distance(displacement(pair.mesh), *machine_.meshes[pair.other],
                               displacement(pair.other))
               : mesh.distance(displacement(pair.mesh), parts(pair.other, i));
      if (apart >= pair.bound) continue;
      limit[i] = pair.limit;
      break;
    }
  }
}

void BatchClearances::check(const PoseBatch& poses, std::size_t first, std::size_t last,
                            BatchResult& result) const {
  const clearance::Kernel& kernel = clearance::kernel_named(poses.instructions);
  Block block;
  block.turning = has_rotations(poses);
  if (!block.turning) block.common = poses.rotation.normalized().toRotationMatrix();
  block.drives = result.drives.data();
  block.stride = poses.size();
  for (std::size_t i = first; i < last; ++i) {
    if (result.limit[i] < 0) block.add(poses, i);
    if (block.count == clearance::kBlock || (i + 1 == last && block.count > 0))
      check_block(poses, kernel, block, result);
  }
}

}  // namespace polyglide
