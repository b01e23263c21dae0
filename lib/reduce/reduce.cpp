// SPDX-License-Identifier: Apache-2.0
#include "subvol/reduce.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "bucket_sort.h"
#include "rbf_terms.h"
#include "sample_parts.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/rbf_field.h"
#include "subvol/surface.h"
#include "thin_samples.h"

namespace subvol {

using detail::FieldFit;
using detail::KernelTerms;
using detail::SamplePart;
using detail::SampleParts;

namespace {

constexpr double kUniform = 12;           // side² of a box over its variance
constexpr double kFarthest = 1.01;        // ρ of a part's farthest sample: the compact kernel weighs .125 there
constexpr double kFirstError = 5;         // times the target: up to there parts are split by their own fits
constexpr std::size_t kPartSamples = 64;  // of a part that take part in the fit
constexpr double kMostGrowth = 0.3;       // of the parts are split in a round
constexpr double kThickness = 1e-3;       // of a flat part, of its largest extent
constexpr int kSteps = 40;                // of conjugate gradients; 120 lower the error by less than a hundredth
constexpr int kMostChecks = 8;            // against the validation samples
constexpr double kAimLower = 0.98;
constexpr double kMoveGain = 2;  // how many times moves lower the error, at first guess
constexpr int kMoves = 12;       // steps of the solver that moves kernels

void check(const FieldSamples& samples) {
    const bool same = samples.values.size() == samples.size() && samples.weights.size() == samples.size();
    if (!same || samples.size() == 0 || samples.size() >= kNone) {
        throw Error(ErrorCode::InvalidInput, "samples need one value and one weight a point", {}, "1 to 2³² samples");
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
    if (!(total > 0)) throw Error(ErrorCode::InvalidInput, "all samples weigh nothing", {}, "the volume that each stands for");
}

void check(const ReduceOptions& options) {
    if (!(options.rmse > 0 && std::isfinite(options.rmse)))
        throw Error(ErrorCode::InvalidInput, "the target error is " + std::to_string(options.rmse), {}, "a positive number");
    if (!(options.overlap >= .7 && options.overlap <= 2))
        throw Error(ErrorCode::InvalidInput, "the overlap is " + std::to_string(options.overlap), {}, "0.7 to 2");
    if (!is_radial(options.kernel))
        throw Error(ErrorCode::InvalidInput, "the kernel is not radial, frames have no axes for it", {}, "a radial kernel");
    if (options.max_points < 1) throw Error(ErrorCode::InvalidInput, "at most 0 points", {}, "1 or more");
}

/// A growing set of kernels over a partition of samples.
class Reduction {
public:
    Reduction(const FieldSamples& samples, const ReduceOptions& options)
        : samples_(samples), options_(options), parts_(samples) {
        weight_ = std::accumulate(samples.weights.begin(), samples.weights.end(), 0.0);
    }

    [[nodiscard]] std::size_t size() const { return parts_.parts().size(); }

    /// Splits by the parts' own fits until those are near the target: cheap, and as good while kernels are far too few.
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

    /// New parts get a kernel and their own fit for a start; the others keep theirs.
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
        frames_[p] = frame(s, 1);
        // No part may have a hole: kernels of odd shapes are widened.
        const auto root = detail::inverse_root(frames_[p]);
        double farthest = 0;
        for (std::size_t k = part.begin; k < part.end; ++k) {
            const Vec3 place = root.times(samples_.points[parts_.order()[k]] - part.fit.mean);
            farthest = std::max(farthest, glm::dot(place, place));
        }
        const double allowed = std::pow(kFarthest / radius, 2);
        if (farthest > allowed) frames_[p] = frame(s, farthest / allowed);
        const Vec3 h = detail::to_frame(frames_[p], part.fit.slope);
        terms_[p] = prior_[p] = {part.fit.value, h.x, h.y, h.z, 0};
    }

    static std::array<float, 6> frame(const Mat3& s, double scale) {
        const auto at = [&](int i, int j) { return static_cast<float>(scale * s[i][j]); };
        return {at(0, 0), at(1, 0), at(2, 0), at(1, 1), at(2, 1), at(2, 2)};
    }

    const FieldSamples& samples_;
    const ReduceOptions& options_;
    SampleParts parts_;
    double weight_ = 0;
    std::vector<std::size_t> fresh_;
    std::vector<Vec3> centers_;
    std::vector<std::array<float, 6>> frames_;
    std::vector<KernelTerms> terms_, prior_;
    std::vector<double> error_;
};

}  // namespace

FieldError field_error(const RbfVolume& volume, const FieldSamples& samples) {
    check(samples);
    const auto values = RbfField(volume).evaluate(samples.points);
    FieldError result;
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
    result.rmse = weight > 0 ? std::sqrt(sum / weight) : 0;
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
        report.validation = field_error(result.volume, validation);
        report.reached = std::max(report.rmse, report.validation.rmse) <= options.rmse && report.validation.uncovered == 0;
        if (!more) break;
        // The samples were met better than what lies between them, or moves gained less: aim lower.
        const double error = std::max(report.rmse, report.validation.rmse);
        target = (options.move ? target : std::min(target, report.rmse)) * std::min(kAimLower, options.rmse / error);
    }
    report.points = result.volume.size();
    report.seconds = watch.seconds();
    return result;
}

ReduceResult reduce_rbf(const HexMesh& mesh, const ReduceOptions& options) {
    check(options);
    // 8 samples a cell, more on coarse meshes; of the independent ones fewer, as each refines its cell.
    constexpr std::size_t kSamples = 200'000, kValidation = 20'000, kMostSamples = 8'000'000;
    const std::size_t cells = mesh.cells.size();
    const int level = cells * 8 >= kSamples ? 1 : cells * 64 >= kSamples ? 2 : 3;
    LimitOptions limit = options.limit;
    limit.progress = options.progress;
    const FieldSamples validation = sample_cells(mesh, kValidation, limit);
    ReduceResult result = reduce_rbf(sample_vertices(mesh, level, limit), validation, options);
    // What fails for want of samples gets eight times as many, once, as long as memory is a matter of course.
    const bool more = !result.report.reached && result.report.points < options.max_points;
    if (more && level < 3 && cells << (3 * level + 3) <= kMostSamples)
        result = reduce_rbf(sample_vertices(mesh, level + 1, limit), validation, options);
    result.volume.channels[0].name = mesh.attributes[0].name;
    const HexMesh once = refine(mesh, {.scheme = limit.scheme, .levels = 1, .progress = limit.progress});
    result.volume.boundary = boundary_surface(on_limit(once, limit.scheme.kind));
    return result;
}

}  // namespace subvol
