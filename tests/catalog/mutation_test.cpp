// Files damaged at random: each is accepted or refused with its mistakes, never
// anything else (run under the sanitizers, this is a fuzzer).
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

using nlohmann::json;

void collect(json& node, std::vector<json*>& nodes) {
  nodes.push_back(&node);
  if (!node.is_structured()) return;
  for (json& child : node) collect(child, nodes);
}

json random_value(std::mt19937& random) {
  static const std::vector<json> kValues = {nullptr,
                                            true,
                                            false,
                                            0,
                                            -1,
                                            3,
                                            1e308,
                                            -1e-308,
                                            "",
                                            "x",
                                            "R",
                                            "1/0",
                                            "rod",
                                            "base",
                                            "platform",
                                            "spherical",
                                            "universal",
                                            "near",
                                            json::array(),
                                            json::object(),
                                            {0, 0, 0},
                                            {1, 2},
                                            {"x", "y"},
                                            {{"k", {0, 1}}},
                                            {{"lean", 90}, {"toward", "x"}}};
  return kValues[random() % kValues.size()];
}

/// Replaces, removes, copies or doubles one value somewhere in the document.
void damage(json& document, std::mt19937& random) {
  std::vector<json*> nodes;
  collect(document, nodes);
  json& node = *nodes[random() % nodes.size()];
  const json other = *nodes[random() % nodes.size()];
  switch (random() % 4) {
    case 0:
      node = random_value(random);
      break;
    case 1:
      node = other;
      break;
    case 2:
      if (node.is_array()) node.push_back(random_value(random));
      break;
    default:
      if (node.is_structured() && !node.empty())
        node.erase(std::next(node.begin(), static_cast<int>(random() % node.size())));
  }
}

/// More rounds for a longer hunt: POLYGLIDE_ROUNDS=100000.
int rounds() {
  const char* given = std::getenv("POLYGLIDE_ROUNDS");
  return given != nullptr ? std::atoi(given) : 600;
}

TEST(DamagedFiles, AreAcceptedOrRefusedWithTheirMistakes) {
  std::vector<json> originals;
  for (const std::string& name : catalog_names()) originals.push_back(find_layout(name).document);
  std::mt19937 random(1);
  int refused = 0;
  for (int round = 0; round < rounds(); ++round) {
    json document = originals[round % originals.size()];
    for (unsigned i = 0; i <= random() % 3; ++i) damage(document, random);
    try {
      const Mechanism mechanism = expand(parse_layout(document, "damaged"));
      EXPECT_FALSE(to_json(mechanism).dump().empty());
    } catch (const InputError& error) {
      EXPECT_FALSE(error.diagnostics().empty());
      ++refused;
    }
    try {  // candidates skip the schema, and must be as safe
      static_cast<void>(expand(make_layout(document, "damaged")));
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(refused, rounds() / 4);
}

}  // namespace
}  // namespace polyglide
