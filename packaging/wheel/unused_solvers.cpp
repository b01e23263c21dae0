// SPDX-License-Identifier: Apache-2.0
// The functions of CHOLMOD, CXSparse and LAPACK that Debian's libceres.a names. The fits of this library ask Ceres for Eigen's
// solvers (lib/kernels/fit/least_squares.cpp, lib/kernels/reduce/moving_fit.cpp), so none of these is called; one that is ends
// the process.
#include <cstdio>
#include <cstdlib>

#define SUBVOL_UNUSED(name)                                                                          \
    extern "C" [[noreturn]] void name() {                                                            \
        std::fputs("subvol: " #name " is not in this build of Ceres: it has Eigen alone\n", stderr); \
        std::abort();                                                                                \
    }

SUBVOL_UNUSED(cholmod_amd)
SUBVOL_UNUSED(cholmod_analyze)
SUBVOL_UNUSED(cholmod_analyze_p)
SUBVOL_UNUSED(cholmod_camd)
SUBVOL_UNUSED(cholmod_factorize)
SUBVOL_UNUSED(cholmod_finish)
SUBVOL_UNUSED(cholmod_free_dense)
SUBVOL_UNUSED(cholmod_free_factor)
SUBVOL_UNUSED(cholmod_free_sparse)
SUBVOL_UNUSED(cholmod_print_common)
SUBVOL_UNUSED(cholmod_solve)
SUBVOL_UNUSED(cholmod_start)
SUBVOL_UNUSED(cholmod_triplet_to_sparse)
SUBVOL_UNUSED(cholmod_zeros)
SUBVOL_UNUSED(cs_di_amd)
SUBVOL_UNUSED(cs_di_calloc)
SUBVOL_UNUSED(cs_di_chol)
SUBVOL_UNUSED(cs_di_cholsol)
SUBVOL_UNUSED(cs_di_compress)
SUBVOL_UNUSED(cs_di_counts)
SUBVOL_UNUSED(cs_di_cumsum)
SUBVOL_UNUSED(cs_di_etree)
SUBVOL_UNUSED(cs_di_free)
SUBVOL_UNUSED(cs_di_ipvec)
SUBVOL_UNUSED(cs_di_lsolve)
SUBVOL_UNUSED(cs_di_ltsolve)
SUBVOL_UNUSED(cs_di_malloc)
SUBVOL_UNUSED(cs_di_multiply)
SUBVOL_UNUSED(cs_di_nfree)
SUBVOL_UNUSED(cs_di_pinv)
SUBVOL_UNUSED(cs_di_post)
SUBVOL_UNUSED(cs_di_pvec)
SUBVOL_UNUSED(cs_di_schol)
SUBVOL_UNUSED(cs_di_sfree)
SUBVOL_UNUSED(cs_di_spfree)
SUBVOL_UNUSED(cs_di_symperm)
SUBVOL_UNUSED(cs_di_transpose)
SUBVOL_UNUSED(dgeqrf_)
SUBVOL_UNUSED(dormqr_)
SUBVOL_UNUSED(dpotrf_)
SUBVOL_UNUSED(dpotrs_)
SUBVOL_UNUSED(dtrtrs_)
