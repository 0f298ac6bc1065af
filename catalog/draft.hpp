#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "catalog/layout.hpp"
#include "catalog/mechanism.hpp"
#include "catalog/reader.hpp"

namespace polyglide {

/// A joint while its mechanism is put together: bodies are still names.
struct JointDraft {
  Joint joint;
  std::array<std::string, 2> bodies;
  bool placed = true;  ///< has a point of its own; else one is found for drawing
  const nlohmann::json* origin = nullptr;  ///< where it is written, for messages
};

/// Reads a joint of the mechanism format, without its name and bodies, in the
/// frame of the compass.
[[nodiscard]] JointDraft read_joint(const nlohmann::json& value, const Reader& reader,
                                    const Compass& compass);

/// Expands one limb of a layout, all its copies, and appends their joints.
/// `scope` holds the parameters; the limb's own variables are added to it for the
/// time of the call.
void expand_limb(const nlohmann::json& limb, Scope& scope, const Units& units, Problems& problems,
                 const std::array<std::string, 2>& base_and_platform,
                 std::vector<JointDraft>& joints);

/// Reads the shapes of a machine whose joints are already there.
void read_shapes(const Layout& layout, const Reader& reader, Mechanism& mechanism);

/// Reads the limits of a machine whose joints and shapes are already there.
void read_limits(const Layout& layout, const Reader& reader, Mechanism& mechanism);

/// expand() without raising: what is wrong goes to `problems`, and then the
/// mechanism is not to be used.
[[nodiscard]] Mechanism assemble(const Layout& layout, const ParameterValues& values,
                                 Problems& problems);

}  // namespace polyglide
