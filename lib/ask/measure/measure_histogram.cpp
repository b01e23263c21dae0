// SPDX-License-Identifier: Apache-2.0
// The volume in which a field has values of an interval: the weights of Gauss points, counted in whole units, since sums of
// whole numbers are the same in any order.
#include <cmath>
#include <functional>
#include <numeric>

#include "measurer.h"

namespace subvol::detail {

namespace {

constexpr int kUnitBits = 52;  // of the largest volume of a histogram

}  // namespace

void Measurer::add_histograms(std::vector<PartMeasure>& found) {
    const auto bins = static_cast<std::size_t>(options_.bins);
    for (PartMeasure& part : found) {
        for (FieldMeasure& field : part.fields) field.histogram.assign(bins, 0);
    }
    if (!has_fields_) {
        for (PartMeasure& part : found) {
            for (FieldMeasure& field : part.fields) field.histogram[0] = part.volume;
        }
        return;
    }
    // Few cells are refined more often, so that each interval has enough Gauss points.
    constexpr std::size_t kEnoughPieces = 16384;  // pieces
    int level = 1;
    while (level < 4 && cells_.size() << 3 * level <= kEnoughPieces) ++level;
    // Volumes are counted in a unit, as sums of whole numbers are the same in any order.
    const double unit = std::ldexp(std::max(std::abs(found[0].volume), box_volume()), -kUnitBits);
    using Counts = std::vector<std::int64_t>;
    const std::size_t each = channels_.size() * bins;
    tbb::enumerable_thread_specific<Counts> counts([&] { return Counts(parts_.size() * each, 0); });
    each_block(
        cells_, level, "histogram",
        [&](const DenseCell& grid, std::size_t) {
            count(grid, found[0], unit, std::span(counts.local()).subspan(part_of(grid.cell) * each, each));
        },
        [](Index, std::size_t, std::size_t) {});
    Counts all(parts_.size() * each, 0);
    for (const Counts& some : counts) std::ranges::transform(some, all, all.begin(), std::plus{});
    for (std::size_t i = 0; i < all.size(); ++i) {
        const double volume = static_cast<double>(all[i]) * unit;
        const auto add = [&](PartMeasure& part) { part.fields[i % each / bins].histogram[i % bins] += volume; };
        add(found[0]);
        if (found.size() > 1) add(found[i / each + 1]);
    }
}

void Measurer::scale_histograms(PartMeasure& part) {
    for (FieldMeasure& field : part.fields) {
        const double sum = std::accumulate(field.histogram.begin(), field.histogram.end(), 0.0);
        if (sum == 0) continue;
        for (double& volume : field.histogram) volume *= part.volume / sum;
    }
}

double Measurer::box_volume() const {
    const Vec3 size = extent_.box.upper - extent_.box.lower;
    return size.x * size.y * size.z;
}

void Measurer::count(const DenseCell& grid, const PartMeasure& whole, double unit, std::span<std::int64_t> counts) {
    const auto bins = static_cast<std::size_t>(options_.bins);
    scratch_.local().measure.each_gauss_point(grid, [&](double weight, std::span<const double> values) {
        const double units = weight / unit;
        if (!(std::abs(units) < std::ldexp(1.0, kUnitBits))) return;  // no such volume is in the box
        const auto whole_units = static_cast<std::int64_t>(std::llround(units));
        for (std::size_t c = 0; c < values.size(); ++c) {
            const double low = whole.fields[c].min.value - channels_[c].origin;
            const double width = whole.fields[c].max.value - whole.fields[c].min.value;
            const double t = width > 0 ? (values[c] - low) / width * static_cast<double>(bins) : 0;
            counts[c * bins + static_cast<std::size_t>(std::clamp(t, 0.0, static_cast<double>(bins - 1)))] += whole_units;
        }
    });
}

}  // namespace subvol::detail
