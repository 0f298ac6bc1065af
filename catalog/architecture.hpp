#pragma once

#include <string>
#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// A machine's architecture in the terms of the field, from its joint graph: "6-UPS",
/// "3-UPS+UP", "2-UPR+SPR", "4R".
///
/// - A limb is the joints of a chain from the base to the platform, a letter each:
///   R revolute, P prismatic, H helical, C cylindrical, U universal, S spherical, E planar,
///   W weld. Joints are taken as the file has them: two crossing hinges are RR, not U.
/// - Equal limbs are counted, "3-PRS"; others are joined by "+", the most frequent first, then
///   in the order of the file.
/// - Chains side by side within a limb stand in brackets: "3-P(2-US)" is a linear Delta,
///   whose carriages each carry two rods. So do the stages of a hybrid:
///   "(3-PRP)(3-RPS)", "(3-UPS+UP)RR".
/// - A single loop is named by its joints around it from the base: "4R" when they are all alike,
///   else as "RSSR", starting at a driven joint of the base where there is one.
/// - Where chains cross from limb to limb, they are listed in square brackets, each from the end
///   nearer to the base: they do not all run from base to platform.
/// - Bodies that hang on one joint only, and loops that hang on one body, are left out.
///
/// Empty for a mechanism without joints. Cost: microseconds.
[[nodiscard]] std::string architecture(const Mechanism& mechanism);

/// The words an architecture is made of, without counts, brackets and order: "3-UPS+UP"
/// gives "UPS" and "UP". Each once.
[[nodiscard]] std::vector<std::string> limb_words(const std::string& architecture);

}  // namespace polyglide
