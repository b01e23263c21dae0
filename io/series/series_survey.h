// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "series_format.h"
#include "subvol/series_file.h"

namespace subvol::detail {

/// The least error that may be asked for, in parts of a range.
inline constexpr double kLeastTolerance = 1e-12;

/// The finite values of a channel in all steps.
struct ChannelRange {
    double min = std::numeric_limits<double>::infinity(), max = -min;

    void add(double x) {
        if (!std::isfinite(x)) return;
        min = std::min(min, x);
        max = std::max(max, x);
    }
    [[nodiscard]] double size() const { return max > min ? max - min : 0; }
};

struct ArrayRange {
    std::string name;
    std::vector<ChannelRange> channels;

    /// The longest side of the box of the values.
    [[nodiscard]] double scale() const {
        double most = 0;
        for (const ChannelRange& channel : channels) most = std::max(most, channel.size());
        return most;
    }
};

/// What the first look at all steps finds: ranges, and how exact points have to be.
class SeriesSurvey {
public:
    /// options: referred to
    SeriesSurvey(const MeshSteps& steps, const SeriesFileOptions& options);

    /// quantizations, the points first
    [[nodiscard]] std::vector<SeriesArray> arrays() const;
    /// The most error of an array's values, in world units or those of the field.
    [[nodiscard]] double most_error(std::size_t array) const;
    /// What errors of an array are told in parts of.
    [[nodiscard]] double unit(std::size_t array) const;

private:
    void look_at(const HexMesh& mesh);
    ArrayRange& range_of_array(const std::string& name, std::size_t channels);
    void keep_cells_sound(const HexMesh& mesh);

    const SeriesFileOptions& options_;
    std::vector<ArrayRange> ranges_;
    std::map<std::pair<std::string, std::size_t>, std::size_t> places_;  // in `ranges_`, by name and channels
    double length_ = 0, point_error_ = 0;
};

/// How many cells are inverted if their points are at these places, three numbers each.
[[nodiscard]] std::size_t inverted_cells_at(const HexMesh& mesh, std::span<const double> places);

}  // namespace subvol::detail
