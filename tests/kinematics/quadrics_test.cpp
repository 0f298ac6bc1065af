#include "kinematics/quadrics.hpp"

#include <gtest/gtest.h>

#include "kinematics/evaluate.hpp"
#include "kinematics/leg_bounds.hpp"
#include "kinematics/singular_face.hpp"
#include "random_machine.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;
using variations::uniform;
using variations::uniform_vector;

const Cuboid kCube{{0, 0, 0}, {1, 1, 1}};

Interval part_below(const Vector3& normal, double offset) {
  return cut_of(kCube, PlaneBound{Interval(-offset), {normal[0], normal[1], normal[2]}}).part;
}

void expect_about(const Interval& part, double expected) {
  EXPECT_LE(part.lower(), expected);
  EXPECT_GE(part.upper(), expected);
  EXPECT_LT(part.upper() - part.lower(), 4e-9);
}

TEST(PlaneCut, CutsCornersWedgesAndSlabs) {
  const UpwardRounding rounding;
  // Of the cube [-1, 1]³: a corner of 1/6 of an edge's cube, a wedge, a slab, one half.
  expect_about(part_below({1, 1, 1}, -2), 1.0 / 48);
  expect_about(part_below({-1, 1, 1}, 2), 1 - 1.0 / 48);
  expect_about(part_below({1, 1, 0}, -1), 1.0 / 8);
  expect_about(part_below({0, -2, 0}, 1), 0.75);
  expect_about(part_below({0.3, -0.7, 0.5}, 0), 0.5);
}

TEST(PlaneCut, NothingAndAllAreExact) {
  const UpwardRounding rounding;
  EXPECT_TRUE(cut_of(kCube, PlaneBound{Interval(-3.0), {1, 1, 1}}).holds());
  EXPECT_TRUE(cut_of(kCube, PlaneBound{Interval(3.5), {1, 1, 1}}).fails());
  EXPECT_TRUE(cut_of(kCube, PlaneBound{Interval(0.0), {0, 0, 0}}).holds());
  const PlaneCut hair = cut_of(kCube, PlaneBound{Interval(-1 + 1e-15), {1, 0, 0}});
  EXPECT_FALSE(hair.holds());
  EXPECT_FALSE(hair.fails());
}

TEST(PlaneCut, ParallelFacesAreTakenAwayOnce) {
  const UpwardRounding rounding;
  const PlaneCut close = cut_of(kCube, PlaneBound{Interval(0.0), {1, 0.5, 0}}),
                 further = cut_of(kCube, PlaneBound{Interval(-0.4), {2, 1, 0}}),
                 across = cut_of(kCube, PlaneBound{Interval(-0.9), {0, 0, -1}});
  EXPECT_NEAR(part_taken(kCube, {close, further}), 0.5, 4e-9);
  EXPECT_NEAR(part_taken(kCube, {further, close, across}), 0.5 + 0.05, 4e-9);
  EXPECT_DOUBLE_EQ(part_taken(kCube, {}), 0);
}

TEST(PlaneCut, WhatPlanesTakeIsNoLessThanWhatSamplesFind) {
  const UpwardRounding rounding;
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 40; ++trial) {
    std::vector<PlaneCut> cuts;
    const Vector3 common = uniform_vector(random);
    for (int i = 0; i < 3; ++i) {
      const Vector3 n = common + 0.3 * uniform_vector(random);
      const PlaneCut one =
          cut_of(kCube, PlaneBound{Interval(0.5 * uniform(random)), {n[0], n[1], n[2]}});
      if (!one.holds() && !one.fails()) cuts.push_back(one);
    }
    int outside = 0;
    constexpr int kSamples = 4000;
    for (int s = 0; s < kSamples; ++s) {
      const Vector3 at = uniform_vector(random);
      outside += !std::ranges::all_of(
          cuts, [&](const PlaneCut& each) { return allows(each.plane, kCube, at); });
    }
    EXPECT_GT(part_taken(kCube, cuts), outside / double{kSamples} - 0.04);
  }
}

TEST(Quadrics, LieBetweenTheirPlanesOnEveryCuboid) {
  const UpwardRounding rounding;
  std::mt19937_64 random(5);
  for (int trial = 0; trial < 300; ++trial) {
    const Vector3 c = uniform_vector(random), a = uniform_vector(random);
    const Affine affine{Interval(uniform(random)), {a[0], a[1], a[2]}};
    const Quadric ball = squared_distance({c[0], c[1], c[2]});
    const Quadric quadric = trial % 3 == 0   ? ball
                            : trial % 3 == 1 ? square(affine)
                                             : ball - Interval(uniform(random)) * square(affine);
    const Vector3 m = uniform_vector(random), half = 0.3 * uniform_vector(random).cwiseAbs();
    const Cuboid cuboid{{m[0], m[1], m[2]}, {half[0], half[1], half[2]}};
    const PlaneBound plane = enclose(quadric, cuboid);
    for (int s = 0; s < 20; ++s) {
      const Vector3 d = half.cwiseProduct(uniform_vector(random)), at = m + d;
      const PlaneBound exact = enclose(quadric, {{at[0], at[1], at[2]}, {0, 0, 0}});
      const double swing = plane.slope[0] * d[0] + plane.slope[1] * d[1] + plane.slope[2] * d[2];
      EXPECT_LE(plane.at.lower() + swing, exact.at.upper() + 1e-14);
      EXPECT_GE(plane.at.upper() + swing, exact.at.lower() - 1e-14);
    }
    // A ball is as far from its plane as the square of half the diagonal, and no farther.
    if (trial % 3 == 0) {
      EXPECT_NEAR(plane.at.upper() - plane.at.lower(), half.squaredNorm(), 1e-12);
    }
  }
}

TEST(Quadrics, SayWhatTheEvaluatorSaysOfRandomMachines) {
  std::mt19937_64 random(11);
  int inside = 0, outside = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Machine machine =
        random_machine(random, trial % 2 == 0 ? DriveKind::strut : DriveKind::guide);
    ASSERT_TRUE(machine.legs);
    const Evaluator evaluator(machine);
    PoseBatch batch;
    for (int i = 0; i < 400; ++i) {
      const Vector3 at = uniform_vector(random);
      batch.x.push_back(at[0]), batch.y.push_back(at[1]), batch.z.push_back(at[2]);
    }
    BatchResult result;
    evaluator.evaluate(batch, result);
    const UpwardRounding rounding;
    const auto limits = LegBounds::make(machine, {}, Eigen::Quaterniond::Identity(), false);
    ASSERT_TRUE(limits);
    LegBounds::Mask rest;
    const std::vector<QuadricLimit> quadrics = limits->quadrics(rest);
    EXPECT_TRUE(rest.none());
    for (std::size_t i = 0; i < batch.size(); ++i) {
      const Cuboid place{{batch.x[i], batch.y[i], batch.z[i]}, {0, 0, 0}};
      bool all = true, none = false;
      for (const QuadricLimit& limit : quadrics) {
        const PlaneCut left = cut_of(place, limit);
        all = all && left.holds();
        none = none || left.fails();
      }
      if (all == none) continue;  // within rounding of a limit
      EXPECT_EQ(all, result.limit[i] < 0)
          << trial << ": " << (all ? evaluator.limit_names()[result.limit[i]] : "nothing");
      ++(all ? inside : outside);
    }
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(outside, 5000);
}

TEST(Quadrics, OfAHexapodThatIsTurnedSayWhatTheEvaluatorSays) {
  const Machine machine = catalog_machine("hexapod-6ups");
  const Evaluator evaluator(machine);
  PoseBatch batch;
  batch.rotation = pose_of(Eigen::Vector<double, 6>(0, 0, 0, 0.2, -0.1, 0.3)).rotation;
  std::mt19937_64 random(17);
  for (int i = 0; i < 2000; ++i) {
    const Vector3 at = 0.5 * uniform_vector(random);
    batch.x.push_back(at[0]), batch.y.push_back(at[1]), batch.z.push_back(at[2]);
  }
  BatchResult result;
  evaluator.evaluate(batch, result);
  const UpwardRounding rounding;
  const auto limits = LegBounds::make(machine, {}, batch.rotation, false);
  LegBounds::Mask rest;
  const std::vector<QuadricLimit> quadrics = limits->quadrics(rest);
  int inside = 0;
  for (std::size_t i = 0; i < batch.size(); ++i) {
    const Cuboid place{{batch.x[i], batch.y[i], batch.z[i]}, {0, 0, 0}};
    const bool all = std::ranges::all_of(
        quadrics, [&](const QuadricLimit& limit) { return cut_of(place, limit).holds(); });
    EXPECT_EQ(all, result.limit[i] < 0);
    inside += all;
  }
  EXPECT_GT(inside, 100);
  EXPECT_LT(inside, 1900);
}

TEST(SingularFace, HasTheSignOfTheDeterminantOnBothSides) {
  // Feet in the plane z = 0: det J is zero where the platform's joint is in it.
  const Machine machine = prepare(strutted({{{-0.5, 0, 0}, {0, 0.2, 0.3}},
                                            {{0.5, 0, 0}, {0, 0.2, 0.3}},
                                            {{0, 0.8, 0}, {0, 0.2, 0.3}}}),
                                  task_of({0, 1, 2}));
  const UpwardRounding rounding;
  const auto limits = LegBounds::make(machine, {}, Eigen::Quaterniond::Identity(), false);
  ASSERT_TRUE(limits);
  PoseBox home;
  home.fill(Interval(0.0));
  const int side = determinant_sign(limits->rod_rows(home));
  ASSERT_NE(side, 0);
  std::mt19937_64 random(23);
  for (int trial = 0; trial < 50; ++trial) {
    const double half = 0.02;
    Vector3 m = 0.2 * uniform_vector(random);
    m.z() = -0.3 + half * uniform(random);
    PoseBox box = home;
    for (int k = 0; k < 3; ++k) box[k] = Interval(m[k] - half, m[k] + half);
    Cuboid cuboid;
    for (int k = 0; k < 3; ++k) {
      cuboid.middle[k] = middle(box[k]);
      cuboid.half[k] = radius(box[k]);
    }
    const auto face = singular_face(*limits, box, cuboid, side);
    ASSERT_TRUE(face);
    const Interval part = cut_of(cuboid, *face).part;
    const double expected = std::clamp((m.z() + half + 0.3) / (2 * half), 0.0, 1.0);
    EXPECT_LE(part.lower(), expected + 1e-12);
    EXPECT_GE(part.upper(), expected - 1e-12);
    EXPECT_LT(part.upper() - part.lower(), 0.3);
  }
}

TEST(SingularFace, IsNotKnownWhereTwoSingularValuesVanish) {
  const Machine machine =
      prepare(strutted({{{-1, 0, 0}, {0, 0, 0}}, {{1, 0, 0}, {0, 0, 0}}, {{2, 0, 0}, {0, 0, 0}}}),
              task_of({0, 1, 2}));
  const UpwardRounding rounding;
  const auto limits = LegBounds::make(machine, {}, Eigen::Quaterniond::Identity(), false);
  ASSERT_TRUE(limits);
  PoseBox box;
  box.fill(Interval(0.0));
  for (int k = 0; k < 3; ++k) box[k] = Interval(-0.01, 0.01);
  EXPECT_FALSE(singular_face(*limits, box, {{0, 0, 0}, {0.01, 0.01, 0.01}}, 1));
}

}  // namespace
}  // namespace polyglide
