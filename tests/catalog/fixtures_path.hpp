#pragma once

#include <string>

namespace polyglide::test {

/// Path of a file in tests/catalog/fixtures.
inline std::string fixture(const std::string& name) {
  return std::string(POLYGLIDE_SOURCE_DIR) + "/tests/catalog/fixtures/" + name;
}

}  // namespace polyglide::test
