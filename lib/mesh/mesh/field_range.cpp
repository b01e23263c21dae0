// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_range.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/number_text.h"
#include "subvol/detail/place_function.h"
#include "subvol/error.h"

namespace subvol {

FieldRange range_of(const Attribute& field) {
    const std::vector<double>& values = own_values(field);
    if (values.empty()) throw Error(ErrorCode::InvalidInput, "has no values", "field " + field.name);
    const auto channels = static_cast<std::size_t>(field.channels);
    FieldRange range;
    range.min.assign(values.begin(), values.begin() + field.channels);
    range.max = range.min;
    for (std::size_t i = channels; i < values.size(); ++i) {
        range.min[i % channels] = std::min(range.min[i % channels], values[i]);
        range.max[i % channels] = std::max(range.max[i % channels], values[i]);
    }
    return range;
}

std::size_t clamp_to(Attribute& field, const FieldRange& range) {
    const auto channels = static_cast<std::size_t>(field.channels);
    if (range.min.size() != channels || range.max.size() != channels)
        throw Error(ErrorCode::InvalidInput, "has another number of components than the range", "field " + field.name);
    std::size_t moved = 0;
    for (std::size_t i = 0; i < field.values.size(); ++i) {
        const double value = std::min(std::max(field.values[i], range.min[i % channels]), range.max[i % channels]);
        if (value != field.values[i]) ++moved;
        field.values[i] = value;
    }
    return moved;
}

std::optional<FieldRange> bounds_of(const Attribute& field) {
    if (field.bounds.empty()) return {};
    FieldRange range;
    for (const auto& [low, high] : field.bounds) {
        range.min.push_back(low);
        range.max.push_back(high);
    }
    return range;
}

double value_origin(double min, double max) {
    constexpr double kLarge = 16;
    return max - min < std::max(std::abs(min), std::abs(max)) / kLarge ? min + (max - min) / 2 : 0;
}

double float_rounding(const Attribute& field, bool half) {
    if (own_values(field).empty()) return 0;
    const auto [min, max] = std::ranges::minmax(own_values(field));
    const double ulp = half ? 0x1p-12 : 0x1p-25;  // half a unit of the last digit
    return max > min ? std::max(std::abs(min), std::abs(max)) / (max - min) * ulp : 0;
}

std::string rounding_warning(const Attribute& field, bool half) {
    constexpr double kMuch = 1e-3;
    const double rounding = float_rounding(field, half);
    if (!(rounding > kMuch)) return {};
    const auto [min, max] = std::ranges::minmax(own_values(field));
    const std::string relative = field.name + "-(" + detail::number_text(min + (max - min) / 2) + ")";
    return std::string(half ? "16" : "32") + "-bit floats round \"" + field.name + "\" by up to " +
           detail::number_text(100 * rounding, 2) + " % of its range; they keep the digits of the expression " + relative;
}

void turn_y_up(HexMesh& mesh) {
    for (Vec3& p : mesh.points) p = {p.x, p.z, -p.y};
    for (Attribute& field : mesh.attributes) {
        if (field.channels != 3) continue;
        detail::change_places(field, [](std::span<double> values) {
            for (std::size_t i = 0; i + 2 < values.size(); i += 3) {
                const double y = values[i + 1];
                values[i + 1] = values[i + 2];
                values[i + 2] = -y;
            }
        });
        if (field.bounds.size() == 3)
            field.bounds = {field.bounds[0], field.bounds[2], {-field.bounds[1][1], -field.bounds[1][0]}};
    }
}

void scale_points(HexMesh& mesh, double factor) {
    if (!std::isfinite(factor) || !(factor > 0))
        throw Error(ErrorCode::InvalidInput, "the factor is not a positive number", "scale");
    for (Vec3& p : mesh.points) p *= factor;
}

}  // namespace subvol
