// SPDX-License-Identifier: Apache-2.0
#include "subvol/transfer_function.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "subvol/clamped.h"
#include "subvol/detail/knot_values.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

TransferFunction clamped(const TransferFunction& function, double min, double max) {
    validate(function);
    if (!std::isfinite(min) || !std::isfinite(max) || min > max)
        throw Error(ErrorCode::InvalidInput, "the range is not finite, or its ends are exchanged", "clamp");
    TransferFunction result;
    result.color.push_back({min, color_at(function, min)});
    result.opacity.push_back({min, alpha_at(function, min)});
    for (const auto& knot : function.color) {
        if (knot.value > min && knot.value < max) result.color.push_back(knot);
    }
    for (const auto& knot : function.opacity) {
        if (knot.value > min && knot.value < max) result.opacity.push_back(knot);
    }
    if (min < max) {
        result.color.push_back({max, color_at(function, max)});
        result.opacity.push_back({max, alpha_at(function, max)});
    }
    return result;
}

namespace {

[[noreturn]] void refuse(const char* list, std::size_t knot, const char* message, const char* allowed = "") {
    throw Error(ErrorCode::InvalidInput, message, std::string("transfer function, ") + list + " knot " + std::to_string(knot),
                allowed);
}

template <class Knot>
void check_values(const std::vector<Knot>& knots, const char* list) {
    if (knots.empty()) throw Error(ErrorCode::InvalidInput, std::string("has no ") + list + " knot", "transfer function");
    for (std::size_t i = 0; i < knots.size(); ++i) {
        if (!std::isfinite(knots[i].value)) refuse(list, i, "the value is not finite");
        if (i > 0 && !(knots[i - 1].value < knots[i].value)) refuse(list, i, "the values do not ascend");
    }
}

/// value_of: the value at a knot that is interpolated
template <class Knot, class ValueOf>
auto interpolate(const std::vector<Knot>& knots, double value, const ValueOf& value_of) {
    const auto next =
        std::upper_bound(knots.begin(), knots.end(), value, [](double v, const Knot& knot) { return v < knot.value; });
    if (next == knots.begin()) return value_of(knots.front());
    const auto last = std::prev(next);
    if (next == knots.end()) return value_of(*last);
    const double t = (value - last->value) / (next->value - last->value);
    return (1 - t) * value_of(*last) + t * value_of(*next);
}

bool in_unit(double x) {
    return x >= 0 && x <= 1;
}

}  // namespace

Vec3 color_at(const TransferFunction& function, double value) {
    return interpolate(function.color, value, [](const auto& knot) { return knot.rgb; });
}

double alpha_at(const TransferFunction& function, double value) {
    return interpolate(function.opacity, value, [](const auto& knot) { return knot.alpha; });
}

TransferFunction stretched(const TransferFunction& function, double min, double max) {
    validate(function);
    const KnotRange to = usable_range(min, max);
    const double first = function.color.front().value, width = function.color.back().value - first;
    TransferFunction result = function;
    if (!(width > 0)) return result;
    for (auto& knot : result.color) knot.value = to.at((knot.value - first) / width);
    for (auto& knot : result.opacity) knot.value = to.at((knot.value - first) / width);
    // In a range that is narrow compared with its distance from 0, neighbouring knots may have been rounded to one value.
    part_equal_values(result.color);
    part_equal_values(result.opacity);
    validate(result);
    return result;
}

void validate(const TransferFunction& function) {
    check_values(function.color, "colour");
    check_values(function.opacity, "opacity");
    for (std::size_t i = 0; i < function.color.size(); ++i) {
        const Vec3& rgb = function.color[i].rgb;
        if (!in_unit(rgb.x) || !in_unit(rgb.y) || !in_unit(rgb.z)) refuse("colour", i, "the colour is out of range", "[0,1]");
    }
    for (std::size_t i = 0; i < function.opacity.size(); ++i) {
        if (!in_unit(function.opacity[i].alpha)) refuse("opacity", i, "the opacity is out of range", "[0,1]");
    }
}

}  // namespace subvol
