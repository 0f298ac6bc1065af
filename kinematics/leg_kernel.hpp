#pragma once

#include <string>
#include <vector>

#include "kinematics/batch_loops.hpp"
#include "kinematics/solve.hpp"

namespace polyglide {

/// Closed-form inverse kinematics, limits and conditioning of a leg machine with
/// a pure task space, for poses that share one rotation. Immutable.
///
/// With t the tool displacement, a rod's platform joint against its carriage joint
/// at home is v = a + t. A rod of length L on a guide g needs the carriage at
///   s = v·g + side·h,  h = sqrt(L² - |v - (v·g) g|²),
/// and gives the row  g - side (v - (v·g) g)/h  of the Jacobian; a strut of length
/// L at home needs s = |v| - L and gives the row v/|v|. Rotational columns are
/// (r × row)/characteristic length, r from the tool to the platform joint.
class LegKernel {
 public:
  static constexpr int kBlock = batch::kStride;  ///< most poses per call

  /// @param machine with legs and a pure task space; strokes that do not count are
  ///        unlimited in its legs already.
  LegKernel(const Machine& machine, const std::vector<std::string>& ignored);

  /// Leg by leg "reach …", "stroke … min", "stroke … max", "cone …"; then
  /// half-space limits; "motion" last.
  [[nodiscard]] const std::vector<std::string>& limit_names() const { return limit_names_; }

  /// What a rotation makes constant.
  struct Oriented;
  [[nodiscard]] Oriented orient(const Eigen::Quaterniond& rotation) const;

  /// Block of poses in, answers out; `drives` [drive × kBlock] is filled with
  /// carriage places and strut strokes from home, meaningless where not reachable.
  struct Block {
    int count = 0;
    bool conditioning = true;  ///< as in PoseBatch
    const double *x = nullptr, *y = nullptr, *z = nullptr;
    int* limit = nullptr;
    double* inverse_condition = nullptr;
    signed char* orientation = nullptr;
    std::vector<double> drives, rows, code;  ///< scratch, kept between calls
  };
  void evaluate(const Oriented& oriented, Block& block) const;

 private:
  struct Cone {
    int joint, limit;
    bool on_platform;
    Vector3 axis;  ///< pointing along the rod from base to platform
    double cosine;
  };
  struct Row {
    Leg leg;
    bool primary;
    int reach, stroke_min, stroke_max;  ///< limit indices
    std::vector<Cone> cones;
  };
  /// normal · (constant + t·follows_tool + direction·drive) <= offset
  struct Plane {
    int limit;
    HalfSpaceLimit::Plane plane;
    std::vector<Vector3> points;
    bool on_platform;
    int drive;  ///< -1 unless on a carriage
    Vector3 direction;
  };

  int add_name(std::string name);
  void add_leg(const Leg& leg, bool primary, const std::vector<std::string>& ignored);
  void add_cone(Row& row, int joint, bool on_platform, const std::vector<std::string>& ignored);
  void add_limit(const HalfSpaceLimit& limit, const std::vector<std::string>& ignored);
  void solve_leg(const Row& row, const Vector3& offset, const Oriented& oriented,
                 Block& block) const;
  void condition_translations(Block& block) const;
  void condition(const Oriented& oriented, Block& block) const;

  Machine machine_;
  std::vector<std::string> limit_names_;
  std::vector<Row> rows_;
  std::vector<Plane> planes_;
  int drives_ = 0;
  int motion_limit_ = 0;
};

struct LegKernel::Oriented {
  Eigen::Matrix3d rotation;
  bool commanded = true;         ///< the machine has the rotation that is asked
  std::vector<int> rows;         ///< rows to solve: those that another one does not repeat
  std::vector<Vector3> offsets;  ///< a, per row of the kernel
  std::vector<Vector3> arms;     ///< r, per drive, of its primary leg
  struct Plane {
    Vector3 normal;        ///< acts on t; zero for points off the platform
    double offset, slope;  ///< normal·t + slope·drive <= offset
    int drive, limit;
  };
  std::vector<Plane> planes;
};

}  // namespace polyglide
