#include <gtest/gtest.h>

#include "kinematics/mesh_tree.hpp"
#include "kinematics/piece_distance.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

using Piece = pieces::Piece<double>;

Piece piece(const std::vector<Vector3>& corners) {
  Piece result;
  result.corners = static_cast<int>(corners.size());
  for (std::size_t k = 0; k < corners.size(); ++k)
    result.corner[k] = {corners[k].x(), corners[k].y(), corners[k].z()};
  return result;
}

double apart(const std::vector<Vector3>& a, const std::vector<Vector3>& b) {
  return std::sqrt(pieces::squared_distance(piece(a), piece(b)));
}

TEST(PieceDistance, OfSkewSegmentsIsTheirCommonNormal) {
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {1, 0, 0}}, {{0.5, -1, 2}, {0.5, 1, 2}}), 2);
  // Beyond its end the nearest point is the end.
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {1, 0, 0}}, {{4, -1, 4}, {4, 1, 4}}), 5);
}

TEST(PieceDistance, KnowsParallelAndShrunkenSegmentsAndPoints) {
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {2, 0, 0}}, {{1, 3, 0}, {5, 3, 0}}), 3);
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {1, 0, 0}}, {{3, 0, 0}, {7, 0, 0}}), 2);
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {1, 0, 0}}, {{1, 0, 0}, {0, 0, 0}}), 0);
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}, {0, 0, 0}}, {{3, 4, 0}, {3, 4, 0}}), 5);
  EXPECT_DOUBLE_EQ(apart({{0, 0, 0}}, {{-1, 2, 0}, {1, 2, 0}}), 2);
}

TEST(PieceDistance, OfATriangleCountsItsInsideAndWhatPiercesIt) {
  const std::vector<Vector3> triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  EXPECT_DOUBLE_EQ(apart(triangle, {{1, 1, 3}}), 3);
  EXPECT_DOUBLE_EQ(apart(triangle, {{1, 1, 3}, {1, 1, -3}}), 0);
  EXPECT_DOUBLE_EQ(apart({{1, 1, 2}, {9, 9, 2}}, triangle), 2);
  EXPECT_DOUBLE_EQ(apart(triangle, {{4, 4, 0}, {9, 9, 0}}), std::sqrt(8));
  EXPECT_DOUBLE_EQ(apart(triangle, {{0, 0, 5}, {4, 0, 5}, {0, 4, 6}}), 5);
}

/// Corners of a random piece, at times degenerate or parallel to the x axis.
std::vector<Vector3> random_corners(Uniform& random) {
  const int corners = 1 + static_cast<int>(1.5 * (random() + 1));
  std::vector<Vector3> result;
  for (int k = 0; k < corners; ++k) result.push_back(random.vector());
  if (corners == 2 && random() > 0.5) result[1] = result[0] + Vector3::UnitX() * random();
  if (corners == 2 && random() > 0.8) result[1] = result[0];
  return result;
}

Mesh mesh_of(const std::vector<Vector3>& corners) {
  Mesh mesh;
  for (std::size_t k = 0; k < 3; ++k)
    mesh.vertices.push_back(corners[std::min(k, corners.size() - 1)]);
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

/// Least distance of points spread over both pieces, and how far that may be above the truth.
double sampled(const std::vector<Vector3>& a, const std::vector<Vector3>& b, int steps) {
  const auto spread = [steps](const std::vector<Vector3>& corners) {
    std::vector<Vector3> points;
    const Vector3 &p = corners[0], &q = corners[std::min<std::size_t>(1, corners.size() - 1)],
                  &r = corners.back();
    for (int i = 0; i <= steps; ++i)
      for (int j = 0; j <= (corners.size() == 3 ? steps - i : 0); ++j)
        points.push_back(p + (q - p) * i / steps +
                         (corners.size() == 3 ? 1 : 0) * (r - p) * j / steps);
    return points;
  };
  double least = 1e9;
  for (const Vector3& one : spread(a))
    for (const Vector3& other : spread(b)) least = std::min(least, (one - other).norm());
  return least;
}

TEST(PieceDistance, AgreesWithSamplingAndWithFcl) {
  Uniform random;
  for (int round = 0; round < 3000; ++round) {
    const auto a = random_corners(random), b = random_corners(random);
    const double found = apart(a, b);
    EXPECT_EQ(found, std::sqrt(pieces::squared_distance(piece(a), piece(b))));
    EXPECT_NEAR(found, apart(b, a), 1e-12);
    if (round < 200) {
      constexpr int kSteps = 24;
      const double rough = sampled(a, b, kSteps);
      EXPECT_LE(found, rough + 1e-12);
      EXPECT_GE(found, rough - 8.0 / kSteps);  // edges are up to 2√3 long
    }
    if (!knows_meshes()) continue;
    const MeshTree tree(mesh_of(a));
    const double theirs = tree.distance(Transform::Identity(), {piece(b)});
    EXPECT_NEAR(found, theirs, 1e-9) << round;
  }
}

}  // namespace
}  // namespace polyglide
