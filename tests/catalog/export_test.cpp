// What the exported texts say; that other programs agree with it is tests/engines.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <regex>
#include <set>
#include <stdexcept>

#include "catalog/catalog.hpp"
#include "catalog/write_mjcf.hpp"
#include "catalog/write_urdf.hpp"
#include "catalog/xml.hpp"

namespace polyglide {
namespace {

Mechanism machine(const std::string& name) { return expand(find_layout(name)); }

std::size_t count(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  return std::distance(std::sregex_iterator(text.begin(), text.end(), regex),
                       std::sregex_iterator());
}

TEST(Xml, NumbersReadBackAsThemselves) {
  for (const double value : {0.1, 1.0 / 3, -2e-17, 123456.789, 1e300, 5e-324, M_PI}) {
    EXPECT_EQ(std::strtod(xml_number(value).c_str(), nullptr), value);
  }
  EXPECT_EQ(xml_number(-0.0), "0");
  EXPECT_EQ(xml_vector({1, -0.5, 0}), "1 -0.5 0");
}

TEST(Xml, EscapesWhatWouldEndAnAttributeOrAComment) {
  XmlElement root{"a", {{"name", "<b c=\"d\"> & \n\x01"}}, {}};
  root.add("e");
  EXPECT_EQ(to_text(root, "x --> y"),
            "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
            "<!-- x -_> y -->\n"
            "<a name=\"&lt;b c=&quot;d&quot;&gt; &amp; __\">\n"
            "  <e/>\n"
            "</a>\n");
}

TEST(UniqueNames, NumberWhatIsTaken) {
  UniqueNames names;
  EXPECT_EQ(names.take("a"), "a");
  EXPECT_EQ(names.take("a_2"), "a_2");
  EXPECT_EQ(names.take("a"), "a_3");
  EXPECT_EQ(names.take("a\t"), "a_");
}

TEST(Mjcf, HasEveryBodyAndDriveUnderItsNameAndOneTieForEveryLoop) {
  for (const std::string& name : catalog_names()) {
    SCOPED_TRACE(name);
    const Mechanism mechanism = machine(name);
    const std::string xml = to_mjcf(mechanism);
    for (const std::string& body : mechanism.bodies)
      EXPECT_NE(xml.find("<body name=\"" + body + "\""), std::string::npos) << body;
    std::size_t drives = 0;
    for (const Joint& joint : mechanism.joints) drives += joint.driven.size();
    EXPECT_EQ(count(xml, "<position "), drives);
    EXPECT_EQ(count(xml, "<(weld|connect) "),
              mechanism.joints.size() + 1 - mechanism.bodies.size());
    EXPECT_EQ(count(xml, "<site name=\"tool\""), 1u);
  }
}

TEST(Mjcf, ABallThatClosesALoopIsOnePointInCommon) {
  const std::string xml = to_mjcf(machine("hexapod-6ups"));
  EXPECT_EQ(count(xml, "<connect "), 5u);
  EXPECT_EQ(count(xml, "<weld "), 0u);
}

TEST(Mjcf, RangesAreInRadiansAndMetresFromHome) {
  const std::string xml = to_mjcf(machine("four-bar"));
  EXPECT_NE(xml.find("angle=\"radian\""), std::string::npos);
  EXPECT_EQ(count(xml, "name=\"a\" type=\"hinge\"[^>]* range=\"-3.14159\\d* 3.14159\\d*\""), 1u);
}

TEST(Mjcf, AScrewIsAHingeWithASlideThatFollows) {
  Mechanism mechanism = machine("four-bar");
  mechanism.joints[1].type = JointType::helical;
  mechanism.joints[1].pitch = 0.25;
  const std::string xml = to_mjcf(mechanism);
  EXPECT_NE(xml.find("<joint joint1=\"b.advance\" joint2=\"b\" polycoef=\"0 0.25 0 0 0\"/>"),
            std::string::npos);
}

TEST(Urdf, ListsTheLoopsInGepettosWords) {
  EXPECT_EQ(to_urdf(machine("four-bar")).loops,
            "closed_loop: [['closedloop1_A', 'closedloop1_B']]\n"
            "type: ['6d']\n"
            "name_mot: ['a']\n"
            "joint_name: []\n"
            "joint_type: []\n");
}

TEST(Urdf, IsATreeWhoseFramesAllHaveTheirOwnName) {
  for (const std::string& name : catalog_names()) {
    SCOPED_TRACE(name);
    const UrdfFiles files = to_urdf(machine(name));
    EXPECT_EQ(count(files.urdf, "<link "), count(files.urdf, "<joint name=") + 1);
    std::set<std::string> names;
    const std::regex named("<(link|joint) name=\"([^\"]*)\"");
    std::sregex_iterator it(files.urdf.begin(), files.urdf.end(), named), end;
    for (; it != end; ++it) EXPECT_TRUE(names.insert((*it)[2]).second) << (*it)[2];
    for (const char* kind : {"spherical", "universal", "planar", "helical", "cylindrical"})
      EXPECT_EQ(count(files.urdf, std::string("type=\"") + kind), 0u) << kind;
  }
}

TEST(Urdf, QuotesNamesInYaml) {
  Mechanism mechanism = machine("four-bar");
  mechanism.joints[0].name = "driver's: #1";
  EXPECT_NE(to_urdf(mechanism).loops.find("name_mot: ['driver''s: #1']"), std::string::npos);
}

TEST(Export, OfWhatIsNotConnectedIsRefused) {
  Mechanism mechanism = machine("four-bar");
  mechanism.bodies.push_back("island");
  EXPECT_THROW((void)to_mjcf(mechanism), std::invalid_argument);
  EXPECT_THROW((void)to_urdf(mechanism), std::invalid_argument);
}

}  // namespace
}  // namespace polyglide
