#include "synthesis/canonical.hpp"

#include <gtest/gtest.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "catalog/catalog.hpp"
#include "congruence.hpp"
#include "machines.hpp"
#include "synthesis/space.hpp"

namespace polyglide {
namespace {

using testing::congruent;

constexpr std::uint64_t kSeed = 20240501;

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(engine_); }
  bool coin() { return below(2) == 1; }
  Vector3 direction() {
    return Vector3(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)).normalized();
  }
  std::vector<int> permutation(std::size_t size) {
    std::vector<int> order(size);
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), engine_);
    return order;
  }

 private:
  std::mt19937_64 engine_;
};

// Any joint kinds, any graph; not assembled in any sense, which the form does not ask.
Mechanism random_mechanism(Random& random) {
  Mechanism mechanism;
  mechanism.bodies = {"base", "platform", "p", "q", "r", "s"};
  mechanism.platform = 1;
  mechanism.tool = random.direction();
  for (int i = 0; i < 10; ++i) {
    Joint joint;
    joint.name = "j" + std::to_string(i);
    joint.type = static_cast<JointType>(random.below(8));
    joint.bodies[0] = random.below(6);
    joint.bodies[1] = (joint.bodies[0] + 1 + random.below(5)) % 6;
    joint.at = 2 * random.direction();
    joint.axes = {random.direction(), random.direction()};
    joint.pitch = random.uniform(-0.1, 0.1);
    const bool drivable = joint.type != JointType::spherical && joint.type != JointType::planar;
    if (drivable && freedoms(joint.type) > 0 && random.coin())
      joint.driven = {random.below(freedoms(joint.type))};
    mechanism.joints.push_back(joint);
  }
  return mechanism;
}

// The same joint told the other way round.
Joint reversed(Joint joint) {
  std::swap(joint.bodies[0], joint.bodies[1]);
  if (joint.type != JointType::universal) return joint;
  std::swap(joint.axes[0], joint.axes[1]);
  for (int& freedom : joint.driven) freedom = 1 - freedom;
  return joint;
}

// The same machine elsewhere, turned, perhaps mirrored, and told in another order.
Mechanism moved(const Mechanism& original, Random& random) {
  const bool mirrored = random.coin();
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(random.uniform(0, 7), Vector3::UnitZ()).toRotationMatrix() *
      Vector3(1, mirrored ? -1 : 1, 1).asDiagonal();
  const Vector3 shift = 3 * random.direction();
  const std::vector<int> body = random.permutation(original.bodies.size());
  Mechanism result = original;
  result.base = body[original.base];
  result.platform = body[original.platform];
  result.tool = turn * original.tool + shift;
  for (std::size_t i = 0; i < body.size(); ++i) result.bodies[body[i]] = original.bodies[i] + "'";
  result.joints.clear();
  for (const int i : random.permutation(original.joints.size())) {
    Joint joint = original.joints[i];
    joint.name += "'";
    for (int& end : joint.bodies) end = body[end];
    joint.at = turn * joint.at + shift;
    for (Vector3& axis : joint.axes) axis = (random.coin() ? 1 : -1) * (turn * axis);
    if (mirrored) joint.pitch = -joint.pitch;
    result.joints.push_back(random.coin() ? reversed(joint) : joint);
  }
  return result;
}

std::vector<Mechanism> expand_all(const Space& space) {
  std::vector<Mechanism> result;
  for (std::uint64_t i = 0; i < raw_count(space); ++i)
    result.push_back(expand(make_layout(raw_candidate(space, i).layout, "test")));
  return result;
}

std::size_t distinct_forms(const std::vector<Mechanism>& mechanisms) {
  std::set<std::string> codes;
  for (const Mechanism& mechanism : mechanisms) codes.insert(canonical_form(mechanism).code);
  return codes.size();
}

// Keeps the first of every class of congruent ones.
std::size_t distinct_by_trial(const std::vector<Mechanism>& mechanisms) {
  std::vector<const Mechanism*> found;
  for (const Mechanism& mechanism : mechanisms)
    if (std::ranges::none_of(found,
                             [&](const Mechanism* one) { return congruent(*one, mechanism); }))
      found.push_back(&mechanism);
  return found.size();
}

// Colourings of a ring of n by k colours up to turning and mirroring (Burnside):
// every turn by i fixes k^gcd(i,n); a mirror fixes k^(number of limbs or pairs it keeps).
std::size_t bracelets(int n, int k) {
  double fixed = 0;
  for (int i = 0; i < n; ++i) fixed += std::pow(k, std::gcd(i, n));
  fixed += n % 2 == 1 ? n * std::pow(k, (n + 1) / 2)
                      : n / 2 * (std::pow(k, n / 2) + std::pow(k, n / 2 + 1));
  return static_cast<std::size_t>(std::lround(fixed / (2 * n)));
}

Space necklace(int limbs, const std::vector<std::string>& ends) {
  return parse_space(testing::necklace(limbs, ends), "necklace");
}

TEST(CanonicalForm, IsTheSameForAMachineMovedMirroredAndRenumbered) {
  Random random(kSeed);
  for (int trial = 0; trial < 200; ++trial) {
    const Mechanism original = random_mechanism(random);
    const Mechanism other = moved(original, random);
    const CanonicalForm a = canonical_form(original), b = canonical_form(other);
    EXPECT_EQ(a.code, b.code) << "trial " << trial;
    EXPECT_EQ(a.symmetry, b.symmetry);
    EXPECT_EQ(short_id(a), short_id(b));
    EXPECT_EQ(short_id(a).size(), 12);
  }
}

TEST(CanonicalForm, IsTheSameForEveryCatalogEntryMovedMirroredAndRenumbered) {
  Random random(kSeed);
  for (const std::string& name : catalog_names()) {
    const Mechanism original = expand(find_layout(name));
    for (int trial = 0; trial < 10; ++trial)
      EXPECT_EQ(canonical_form(original).code, canonical_form(moved(original, random)).code)
          << name;
  }
}

TEST(CanonicalForm, TellsCatalogEntriesApart) {
  std::set<std::string> ids;
  for (const std::string& name : catalog_names())
    EXPECT_TRUE(ids.insert(short_id(canonical_form(expand(find_layout(name))))).second) << name;
}

TEST(CanonicalForm, ChangesWithAnyOneJoint) {
  Random random(kSeed);
  const Mechanism original = expand(find_layout("table1-6"));
  const std::string code = canonical_form(original).code;
  for (std::size_t i = 0; i < original.joints.size(); ++i) {
    std::vector<Mechanism> changed(4, original);
    Joint& other_type = changed[0].joints[i];
    other_type.type =
        other_type.type == JointType::revolute ? JointType::spherical : JointType::revolute;
    Joint& driven = changed[1].joints[i];
    driven.driven = driven.driven.empty() ? std::vector{0} : std::vector<int>{};
    Joint& elsewhere = changed[2].joints[i];
    if (elsewhere.type == JointType::prismatic)
      elsewhere.axes[0] = random.direction();
    else
      elsewhere.at += 1e-4 * random.direction();
    Joint& elsewhere_joined = changed[3].joints[i];
    elsewhere_joined.bodies[1] =
        elsewhere_joined.bodies[1] == changed[3].platform ? changed[3].base : changed[3].platform;
    for (const Mechanism& mechanism : changed)
      EXPECT_NE(canonical_form(mechanism).code, code) << original.joints[i].name;
  }
}

TEST(CanonicalForm, KnowsUpFromDownAndLargeFromSmall) {
  const Mechanism original = expand(find_layout("tripod-70"));
  Mechanism upside_down = original, doubled = original;
  upside_down.tool.z() *= -1;
  doubled.tool *= 2;
  for (Joint& joint : upside_down.joints) {
    joint.at.z() *= -1;
    for (Vector3& axis : joint.axes) axis.z() *= -1;
  }
  for (Joint& joint : doubled.joints) joint.at *= 2;
  EXPECT_NE(canonical_form(original).code, canonical_form(upside_down).code);
  EXPECT_NE(canonical_form(original).code, canonical_form(doubled).code);
}

TEST(CanonicalForm, TellsLeftFromRightWhereThreadsMakeADifference) {
  // Two screws: same hands or opposite hands is a difference, both left or both right is not.
  Mechanism machine;
  machine.bodies = {"base", "platform"};
  machine.platform = 1;
  for (int i = 0; i < 2; ++i) {
    Joint joint;
    joint.type = JointType::helical;
    joint.bodies = {0, 1};
    joint.at = Vector3(i == 0 ? 1 : -1, 0.3, 0);
    joint.pitch = 0.01;
    machine.joints.push_back(joint);
  }
  Mechanism both_left = machine, opposite = machine;
  for (Joint& joint : both_left.joints) joint.pitch *= -1;
  opposite.joints[0].pitch *= -1;
  EXPECT_EQ(canonical_form(machine).code, canonical_form(both_left).code);
  EXPECT_NE(canonical_form(machine).code, canonical_form(opposite).code);
}

TEST(CanonicalForm, CountsTheSymmetriesOfAMachine) {
  EXPECT_EQ(canonical_form(expand(find_layout("tripod-70"))).symmetry, 6);
  EXPECT_EQ(canonical_form(expand(find_layout("table1-2"))).symmetry, 8);
  EXPECT_EQ(canonical_form(expand(find_layout("table1-3"))).symmetry, 4);
  EXPECT_EQ(canonical_form(expand(find_layout("table1-6"))).symmetry, 2);
}

TEST(CanonicalForm, AcceptsMachinesWithoutAnyPointOrAzimuth) {
  Mechanism lift;
  lift.bodies = {"base", "platform"};
  lift.platform = 1;
  Joint slide;
  slide.type = JointType::prismatic;
  slide.bodies = {0, 1};
  lift.joints = {slide};
  EXPECT_NE(canonical_form(lift).code, "");
  lift.joints.clear();
  EXPECT_NE(canonical_form(lift).code, "");
}

TEST(CanonicalForm, CountsNecklacesAsBurnsideDoes) {
  EXPECT_EQ(bracelets(4, 3), (81 + 2 * 27 + 3 * 9 + 2 * 3) / 8);  // the textbook's formula
  const std::vector<std::string> ends = {"tangential", "radial", "z", "spherical"};
  for (const auto& [limbs, colours] : {std::pair{3, 4}, {4, 2}, {4, 3}, {4, 4}, {5, 3}, {6, 2}}) {
    const Space space = necklace(limbs, {ends.begin(), ends.begin() + colours});
    EXPECT_EQ(distinct_forms(expand_all(space)), bracelets(limbs, colours))
        << limbs << " limbs, " << colours << " ends";
  }
}

TEST(CanonicalForm, CountsHandedNecklacesAsBurnsideDoes) {
  // Each limb has its axis askew to the left or to the right; mirrors swap the two. Of the
  // square's motions, turns fix 16 + 2 + 4 + 2, mirrors through limbs none, mirrors between
  // limbs 4 each: (24 + 2·4)/8.
  testing::Json document = testing::necklace(4, {"x", "y"});
  for (testing::Json& limb : document["limbs"]) {
    testing::Json& options = limb["rods"]["carriage"]["choose"];
    options[0]["value"]["axis"] = {1, 1, 0};
    options[1]["value"]["axis"] = {1, -1, 0};
  }
  EXPECT_EQ(distinct_forms(expand_all(parse_space(document, "handed"))), 4);
}

TEST(CanonicalForm, AgreesWithTrialOfAllMotions) {
  // Axes along base x and y do not turn with the limb, so no formula is at hand.
  for (const auto& ends :
       {std::vector<std::string>{"x", "y", "z"}, {"x", "tangential", "spherical"}}) {
    const std::vector<Mechanism> mechanisms = expand_all(necklace(4, ends));
    EXPECT_EQ(distinct_forms(mechanisms), distinct_by_trial(mechanisms));
  }
}

TEST(CanonicalForm, AgreesPairByPairWithTrialOfAllMotions) {
  const std::vector<Mechanism> mechanisms = expand_all(necklace(3, {"x", "z", "tangential"}));
  for (const Mechanism& a : mechanisms)
    for (const Mechanism& b : mechanisms)
      EXPECT_EQ(canonical_form(a).code == canonical_form(b).code, congruent(a, b));
}

TEST(CanonicalForm, IsTheSameOnEveryThread) {
  const std::vector<Mechanism> mechanisms = expand_all(necklace(4, {"x", "y", "z", "spherical"}));
  std::vector<std::string> alone, together(mechanisms.size());
  for (const Mechanism& mechanism : mechanisms) alone.push_back(canonical_form(mechanism).code);
  tbb::parallel_for(std::size_t{0}, mechanisms.size(),
                    [&](std::size_t i) { together[i] = canonical_form(mechanisms[i]).code; });
  EXPECT_EQ(alone, together);
}

}  // namespace
}  // namespace polyglide
