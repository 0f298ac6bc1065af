#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// Whether a word of a file means this name: it is the same, with * for any letters and ? for any
/// one; or it means so the limb that the name belongs to, with or without the number of the copy:
/// "leg1.rod" is meant by leg1.rod, leg*.rod, leg1 and leg.
[[nodiscard]] bool means(std::string_view word, std::string_view name);

/// Whether two shapes are always in touch: they are of one body, a joint connects them, joints
/// of both are at one point of a third body, or one is the rail on which the other, or what
/// carries it, slides.
enum class Contact { none, joined, same_body };
[[nodiscard]] Contact contact(const Mechanism& mechanism, const BodyShape& a, const BodyShape& b);

/// Points of a body at which joints other than slides connect it, each once.
[[nodiscard]] std::vector<Vector3> joint_points(const Mechanism& mechanism, int body);

}  // namespace polyglide
