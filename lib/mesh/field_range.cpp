// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_range.h"

#include <algorithm>
#include <cmath>

#include "subvol/error.h"

namespace subvol {

FieldRange range_of(const Attribute& field) {
    if (field.values.empty()) throw Error(ErrorCode::InvalidInput, "has no values", "field " + field.name);
    const auto channels = static_cast<std::size_t>(field.channels);
    FieldRange range;
    range.min.assign(field.values.begin(), field.values.begin() + field.channels);
    range.max = range.min;
    for (std::size_t i = channels; i < field.values.size(); ++i) {
        range.min[i % channels] = std::min(range.min[i % channels], field.values[i]);
        range.max[i % channels] = std::max(range.max[i % channels], field.values[i]);
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

void turn_y_up(HexMesh& mesh) {
    for (Vec3& p : mesh.points) p = {p.x, p.z, -p.y};
    for (Attribute& field : mesh.attributes) {
        if (field.channels != 3) continue;
        for (std::size_t i = 0; i + 2 < field.values.size(); i += 3) {
            const double y = field.values[i + 1];
            field.values[i + 1] = field.values[i + 2];
            field.values[i + 2] = -y;
        }
    }
}

void scale_points(HexMesh& mesh, double factor) {
    if (!std::isfinite(factor) || !(factor > 0))
        throw Error(ErrorCode::InvalidInput, "the factor is not a positive number", "scale");
    for (Vec3& p : mesh.points) p *= factor;
}

}  // namespace subvol
