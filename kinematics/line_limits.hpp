#pragma once

#include <optional>
#include <string>
#include <vector>

#include "kinematics/region.hpp"

namespace polyglide {

/// Part of a line where every limit holds, and the limits at its ends.
struct Span {
  double from = 0, to = 0;
  int first = 0, last = 0;
};

/// The limits of a leg machine at one orientation along straight lines: where a line enters
/// and leaves the workspace is a root of a polynomial of degree 2 (rods on guides, struts, cones,
/// planes) or 4 (the reach of cranks), and of det J, which is looked for in samples. Lines run
/// along z of a frame that is turned against everything in the machine, so that no face of the
/// workspace is parallel to it but by chance. Planar machines: lines in their plane, x = 0.
class LineLimits {
 public:
  /// nullopt for machines without closed form; whose rods must agree about a carriage; with cones
  /// on cranks, clearances or expressions; or with fewer than two translations.
  /// @param box limits everything: search_bounds().
  [[nodiscard]] static std::optional<LineLimits> make(const Machine& machine,
                                                      const std::vector<std::string>& ignored,
                                                      const Eigen::Quaterniond& rotation,
                                                      const Bounds& box);

  /// 3, or 2 for planar machines.
  [[nodiscard]] int dimensions() const { return dimensions_; }

  /// Only where det J has the sign that it has at `place`: false, and no change, when J is not
  /// square or singular there.
  bool keep_side_of(const Vector3& place);

  /// Only before a wall.
  void keep_before(const SingularWall& wall) {
    planes_.push_back({wall.normal, wall.offset, limits_++});
  }

  /// Ascending, along the line of the given x and y. Cost: 1 to 10 µs.
  void spans(double x, double y, std::vector<Span>& result) const;

  /// Whether the limits, the side of det J too, hold at a place given in the base frame.
  [[nodiscard]] bool inside(const Vector3& place) const;

  /// A place in the frame of the lines.
  [[nodiscard]] Vector3 in_frame(const Vector3& place) const { return frame_.transpose() * place; }

  /// Of a box of the base frame, in the frame of the lines.
  [[nodiscard]] Bounds frame_bounds(const Bounds& box) const;

  /// The box that limits everything, in the frame of the lines.
  [[nodiscard]] const Bounds& extent() const { return extent_; }

  /// Number that stands for det J in Span.
  static constexpr int kSingular = 0;

 private:
  static constexpr double kTouch = 1e-12;  // of the machine's size: ends nearer than this are one

  struct Cone {
    int limit;
    Vector3 axis;
    double cosine;
  };
  struct Rod {
    Leg::Kind kind = Leg::Kind::strut;
    int drive = 0;
    Vector3 shift;  // from the joint at the base side, or the crank's centre, to the platform joint
    Vector3 direction, arm;
    Vector3 outward = Vector3::Zero(), onward = Vector3::Zero();  // of a crank, with its radius
    double radius = 0, length = 0, side = 1, min = 0, max = 0;
    int reach = 0;  // min and max are the two numbers after it
    std::vector<Cone> cones;
  };
  struct Plane {
    Vector3 normal;
    double offset = 0;
    int limit = 0;
  };
  struct Solved {
    bool reached = false;
    double place = 0;  // of the drive
    Vector3 rod;       // from base to platform
  };

  LineLimits() = default;
  bool add_rods(const Machine& machine, const std::vector<std::string>& ignored,
                const Eigen::Quaterniond& rotation);
  bool add_planes(const Machine& machine, const std::vector<std::string>& ignored,
                  const Eigen::Quaterniond& rotation);
  void add_box(const Machine& machine, const Bounds& box);
  void drop_repeats();
  static Solved solve(const Rod& rod, const Vector3& place);
  [[nodiscard]] bool within_limits(const Vector3& place) const;
  [[nodiscard]] double determinant(const Vector3& place) const;
  template <typename Add>
  void crossings(const Rod& rod, const Vector3& start, const Add& add) const;
  void cut_at_singularities(const Vector3& start, std::vector<Span>& spans) const;

  int dimensions_ = 3, limits_ = kSingular + 1, side_ = 0;
  double size_ = 1, scale_ = 1;
  std::vector<int> axes_;
  std::vector<Rod> rods_;    // that limit
  std::vector<Rod> drives_;  // one per drive
  std::vector<Plane> planes_;
  Eigen::Matrix3d frame_ = Eigen::Matrix3d::Identity();
  Bounds extent_;
};

}  // namespace polyglide
