#pragma once

// Part of the precompiled headers, never included by a source. What takes the compiler longest in
// Eigen is compiled once, in eigen_instances.cpp, and left out everywhere else. The code is the
// same either way, and none of it is ever inlined.
#include <Eigen/Dense>

#ifndef POLYGLIDE_INSTANCE
#define POLYGLIDE_INSTANCE extern template
#endif

namespace Eigen {
POLYGLIDE_INSTANCE JacobiSVD<MatrixXd>& JacobiSVD<MatrixXd>::compute(const MatrixXd&, unsigned);
POLYGLIDE_INSTANCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(
    const EigenBase<MatrixXd>&, int);
POLYGLIDE_INSTANCE void PartialPivLU<MatrixXd>::compute();
POLYGLIDE_INSTANCE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
POLYGLIDE_INSTANCE void HouseholderQR<MatrixXd>::computeInPlace();
POLYGLIDE_INSTANCE void ColPivHouseholderQR<MatrixXd>::computeInPlace();
POLYGLIDE_INSTANCE void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();

// Products of matrices, by any orders of storage: as version 3.4 makes them.
#if !EIGEN_VERSION_AT_LEAST(3, 4, 90)
namespace internal {
using Blocks = gebp_traits<double, double>;
template <int Order>
using Source = const_blas_data_mapper<double, Index, Order>;
POLYGLIDE_INSTANCE struct gebp_kernel<double, double, Index,
                                      blas_data_mapper<double, Index, ColMajor>, Blocks::mr,
                                      Blocks::nr, false, false>;
POLYGLIDE_INSTANCE struct gemm_pack_lhs<double, Index, Source<ColMajor>, Blocks::mr,
                                        Blocks::LhsProgress, Blocks::LhsPacket4Packing, ColMajor>;
POLYGLIDE_INSTANCE struct gemm_pack_lhs<double, Index, Source<RowMajor>, Blocks::mr,
                                        Blocks::LhsProgress, Blocks::LhsPacket4Packing, RowMajor>;
POLYGLIDE_INSTANCE struct gemm_pack_rhs<double, Index, Source<ColMajor>, Blocks::nr, ColMajor>;
POLYGLIDE_INSTANCE struct gemm_pack_rhs<double, Index, Source<RowMajor>, Blocks::nr, RowMajor>;
POLYGLIDE_INSTANCE struct general_matrix_vector_product<Index, double, Source<ColMajor>, ColMajor,
                                                        false, double, Source<RowMajor>, false>;
POLYGLIDE_INSTANCE struct general_matrix_vector_product<Index, double, Source<RowMajor>, RowMajor,
                                                        false, double, Source<ColMajor>, false>;
}  // namespace internal
#endif
}  // namespace Eigen
