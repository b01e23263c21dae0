// SPDX-License-Identifier: Apache-2.0
// Few kernels for the samples of a field, from the top down. The samples are one part at first; each part has one kernel, whose
// centre is the part's mean and whose frame is its covariance, scaled for the kernel's support and widened until the part's
// farthest sample is covered.
//
//     parts are split by the errors of their own fits, until all errors together are 5 times the target
//     ┌► all kernels are fitted together to some samples of each part, by conjugate gradients
//     │  the parts with the largest squared errors are split, about as many as the rest of the error needs
//     └─ until the target is met, or nothing can be split
//     kernels are moved and resized, if asked for
//     errors are measured at other samples; if they are too large, it goes on at "┌►" with a lower target, a few times
//
// The error is the root of the mean square by the samples' weights, in the field's unit. New parts start with their own fit,
// the others with the terms of the last round.
#include "subvol/reduce.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "field_fit.h"
#include "sample_parts.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/rbf_field.h"
#include "subvol/surface.h"

namespace subvol {

using detail::FieldFit;
using detail::KernelTerms;
using detail::SamplePart;
using detail::SampleParts;

namespace {

constexpr double kUniform = 12;           // side² of a box over its variance
constexpr double kFarthest = 1.01;        // ρ of a part's farthest sample: the compact kernel's weight is .125 there
constexpr double kFirstError = 5;         // parts are split by their own fits until the error is this many times the target
constexpr std::size_t kPartSamples = 64;  // the most samples of a part in the fit
constexpr double kMostGrowth = 0.3;       // the most parts that are split in a round, of all
constexpr double kThickness = 1e-3;       // the least of a part, of its largest extent
constexpr int kSteps = 40;                // of conjugate gradients; 120 lower the error by less than a hundredth
constexpr int kMostChecks = 8;            // against the validation samples
constexpr double kAimLower = 0.98;        // the next target, at most this part of the last
constexpr double kMoveGain = 2;           // first guess of the factor by which moves lower the error
constexpr int kMoves = 12;                // steps of the solver that moves kernels

void check(const FieldSamples& samples) {
    const bool same = samples.values.size() == samples.size() && samples.weights.size() == samples.size();
    if (!same || samples.size() == 0 || samples.size() >= kNone) {
        throw Error(ErrorCode::InvalidInput, "samples need one value and one weight per point", {}, "1 to 2³² samples");
    }
    double total = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const Vec3& p = samples.points[i];
        if (!(std::isfinite(p.x + p.y + p.z) && std::isfinite(samples.values[i]) && std::isfinite(samples.weights[i]) &&
              samples.weights[i] >= 0)) {
            throw Error(ErrorCode::InvalidInput, "sample " + std::to_string(i) + " is not finite or has a negative weight");
        }
        total += samples.weights[i];
    }
    if (!(total > 0))
        throw Error(ErrorCode::InvalidInput, "all weights of samples are 0", {}, "the volume that each represents");
}

void check(const ReduceOptions& options) {
    check_options(options);
    if (!is_radial(options.kernel))
        throw Error(ErrorCode::InvalidInput, "the kernel is not radial: frames define no axes for it", {}, "a radial kernel");
}

/// A growing set of kernels, one for each part of a partition of samples.
class Reduction {
public:
    Reduction(const FieldSamples& samples, const ReduceOptions& options)
        : samples_(samples), options_(options), parts_(samples) {
        weight_ = std::accumulate(samples.weights.begin(), samples.weights.end(), 0.0);
    }

    [[nodiscard]] std::size_t size() const { return parts_.parts().size(); }

    /// Splits by the parts' own fits until they are near the target: cheap, and as good as the full fit while there are far too
    /// few kernels.
    void grow_alone(double rmse) {
        const double allowed = kFirstError * kFirstError * rmse * rmse * weight_;
        while (true) {
            std::vector<double> error(size());
            for (std::size_t p = 0; p < size(); ++p) error[p] = parts_.parts()[p].fit.error;
            if (!split_worst(error, allowed, 1)) break;
        }
    }

    /// Fits all kernels together. Returns the error.
    double fit(int steps) {
        place_kernels();
        // Parts are not in the samples' order.
        std::vector<std::size_t> by_place(size()), starts(1, 0);
        std::iota(by_place.begin(), by_place.end(), std::size_t{0});
        std::sort(by_place.begin(), by_place.end(),
                  [&](std::size_t a, std::size_t b) { return parts_.parts()[a].begin < parts_.parts()[b].begin; });
        for (const std::size_t p : by_place) starts.push_back(parts_.parts()[p].end);
        const auto chosen = detail::thin_samples(samples_, parts_.order(), starts, kPartSamples);
        const FieldFit fit(centers_, frames_, options_.kernel, chosen.samples);
        fit.solve(terms_, prior_, steps);
        const auto residual = fit.residuals(terms_);
        error_.assign(size(), 0);
        detail::parallel_each(size(), [&](std::size_t p) {
            for (std::size_t k = chosen.starts[p]; k < chosen.starts[p + 1]; ++k)
                error_[by_place[p]] += chosen.samples.weights[k] * residual[k] * residual[k];
        });
        return std::sqrt(std::accumulate(error_.begin(), error_.end(), 0.0) / weight_);
    }

    /// Splits parts where the fit is worst, about as many as the target needs. Returns whether there was one to split.
    bool grow(double rmse) { return split_worst(error_, rmse * rmse * weight_, kMostGrowth); }

    [[nodiscard]] RbfVolume volume() const {
        RbfVolume result;
        result.centers = centers_;
        result.frames = frames_;
        result.kernel = options_.kernel;
        detail::set_terms(result.channels.emplace_back(), frames_, terms_);
        for (const Vec3& p : samples_.points) result.bounds.add(p);
        return result;
    }

private:
    bool split_worst(const std::vector<double>& error, double allowed, double most_growth) {
        double excess = std::accumulate(error.begin(), error.end(), 0.0) - allowed;
        std::vector<std::size_t> worst;
        for (std::size_t p = 0; p < size(); ++p) {
            if (parts_.parts()[p].gain > 0 && error[p] > 0) worst.push_back(p);
        }
        std::sort(worst.begin(), worst.end(),
                  [&](std::size_t a, std::size_t b) { return error[a] != error[b] ? error[a] > error[b] : a < b; });
        const auto most = std::min(static_cast<std::size_t>(std::ceil(most_growth * static_cast<double>(size()))),
                                   options_.max_points - std::min(size(), options_.max_points));
        std::size_t count = 0;
        while (count < std::min(most, worst.size()) && excess > 0) {
            const SamplePart& part = parts_.parts()[worst[count]];
            excess -= error[worst[count++]] * std::min(1.0, part.gain / part.fit.error);
        }
        worst.resize(count);
        for (const std::size_t p : worst) fresh_.push_back(p);
        for (std::size_t k = 0; k < count; ++k) fresh_.push_back(size() + k);
        parts_.split(worst);
        return count > 0;
    }

    /// New parts get a kernel that starts with their own fit; the others keep theirs.
    void place_kernels() {
        if (centers_.empty()) {
            fresh_.resize(size());
            std::iota(fresh_.begin(), fresh_.end(), std::size_t{0});
        }
        centers_.resize(size());
        frames_.resize(size());
        terms_.resize(size());
        prior_.resize(size());
        detail::parallel_each(fresh_.size(), [&](std::size_t k) { place_kernel(fresh_[k]); });
        fresh_.clear();
    }

    void place_kernel(std::size_t p) {
        const SamplePart& part = parts_.parts()[p];
        centers_[p] = part.fit.mean;
        const double radius = support_radius(options_.kernel), r = options_.overlap * radius;
        Mat3 s = (r * r * kUniform) * part.fit.covariance;
        const double trace = s[0][0] + s[1][1] + s[2][2];
        s += Mat3(kThickness * kThickness * (trace > 0 ? trace : 1e-12));
        frames_[p] = symmetric3(s);
        // Every sample of the part must be covered: the kernel of a part with distant samples is widened.
        const auto root = detail::inverse_root(frames_[p]);
        double farthest = 0;
        for (std::size_t k = part.begin; k < part.end; ++k) {
            const Vec3 place = root.times(samples_.points[parts_.order()[k]] - part.fit.mean);
            farthest = std::max(farthest, glm::dot(place, place));
        }
        const double allowed = std::pow(kFarthest / radius, 2);
        if (farthest > allowed) frames_[p] = symmetric3(farthest / allowed * s);
        const Vec3 h = detail::to_frame(frames_[p], part.fit.slope);
        terms_[p] = prior_[p] = {part.fit.value, h.x, h.y, h.z, 0};
    }

    const FieldSamples& samples_;
    const ReduceOptions& options_;
    SampleParts parts_;
    double weight_ = 0;
    std::vector<std::size_t> fresh_;
    std::vector<Vec3> centers_;
    std::vector<Symmetric3> frames_;
    std::vector<KernelTerms> terms_, prior_;
    std::vector<double> error_;
};

}  // namespace

ErrorAtSamples error_at_samples(const RbfVolume& volume, const FieldSamples& samples) {
    check(samples);
    const auto values = RbfField(volume).evaluate(samples.points);
    ErrorAtSamples result;
    double sum = 0, weight = 0;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (std::isnan(values[i])) {
            ++result.uncovered;
            continue;
        }
        const double error = values[i] - samples.values[i];
        sum += samples.weights[i] * error * error;
        weight += samples.weights[i];
        result.max_abs = std::max(result.max_abs, std::abs(error));
    }
    result.rmse = std::sqrt(sum / weight);
    if (result.uncovered == samples.size()) result.max_abs = NAN;
    return result;
}

ReduceResult reduce_rbf(const FieldSamples& samples, const FieldSamples& validation, const ReduceOptions& options) {
    const detail::Stopwatch watch;
    check(options);
    check(samples);
    Reduction reduction(samples, options);
    ReduceResult result;
    auto& report = result.report;
    report.samples = samples.size();
    double target = options.move ? kMoveGain * options.rmse : options.rmse;
    reduction.grow_alone(target);
    for (int checks = 0; !report.reached && checks < kMostChecks; ++checks) {
        bool more = true;
        while (true) {
            report_progress(options.progress, "reduce", report.rmse > 0 ? std::min(1.0, options.rmse / report.rmse) : 0);
            ++report.rounds;
            report.rmse = reduction.fit(kSteps);
            if (report.rmse <= target) break;
            more = reduction.grow(target);
            if (!more) break;
        }
        result.volume = reduction.volume();
        if (options.move) {
            auto moved = refine_rbf(result.volume, samples, {.move = true, .iterations = kMoves, .progress = options.progress});
            result.volume = std::move(moved.volume);
            report.rmse = moved.report.rmse_after;
        }
        report.validation = error_at_samples(result.volume, validation);
        report.reached = std::max(report.rmse, report.validation.rmse) <= options.rmse && report.validation.uncovered == 0;
        if (!more) break;
        // The fit is better at the samples than between them, or moves gained less than expected: aim lower.
        const double error = std::max(report.rmse, report.validation.rmse);
        target = (options.move ? target : std::min(target, report.rmse)) * std::min(kAimLower, options.rmse / error);
    }
    report.points = result.volume.size();
    report.seconds = watch.seconds();
    return result;
}

ReduceResult reduce_rbf(const HexMesh& mesh, std::string_view field, const ReduceOptions& options) {
    check(options);
    const HexMesh bare = with_scalar_field(mesh, field);
    // 8 samples per cell, more on coarse meshes; fewer independent ones, as each refines its cell.
    constexpr std::size_t kSamples = 200'000, kValidation = 20'000, kMostSamples = 8'000'000;
    const std::size_t cells = mesh.cells.size();
    const int level = cells * 8 >= kSamples ? 1 : cells * 64 >= kSamples ? 2 : 3;
    LimitOptions limit = options.limit;
    limit.progress = options.progress;
    const FieldSamples validation = limit_samples_in_cells(bare, {}, kValidation, limit);
    ReduceResult result = reduce_rbf(limit_samples_at_vertices(bare, {}, level, limit), validation, options);
    // If there were too few samples, try once with eight times as many, unless they would take too much memory.
    const bool more = !result.report.reached && result.report.points < options.max_points;
    if (more && level < 3 && cells << (3 * level + 3) <= kMostSamples)
        result = reduce_rbf(limit_samples_at_vertices(bare, {}, level + 1, limit), validation, options);
    result.volume.channels[0].name = bare.attributes[0].name;
    const HexMesh once = refine(bare, {.scheme = limit.scheme, .levels = 1, .progress = limit.progress});
    result.volume.boundary = boundary_surface(on_limit(once, limit.scheme.kind));
    return result;
}

std::vector<Option> options_of(ReduceOptions& options) {
    return {Option("rmse", options.rmse).positive().help("RMSE", "the root mean square error, in the field's unit"),
            kernel_option("kernel", options.kernel).help("NAME|JSON", "the kernel of the points"),
            Option("overlap", options.overlap).between(0.7, 2).help("R", "1 is the overlap of uniform samples"),
            Option("max-points", options.max_points).between(1, 1e12).help("N", "no more kernels than these"),
            Option("move", options.move).help("also move and resize the kernels: about half as many, ten times as slow")};
}

}  // namespace subvol
