#include "kinematics/clearance_kernel.hpp"

namespace polyglide::clearance {

/// The kernel on plain numbers: for other processors, and to compare with.
const Kernel& scalar_kernel() {
  static const Kernel kernel{"scalar", 1, &check<double>};
  return kernel;
}

}  // namespace polyglide::clearance
