// Opens written reports in headless Chromium, from disk, and looks at what is
// really drawn. Skipped where Chromium is not installed.
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>

#include "catalog/json_file.hpp"
#include "report/html.hpp"
#include "sample.hpp"

namespace polyglide {
namespace {

namespace fs = std::filesystem;
using fixtures::sample;

/// What the browser made of a page.
struct Opened {
  std::map<std::string, std::string> marks;  ///< data-* of <html>
  std::string console;                       ///< every console message
  std::string dom;

  int count(const std::string& mark) const {
    return marks.contains(mark) ? std::stoi(marks.at(mark)) : -1;
  }
};

class Page : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium-headless-shell >/dev/null 2>&1") != 0) {
      GTEST_SKIP() << "chromium-headless-shell is not installed";
    }
    std::string name = (fs::temp_directory_path() / "polyglide-page-XXXXXX").string();
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override {
    if (!folder_.empty()) fs::remove_all(folder_);
  }

  /// Writes the report of a run and opens it; `fragment` follows the '#', `script`
  /// is run in the page after it has drawn itself.
  Opened open(const nlohmann::json& run, const std::string& fragment = "",
              const std::string& script = "") {
    const fs::path file = folder_ / "report.html";
    write_html(run, file);
    if (!script.empty()) {
      write_atomically(file, read_text(file) + "<script>" + script + "</script>");
    }
    // Chromium keeps its profile, caches and temporary files in our folder.
    const std::string command =
        "cd '" + folder_.string() +
        "' && HOME=$PWD TMPDIR=$PWD timeout 120 chromium-headless-shell" +
        " --no-sandbox --disable-gpu --use-gl=angle --use-angle=swiftshader"
        " --enable-unsafe-swiftshader --user-data-dir=profile --window-size=1200,900"
        " --virtual-time-budget=8000 --enable-logging=stderr --dump-dom 'file://" +
        file.string() + "#" + fragment + "' >dom.html 2>log.txt";
    // On a busy machine the budget may be spent before the page has drawn itself.
    std::string dom;
    for (int attempt = 0; attempt < 3 && dom.find("data-rendered") == std::string::npos;
         ++attempt) {
      EXPECT_EQ(std::system(command.c_str()), 0) << read_text(folder_ / "log.txt");
      dom = read_text(folder_ / "dom.html");
    }
    return {marks_of(dom), console_of(read_text(folder_ / "log.txt")), dom};
  }

 private:
  static std::map<std::string, std::string> marks_of(const std::string& dom) {
    const std::string tag = dom.substr(0, dom.find("<head"));
    std::map<std::string, std::string> marks;
    const std::regex mark("data-([a-z-]+)=\"([^\"]*)\"");
    for (std::sregex_iterator it(tag.begin(), tag.end(), mark), end; it != end; ++it) {
      marks[(*it)[1]] = (*it)[2];
    }
    return marks;
  }

  /// Chromium's own remark that reading pixels back is slow on a software renderer
  /// is no message of the page.
  static std::string console_of(const std::string& log) {
    std::istringstream lines(log);
    std::string line, out;
    while (std::getline(lines, line)) {
      if (line.find("CONSOLE") == std::string::npos) continue;
      if (line.find("GL Driver Message (OpenGL, Performance") != std::string::npos) continue;
      out += line + '\n';
    }
    return out;
  }

  fs::path folder_;
};

TEST_F(Page, DrawsEveryPartOfAFullRunWithAnEmptyConsole) {
  const Opened page = open(sample());
  EXPECT_EQ(page.console, "");
  EXPECT_EQ(page.marks.at("rendered"), "true");
  EXPECT_EQ(page.count("rank-rows"), 4);
  EXPECT_GT(page.count("heatmap-cells"), 200);
  EXPECT_GT(page.count("chart-marks"), page.count("heatmap-cells"));
  EXPECT_GT(page.count("scheme-segments"), 20);
  EXPECT_GT(page.count("scheme-pixels"), 2000);
  EXPECT_EQ(page.count("dimension-labels"), 5) << "rod, R, r, lean and gap are in the drawing";
  for (const char* id :
       {"requirements", "ranking", "machine", "stability", "duel", "rejected", "provenance"}) {
    EXPECT_NE(page.dom.find("<section id=\"" + std::string(id) + '"'), std::string::npos) << id;
  }
  EXPECT_EQ(page.dom.find("class=\"failed\""), std::string::npos);
}

TEST_F(Page, DrawsAPictureOfEveryRankedLayoutThatHasAScene) {
  nlohmann::json run = sample();
  EXPECT_EQ(open(run).count("rank-pictures"), 4);
  const nlohmann::json scene = run["layouts"].back()["scene"];
  run["layouts"].erase(run["layouts"].size() - 1);
  EXPECT_EQ(open(run).count("rank-pictures"), 3) << "no details are stored of the last";
  run["ranking"].back()["scene"] = {{"bodies", scene["bodies"]}, {"segments", scene["segments"]}};
  const Opened page = open(run);
  EXPECT_EQ(page.count("rank-pictures"), 4);
  EXPECT_EQ(page.console, "");
}

TEST_F(Page, ShowsTheLayoutNamedInTheAddressAlsoARejectedOne) {
  const Opened page = open(sample(), "layout-e58f613ac9027bd4");
  EXPECT_EQ(page.console, "");
  EXPECT_GT(page.count("scheme-pixels"), 1000);
  EXPECT_EQ(page.count("heatmap-cells"), 0) << "a rejected layout has no workspace";
  EXPECT_NE(page.dom.find("The freedom that is left"), std::string::npos);
  EXPECT_NE(page.dom.find("&lt;script&gt;-like title &lt;/script&gt;"), std::string::npos);
}

TEST_F(Page, FollowsClicksSlidersAndThePlayButton) {
  const Opened page = open(sample(), "", R"(
    addEventListener("load", () => setTimeout(() => {
      const marks = document.documentElement.dataset;
      const slide = (drive, end) => {
        const input = document.querySelectorAll(".drive input")[drive];
        input.value = input[end];
        input.dispatchEvent(new Event("input"));
      };
      document.querySelector("tr[data-layout='3fa1c07be2d94415']").click();
      marks.shown = document.querySelector(".chooser select").value;
      marks.outputs = document.querySelectorAll(".drive output").length;
      for (const drive of [0, 1, 2]) slide(drive, "max");
      marks.apart = document.querySelector(".status").textContent;
      document.querySelector(".drives button").click();
      marks.home = document.querySelector(".status").textContent;
      document.querySelector(".tick input").click();
      document.querySelectorAll("button.slice")[9].click();
      document.querySelector("button.card[data-layout='e58f613ac9027bd4']").click();
      document.querySelector("button.play").click();
      setTimeout(() => {
        marks.playing = document.querySelector("button.play").textContent;
        document.querySelector("button.play").click();
        marks.stopped = document.querySelector("button.play").textContent;
      }, 300);
    }, 500));)");
  EXPECT_EQ(page.console, "");
  EXPECT_EQ(page.marks.at("shown"), "3fa1c07be2d94415");
  EXPECT_EQ(page.marks.at("outputs"), "3");
  EXPECT_EQ(page.marks.at("apart"), "The machine cannot be assembled here.");
  EXPECT_EQ(page.marks.at("home"), "");
  EXPECT_NE(page.marks.at("playing").find("Stop"), std::string::npos);
  EXPECT_NE(page.marks.at("stopped").find("Play"), std::string::npos);
}

TEST_F(Page, LeavesOutWhatARunDoesNotHold) {
  nlohmann::json run = sample();
  for (const char* key :
       {"requirements", "stability", "duel", "rejected", "provenance", "indices", "counts"}) {
    run.erase(key);
  }
  for (nlohmann::json& layout : run["layouts"]) {
    layout.erase("workspace");
    layout.erase("convergence");
    layout.erase("check");
    layout["scene"].erase("poses");
  }
  const Opened page = open(run);
  EXPECT_EQ(page.console, "");
  EXPECT_EQ(page.count("heatmap-cells"), 0);
  EXPECT_GT(page.count("scheme-pixels"), 1000);
}

TEST_F(Page, ARunOfNothingGivesAPageThatSaysSo) {
  const Opened page = open({{"format", "polyglide/run/1"}, {"kind", "design"}});
  EXPECT_EQ(page.console, "");
  EXPECT_EQ(page.marks.at("rendered"), "true");
  EXPECT_NE(page.dom.find("No layout satisfies the brief"), std::string::npos);
}

}  // namespace
}  // namespace polyglide
