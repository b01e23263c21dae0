// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>

#include "subvol/field_samples.h"
#include "subvol/limit.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"

namespace subvol {

/// How far a field is from samples: the root of the volume's mean squared error.
///
/// uncovered: samples where the field has no value; they do not count for rmse
struct ErrorAtSamples {
    double rmse = 0;
    double max_abs = 0;
    std::size_t uncovered = 0;
};

[[nodiscard]] ErrorAtSamples error_at_samples(const RbfVolume& volume, const FieldSamples& samples);

/// rmse:       to be reached, in units of the field, > 0
/// kernel:     of the result; radial
/// overlap:    0.7 to 2; 1 is that of uniform samples: a box of side h gets the support R h, R that of the kernel
/// max_points: where the growth ends at the latest
/// move:       kernels are also moved and resized (`refine_rbf`): about half as many, ten times as slow
/// limit:      the scheme, and how exact the validation samples are; its `progress` is not used
struct ReduceOptions {
    double rmse = 0.01;
    Kernel kernel{};
    double overlap = 1;
    std::size_t max_points = 1'000'000;
    bool move = false;
    LimitOptions limit{.tolerance = 1e-4};
    Progress* progress = nullptr;
};

/// rmse, validation: on the samples that made the volume, and on independent ones
/// reached:          whether both meet the target and no sample is uncovered
struct ReduceReport {
    std::size_t points = 0;
    std::size_t samples = 0;
    int rounds = 0;
    double rmse = 0;
    ErrorAtSamples validation;
    bool reached = false;
    double seconds = 0;
};

struct ReduceResult {
    RbfVolume volume;
    ReduceReport report;
};

/// Few kernels for a field: as many as the target error needs, where it needs them.
///
/// Top-down: the samples are halved, and again, each time where the error is largest, across the direction that helps most;
/// each part gets one kernel with the frame of its covariance, so flat parts get flat kernels. All values, gradients and
/// moments are fitted together to all samples, and what the fit leaves over tells which parts are halved next.
/// returns: a volume without boundary; its bounds are those of the samples
/// throws:  Error(InvalidInput) for options out of range or samples that do not fit together
/// cost:    a round is O(samples · kernels over a point); bitwise the same for any number of threads
[[nodiscard]] ReduceResult reduce_rbf(const FieldSamples& samples, const FieldSamples& validation,
                                      const ReduceOptions& options = {});

/// The same for a field of a mesh: samples of its limit, its boundary surface and bounds.
///
/// field:  as in `scalar_field`
/// throws: as above, as `refine` and `scalar_field`
[[nodiscard]] ReduceResult reduce_rbf(const HexMesh& mesh, std::string_view field, const ReduceOptions& options = {});

/// move:       centres and sizes too, not values, gradients and moments alone
/// iterations: at most, of the solver: conjugate gradients without `move`, Levenberg-Marquardt with it
/// ridge:      how strongly terms that no sample sees are held, of a kernel's mean weight
struct RbfRefineOptions {
    bool move = false;
    int iterations = 60;
    double ridge = 1e-4;
    Progress* progress = nullptr;
};

/// bytes: estimated, of what the solver held
struct RbfRefineReport {
    int iterations = 0;
    double rmse_before = 0, rmse_after = 0;
    double seconds = 0;
    std::size_t bytes = 0;
};

struct RbfRefineResult {
    RbfVolume volume;
    RbfRefineReport report;
};

/// Fits an RBF volume to samples by least squares, all kernels of its first channel together.
///
/// With the centres and frames as they are this is one linear problem. With `move` each kernel may also shift and grow in its
/// frame; that is nonlinear, and is solved by Ceres: sparse Cholesky up to 200 kernels, conjugate gradients beyond.
/// returns: the volume with that one channel, without Hessians unless they were better; boundary and bounds are kept. Never
///          worse on the samples than before
/// throws:  Error(InvalidInput) for options out of range, no channel, or samples that do not fit together
/// cost:    O(samples · kernels over a point) an iteration; bitwise the same for any number of threads
/// source:  the idea of Weiler 05 and Jang 06; analytic derivatives
[[nodiscard]] RbfRefineResult refine_rbf(const RbfVolume& volume, const FieldSamples& samples,
                                         const RbfRefineOptions& options = {});

}  // namespace subvol
