// Laws that hold for every entry of the catalog: a new file is tested by itself.
#include "catalog/catalog.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "catalog/fixtures_path.hpp"
#include "catalog/json_file.hpp"

namespace polyglide {
namespace {

void expect_same(const Mechanism& a, const Mechanism& b) {
  EXPECT_EQ(a.bodies, b.bodies);
  EXPECT_EQ(a.base, b.base);
  EXPECT_EQ(a.platform, b.platform);
  EXPECT_EQ(a.tool, b.tool);
  ASSERT_EQ(a.joints.size(), b.joints.size());
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    const Joint &p = a.joints[i], &q = b.joints[i];
    SCOPED_TRACE(p.name);
    EXPECT_EQ(p.name, q.name);
    EXPECT_EQ(p.type, q.type);
    EXPECT_EQ(p.bodies, q.bodies);
    EXPECT_EQ(p.driven, q.driven);
    EXPECT_LT((p.at - q.at).norm(), 1e-15);
    EXPECT_LT((p.axes[0] - q.axes[0]).norm() + (p.axes[1] - q.axes[1]).norm(), 1e-15);
    EXPECT_NEAR(p.pitch, q.pitch, 1e-15);
    EXPECT_EQ(p.cone.has_value(), q.cone.has_value());
    EXPECT_NEAR(p.cone.value_or(0), q.cone.value_or(0), 1e-15);
    EXPECT_LT((p.cone_axis - q.cone_axis).norm(), 1e-15);
    ASSERT_EQ(p.range.size(), q.range.size());
    for (std::size_t k = 0; k < p.range.size(); ++k) {
      EXPECT_DOUBLE_EQ(p.range[k].min, q.range[k].min);
      EXPECT_DOUBLE_EQ(p.range[k].max, q.range[k].max);
    }
  }
  ASSERT_EQ(a.limits.size(), b.limits.size());
  for (std::size_t i = 0; i < a.limits.size(); ++i) {
    EXPECT_EQ(a.limits[i].name, b.limits[i].name);
    EXPECT_EQ(a.limits[i].body, b.limits[i].body);
    ASSERT_EQ(a.limits[i].points.size(), b.limits[i].points.size());
    ASSERT_EQ(a.limits[i].planes.size(), b.limits[i].planes.size());
    for (std::size_t k = 0; k < a.limits[i].planes.size(); ++k) {
      EXPECT_LT((a.limits[i].planes[k].normal - b.limits[i].planes[k].normal).norm(), 1e-15);
      EXPECT_NEAR(a.limits[i].planes[k].offset, b.limits[i].planes[k].offset, 1e-15);
    }
  }
}

void expect_round_trip(const Layout& layout) {
  const Mechanism mechanism = expand(layout);
  const std::string text = to_json(mechanism).dump(2);
  expect_same(mechanism, expand(parse_layout(parse_json(text, "again"), "again")));
}

class CatalogEntry : public testing::TestWithParam<std::string> {};

TEST_P(CatalogEntry, HasTheNameOfItsFileASourceAndAbout) {
  const Layout layout = find_layout(GetParam());
  EXPECT_EQ(layout.name, GetParam());
  EXPECT_FALSE(layout.title.empty());
  EXPECT_FALSE(layout.source.empty());
  EXPECT_FALSE(layout.about.empty());
  for (const Parameter& parameter : layout.parameters) EXPECT_FALSE(parameter.about.empty());
}

TEST_P(CatalogEntry, HasUnitAxesAndAPointForEveryJoint) {
  for (const Joint& joint : expand(find_layout(GetParam())).joints) {
    EXPECT_NEAR(joint.axes[0].norm(), 1, 1e-15) << joint.name;
    EXPECT_NEAR(joint.axes[1].norm(), 1, 1e-15) << joint.name;
    EXPECT_NEAR(joint.cone_axis.norm(), joint.cone ? 1 : 0, 1e-15) << joint.name;
    EXPECT_TRUE(joint.at.allFinite());
  }
}

TEST_P(CatalogEntry, StandsWithinItsLimitsAtHome) {
  const Mechanism machine = expand(find_layout(GetParam()));
  for (const Joint& joint : machine.joints)
    for (const Range& range : joint.range) {
      EXPECT_LE(range.min, 0) << joint.name;
      EXPECT_GE(range.max, 0) << joint.name;
    }
  for (const HalfSpaceLimit& limit : machine.limits)
    for (const auto& plane : limit.planes)
      for (const Vector3& point : limit.points) EXPECT_LE(plane.normal.dot(point), plane.offset);
}

TEST_P(CatalogEntry, LimitsEveryDrive) {
  for (const Joint& joint : expand(find_layout(GetParam())).joints)
    for (const int driven : joint.driven) {
      ASSERT_GT(static_cast<int>(joint.range.size()), driven) << joint.name;
      EXPECT_TRUE(std::isfinite(joint.range[driven].min) && std::isfinite(joint.range[driven].max));
    }
}

TEST_P(CatalogEntry, UsesAllItsParameters) {
  const Layout layout = find_layout(GetParam());
  const auto used = used_names(layout.document);
  for (const Parameter& parameter : layout.parameters)
    EXPECT_TRUE(used.contains(parameter.name)) << parameter.name;
}

TEST_P(CatalogEntry, ExpandsAtBothEndsOfEveryParameterOrSaysThatRodsDoNotReach) {
  const Layout layout = find_layout(GetParam());
  for (const Parameter& parameter : layout.parameters)
    for (const double value : {parameter.min, parameter.max}) {
      try {
        EXPECT_FALSE(expand(layout, {{parameter.name, value}}).joints.empty());
      } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("does not close"), std::string::npos)
            << error.what();
      }
    }
}

TEST_P(CatalogEntry, IsTheSameAfterWritingAndReading) {
  expect_round_trip(find_layout(GetParam()));
}

INSTANTIATE_TEST_SUITE_P(Catalog, CatalogEntry, testing::ValuesIn(catalog_names()),
                         [](const auto& entry) {
                           std::string name = entry.param;
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

TEST(Catalog, HoldsTheReservedNames) {
  const auto names = catalog_names();
  for (const char* name : {"table1-1", "table1-2", "table1-3", "table1-4", "table1-5", "table1-6",
                           "delta-1", "tripod-70", "hexapod-6ups", "3-prp", "3-rps",
                           "hybrid-3prp-3rps", "four-bar", "bennett", "sarrus"})
    EXPECT_TRUE(std::ranges::count(names, name)) << name;
}

TEST(ToJson, KeepsEveryKindOfJoint) {
  expect_round_trip(load_layout(test::fixture("every_joint.json")));
  expect_round_trip(load_layout(test::fixture("metres.json")));
}

TEST(ToJson, WritesPeoplesNumbersBackAsTheyWere) {
  const auto json = to_json(expand(load_layout(test::fixture("every_joint.json"))));
  EXPECT_EQ(json["joints"][0]["range"].dump(), "[-90,90]");
  EXPECT_EQ(json["joints"][1]["range"].dump(), "[null,5]");
  EXPECT_EQ(json["joints"][2]["pitch"].dump(), "0.4");
  EXPECT_EQ(json["tool"].dump(), "[1,2,3]");
}

}  // namespace
}  // namespace polyglide
