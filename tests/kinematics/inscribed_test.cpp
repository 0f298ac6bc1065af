#include "kinematics/inscribed.hpp"

#include <gtest/gtest.h>

#include "kinematics/workspace.hpp"
#include "machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

/// An equilateral triangle of side `a` with its lowest side along x, from z = -h/2 to h/2.
Machine triangular_prism(double a, double h) {
  const double inner = a / (2 * std::sqrt(3)), c = std::sqrt(3) / 2;
  return prism({{-Vector3::UnitY(), inner},
                {Vector3(c, 0.5, 0), inner},
                {Vector3(-c, 0.5, 0), inner},
                {Vector3::UnitZ(), h / 2},
                {-Vector3::UnitZ(), h / 2}});
}

Workspace shapes_of(const Machine& machine, WorkspaceOptions options = {}) {
  options.accuracy = 2e-3;
  return compute_workspace(machine, options);
}

TEST(Inscribed, TheLargestCylinderInATriangularPrismIsItsIncircle) {
  const Workspace workspace = shapes_of(triangular_prism(0.6, 0.2));
  EXPECT_NEAR(workspace.inscribed_cylinder.diameter, 0.6 / std::sqrt(3), 1e-3);
  EXPECT_NEAR(workspace.inscribed_cylinder.height, 0.2, 1e-3);
  EXPECT_LT(workspace.inscribed_cylinder.center.norm(), 1e-3);
}

TEST(Inscribed, TheLargestBoxInATriangularPrismHasHalfTheArea) {
  const Workspace workspace = shapes_of(triangular_prism(0.6, 0.2));
  const Vector3& size = workspace.inscribed_box.size;
  EXPECT_NEAR(size.prod(), 0.5 * std::sqrt(3) / 4 * 0.36 * 0.2, 0.01 * 0.0156);
  EXPECT_NEAR(size.x(), 0.3, 0.02);
  EXPECT_NEAR(size.z(), 0.2, 1e-3);
}

TEST(Inscribed, AskedShapesAreFoundExactlyWhenTheyFit) {
  const Machine machine = triangular_prism(0.6, 0.2);
  WorkspaceOptions options;
  options.cylinder = {0.34, 0.19};          // the incircle is 0.3464
  options.box = Vector3(0.29, 0.25, 0.19);  // 0.5543 - 0.25·... leaves 0.311 at this depth
  const Workspace fits = shapes_of(machine, options);
  ASSERT_TRUE(fits.asked_cylinder);
  EXPECT_EQ(fits.asked_cylinder->diameter, 0.34);
  EXPECT_EQ(fits.asked_cylinder->height, 0.19);
  ASSERT_TRUE(fits.asked_box);
  EXPECT_EQ(fits.asked_box->size, *options.box);

  options.cylinder = {0.35, 0.1};
  options.box = Vector3(0.33, 0.25, 0.1);
  const Workspace too_large = shapes_of(machine, options);
  EXPECT_FALSE(too_large.asked_cylinder);
  EXPECT_FALSE(too_large.asked_box);
}

TEST(Inscribed, DeltaOneHoldsItsPublishedZoneAsACylinderNotAsASquare) {
  WorkspaceOptions options;
  options.cylinder = {0.23, 0.17};
  options.box = Vector3(0.23, 0.23, 0.01);
  const Workspace workspace = shapes_of(catalog_machine("delta-1"), options);
  EXPECT_TRUE(workspace.asked_cylinder);
  EXPECT_FALSE(workspace.asked_box);
  EXPECT_GE(workspace.inscribed_cylinder.diameter, 0.23);
  // Above a guide at distance 122.47 mm from the axis the ceiling is 426 - sqrt(a² - …) mm.
  for (const Cylinder& cylinder : workspace.cylinders) {
    if (std::abs(cylinder.diameter - 0.14) < 1e-9) {
      EXPECT_NEAR(cylinder.height, 0.1754, 5e-4);
    }
  }
}

TEST(Inscribed, WiderCylindersAreNeverTaller) {
  const Workspace workspace = shapes_of(catalog_machine("tripod-70"));
  ASSERT_GE(workspace.cylinders.size(), 5u);
  for (std::size_t i = 1; i < workspace.cylinders.size(); ++i) {
    EXPECT_GT(workspace.cylinders[i].diameter, workspace.cylinders[i - 1].diameter);
    EXPECT_LT(workspace.cylinders[i].height, workspace.cylinders[i - 1].height + 2e-3);
  }
}

TEST(Inscribed, EveryPointOfAFoundShapeIsReachable) {
  Uniform random;
  for (const char* name : {"delta-1", "tripod-70", "table1-6"}) {
    const Machine machine = catalog_machine(name);
    const Workspace workspace = shapes_of(machine);
    const Evaluator evaluator(machine);
    Points points;
    for (int i = 0; i < 4000; ++i) {
      const Vector3 box = workspace.inscribed_box.center +
                          0.499 * workspace.inscribed_box.size.cwiseProduct(random.vector());
      const double angle = M_PI * random(), radius = 0.499 * std::sqrt(std::abs(random()));
      const Cylinder& cylinder = workspace.inscribed_cylinder;
      points.add(box);
      points.add(cylinder.center + Vector3(cylinder.diameter * radius * std::cos(angle),
                                           cylinder.diameter * radius * std::sin(angle),
                                           0.499 * cylinder.height * random()));
    }
    EXPECT_TRUE(Probe(evaluator, Eigen::Quaterniond::Identity()).all_inside(points)) << name;
  }
}

}  // namespace
}  // namespace polyglide
