#pragma once

#include "kinematics/workspace.hpp"

namespace polyglide {

/// Puts the size by quadrature in place of the sampled one, to 1e-6 or the accuracy asked for if
/// that is finer, where the machine has closed forms for it (LineLimits) and it agrees with what
/// was sampled and proved; else leaves the workspace as it is. Where every pose of the orientation
/// is singular, the size of what the limits leave.
void measure_by_quadrature(Workspace& workspace, const Probe& probe, const Region& region,
                           const WorkspaceOptions& options);

}  // namespace polyglide
