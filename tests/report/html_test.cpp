#include "report/html.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "sample.hpp"

namespace polyglide {
namespace {

namespace fs = std::filesystem;
using fixtures::sample;

const WebBundle kTinyBundle{"draw();", "p { color: black }"};

/// What stands between the island's tags.
std::string island_of(const std::string& html) {
  const std::string open = R"(<script type="application/json" id="run">)";
  const std::size_t from = html.find(open) + open.size();
  return html.substr(from, html.find("</script>", from) - from);
}

TEST(Html, TextOfTheRunCannotEndTheIslandOrOpenAComment) {
  const nlohmann::json run = {{"title", "</script><script>alert(1)</script> <!-- & ]]>"}};
  const std::string html = render_html(run, kTinyBundle);
  const std::string island = island_of(html);
  EXPECT_EQ(island.find('<'), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(island), run);
  EXPECT_NE(html.find("<title>&lt;/script&gt;&lt;script&gt;alert(1)"), std::string::npos);
}

TEST(Html, TheRunComesBackFromTheIslandWithSevenDigits) {
  const nlohmann::json run = {{"a", 0.123456789012}, {"n", 12345678901}, {"list", {1.5, nullptr}}};
  const auto back = nlohmann::json::parse(island_of(render_html(run, kTinyBundle)));
  EXPECT_DOUBLE_EQ(back["a"].get<double>(), 0.1234568);
  EXPECT_EQ(back["n"], run["n"]);
  EXPECT_EQ(back["list"], run["list"]);
}

TEST(Html, ANumberThatIsNotFiniteBecomesNull) {
  const nlohmann::json run = {{"a", std::nan("")}};
  EXPECT_EQ(island_of(render_html(run, kTinyBundle)), R"({"a":null})");
}

TEST(Html, InvalidUtf8IsReplacedAndDoesNotStopTheReport) {
  const nlohmann::json run = {{"title", "a\xff"}};
  EXPECT_NO_THROW(nlohmann::json::parse(island_of(render_html(run, kTinyBundle))));
}

TEST(Html, APageWithoutTitleIsNamedAfterItsRun) {
  EXPECT_NE(render_html({{"name", "r"}}, kTinyBundle).find("<title>r</title>"), std::string::npos);
  EXPECT_NE(render_html({{"title", nullptr}}, kTinyBundle).find("<title>Design report</title>"),
            std::string::npos);
}

TEST(Html, ThePageLoadsNothingAndForbidsItself) {
  const std::string html = render_html(sample(), load_web_bundle());
  const std::string shell = render_html(nlohmann::json::object(), kTinyBundle);
  EXPECT_NE(shell.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(shell.find("http"), shell.find("http-equiv"));
  for (const char* loader : {" src=", "<link", "<iframe", "@import", "import("}) {
    EXPECT_EQ(shell.find(loader), std::string::npos) << loader;
  }
  EXPECT_LT(html.size(), 5'000'000u);
}

TEST(Html, TheBundleCannotEndItsOwnElements) {
  const WebBundle bundle = load_web_bundle();
  EXPECT_EQ(bundle.script.find("</script"), std::string::npos);
  EXPECT_EQ(bundle.script.find("<!--"), std::string::npos);
  EXPECT_EQ(bundle.style.find("</style"), std::string::npos);
  EXPECT_EQ(bundle.style.find("url("), std::string::npos);
}

TEST(Html, TheBundleHoldsItsLibrariesLicences) {
  const std::string script = load_web_bundle().script;
  for (const char* words : {"Permission is hereby granted", "Apache License", "three.js authors"}) {
    EXPECT_NE(script.find(words), std::string::npos) << words;
  }
}

TEST(Html, TheFileIsWrittenWholeWithItsFolder) {
  const fs::path folder = fs::path(testing::TempDir()) / "polyglide_html";
  fs::remove_all(folder);
  const fs::path file = folder / "deep" / "report.html";
  write_html(sample(), file);
  const std::string html = read_text(file);
  EXPECT_EQ(html, render_html(sample(), load_web_bundle()));
  EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), {}), 1)
      << "a temporary file was left behind";
  fs::remove_all(folder);
}

TEST(Html, AMissingBundleIsReportedWithThePlacesTried) {
  const fs::path nowhere = fs::path(testing::TempDir()) / "polyglide_no_bundle";
  try {
    (void)load_web_bundle({nowhere / "a", nowhere / "b"});
    FAIL() << "no bundle was there";
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find((nowhere / "a").string()), std::string::npos);
    EXPECT_NE(message.find((nowhere / "b").string()), std::string::npos);
    EXPECT_NE(message.find("polyglide_web"), std::string::npos);
  }
}

}  // namespace
}  // namespace polyglide
