// SPDX-License-Identifier: Apache-2.0
// A scale is a monotone function s of values. The colour at a part t of the map moves from min + t (max − min) to the value v
// with s(v) = s(min) + t (s(max) − s(min)). Renderers keep their straight lines between knots: there are so many knots that
// these follow the curve.
#include "subvol/color_scale.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "subvol/detail/knot_values.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;
namespace {

constexpr int kPieces = 256;  // of a scale that is not linear

double scaled(const ColorScale& scale, double value) {
    if (scale.logarithmic) return std::log(value);
    if (scale.linear_within > 0) return std::copysign(std::log1p(std::abs(value) / scale.linear_within), value);
    return value;
}

double unscaled(const ColorScale& scale, double s) {
    if (scale.logarithmic) return std::exp(s);
    if (scale.linear_within > 0) return std::copysign(scale.linear_within * std::expm1(std::abs(s)), s);
    return s;
}

void check_range(const ColorScale& scale, double min) {
    if (!scale.logarithmic || min > 0) return;
    throw Error(ErrorCode::InvalidInput, "a logarithmic scale needs values above 0; the range begins at " + number_text(min),
                scale.where, "a range above 0, or a scale that is logarithmic on both sides of 0");
}

/// Knots spread over the range of their values, with new ones between them where the scale bends.
///
/// value_at(v): the knot at a value of the linear map
template <class Knot, class ValueAt>
std::vector<Knot> spread(const std::vector<Knot>& knots, const ColorScale& scale, const ValueAt& value_at) {
    const double min = knots.front().value, max = knots.back().value;
    if (scale.linear() || !(min < max)) return knots;
    check_range(scale, min);
    std::vector<double> parts;
    for (const Knot& knot : knots) parts.push_back((knot.value - min) / (max - min));
    for (int i = 0; i <= kPieces; ++i) parts.push_back(static_cast<double>(i) / kPieces);
    std::ranges::sort(parts);
    std::vector<Knot> result;
    for (const double part : parts) {
        Knot knot = value_at(min + part * (max - min));
        knot.value = part <= 0 ? min : part >= 1 ? max : scale.at(part, min, max);
        if (result.empty() || result.back().value < knot.value) result.push_back(knot);
    }
    return result;
}

std::vector<TransferFunction::ColorKnot> in_bands(const TransferFunction& function, const ColorShape& shape) {
    const double min = function.color.front().value, max = function.color.back().value;
    std::vector<TransferFunction::ColorKnot> knots;
    for (int band = 0; band < shape.bands; ++band) {
        const double middle = shape.bands == 1 ? 0.5 : static_cast<double>(band) / (shape.bands - 1);
        const Vec3 color = color_at(function, shape.scale.at(middle, min, max));
        for (const int end : {band, band + 1})
            knots.push_back({shape.scale.at(static_cast<double>(end) / shape.bands, min, max), color});
    }
    return knots;
}

}  // namespace

double ColorScale::part(double value, double min, double max) const {
    if (logarithmic && !(min > 0)) return ColorScale{}.part(value, min, max);
    const double low = scaled(*this, min);
    return (scaled(*this, value) - low) / (scaled(*this, max) - low);
}

double ColorScale::at(double part, double min, double max) const {
    if (logarithmic && !(min > 0)) return ColorScale{}.at(part, min, max);
    const double low = scaled(*this, min), high = scaled(*this, max);
    return unscaled(*this, low + part * (high - low));
}

TransferFunction shaped(const TransferFunction& function, const ColorShape& shape) {
    validate(function);
    if (shape.bands < 0)
        throw Error(ErrorCode::InvalidInput, "the number of bands is negative", "transfer function", "1 or more");
    TransferFunction result;
    result.color = spread(function.color, shape.scale, [&](double value) {
        return TransferFunction::ColorKnot{value, color_at(function, value)};
    });
    result.opacity = spread(function.opacity, shape.scale, [&](double value) {
        return TransferFunction::OpacityKnot{value, alpha_at(function, value)};
    });
    if (shape.bands > 0 && result.color.front().value < result.color.back().value) result.color = in_bands(result, shape);
    if (shape.below) result.color.insert(result.color.begin(), {result.color.front().value, *shape.below});
    if (shape.above) result.color.push_back({result.color.back().value, *shape.above});
    part_equal_values(result.color);
    validate(result);
    return result;
}

}  // namespace subvol
