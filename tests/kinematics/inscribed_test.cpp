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

TEST(Inscribed, TheLargestSphereInATriangularPrismTouchesTheNarrowestPair) {
  EXPECT_NEAR(shapes_of(triangular_prism(0.6, 0.2)).inscribed_sphere.diameter, 0.2, 1e-3);
  const Sphere wide = shapes_of(triangular_prism(0.6, 0.6)).inscribed_sphere;
  EXPECT_NEAR(wide.diameter, 0.6 / std::sqrt(3), 1e-3);
}

/// Places within 1 of (0, 0, ±1/2): a lens. Its third leg makes the plane y = 0 singular.
Machine half_lens() {
  constexpr double kHome = 0.3;
  const Vector3 head(0, kHome, 0);
  Mechanism mechanism = strutted({{{0, 0, 0.5}, head}, {{0, 0, -0.5}, head}, {{5, 0, 0}, head}});
  for (Joint& joint : mechanism.joints)
    if (joint.type == JointType::prismatic && joint.name != "leg3.strut")
      joint.range = {{-0.1, 1 - std::hypot(kHome, 0.5)}};
  return prepare(mechanism, task_of({0, 1, 2}));
}

// In half the lens: r = y and r = 1 − sqrt(y² + 1/4) give 3/8.
TEST(Inscribed, TheLargestSphereInHalfALensHasItsClosedForm) {
  Machine machine = half_lens();
  WorkspaceOptions options;
  options.ignored = {"stroke leg1.strut min", "stroke leg2.strut min"};
  const Workspace workspace = shapes_of(machine, options);
  EXPECT_NEAR(workspace.volume, 1.3089969389957472 / 2, 0.004);
  EXPECT_NEAR(workspace.inscribed_sphere.diameter, 0.75, 2e-3);
  EXPECT_LE(workspace.inscribed_sphere.diameter, 0.75 * (1 + 2e-4));
  EXPECT_NEAR(workspace.inscribed_sphere.center.y(), 0.375 - 0.3, 2e-3);
  bool singular = false;
  for (const auto& touch : workspace.sphere_evidence.touches)
    singular = singular || touch.limit == "singularity";
  EXPECT_TRUE(singular);
}

TEST(Inscribed, ShapesComeWithPlacesAskedAndLimitsThatTouch) {
  const Workspace workspace = shapes_of(catalog_machine("delta-1"));
  for (const ShapeEvidence* dut :
       {&workspace.cylinder_evidence, &workspace.box_evidence, &workspace.sphere_evidence}) {
    EXPECT_GT(dut->places, 5000u);
    EXPECT_EQ(dut->outside, 0u);
    EXPECT_GT(dut->spacing, 0);
    EXPECT_GE(dut->touches.size(), 1u);
  }
}

/// Distance of places to the boundary along many directions, by brute force over all places.
double widest_by_brute_force(const Machine& machine, const Workspace& workspace) {
  const Evaluator evaluator(machine);
  const Probe probe(evaluator, Eigen::Quaterniond::Identity());
  std::vector<Points> shell = sphere_surface({0, 0, 0, 0, 300})(as_shape(Sphere{2, {0, 0, 0}}));
  double best = 0;
  constexpr int kPlaces = 14;
  for (int k = 0; k < kPlaces * kPlaces * kPlaces; ++k) {
    const Vector3 share(k % kPlaces, k / kPlaces % kPlaces, k / kPlaces / kPlaces);
    const Vector3 at =
        workspace.lower +
        (workspace.upper - workspace.lower).cwiseProduct(share + Vector3::Constant(0.5)) / kPlaces;
    // Only places that could do better are grown.
    for (double radius = best * 1.01 + 1e-3;; radius *= 1.01) {
      bool inside = true;
      for (const Points& part : shell) {
        Points moved;
        for (std::size_t i = 0; i < part.size(); ++i) moved.add(at + radius * part[i]);
        inside = inside && probe.all_inside(moved);
      }
      if (!inside) break;
      best = radius;
    }
  }
  return 2 * best;
}

TEST(Inscribed, NoSphereOfABruteForceSearchIsLarger) {
  for (const char* name : {"delta-1", "tripod-70", "hexapod-6ups"}) {
    const Machine machine = catalog_machine(name);
    const Workspace workspace = shapes_of(machine);
    const double brute = widest_by_brute_force(machine, workspace);
    EXPECT_GT(workspace.inscribed_sphere.diameter, brute * 0.995) << name;
    EXPECT_LT(workspace.inscribed_sphere.diameter, brute * 1.25) << name;
  }
}

}  // namespace
}  // namespace polyglide
