// The published schemas, and our reading of them, against an independent validator.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <sstream>

#include "catalog/catalog.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

namespace fs = std::filesystem;

/// Every JSON file of the project that a schema of ours describes.
std::vector<fs::path> described_files() {
  const fs::path source = POLYGLIDE_SOURCE_DIR;
  std::vector<fs::path> files;
  for (const char* folder : {"catalog/data", "examples", "tests/catalog/fixtures"})
    for (const auto& entry : fs::recursive_directory_iterator(source / folder))
      if (entry.path().extension() == ".json") files.push_back(entry.path());
  return files;
}

/// "polyglide/layout/1" → "layout-1"; "" when the format has no schema.
std::string schema_of(const nlohmann::json& document) {
  const std::string format = document.value("format", "");
  for (const char* kind : {"mechanism", "layout", "space", "brief", "study"})
    if (format == "polyglide/" + std::string(kind) + "/1") return kind + std::string("-1");
  return "";
}

TEST(Schemas, JudgeEveryFileAsPythonJsonschemaDoes) {
  const fs::path verdicts =
      fs::temp_directory_path() / ("polyglide-schema-" + std::to_string(getpid()));
  const std::string command = "/usr/bin/python3 " POLYGLIDE_SOURCE_DIR
                              "/tests/catalog/validate.py " POLYGLIDE_SOURCE_DIR
                              "/catalog/schema >" +
                              verdicts.string();
  std::string arguments;
  std::vector<std::pair<fs::path, bool>> ours;
  for (const fs::path& file : described_files()) {
    const auto document = read_json(file);
    const std::string schema = schema_of(document);
    if (schema.empty()) continue;
    ours.emplace_back(file, check_schema(document, schema, file.string()).empty());
    arguments += ' ' + file.string();
  }
  ASSERT_GT(ours.size(), 15u);
  const std::string whole = command + arguments;
  ASSERT_EQ(std::system(whole.c_str()), 0) << "needs python3-jsonschema";
  std::istringstream theirs(read_text(verdicts));
  fs::remove(verdicts);
  for (const auto& [file, valid] : ours) {
    std::string verdict;
    theirs >> verdict;
    EXPECT_EQ(verdict, valid ? "valid" : "invalid") << file;
  }
}

TEST(Schemas, DescribeEveryProperty) {
  for (const auto& entry : fs::directory_iterator(data_directory() / "catalog" / "schema")) {
    const auto schema = read_json(entry.path());
    const std::function<void(const nlohmann::json&, const std::string&)> visit =
        [&](const nlohmann::json& part, const std::string& place) {
          if (part.is_object() && part.contains("properties")) {
            for (const auto& [name, property] : part["properties"].items())
              EXPECT_TRUE(property.contains("description"))
                  << entry.path().filename() << place << '/' << name;
          }
          if (part.is_structured())
            for (const auto& [name, child] : part.items()) visit(child, place + '/' + name);
        };
    visit(schema, "");
  }
}

std::vector<Diagnostic> violations(const char* text, const std::string& schema) {
  return check_schema(parse_json(text, "f"), schema, "f");
}

TEST(Schemas, OfABriefAndAStudyTellTyposWithTheNearestName) {
  const auto brief = violations(
      R"({"format": "polyglide/brief/1", "name": "x", "space": "s.json", "motion": "XYZA",
          "objectves": {"workspace": 1}})",
      "brief-1");
  ASSERT_EQ(brief.size(), 2u);
  EXPECT_NE(brief[0].rule.find("\"objectives\" must be given"), std::string::npos);
  EXPECT_EQ(brief[1].hint, "did you mean \"objectives\"?");
}

}  // namespace
}  // namespace polyglide
