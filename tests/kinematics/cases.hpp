#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <string>

#include "catalog/catalog.hpp"
#include "kinematics/mobility.hpp"

// Machines by name, as parameters of tests.
namespace polyglide::fixtures {

inline const std::filesystem::path kTruth =
    std::filesystem::path(POLYGLIDE_SOURCE_DIR) / "tests/truth";

/// The parameter as gtest allows it in a test's name.
inline std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::ranges::replace_if(
      name, [](unsigned char c) { return !std::isalnum(c); }, '_');
  return name;
}

inline MobilityReport check(const Mechanism& mechanism) {
  return analyse_mobility(compile(mechanism));
}
inline MobilityReport check(const std::string& name) { return check(expand(find_layout(name))); }

}  // namespace polyglide::fixtures
