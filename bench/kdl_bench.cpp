// The batch evaluator's work as a user of Orocos KDL does it, pose by pose: a serial chain for
// every leg, its joints from geometry, KDL's Jacobian of the chain, inverted for the drive's
// row; then Eigen's decomposition.
#include <Eigen/LU>
#include <Eigen/SVD>
#include <kdl/chain.hpp>
#include <kdl/chainjnttojacsolver.hpp>

#include "bench/machines.hpp"

namespace polyglide::bench {
namespace {

KDL::Vector to_kdl(const Vector3& v) { return {v.x(), v.y(), v.z()}; }

KDL::Frame frame_of(const Eigen::Matrix3d& r, const Vector3& origin) {
  return {KDL::Rotation(r(0, 0), r(0, 1), r(0, 2), r(1, 0), r(1, 1), r(1, 2), r(2, 0), r(2, 1),
                        r(2, 2)),
          to_kdl(origin)};
}

/// A leg as KDL sees it, in a frame at its base joint whose z is `turn`'s.
struct ChainLeg {
  KDL::Chain chain;
  std::unique_ptr<KDL::ChainJntToJacSolver> solver;
  Eigen::Matrix3d turn;
  KDL::JntArray joints;
  KDL::Jacobian jacobian;

  /// To be called where the leg will stay: the solver keeps a reference to the chain.
  void finish() {
    solver = std::make_unique<KDL::ChainJntToJacSolver>(chain);
    joints.resize(chain.getNrOfJoints());
    jacobian.resize(chain.getNrOfJoints());
  }
};

/// Angles about x, then y, that turn z into the direction.
std::pair<double, double> aim(const Vector3& direction) {
  return {std::atan2(-direction.y(), direction.z()), std::asin(direction.x())};
}

/// Guide, two rotations, rod.
ChainLeg guide_leg(const Leg& leg) {
  ChainLeg found;
  found.turn = Eigen::Quaterniond::FromTwoVectors(Vector3::UnitZ(), leg.direction).matrix();
  found.chain.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::Fixed), frame_of(found.turn, leg.base_point)));
  found.chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::TransZ)));
  found.chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotX)));
  found.chain.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::RotY), KDL::Frame(KDL::Vector(0, 0, leg.length))));
  return found;
}

/// Two rotations, strut, three rotations, platform.
ChainLeg strut_leg(const Leg& leg, const Vector3& tool) {
  ChainLeg found;
  found.turn.setIdentity();
  found.chain.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::Fixed), KDL::Frame(to_kdl(leg.base_point))));
  for (auto type :
       {KDL::Joint::RotX, KDL::Joint::RotY, KDL::Joint::TransZ, KDL::Joint::RotX, KDL::Joint::RotY})
    found.chain.addSegment(KDL::Segment(KDL::Joint(type)));
  found.chain.addSegment(
      KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame(to_kdl(tool - leg.platform_point))));
  return found;
}

double inverse_condition(const Eigen::MatrixXd& jacobian) {
  const Eigen::VectorXd sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(jacobian).singularValues();
  return sigma[sigma.size() - 1] / sigma[0];
}

double delta_pose(std::vector<ChainLeg>& chains, const std::vector<Leg>& legs, const Vector3& t) {
  Eigen::Matrix3d j;
  for (int i = 0; i < 3; ++i) {
    const Leg& leg = legs[i];
    ChainLeg& chain = chains[i];
    const Vector3 v = chain.turn.transpose() * (leg.platform_point + t - leg.base_point);
    const double drive =
        v.z() + leg.side * std::sqrt(leg.length * leg.length - v.head<2>().squaredNorm());
    if (!(drive >= leg.stroke.min && drive <= leg.stroke.max)) return 0;
    const auto [a, b] = aim((v - drive * Vector3::UnitZ()) / leg.length);
    chain.joints(0) = drive, chain.joints(1) = a, chain.joints(2) = b;
    chain.solver->JntToJac(chain.joints, chain.jacobian);
    j.row(i) = chain.jacobian.data.topRows<3>().inverse().row(0);
  }
  return inverse_condition(j);
}

double hexapod_pose(std::vector<ChainLeg>& chains, const std::vector<Leg>& legs, const Pose& pose,
                    double scale) {
  const Vector3& tool = hexapod().model.mechanism.tool;
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  Eigen::Matrix<double, 6, 6> j;
  for (int i = 0; i < 6; ++i) {
    const Leg& leg = legs[i];
    ChainLeg& chain = chains[i];
    const Vector3 v = tool + pose.position + r * (leg.platform_point - tool) - leg.base_point;
    const double length = v.norm(), drive = length - leg.length;
    if (!(drive >= leg.stroke.min && drive <= leg.stroke.max)) return 0;
    const auto [a, b] = aim(v / length);
    const Eigen::Matrix3d ball =
        (Eigen::AngleAxisd(a, Vector3::UnitX()) * Eigen::AngleAxisd(b, Vector3::UnitY()))
            .toRotationMatrix()
            .transpose() *
        r;
    KDL::JntArray& q = chain.joints;
    q(0) = a, q(1) = b, q(2) = length;
    q(3) = std::atan2(-ball(1, 2), ball(2, 2));
    q(4) = std::asin(ball(0, 2));
    q(5) = std::atan2(-ball(0, 1), ball(0, 0));
    chain.solver->JntToJac(q, chain.jacobian);
    const Eigen::Matrix<double, 6, 6> leg_rates = chain.jacobian.data;
    j.row(i) = leg_rates.inverse().row(2);
  }
  j.rightCols<3>() /= scale;
  return inverse_condition(j);
}

constexpr std::size_t kFew = 5000;

void finish(benchmark::State& state, double sum) {
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kFew));
  state.counters["mean_index"] = sum / kFew;
}

void run_delta(benchmark::State& state) {
  std::vector<Leg> legs;
  std::vector<ChainLeg> chains;
  for (int index : delta().legs->primary) {
    legs.push_back(delta().legs->legs[index]);
    chains.push_back(guide_leg(legs.back()));
  }
  for (ChainLeg& chain : chains) chain.finish();
  const PoseBatch& poses = delta_poses();
  double sum = 0;
  for (auto _ : state) {
    sum = 0;
    for (std::size_t i = 0; i < kFew; ++i)
      sum += delta_pose(chains, legs, {poses.x[i], poses.y[i], poses.z[i]});
  }
  finish(state, sum);
}

void run_hexapod(benchmark::State& state) {
  const std::vector<Leg>& legs = hexapod().legs->legs;
  std::vector<ChainLeg> chains;
  for (const Leg& leg : legs) chains.push_back(strut_leg(leg, hexapod().model.mechanism.tool));
  for (ChainLeg& chain : chains) chain.finish();
  const PoseBatch& poses = hexapod_poses();
  double sum = 0;
  for (auto _ : state) {
    sum = 0;
    for (std::size_t i = 0; i < kFew; ++i)
      sum += hexapod_pose(chains, legs,
                          pose_of({poses.x[i], poses.y[i], poses.z[i], poses.angles[0][i],
                                   poses.angles[1][i], poses.angles[2][i]}),
                          hexapod().task.characteristic_length);
  }
  finish(state, sum);
}

}  // namespace
}  // namespace polyglide::bench

int main(int argc, char** argv) {
  using namespace polyglide::bench;
  benchmark::Initialize(&argc, argv);
  benchmark::RegisterBenchmark("delta/condition/KDL per pose", run_delta);
  benchmark::RegisterBenchmark("hexapod/condition/KDL per pose", run_hexapod);
  benchmark::RunSpecifiedBenchmarks();
}
