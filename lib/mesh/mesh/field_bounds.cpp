// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_bounds.h"
#include "subvol/detail/error_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>

#include "subvol/detail/small_letters.h"
#include "subvol/field_range.h"

namespace subvol {
namespace {

constexpr std::array<double, 2> kUnbounded{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

/// The field as it was given.
const Attribute& given_of(const Attribute& field, std::span<const Attribute> at_cells) {
    const auto found = std::ranges::find(at_cells, field.name, &Attribute::name);
    return found != at_cells.end() && found->channels == field.channels ? *found : field;
}

bool is_finite(const std::array<double, 2>& bounds) {
    return std::isfinite(bounds[0]) && std::isfinite(bounds[1]);
}

bool names_fraction(std::string_view name) {
    constexpr std::array<std::string_view, 3> kParts{"fraction", "saturation", "porosity"};
    const std::string text = detail::small_letters(name);
    return text.starts_with("alpha.") || text == "vof" || text.ends_with("_vof") || text.starts_with("vof_") ||
           std::ranges::any_of(kParts, [&](std::string_view part) { return text.find(part) != std::string::npos; });
}

}  // namespace

void bound_as_given(HexMesh& mesh, std::span<const Attribute> at_cells) {
    for (Attribute& field : mesh.attributes) {
        const Attribute& given = given_of(field, at_cells);
        if (given.values.empty()) continue;
        const FieldRange range = range_of(given);
        field.bounds.resize(static_cast<std::size_t>(field.channels), kUnbounded);
        for (std::size_t c = 0; c < field.bounds.size(); ++c) {
            auto& [low, high] = field.bounds[c];
            if (is_finite(field.bounds[c])) continue;
            low = std::max(low, range.min[c]);
            high = std::min(high, range.max[c]);
        }
    }
}

std::vector<std::string> bound_fractions(HexMesh& mesh, std::span<const Attribute> at_cells) {
    constexpr double kSlack = 1e-6;  // of solvers
    std::vector<std::string> bounded;
    for (Attribute& field : mesh.attributes) {
        const Attribute& given = given_of(field, at_cells);
        if (field.channels != 1 || given.values.empty() || !names_fraction(field.name)) continue;
        const auto [least, greatest] = std::ranges::minmax(given.values);
        if (!(least >= -kSlack && greatest <= 1 + kSlack)) continue;
        const std::array<double, 2> before = field.bounds.empty() ? kUnbounded : field.bounds[0];
        field.bounds = {{std::max(before[0], 0.0), std::min(before[1], 1.0)}};
        if (!is_finite(before)) bounded.push_back(field.name);
    }
    return bounded;
}

std::string bounded_fractions_text(std::span<const std::string> names) {
    return detail::listed(names) + (names.size() == 1 ? " is a fraction: it stays" : " are fractions: they stay") +
           " within 0 and 1 between the points, too";
}

}  // namespace subvol
