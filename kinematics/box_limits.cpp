#include "kinematics/box_limits.hpp"

#include "kinematics/closure_bounds.hpp"
#include "kinematics/leg_bounds.hpp"

namespace polyglide {

std::unique_ptr<const BoxLimits> make_box_limits(const Machine& machine,
                                                 const std::vector<std::string>& ignored,
                                                 const Eigen::Quaterniond& fixed, bool turning) {
  if (auto legs = LegBounds::make(machine, ignored, fixed, turning))
    return std::make_unique<const LegBounds>(std::move(*legs));
  if (auto loops = ClosureBounds::make(machine, ignored, fixed))
    return std::make_unique<const ClosureBounds>(std::move(*loops));
  return nullptr;
}

}  // namespace polyglide
