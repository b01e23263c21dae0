// SPDX-License-Identifier: Apache-2.0
#include "series_survey.h"

#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "subvol/mesh_report.h"
#include "wavelet_format.h"

namespace subvol::detail {

namespace {

/// A step that rounds by `most` at most, or a little less so that the ends of the range are whole numbers of steps; 0 is one
/// where the values have either sign.
Quantization quantization(const ChannelRange& range, double most) {
    if (!(range.max > range.min)) {
        const double only = range.max < range.min ? 0 : range.min;
        return {only, 0, only, only};
    }
    const bool around_zero = range.min < 0 && range.max > 0;
    const double length = around_zero ? std::max(range.max, -range.min) : range.size();
    // A residual is rounded by half a step at most, and a target by half of 2⁻⁸ of one.
    const double steps = std::max(1.0, std::ceil(length / (2 * most) * (1 + 1e-9 + std::ldexp(1.0, -kFractionBits))));
    return {around_zero ? 0 : range.min, length / steps, range.min, range.max};
}

/// `values` are those of all channels, point-major.
std::vector<double> rounded_values(std::span<const double> values, std::span<const Quantization> channels) {
    std::vector<double> rounded(values.begin(), values.end());
    parallel_each(rounded.size(), [&](std::size_t i) {
        const Quantization& q = channels[i % channels.size()];
        if (std::isfinite(rounded[i]) && q.step > 0)
            rounded[i] = q.value(std::llround((rounded[i] - q.origin) / q.step) * (std::int64_t{1} << kFractionBits));
    });
    return rounded;
}

}  // namespace

SeriesSurvey::SeriesSurvey(const MeshSteps& steps, const SeriesFileOptions& options) : options_(options) {
    ranges_.push_back({"", std::vector<ChannelRange>(3)});
    for (std::size_t k = 0; k < steps.times.size(); ++k) {
        report_progress(options.progress, "ranges of fields", k, steps.times.size());
        look_at(steps.read(k));
    }
}

std::vector<SeriesArray> SeriesSurvey::arrays() const {
    std::vector<SeriesArray> arrays;
    for (const ArrayRange& range : ranges_) {
        const double most = arrays.empty() ? point_error_ : options_.tolerance * range.scale();
        SeriesArray& array = arrays.emplace_back(SeriesArray{range.name, {}});
        for (const ChannelRange& channel : range.channels) array.channels.push_back(quantization(channel, most));
    }
    return arrays;
}

double SeriesSurvey::most_error(std::size_t array) const {
    return array == 0 ? point_error_ : options_.tolerance * ranges_[array].scale();
}

double SeriesSurvey::unit(std::size_t array) const {
    const double scale = array == 0 ? length_ : ranges_[array].scale();
    return scale > 0 ? scale : 1;
}

void SeriesSurvey::look_at(const HexMesh& mesh) {
    if (mesh.points.size() > 8 * mesh.cells.size()) {
        throw Error(ErrorCode::InvalidInput,
                    std::to_string(mesh.points.size()) + " points are more than the corners of the cells", "series",
                    "without_unused_points leaves out those that no cell uses");
    }
    for (const Vec3& p : mesh.points) {
        for (int k = 0; k < 3; ++k) ranges_[0].channels[static_cast<std::size_t>(k)].add(p[k]);
    }
    for (const Attribute& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        ArrayRange& range = range_of_array(attribute.name, channels);
        for (std::size_t i = 0; i < attribute.values.size(); ++i) range.channels[i % channels].add(attribute.values[i]);
    }
    if (length_ == 0) {
        length_ = ranges_[0].scale();
        point_error_ = options_.point_tolerance.value_or(std::max(options_.tolerance / 10, kLeastTolerance)) * length_;
    }
    if (!options_.point_tolerance) keep_cells_sound(mesh);
}

ArrayRange& SeriesSurvey::range_of_array(const std::string& name, std::size_t channels) {
    const auto [at, is_new] = places_.try_emplace({name, channels}, ranges_.size());
    if (is_new) ranges_.push_back({name, std::vector<ChannelRange>(channels)});
    return ranges_[at->second];
}

void SeriesSurvey::keep_cells_sound(const HexMesh& mesh) {
    constexpr int kMostThirds = 8;
    const std::vector<double> places = coordinates(mesh.points);
    const std::size_t before = inverted_cells_at(mesh, places);
    for (int attempt = 0; attempt < kMostThirds; ++attempt) {
        std::vector<Quantization> channels;
        for (const ChannelRange& channel : ranges_[0].channels) channels.push_back(quantization(channel, point_error_));
        if (inverted_cells_at(mesh, rounded_values(places, channels)) <= before) return;
        if (point_error_ / 3 < kLeastTolerance * length_) return;
        point_error_ /= 3;
    }
}

std::size_t inverted_cells_at(const HexMesh& mesh, std::span<const double> places) {
    HexMesh moved;
    moved.cells = mesh.cells;
    moved.points.reserve(mesh.points.size());
    for (std::size_t i = 0; i < places.size(); i += 3) moved.points.emplace_back(places[i], places[i + 1], places[i + 2]);
    return measure_cells(moved).inverted_cells;
}

}  // namespace subvol::detail
