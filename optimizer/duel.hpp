#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "optimizer/brief.hpp"
#include "optimizer/families.hpp"

namespace polyglide {

/// Checks that the space knows what a duel names.
/// @throws InputError a catalog entry that the space does not contain, a choice that it
///         does not have (with the nearest).
void check_duel(const Brief& brief, const Space& space, const Enumeration& enumeration);

/// Is one of the family's layouts of the arrangement that `known` stands for?
[[nodiscard]] bool belongs_to(const Family& family, const std::string& known,
                              const DuelRequest& request, const Enumeration& enumeration);

/// Two arrangements of the space held against each other, each represented by its best
/// tuned layout: `duel` of a stored run, with a sentence that says who wins by what.
/// An arrangement is all layouts that choose like the named one in the choices `by`.
/// null when one of them has no tuned layout.
[[nodiscard]] nlohmann::ordered_json duel_json(const DuelRequest& request,
                                               const Enumeration& enumeration,
                                               const std::vector<Family>& families);

}  // namespace polyglide
