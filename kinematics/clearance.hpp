#pragma once

#include <string>
#include <vector>

#include "kinematics/clearance_kernels.hpp"
#include "kinematics/evaluate.hpp"
#include "kinematics/leg_places.hpp"

namespace polyglide {

constexpr double kClearanceSlack = 1e-9;  ///< [m] shapes this much nearer than asked are allowed

/// Distance between the surfaces of two shapes at a posture [m]; negative by at most both radii
/// where they overlap. Meshes have no inside.
[[nodiscard]] double clearance_of(const Model& model, const Posture& posture,
                                  const std::array<int, 2>& pair);

/// Name of the first pair of shapes that is too near, "" when there is none.
[[nodiscard]] std::string broken_clearance(const Model& model, const Posture& posture,
                                           const std::vector<std::string>& ignored);

/// One pair of shapes that must stay apart.
struct WatchedPair {
  std::array<int, 2> shapes;
  std::string name;  ///< clearance_name()
  double apart =
      0;  ///< least distance of lines, plates and surfaces: radii included, slack not [m]
};

/// The pairs of all clearance limits that are not ignored, in the order of the file.
[[nodiscard]] std::vector<WatchedPair> watched_pairs(const Mechanism& mechanism,
                                                     const std::vector<std::string>& ignored);

/// A line or plate cut into points, segments and triangles: their corners as indices of its points.
[[nodiscard]] std::vector<clearance::PieceData> cut(const BodyShape& shape);

/// Clearances of batches of poses of a leg machine whose shapes are all placed in closed form
/// (shapes_are_placed()). Immutable.
class BatchClearances {
 public:
  /// @param limit_names of an evaluator, in which the names of the pairs are looked up.
  BatchClearances(const Machine& machine, const std::vector<std::string>& ignored,
                  const std::vector<std::string>& limit_names);

  [[nodiscard]] bool empty() const { return model_.pairs.empty() && meshes_.empty(); }

  /// Stops poses [first, last) of those that nothing has stopped yet where shapes are too near.
  /// Needs the drives of the result. Nothing is allocated per pose, but for meshes.
  void check(const PoseBatch& poses, std::size_t first, std::size_t last,
             BatchResult& result) const;

 private:
  /// Where a corner is, one column of numbers for a block of poses. Rods and struts take theirs
  /// from the columns of their ends.
  struct Column {
    LegPlace place;
    int base = -1, platform = -1;
  };
  struct MeshPair {
    int mesh = 0, other = 0;  ///< shapes; the other may be a mesh, too
    double bound = 0;         ///< [m]
    int limit = 0;
  };
  struct Block;

  int add_column(const LegPlace& place);
  std::pair<int, int> add_pieces(const Machine& machine, int shape);
  void fill(const Column& column, const Block& block, double* places, double* out) const;
  void check_meshes(const PoseBatch& poses, const Block& block, const double* places,
                    double* limit) const;
  void check_block(const PoseBatch& poses, const clearance::Kernel& kernel, Block& block,
                   BatchResult& result) const;

  Model machine_;
  LegMachine legs_;
  std::vector<Column> columns_;
  std::vector<std::pair<int, int>> pieces_of_shape_;  ///< first and last; -1 when not made yet
  clearance::KernelModel model_;
  std::vector<MeshPair> meshes_;
};

}  // namespace polyglide
