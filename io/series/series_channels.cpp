// SPDX-License-Identifier: Apache-2.0
// Each value is predicted from values as they are read again, and what it differs from its prediction is rounded to whole
// steps: the error is that of this rounding, whatever the prediction. Both sides compute in whole numbers, 2⁸ to a step, so
// that every machine reads the same. Which prediction is best differs from field to field and from step to step: all are tried,
// and the one is taken whose residuals are compressed best.
#include "series_channels.h"

#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "wavelet_bytes.h"

namespace subvol::detail {

namespace {

/// base: what earlier steps predict
Residuals residuals_of(const std::vector<std::int64_t>& targets, const std::vector<std::int64_t>& base,
                       const ValuePrediction* prediction) {
    constexpr std::int64_t kHalf = std::int64_t{1} << (kFractionBits - 1);
    Residuals made;
    std::vector<std::int64_t>& changes = made.numbers;
    changes.resize(targets.size());
    std::vector<std::uint64_t> rest(targets.size());
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        const std::size_t p = prediction == nullptr ? i : prediction->order[i];
        const std::int64_t predicted = prediction == nullptr ? 0 : prediction->predict(i, changes);
        const std::int64_t residual = (targets[p] - base[p] - predicted + kHalf) >> kFractionBits;
        changes[p] = predicted + residual * (std::int64_t{1} << kFractionBits);
        rest[i] = folded(residual);
        all |= rest[i];
    }
    for (std::size_t p = 0; p < changes.size(); ++p) changes[p] += base[p];
    made.bytes_each = (static_cast<std::size_t>(std::bit_width(all)) + 7) / 8;
    made.planes.resize(made.bytes_each * rest.size());
    for (std::size_t plane = 0; plane < made.bytes_each; ++plane) {
        char* out = made.planes.data() + plane * rest.size();
        for (std::size_t i = 0; i < rest.size(); ++i) out[i] = static_cast<char>(rest[i] >> 8 * plane & 255);
    }
    return made;
}

/// What is tried, given how many steps before are known.
std::vector<Mode> modes(std::size_t steps_before) {
    std::vector<Mode> tried;
    if (steps_before > 0) tried.push_back({Spatial::None, Temporal::Same});
    for (const Spatial spatial : kSpatials) {
        tried.push_back({spatial, Temporal::None});
        if (steps_before > 0) tried.push_back({spatial, Temporal::Same});
        if (steps_before > 1) tried.push_back({spatial, Temporal::Linear});
    }
    if (steps_before > 1) tried.push_back({Spatial::None, Temporal::Linear});
    return tried;
}

}  // namespace

Predictions::Predictions(const HexMesh& mesh) {
    HexMesh cells_alone;  // neither creases nor sharp faces matter
    cells_alone.points.resize(mesh.points.size());
    cells_alone.cells = mesh.cells;
    topology_ = build_topology(cells_alone);
}

void Predictions::make(Spatial spatial) {
    auto& made = made_[static_cast<std::size_t>(spatial)];
    if (made) return;
    switch (spatial) {
        case Spatial::ByNumber:
            made = predict_by_number(topology_.point_count);
            break;
        case Spatial::InCells:
            made = predict_in_cells(topology_);
            break;
        case Spatial::BetweenSheets:
            made = predict_between_sheets(topology_);
            break;
        default:
            break;
    }
}

const ValuePrediction* Predictions::find(Spatial spatial) const {
    const auto& made = made_[static_cast<std::size_t>(spatial)];
    return made ? &*made : nullptr;
}

std::vector<std::int64_t> targets_of(std::span<const double> values, std::size_t channel, std::size_t channels,
                                     const Quantization& q) {
    std::vector<std::int64_t> targets(values.size() / channels, 0);
    if (q.step == 0) return targets;
    for (std::size_t p = 0; p < targets.size(); ++p) {
        const double part = std::ldexp((values[p * channels + channel] - q.origin) / q.step, kFractionBits);
        if (std::abs(part) <= static_cast<double>(kMostQuantized / 2)) targets[p] = std::llround(part);
    }
    return targets;
}

CodedChannel coded(const std::vector<std::int64_t>& targets, const std::array<const std::vector<std::int64_t>*, 2>& before,
                   const Predictions& predictions) {
    static const std::vector<std::int64_t> kNothing;
    const std::vector<std::int64_t>&last = before[0] ? *before[0] : kNothing, &two_before = before[1] ? *before[1] : kNothing;
    CodedChannel best;
    best.bytes = std::numeric_limits<std::uint64_t>::max();
    std::vector<std::int64_t> base(targets.size());
    for (const Mode mode : modes(last.empty() ? 0 : two_before.empty() ? 1 : 2)) {
        for (std::size_t p = 0; p < base.size(); ++p) base[p] = earlier(mode.temporal, last, two_before, p);
        Residuals residuals = residuals_of(targets, base, predictions.find(mode.spatial));
        const std::uint64_t bytes = residuals.planes.empty() ? 0 : compressed_numbers(residuals.planes, Effort::Least).size();
        if (bytes >= best.bytes) continue;
        best = {mode, std::move(residuals), bytes};
        if (bytes == 0) break;
    }
    return best;
}

KeptValues kept_values(std::span<const double> values, std::size_t channel, std::size_t channels, const Quantization& q,
                       std::span<const std::int64_t> numbers, double most) {
    KeptValues kept;
    for (std::size_t p = 0; p < numbers.size(); ++p) {
        const double x = values[p * channels + channel], error = std::abs(q.value(numbers[p]) - x);
        if (error <= most) {
            kept.max_error = std::max(kept.max_error, error);
            continue;
        }
        kept.exact_points.push_back(p);
        kept.exact_values.push_back(x);
    }
    return kept;
}

}  // namespace subvol::detail
