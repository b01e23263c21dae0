#include <algorithm>
#include <array>
#include <cstddef>

#include "subvol/optics.h"

namespace subvol {

namespace {

constexpr double kGaussOffset = 0.3872983346207417;  // √(3/5) / 2
constexpr std::array<std::array<double, 2>, 3> kGauss{
    {{0.5 - kGaussOffset, 5.0 / 18}, {0.5, 8.0 / 18}, {0.5 + kGaussOffset, 5.0 / 18}}};

// ∫ τ c between two values without a knot between them.
Vec3 emission(const Optics& optics, double from, double to) {
    Vec3 sum(0.0);
    for (const auto& [u, weight] : kGauss) {
        const double value = from + u * (to - from);
        sum += weight * optics.extinction(value) * optics.color(value);
    }
    return (to - from) * sum;
}

Vec3 emission_across_knots(const Optics& optics, double from, double to) {
    const auto knots = optics.knots();
    Vec3 sum(0.0);
    for (auto knot = std::upper_bound(knots.begin(), knots.end(), from); knot != knots.end() && *knot < to; ++knot) {
        sum += emission(optics, from, *knot);
        from = *knot;
    }
    return sum + emission(optics, from, to);
}

std::array<float, 4> row(double extinction, const Vec3& color) {
    return {static_cast<float>(extinction), static_cast<float>(color.x), static_cast<float>(color.y),
            static_cast<float>(color.z)};
}

}  // namespace

PreintegratedTable make_preintegrated_table(const Optics& optics) {
    constexpr int kLast = PreintegratedTable::kSize - 1;
    PreintegratedTable table{.min = optics.knots().front(), .max = optics.knots().back(), .prefixes = {}, .points = {}};
    if (!(table.min < table.max)) table.max = table.min + 1;  // a constant function: any range shows it
    table.prefixes.reserve(PreintegratedTable::kSize);
    table.points.reserve(PreintegratedTable::kSize);
    const auto value_at = [&](int i) { return table.min + (table.max - table.min) * i / kLast; };
    Vec3 emitted(0.0);
    for (int i = 0; i <= kLast; ++i) {
        if (i > 0) emitted += emission_across_knots(optics, value_at(i - 1), value_at(i));
        const double depth = optics.extinction_integral(value_at(i));
        table.prefixes.push_back(row(depth, emitted));
        table.points.push_back(row(optics.extinction(value_at(i)), optics.color(value_at(i))));
    }
    return table;
}

}  // namespace subvol
