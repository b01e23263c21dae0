// SPDX-License-Identifier: Apache-2.0
#include "color_curve.h"

#include <algorithm>

#include "knots.h"
#include "subvol/srgb.h"

namespace subvol::detail {
namespace {

using ColorKnot = TransferFunction::ColorKnot;

double largest(const Vec3& difference) {
    const Vec3 d = glm::abs(difference);
    return std::max({d.x, d.y, d.z});
}

Vec3 encoded(const Vec3& linear) {
    return {srgb_from_linear(linear.x), srgb_from_linear(linear.y), srgb_from_linear(linear.z)};
}

void append_piece(const ColorKnot& first, const ColorKnot& second, ColorSpace space, std::vector<ColorKnot>& straight) {
    if (!(first.value < second.value)) return;
    if (space == ColorSpace::Step) {
        straight.push_back({first.value, linear_from_srgb(second.rgb)});
        return;
    }
    const auto color = [&](double s) { return mix_colors(space, first.rgb, second.rgb, s); };
    const auto is_close = [&](double from, double to) {
        const Vec3 a = linear_from_srgb(color(from)), b = linear_from_srgb(color(to));
        const auto deviation = [&](double s, double t) {
            const Vec3 chord = (1 - t) * a + t * b, exact = color(s);
            return std::max(largest(linear_from_srgb(exact) - chord), largest(exact - encoded(chord)));
        };
        return deviates_little(deviation, from, to);
    };
    std::vector<double> places;
    add_chord_ends(is_close, 0, 1, places);
    append_between(straight, places, first.value, second.value, [&](double s) { return linear_from_srgb(color(s)); });
}

}  // namespace

std::vector<ColorKnot> straight_pieces(std::span<const ColorKnot> knots, ColorSpace space) {
    std::vector<ColorKnot> straight{{knots.front().value, linear_from_srgb(knots.front().rgb)}};
    for (std::size_t i = 1; i < knots.size(); ++i) {
        append_piece(knots[i - 1], knots[i], space, straight);
        straight.push_back({knots[i].value, linear_from_srgb(knots[i].rgb)});
    }
    part_equal_values(straight);
    return straight;
}

}  // namespace subvol::detail
