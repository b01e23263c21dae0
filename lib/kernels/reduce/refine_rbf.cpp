// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <string>

#include "field_fit.h"
#include "sample_parts.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"

namespace subvol {
namespace {

constexpr std::size_t kMostSamples = 100;  // of each kernel, which has at most 9 unknowns

void check(const RbfVolume& volume, const RbfRefineOptions& options) {
    detail::check_rbf_volume(volume);
    if (volume.channels.empty() || volume.size() == 0)
        throw Error(ErrorCode::InvalidInput, "the volume has no kernels or no channel", {}, "one channel to be fitted");
    if (options.iterations < 1 || options.iterations > 10000)
        throw Error(ErrorCode::InvalidInput, "iterations: " + std::to_string(options.iterations), {}, "1 to 10000");
    if (!(options.ridge > 0 && options.ridge <= 1))
        throw Error(ErrorCode::InvalidInput, "the ridge is " + detail::number_text(options.ridge), {}, "above 0, to 1");
}

detail::MovingFitReport fit_fixed(RbfVolume& volume, const FieldSamples& samples, const RbfRefineOptions& options) {
    report_progress(options.progress, "refine kernels", 0);
    const detail::FieldFit fit(volume.centers, volume.frames, volume.kernel, samples);
    auto terms = detail::terms_of(volume, volume.channels[0]);
    const auto prior = terms;
    detail::MovingFitReport report;
    report.iterations = fit.solve(terms, prior, options.iterations, options.ridge);
    report.bytes = fit.bytes();
    detail::set_terms(volume.channels[0], volume.frames, terms);
    return report;
}

}  // namespace

RbfRefineResult refine_rbf(const RbfVolume& volume, const FieldSamples& samples, const RbfRefineOptions& options) {
    const detail::Stopwatch watch;
    check(volume, options);
    RbfRefineResult result;
    result.volume = volume;
    result.volume.channels.resize(1);
    const ErrorAtSamples before = error_at_samples(result.volume, samples);
    result.volume.channels[0].hessians.clear();  // values, gradients and moments are fitted without them
    const auto groups = detail::group_by_kernel(result.volume, samples);
    const FieldSamples chosen = detail::thin_samples(samples, groups.order, groups.starts, kMostSamples).samples;
    const auto fit =
        options.move ? detail::fit_moving(result.volume, chosen, options) : fit_fixed(result.volume, chosen, options);
    const ErrorAtSamples after = error_at_samples(result.volume, samples);
    const bool better = after.rmse <= before.rmse && after.uncovered <= before.uncovered;
    if (!better) {
        result.volume = volume;
        result.volume.channels.resize(1);
    }
    result.report = {.iterations = fit.iterations,
                     .rmse_before = before.rmse,
                     .rmse_after = better ? after.rmse : before.rmse,
                     .seconds = watch.seconds(),
                     .bytes = fit.bytes};
    return result;
}

}  // namespace subvol
