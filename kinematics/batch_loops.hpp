#pragma once

namespace polyglide::batch {

// The innermost loops of LegKernel: plain arrays of `count` poses, no branches, so
// that the compiler makes vector instructions of them, chosen for the processor at run
// time. Contraction is off, so every choice gives the same bits.
//
// Unit vectors `along` a leg and rows of the Jacobian are three columns kStride apart.
// `code` holds the first limit a pose meets as a number, negative while there is
// none; a check only writes where it is still negative.

struct Vector {
  double x, y, z;
};
constexpr int kStride = 256;  ///< from one column of three to the next; most poses per call

/// A rod of constant length on a guide: where the carriage must be, and the unit
/// vector along the rod. `offset` is the platform joint minus the carriage joint at home.
struct Rod {
  Vector offset, guide;
  double length, side, reach_code;
};
void solve_rod(int count, const double* x, const double* y, const double* z, const Rod& rod,
               double* place, double* along, double* code);

/// A strut: its length beyond the one at home, and the unit vector along it.
struct Strut {
  Vector offset;
  double length, reach_code;
};
void solve_strut(int count, const double* x, const double* y, const double* z, const Strut& strut,
                 double* place, double* along, double* code);

void check_range(int count, const double* place, double min, double min_code, double max,
                 double max_code, double* code);

/// |place - other| <= tolerance.
void check_agreement(int count, const double* place, const double* other, double tolerance,
                     double failure, double* code);

/// along·axis >= cosine.
void check_cone(int count, const double* along, Vector axis, double cosine, double failure,
                double* code);

/// normal·(x, y, z) + slope·place <= offset.
void check_plane(int count, const double* x, const double* y, const double* z, Vector normal,
                 const double* place, double slope, double offset, double failure, double* code);

/// Row of the Jacobian: along/(along·guide).
void rod_row(int count, const double* along, Vector guide, double* row);

/// 1/κ of a Jacobian of `rows` rows with three columns: entries[(3·row + column)·kStride].
void condition3(int count, int rows, const double* entries, double* inverse_condition);

/// Determinant of three such rows.
void determinant3(int count, const double* entries, double* determinant);

constexpr int kLanes = 32;  ///< poses per call of condition_n
constexpr int kMost = 6;    ///< most columns

/// Symmetric matrices JᵀJ of kLanes poses, upper triangle.
struct Grams {
  double entry[kMost][kMost][kLanes];
};

/// 1/κ from JᵀJ of n columns by cyclic Jacobi rotations, six sweeps; destroys
/// `grams`. Error about 1e-8 (JᵀJ squares κ).
void condition_n(int n, Grams& grams, double* inverse_condition);

}  // namespace polyglide::batch
