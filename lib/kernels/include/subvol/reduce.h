// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "subvol/field_samples.h"
#include "subvol/limit.h"
#include "subvol/option_names.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"

namespace subvol {

/// How far the field of an RBF volume is from samples.
struct ErrorAtSamples {
    double rmse = 0;  ///< root of the mean squared error over the volume
    double max_abs = 0;
    /// Samples where the field has no value; they do not count for the others, which are NaN if there are no more
    std::size_t uncovered = 0;
};

[[nodiscard]] ErrorAtSamples error_at_samples(const RbfVolume& volume, const FieldSamples& samples);

struct ReduceOptions {
    double rmse = 0.01;  ///< the target, in units of the field, > 0
    Kernel kernel{};     ///< kernel of the result; radial
    /// 0.7 to 2; 1 is that of uniform samples: a box of side h gets the support radius R h, R that of the kernel
    double overlap = 1;
    std::size_t max_points = 1'000'000;  ///< no more kernels than these
    bool move = false;  ///< kernels are also moved and resized (`refine_rbf`): about half as many, ten times as slow
    /// The scheme, and the accuracy of the validation samples; its `progress` is not used
    LimitOptions limit{.tolerance = 1e-4};
    Progress* progress = nullptr;
};

[[nodiscard]] std::vector<Option> options_of(ReduceOptions& options);

struct ReduceReport {
    std::size_t points = 0;
    std::size_t samples = 0;
    int rounds = 0;
    double rmse = 0;            ///< error at the samples that were fitted
    ErrorAtSamples validation;  ///< errors at independent samples
    bool reached = false;       ///< `rmse` and `validation` meet the target, and no sample is uncovered
    double seconds = 0;
};

struct ReduceResult {
    RbfVolume volume;
    ReduceReport report;
};

/// Approximates a field with few kernels: as many as the target error needs, where it needs them.
///
/// Top-down: the samples are halved again and again, each time where the error is largest and across the direction in which
/// that helps most. Each part gets one kernel whose frame is the covariance of the part, so flat parts get flat kernels. All
/// values, gradients and moments are fitted together to all samples; the residuals decide which parts are halved next.
///
/// returns: a volume without boundary; its bounds are those of the samples
/// throws:  Error(InvalidInput) for options out of range, or unless samples have one finite value and weight per point
/// cost:    a round is O(samples · kernels over a point); bitwise the same for any number of threads
[[nodiscard]] ReduceResult reduce_rbf(const FieldSamples& samples, const FieldSamples& validation,
                                      const ReduceOptions& options = {});

/// The same for a field of a mesh: samples of its limit, its boundary surface and bounds.
///
/// field:  as in `scalar_field`
/// throws: as above, as `refine` and `scalar_field`
[[nodiscard]] ReduceResult reduce_rbf(const HexMesh& mesh, std::string_view field, const ReduceOptions& options = {});

struct RbfRefineOptions {
    bool move = false;  ///< also fit centres and sizes, not only values, gradients and moments
    /// The most iterations of the solver: conjugate gradients without `move`, Levenberg-Marquardt with it
    int iterations = 60;
    double ridge = 1e-4;  ///< how strongly terms are held that no sample determines, as a part of a kernel's mean weight
    Progress* progress = nullptr;
};

struct RbfRefineReport {
    int iterations = 0;
    double rmse_before = 0, rmse_after = 0;
    double seconds = 0;
    std::size_t bytes = 0;  ///< estimated memory of the solver
};

struct RbfRefineResult {
    RbfVolume volume;
    RbfRefineReport report;
};

/// Fits an RBF volume to samples by least squares, all kernels of its first channel together.
///
/// With fixed centres and frames this is one linear problem. With `move` each kernel may also shift and grow in its frame; that
/// is nonlinear and is solved by Ceres: sparse Cholesky up to 200 kernels, conjugate gradients beyond.
///
/// returns: the volume with that one channel and without Hessians; boundary and bounds are kept. If the fit is worse at the
///          samples than the volume was, the channel is returned unchanged
/// throws:  Error(InvalidInput) for options out of range, no channel, or unless samples have one finite value and weight per
///          point
/// cost:    O(samples · kernels over a point) an iteration; bitwise the same for any number of threads
/// source:  the idea of Weiler 05 and Jang 06; analytic derivatives
[[nodiscard]] RbfRefineResult refine_rbf(const RbfVolume& volume, const FieldSamples& samples,
                                         const RbfRefineOptions& options = {});

}  // namespace subvol
