// SPDX-License-Identifier: Apache-2.0
#include "subvol/mesh_series.h"

#include <algorithm>
#include <cmath>

#include "format_table.h"

namespace subvol {

MeshSeries open_series(const std::filesystem::path& path) {
    const detail::MeshFormat& format = detail::readable_format(path);
    MeshSeries series{path, format.times ? format.times(path) : std::vector<double>()};
    if (series.times.empty()) series.times = {0};
    return series;
}

std::size_t nearest_step(const MeshSeries& series, double time) {
    const auto nearest = std::ranges::min_element(series.times, [&](double a, double b) {
        const auto distance = [&](double t) {
            return std::isnan(t) ? std::numeric_limits<double>::infinity() : std::abs(t - time);
        };
        return distance(a) < distance(b);
    });
    return static_cast<std::size_t>(nearest - series.times.begin());
}

}  // namespace subvol
