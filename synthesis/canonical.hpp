#pragma once

#include <string>

#include "catalog/mechanism.hpp"

namespace polyglide {

/// What is left of a mechanism when its place, its heading and all names and
/// numbers are forgotten.
struct CanonicalForm {
  std::string code;     ///< equal exactly for equal machines; a few kB of text
  double symmetry = 1;  ///< number of rotations and reflections that carry the machine onto
                        ///< itself, times permutations of coincident equal parts
};

/// Two mechanisms have equal codes exactly when one is carried onto the other by
/// a rotation about the vertical, a reflection in a vertical plane, a translation
/// and any renumbering of bodies and joints, both bodies of a joint included.
///
/// What counts: joint kinds, which bodies they join, their points (not of
/// prismatic joints and welds) and axes, pitch, drives, base, platform and tool
/// point. What does not: names, ranges, cones and other limits: they bound a
/// layout, they do not make another one.
///
/// How: the vertical through the centroid of the joint points is common to all
/// these motions, so height and radius of a point do not change, and azimuths
/// can only be turned or mirrored as one. The distinct azimuths in use form a
/// ring coloured by the angles between them; joints, axes and the tool hang on
/// the ring and on the bodies, coloured by kind, height and radius. Two machines
/// are congruent exactly when these coloured graphs are isomorphic, which nauty
/// decides. Lengths are compared to a millionth of the machine's size.
/// Cost: about 0.1 ms for four legs of two rods. Thread-safe.
/// Source: McKay & Piperno, Practical graph isomorphism II (2014), for the labelling.
[[nodiscard]] CanonicalForm canonical_form(const Mechanism& mechanism);

/// Name of a form: the first 12 hex digits of content_hash of its code.
[[nodiscard]] std::string short_id(const CanonicalForm& form);

}  // namespace polyglide
