#include <gtest/gtest.h>

#include "leg_machines.hpp"

namespace polyglide {
namespace {

using namespace polyglide::fixtures;

TEST(BatchIndices, FollowFromTheJacobian) {
  for (const auto& [name, machine] : leg_machines()) {
    const Evaluator evaluator(machine);
    const PoseBatch batch = poses_of(machine, 200);
    BatchResult result;
    evaluator.evaluate(batch, result);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (result.limit[i] >= 0) continue;
      const Eigen::MatrixXd j = jacobian_at(result, machine, i);
      if (j.rows() < j.cols()) {  // drives too few: a motion is left
        EXPECT_EQ(result.inverse_condition[i] + result.frobenius[i] + result.smallest[i], 0);
        continue;
      }
      const Eigen::VectorXd s = Eigen::JacobiSVD<Eigen::MatrixXd>(j).singularValues();
      const double least = s[s.size() - 1], greatest = s[0];
      ASSERT_NEAR(result.inverse_condition[i], least / greatest, 1e-9) << name << '\n' << j;
      if (least / greatest < kNoSign)
        continue;  // singular everywhere: nothing but rounding is left
      // table1-4 is all but singular: no way keeps more than 1e-14 of the greatest.
      EXPECT_NEAR(result.smallest[i], least, 1e-9 * least + 1e-14 * greatest) << name;
      EXPECT_NEAR(result.softest[i], least * least, 2e-9 * least * least + 1e-14 * greatest * least)
          << name;
      EXPECT_NEAR(result.stiffest[i] / (greatest * greatest), 1, 1e-9) << name;
      const double n = static_cast<double>(j.cols());
      EXPECT_NEAR(result.frobenius[i], n / (s.norm() * s.cwiseInverse().norm()), 1e-9) << name;
      EXPECT_GE(result.frobenius[i], result.inverse_condition[i] - 1e-12) << name;
      if (j.rows() == j.cols()) {
        EXPECT_EQ(result.orientation[i], j.determinant() > 0 ? 1 : -1) << name;
      }
    }
  }
}

TEST(BatchIndices, OnTheAxisOfALinearDeltaTheRepeatedSingularValuesAreRight) {
  // sqrt 3 and sqrt(3/2) tan β (double), sin β = e/L.
  for (double e : {0.1, 0.25, 0.5, std::sqrt(2.0 / 3), 0.9}) {
    const Evaluator evaluator(prepare(linear_delta(e, 1, 5, 1), task_of({0, 1, 2})));
    PoseBatch batch;
    for (int i = 0; i < 21; ++i) batch.z.push_back(0.01 * i);
    batch.x.assign(21, 0);
    batch.y.assign(21, 0);
    BatchResult result;
    evaluator.evaluate(batch, result);
    const double ratio = std::tan(std::asin(e)) / std::sqrt(2);
    for (double inverse : result.inverse_condition)
      EXPECT_NEAR(inverse, std::min(ratio, 1 / ratio), 1e-12) << e;
  }
}

TEST(BatchIndices, ASymmetricHexapodHasTheSingularValuesOfTheDecomposition) {
  const Machine machine = catalog_machine("hexapod-6ups");
  const Evaluator evaluator(machine);
  PoseBatch batch;
  batch.wanted = kEverything;
  for (int i = 0; i < 9; ++i) batch.z.push_back(0.01 * (i - 4));
  batch.x.assign(9, 0);
  batch.y.assign(9, 0);
  BatchResult result;
  evaluator.evaluate(batch, result);
  for (std::size_t i = 0; i < 9; ++i) {
    ASSERT_EQ(result.limit[i], -1);
    const Eigen::VectorXd s =
        Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian_at(result, machine, i)).singularValues();
    EXPECT_NEAR(result.inverse_condition[i], s[5] / s[0], 1e-9);
  }
}

TEST(BatchIndices, TransmissionOfAnOrthoglideAtHomeIsPerfectAndFallsOffAlongTheDiagonal) {
  // At (t, t, t) rod i makes cos = sqrt(1 - 2t²) with its guide.
  const Evaluator evaluator(prepare(orthoglide(1), task_of({0, 1, 2})));
  PoseBatch batch;
  batch.x = {0, 0.1, 0.2};
  batch.y = batch.z = batch.x;
  batch.wanted = Wanted::transmission;
  BatchResult result;
  evaluator.evaluate(batch, result);
  EXPECT_NEAR(result.transmission[0], 1, 1e-12);
  for (int i = 1; i < 3; ++i) {
    const double t = batch.x[i], in = std::sqrt(1 - 2 * t * t);
    // Out: rows of J are (1, a, a), a = -t/in; the velocity is a column of its inverse.
    const double a = -t / in;
    Eigen::Matrix3d j = Eigen::Matrix3d::Constant(a);
    j.diagonal().setOnes();
    const double out = 1 / (j.row(0).norm() * j.inverse().col(0).norm());
    EXPECT_NEAR(result.transmission[i], std::min(in, out), 1e-12);
  }
}

}  // namespace
}  // namespace polyglide
