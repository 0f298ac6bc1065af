#include "catalog/json_file.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <ctime>
#include <fstream>

namespace polyglide {
namespace {

namespace fs = std::filesystem;

class JsonFile : public testing::Test {
 protected:
  JsonFile() : folder_(fs::temp_directory_path() / ("polyglide-json-" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~JsonFile() override { fs::remove_all(folder_); }

  fs::path write(const std::string& text) const {
    std::ofstream(folder_ / "file.json", std::ios::binary) << text;
    return folder_ / "file.json";
  }
  /// The only mistake of a text; a test failure when it has none or more.
  static Diagnostic mistake(const std::string& text) {
    try {
      static_cast<void>(parse_json(text, "f"));
    } catch (const InputError& error) {
      EXPECT_EQ(error.diagnostics().size(), 1u);
      return error.diagnostics().front();
    }
    ADD_FAILURE() << "accepted: " << text.substr(0, 80);
    return {};
  }

  fs::path folder_;
};

TEST_F(JsonFile, ReadsEveryKindOfValue) {
  const auto json = parse_json(R"({"a": [1, -2, 0.5, true, null, "ü"], "b": {}})", "f");
  EXPECT_EQ(json.dump(), R"({"a":[1,-2,0.5,true,null,"ü"],"b":{}})");
}

TEST_F(JsonFile, ThatIsMissingIsToldByItsName) {
  try {
    static_cast<void>(read_json("/nowhere/at/all.json"));
    FAIL();
  } catch (const InputError& error) {
    EXPECT_STREQ(error.what(), "/nowhere/at/all.json:: there must be a file of this name");
  }
}

TEST_F(JsonFile, MayNotBeAFolder) {
  EXPECT_THROW(static_cast<void>(read_json("/tmp")), InputError);
}

TEST_F(JsonFile, MayNotBeEmpty) {
  EXPECT_EQ(mistake("").rule, "must not be empty");
  EXPECT_EQ(mistake(" \n\t ").rule, "must not be empty");
}

TEST_F(JsonFile, ThatIsNotJsonIsToldWithLineAndColumn) {
  const std::string rule = mistake("{\n  \"a\": 1,\n  oops\n}").rule;
  EXPECT_NE(rule.find("line 3, column 3"), std::string::npos) << rule;
  EXPECT_LT(mistake(std::string(1 << 20, 'a')).rule.size(), 300u);
  EXPECT_LT(mistake('"' + std::string(1 << 20, 'a')).rule.size(), 300u);
}

TEST_F(JsonFile, MayNotHoldNumbersThatAreNotFinite) {
  EXPECT_NE(mistake("[1e999]").rule.find("number overflow"), std::string::npos);
  mistake("[NaN]");
}

TEST_F(JsonFile, MayNotHoldBytesThatAreNotUtf8) { mistake("[\"\xff\"]"); }

TEST_F(JsonFile, WithANameGivenTwiceIsToldWithItsPlace) {
  const Diagnostic diagnostic = mistake(R"({"a": [{"x/y": 1, "x/y": 2}]})");
  EXPECT_EQ(diagnostic.pointer, "/a/0/x~1y");
  EXPECT_EQ(diagnostic.value, "\"x/y\"");
}

TEST_F(JsonFile, MayBeNestedSixtyFourDeepAndNoDeeper) {
  EXPECT_NO_THROW(static_cast<void>(parse_json(std::string(64, '[') + std::string(64, ']'), "f")));
  EXPECT_NE(mistake(std::string(65, '[') + std::string(65, ']')).rule.find("deeper than 64"),
            std::string::npos);
}

TEST_F(JsonFile, OfFiftyMegabytesOfBracketsIsRefusedAtOnce) {
  const fs::path file = write(std::string(50 << 20, '['));
  const std::clock_t start = std::clock();  // processor time: other programs do not count
  EXPECT_THROW(static_cast<void>(read_json(file)), InputError);
  EXPECT_LT(std::clock() - start, CLOCKS_PER_SEC / 2);
}

TEST_F(JsonFile, WithMillionsOfEmptyListsIsRefused) {
  std::string text = "[[]";
  for (int i = 0; i < 2'000'000; ++i) text += ",[]";
  EXPECT_NE(mistake(text + "]").rule.find("2000000 values"), std::string::npos);
}

TEST_F(JsonFile, LargerThanSixtyFourMegabytesIsRefused) {
  const fs::path file = write("");
  fs::resize_file(file, (64 << 20) + 1);
  EXPECT_THROW(static_cast<void>(read_json(file)), InputError);
}

TEST_F(JsonFile, IsWrittenWholeAndLeavesNoDraft) {
  const fs::path file = folder_ / "new" / "deep" / "out.json";
  write_atomically(file, "{}");
  write_atomically(file, "[1]");
  EXPECT_EQ(read_text(file), "[1]");
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1);
}

TEST_F(JsonFile, ThatCannotBeWrittenIsTheUsersMistake) {
  EXPECT_THROW(write_atomically("/proc/nothing/out.json", "{}"), InputError);
}

TEST(ContentHash, IsFnv1a) {
  EXPECT_EQ(content_hash(""), "cbf29ce484222325");
  EXPECT_EQ(content_hash("a"), "af63dc4c8601ec8c");
}

}  // namespace
}  // namespace polyglide
