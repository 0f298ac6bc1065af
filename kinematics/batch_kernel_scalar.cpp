#include "kinematics/batch_kernel.hpp"

namespace polyglide::batch {

/// The kernel on plain numbers: for other processors, and to compare with.
const Kernel& scalar_kernel() {
  static const Kernel kernel{"scalar", 1, 1, &evaluate<double>, &forward<double>};
  return kernel;
}

}  // namespace polyglide::batch
