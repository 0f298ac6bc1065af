#pragma once

#include <string>

#include "kinematics/certify.hpp"
#include "kinematics/orientation_workspace.hpp"
#include "kinematics/singularity_map.hpp"
#include "kinematics/workspace.hpp"

namespace polyglide {

/// What the command `workspace` tells people, in millimetres and degrees, on standard output.
void print_page(const Workspace& workspace, const WorkspaceOptions& how, const std::string& name);
void print_page(const BoxCertificate& certificate, const std::string& name);
void print_page(const OrientationWorkspace& workspace, const Vector3& at, const std::string& name);
void print_page(const SingularityMap& map, const std::string& name);

}  // namespace polyglide
