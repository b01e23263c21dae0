// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "subvol/detail/preintegrated_table.h"

namespace subvol::detail {

namespace {

using Channels = std::array<double, 4>;

constexpr double kGaussOffset = 0.3872983346207417;  // √(3/5) / 2
constexpr std::array<std::array<double, 2>, 3> kGauss{
    {{0.5 - kGaussOffset, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + kGaussOffset, 5.0 / 18}}};

Channels emission_at(const Optics& optics, double value) {
    const double extinction = optics.extinction(value);
    const Vec3 color = optics.color(value);
    return {extinction, extinction * color.x, extinction * color.y, extinction * color.z};
}

/// Means over values between which there is no knot.
Channels mean_between_knots(const Optics& optics, double from, double to) {
    Channels sum{};
    for (const auto& [u, weight] : kGauss) {
        const Channels emission = emission_at(optics, from + u * (to - from));
        for (std::size_t c = 0; c < 4; ++c) sum[c] += weight * emission[c];
    }
    sum[0] = (optics.extinction_integral(to) - optics.extinction_integral(from)) / (to - from);
    return sum;
}

Channels mean_across_knots(const Optics& optics, double from, double to) {
    const auto knots = optics.knots();
    Channels sum{};
    const double width = to - from;
    const auto add = [&](double end) {
        if (!(end > from)) return;
        const Channels part = mean_between_knots(optics, from, end);
        for (std::size_t c = 0; c < 4; ++c) sum[c] += (end - from) / width * part[c];
        from = end;
    };
    for (auto knot = std::upper_bound(knots.begin(), knots.end(), from); knot != knots.end() && *knot < to; ++knot) add(*knot);
    add(to);
    return sum;
}

}  // namespace

PreintegratedTable make_preintegrated_table(const Optics& optics) {
    constexpr int kCells = PreintegratedTable::kCells;
    constexpr double kCounts = 1 << 30;
    PreintegratedTable table{.min = optics.knots().front(), .max = optics.knots().back(), .rows = {}, .visible = {}};
    if (!(table.min < table.max)) table.max = table.min + 1;  // a constant function is the same on any range
    const auto value_at = [&](int i) { return table.min + (table.max - table.min) * i / kCells; };

    std::vector<Channels> ends(kCells + 1), means(kCells + 2);
    for (int i = 0; i <= kCells; ++i) ends[static_cast<std::size_t>(i)] = emission_at(optics, value_at(i));
    means.front() = ends.front();
    means.back() = ends.back();
    for (int i = 0; i < kCells; ++i) {
        means[static_cast<std::size_t>(i) + 1] = mean_across_knots(optics, value_at(i), value_at(i + 1));
    }

    table.rows.resize(means.size());
    for (std::size_t c = 0; c < 4; ++c) {
        double total = 0, sum = 0;
        for (const Channels& mean : means) total += mean[c];
        const double unit = total > 0 ? total / kCounts : 1;
        table.unit[c] = static_cast<float>(unit);
        for (std::size_t i = 0; i < means.size(); ++i) {
            auto& row = table.rows[i];
            row.prefix[c] = static_cast<std::int32_t>(std::lround(sum / unit));
            row.mean[c] = static_cast<float>(means[i][c]);
            row.bend[c] = i > 0 && i <= kCells ? static_cast<float>(0.5 * (ends[i][c] - ends[i - 1][c])) : 0.0f;
            sum += means[i][c];
        }
    }
    table.visible.push_back(0);
    for (const auto& row : table.rows) table.visible.push_back(table.visible.back() + (row.mean[0] > 0 ? 1 : 0));
    return table;
}

bool PreintegratedTable::transparent(double x0, double x1) const {
    const auto row = [](double x) { return static_cast<std::size_t>(std::clamp(std::floor(x), -1.0, double{kCells}) + 1); };
    return visible[row(std::max(x0, x1)) + 1] == visible[row(std::min(x0, x1))];
}

}  // namespace subvol::detail
