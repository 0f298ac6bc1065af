#include "report/map_picture.hpp"

#include <gtest/gtest.h>

namespace polyglide {
namespace {

using Json = nlohmann::ordered_json;

/// A map of 3 × 2 nodes with one curve.
Json small_map() {
  return Json::parse(
      R"({"name": "a < b & c", "axes": ["X", "C"], "slice": "XC at Y 20 mm", "u": [0, 0.1, 0.2], "v": [0, 1],
    "inverse_condition": [[0.5, 0.5, null], [0.5, 0.2, null]],
    "limit": [[-1, -1, 0], [-1, 2, 0]],
    "curves": [{"kind": "direct", "closed": false, "gained": ["rotation <about> z"], "lost": [],
                "points": [[0, 0.5], [0.2, 0.5]]}]})");
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

TEST(MapPicture, DrawsCurvesAxesAndALegend) {
  const std::string dut = map_svg(small_map());
  EXPECT_TRUE(dut.starts_with("<svg xmlns"));
  EXPECT_EQ(count(dut, "<polyline"), 1u);
  EXPECT_NE(dut.find("singularities over XC at Y 20 mm"), std::string::npos);
  EXPECT_NE(dut.find("X [mm]"), std::string::npos);
  EXPECT_NE(dut.find("C [°]"), std::string::npos);
  EXPECT_NE(dut.find("direct singularity (type II)"), std::string::npos);
  EXPECT_NE(dut.find(">200</text>"), std::string::npos);  // 0.2 m
}

TEST(MapPicture, TextOfTheMapCannotBecomeMarkup) {
  const std::string dut = map_svg(small_map());
  EXPECT_NE(dut.find("a &lt; b &amp; c"), std::string::npos);
  EXPECT_EQ(dut.find("<about>"), std::string::npos);
}

TEST(MapPicture, OfASliceWithoutCurvesSaysSo) {
  Json map = small_map();
  map["curves"] = Json::array();
  EXPECT_NE(map_svg(map).find("no singular curve"), std::string::npos);
}

}  // namespace
}  // namespace polyglide
