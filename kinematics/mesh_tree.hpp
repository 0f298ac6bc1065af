#pragma once

#include <memory>
#include <vector>

#include "catalog/mesh.hpp"
#include "kinematics/model.hpp"
#include "kinematics/piece_distance.hpp"

namespace polyglide {

/// A surface prepared for distances (FCL's tree of boxes about triangles). It has no inside: a body
/// wholly within it is as far from it as its surface. Immutable.
class MeshTree {
 public:
  /// @throws InputError naming FCL when polyglide was built without it.
  explicit MeshTree(const Mesh& mesh);
  ~MeshTree();
  MeshTree(const MeshTree&) = delete;
  MeshTree& operator=(const MeshTree&) = delete;

  /// Distance of two surfaces, each moved from home; 0 where they cross.
  [[nodiscard]] double distance(const Transform& own, const MeshTree& other,
                                const Transform& its) const;

  /// Distance from pieces that are where they are.
  [[nodiscard]] double distance(const Transform& own,
                                const std::vector<pieces::Piece<double>>& others) const;

 private:
  struct Tree;
  std::unique_ptr<const Tree> tree_;
};

/// Whether this build can do so.
[[nodiscard]] bool knows_meshes();

}  // namespace polyglide
