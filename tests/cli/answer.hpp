#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/run_program.hpp"

namespace polyglide::test {

/// The document that the program answers with; the test fails unless it ends with status 0.
inline nlohmann::json answer(std::vector<std::string> words) {
  words.emplace_back("--json");
  words.emplace_back("--quiet");
  const ProgramResult dut = run_polyglide(words);
  EXPECT_EQ(dut.status, 0) << dut.err;
  return nlohmann::json::parse(dut.out, nullptr, false);
}

}  // namespace polyglide::test
