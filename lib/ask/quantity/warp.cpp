// SPDX-License-Identifier: Apache-2.0
#include "subvol/warp.h"

#include <algorithm>
#include <cmath>

#include "quantity_source.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/quantity.h"

namespace subvol {
namespace {

void add(std::vector<Vec3>& points, const Attribute& displacement, double factor) {
    const double* d = displacement.values.data();
    for (Vec3& point : points) {
        point += factor * Vec3(d[0], d[1], d[2]);
        d += 3;
    }
}

std::optional<double> automatic_factor(const HexMesh& mesh, const Attribute& displacement) {
    constexpr double kPart = 0.1;
    const std::vector<double> lengths = detail::length_of(displacement).values;
    const double longest = lengths.empty() ? 0 : *std::ranges::max_element(lengths);
    return longest > 0 ? std::optional(kPart * bounds(mesh).diagonal() / longest) : std::nullopt;
}

Attribute displacement_of(const HexMesh& mesh, const std::string& field) {
    Attribute displacement = field_of(mesh, field, field);
    if (displacement.channels == 3) return displacement;
    throw Error(ErrorCode::InvalidInput,
                "\"" + field + "\" has " + std::to_string(displacement.channels) + " components, a displacement has 3", {},
                "a vector field: " + detail::list_of(mesh));
}

}  // namespace

Warp parse_warp(const std::string& text) {
    // Behind the last parenthesis: vector(2*a,b,c) has no factor.
    const std::size_t star = text.rfind('*'), parenthesis = text.rfind(')');
    if (star == std::string::npos || (parenthesis != std::string::npos && star < parenthesis)) return {text};
    const std::string field = text.substr(0, star), factor = text.substr(star + 1);
    if (factor == "auto") return {field, std::nullopt};
    const std::optional<double> number = detail::plain_number(factor);
    if (number && std::isfinite(*number)) return {field, *number};
    throw Error(ErrorCode::InvalidInput, "'" + factor + "' is not a factor", {}, "FIELD, FIELD*20 or FIELD*auto");
}

std::optional<double> automatic_factor(const HexMesh& mesh, const std::string& field) {
    return automatic_factor(mesh, displacement_of(mesh, field));
}

double move_points(HexMesh& mesh, const Warp& warp) {
    const Attribute displacement = displacement_of(mesh, warp.field);
    const std::optional<double> factor = warp.factor ? warp.factor : automatic_factor(mesh, displacement);
    if (!factor) {
        throw Error(ErrorCode::InvalidInput, "\"" + displacement.name + "\" is 0 everywhere, so there is no factor to find",
                    displacement.name + "*auto", displacement.name + "*1");
    }
    add(mesh.points, displacement, *factor);
    return *factor;
}

void move_points(std::vector<Vec3>& points, std::span<const Attribute> attributes, const Warp& warp, double factor) {
    HexMesh alone;
    alone.points = points;
    alone.attributes.assign(attributes.begin(), attributes.end());
    add(points, displacement_of(alone, warp.field), factor);
}

}  // namespace subvol
