#pragma once

#include <cmath>

#include "kinematics/evaluate.hpp"
#include "machines.hpp"

// Every machine that the batch kernel knows, and poses to try it at.
namespace polyglide::fixtures {

inline constexpr unsigned kEverything =
    Wanted::condition | Wanted::orientation | Wanted::frobenius | Wanted::smallest |
    Wanted::transmission | Wanted::stiffness | Wanted::drives | Wanted::jacobian;

/// Arms of length `arm` on axes tangential to a circle, rods with balls to a platform
/// below: Clavel's Delta, each parallelogram one rod. The rods of leg 1 are two, apart.
inline Mechanism rotary_delta(double radius = 0.4, double arm = 0.3, double rod = 0.8,
                              const Range& range = {}) {
  Mechanism mechanism;
  mechanism.name = "rotary delta";
  mechanism.bodies = {"base", "platform"};
  mechanism.platform = 1;
  const auto add = [&mechanism](const std::string& name) {
    mechanism.bodies.push_back(name);
    return static_cast<int>(mechanism.bodies.size()) - 1;
  };
  const double down = std::sqrt(rod * rod - (radius + arm - 0.1) * (radius + arm - 0.1));
  for (int leg = 0; leg < 3; ++leg) {
    const double angle = leg * 2 * M_PI / 3;
    const Vector3 out(std::cos(angle), std::sin(angle), 0), along(-out.y(), out.x(), 0);
    const std::string name = "leg" + std::to_string(leg + 1);
    const int crank = add(name + ".arm");
    Joint drive =
        joint_of(name + ".crank", JointType::revolute, 0, crank, radius * out + 0.2 * along, along);
    drive.driven = {0};
    drive.range = {range};
    mechanism.joints.push_back(drive);
    for (double aside : {-0.05, 0.05}) {
      const std::string side = aside < 0 ? "_a" : "_b";
      const int body = add(name + ".rod" + side);
      const Vector3 elbow = (radius + arm) * out + aside * along;
      const Vector3 foot = 0.1 * out + aside * along - down * Vector3::UnitZ();
      mechanism.joints.push_back(
          joint_of(name + ".top" + side, JointType::spherical, crank, body, elbow));
      mechanism.joints.push_back(
          joint_of(name + ".bottom" + side, JointType::spherical, body, 1, foot));
    }
  }
  return mechanism;
}

/// Poses about home in the task coordinates of a machine, with angles where it has some.
inline PoseBatch poses_of(const Machine& machine, std::size_t count, double reach = 0.08,
                          double turn = 0.2) {
  Uniform random;
  PoseBatch batch;
  batch.wanted = kEverything;
  batch.x.assign(count, 0);
  batch.y = batch.z = batch.x;
  for (int axis : machine.task.axes) {
    std::vector<double>& column = axis == 0   ? batch.x
                                  : axis == 1 ? batch.y
                                  : axis == 2 ? batch.z
                                              : batch.angles[axis - 3];
    column.resize(count);
    const double span = axis < 3 ? reach * machine.model.size : turn;
    for (double& value : column) value = span * random();
  }
  return batch;
}

/// Every leg machine of the catalog, and one with cranks.
inline const std::vector<std::pair<std::string, Machine>>& leg_machines() {
  static const auto machines = [] {
    std::vector<std::pair<std::string, Machine>> found;
    for (const std::string& name : catalog_names()) {
      const Mechanism mechanism = expand(find_layout(name));
      if (!recognise_legs(compile(mechanism))) continue;
      Machine machine = prepare(mechanism);
      if (machine.task.pure) found.emplace_back(name, std::move(machine));
    }
    found.emplace_back("rotary delta", prepare(rotary_delta(), task_of({0, 1, 2})));
    return found;
  }();
  return machines;
}

inline constexpr double kNoSign = 1e-10;  // 1/κ below which a determinant's sign is rounding

/// One Jacobian of a batch.
inline Eigen::MatrixXd jacobian_at(const BatchResult& result, const Machine& machine,
                                   std::size_t i) {
  const auto rows = static_cast<Eigen::Index>(machine.model.drives.size());
  const auto columns = static_cast<Eigen::Index>(machine.task.axes.size());
  Eigen::MatrixXd jacobian(rows, columns);
  for (Eigen::Index r = 0; r < rows; ++r)
    for (Eigen::Index c = 0; c < columns; ++c)
      jacobian(r, c) =
          result.jacobian[static_cast<std::size_t>(r * columns + c) * result.limit.size() + i];
  return jacobian;
}

}  // namespace polyglide::fixtures
