#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace polyglide::batch {

constexpr int kMostDrives = 24;  ///< a machine with more is evaluated the general way
constexpr int kBlock = 256;      ///< most poses per call of a kernel
constexpr int kMostLanes = 16;   ///< of any kernel

enum class LegKind { guide_rod, strut, crank_rod };

/// One rod or strut, base frame at home, SI. With t the tool displacement and R the
/// rotation, its platform joint against its base joint at home (or the crank's centre) is
/// v = t + shift + R·arm; for a rotation common to the batch, arm holds R·arm and shift
/// includes it.
struct LegData {
  LegKind kind = LegKind::guide_rod;
  int drive = 0;
  bool primary = true;  ///< gives its drive; others must agree with it
  double arm[3] = {}, shift[3] = {};
  double direction[3] = {};                ///< guide
  double outward[3] = {}, onward[3] = {};  ///< crank: unit vectors centre → rod at home, and ahead
  double length = 0, side = 1, radius = 1;         ///< rod (strut at home), root, crank arm
  double min = 0, max = 0, tolerance = 0;          ///< of the drive, and between rods of a carriage
  double reach = 0, min_limit = 0, max_limit = 0;  ///< indices of limits, as all `limit`s
  int first_cone = 0, last_cone = 0;
};

/// Deflection of a rod: along·axis >= cosine; the axis is fixed in base, crank or platform.
struct ConeData {
  enum class On { base, crank, platform } on = On::base;
  double axis[3] = {}, cosine = -1, limit = 0;
};

/// normal·(t + R·arm) + slope·drive <= offset, for every arm; without arms the
/// middle term is in the offset.
struct PlaneData {
  double normal[3] = {}, offset = 0, slope = 0, limit = 0;
  int drive = 0, first_arm = 0, last_arm = 0;
};

/// A machine in the words of the kernel.
struct KernelModel {
  int drives = 0, columns = 0;
  int axes[6] = {};      ///< the columns of J among X Y Z A B C
  bool free[6] = {};     ///< whether a coordinate may differ from zero
  bool moments = false;  ///< some column is a rotation
  double scale = 1;      ///< 1/characteristic length
  std::vector<LegData> legs;
  std::vector<ConeData> cones;
  std::vector<PlaneData> planes;
  std::vector<double> arms;   ///< of the planes, three each
  std::vector<double> lever;  ///< per drive: crank arm, else 1
  double motion = 0, not_finite = 0;
};

/// Columns of poses. Angles absent (null) are zero; quaternions stand for angles.
struct KernelInput {
  const double *x = nullptr, *y = nullptr, *z = nullptr;
  const double* angle[3] = {};
  const double* quaternion[4] = {};  ///< w x y z
  [[nodiscard]] bool turning() const { return angle[0] || angle[1] || angle[2] || quaternion[0]; }
};

/// Columns of answers; null where not wanted. Drives and Jacobian have `stride`
/// poses from one column to the next.
struct KernelOutput {
  int* limit = nullptr;                ///< first limit met, negative when there is none
  signed char* orientation = nullptr;  ///< sign of det J
  double *condition = nullptr, *frobenius = nullptr, *smallest = nullptr, *transmission = nullptr;
  double *softest = nullptr, *stiffest = nullptr;
  double *drives = nullptr, *jacobian = nullptr;
  std::size_t stride = 0;
};

/// Forward kinematics: drives in, poses in and out.
struct ForwardColumns {
  const double* drives = nullptr;
  std::size_t stride = 0;
  double *x = nullptr, *y = nullptr, *z = nullptr;
  double* quaternion[4] = {};  ///< w x y z
  double* residual = nullptr;
};

/// What an instruction set offers. `count` is a multiple of `lanes` or `forward_lanes`, at
/// most kBlock.
struct Kernel {
  const char* name;
  int lanes, forward_lanes;
  void (*evaluate)(const KernelModel&, const KernelInput&, const KernelOutput&, int count);
  void (*forward)(const KernelModel&, const ForwardColumns&, int count);
};

// One per instruction set, each compiled with its own flags. The wide ones must only be
// called where the processor has them.
const Kernel& scalar_kernel();
#if defined(__x86_64__)
const Kernel& x86_64_kernel();  ///< SSE2
const Kernel& v3_kernel();      ///< AVX2 and FMA
const Kernel& v4_kernel();      ///< AVX-512
#endif

/// The kernels that this processor can run, slowest first: "scalar", then on
/// x86-64 "x86_64", "v3", "v4".
[[nodiscard]] const std::vector<const Kernel*>& available_kernels();

/// The kernel of that name; the last of available_kernels() for "".
/// @throws std::invalid_argument for a name that is not available.
[[nodiscard]] const Kernel& kernel_named(const std::string& name = "");

}  // namespace polyglide::batch
