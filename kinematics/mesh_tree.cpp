#include "kinematics/mesh_tree.hpp"

#include <algorithm>
#include <array>

#ifdef POLYGLIDE_FCL
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/distance.h>
#else
#include "catalog/diagnostics.hpp"
#endif

namespace polyglide {

#ifdef POLYGLIDE_FCL

namespace {

using Tree3 = fcl::BVHModel<fcl::RSSd>;

double distance_of(const Tree3& a, const Transform& at, const Tree3& b, const Transform& there) {
  fcl::DistanceRequestd request;
  fcl::DistanceResultd result;
  // FCL's transform is Eigen's.
  fcl::distance(&a, at, &b, there, request, result);
  return std::max(0.0, result.min_distance);
}

/// Pieces as a surface; a point or segment is a triangle of no area.
Tree3 tree_of(const std::vector<pieces::Piece<double>>& parts) {
  Tree3 tree;
  tree.beginModel(static_cast<int>(parts.size()), static_cast<int>(3 * parts.size()));
  for (const auto& part : parts) {
    std::array<Vector3, 3> corners;
    for (int k = 0; k < 3; ++k) {
      const auto& corner = part.corner[std::min(k, part.corners - 1)];
      corners[k] = {corner.x, corner.y, corner.z};
    }
    tree.addTriangle(corners[0], corners[1], corners[2]);
  }
  tree.endModel();
  return tree;
}

}  // namespace

struct MeshTree::Tree {
  Tree3 model;
};

MeshTree::MeshTree(const Mesh& mesh) {
  auto tree = std::make_unique<Tree>();
  std::vector<fcl::Triangle> triangles;
  triangles.reserve(mesh.triangles.size());
  for (const auto& [a, b, c] : mesh.triangles) triangles.emplace_back(a, b, c);
  tree->model.beginModel(static_cast<int>(triangles.size()),
                         static_cast<int>(mesh.vertices.size()));
  tree->model.addSubModel(mesh.vertices, triangles);
  tree->model.endModel();
  tree_ = std::move(tree);
}

double MeshTree::distance(const Transform& own, const MeshTree& other, const Transform& its) const {
  return distance_of(tree_->model, own, other.tree_->model, its);
}

double MeshTree::distance(const Transform& own,
                          const std::vector<pieces::Piece<double>>& others) const {
  return distance_of(tree_->model, own, tree_of(others), Transform::Identity());
}

bool knows_meshes() { return true; }

#else

struct MeshTree::Tree {};

MeshTree::MeshTree(const Mesh&) {
  throw InputError({{"", "/shapes", "", "meshes need FCL, without which this polyglide was built",
                     "install libfcl-dev, configure and build again"}});
}

double MeshTree::distance(const Transform&, const MeshTree&, const Transform&) const { return 0; }

double MeshTree::distance(const Transform&, const std::vector<pieces::Piece<double>>&) const {
  return 0;
}

bool knows_meshes() { return false; }

#endif

MeshTree::~MeshTree() = default;

}  // namespace polyglide
