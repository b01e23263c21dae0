// SPDX-License-Identifier: Apache-2.0
#include "grid_fields.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "numbers.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/place_function.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

/// The parts of a text between commas that are not in parentheses.
std::vector<std::string> parts_of(const std::string& text) {
    std::vector<std::string> parts(1);
    int depth = 0;
    for (const char c : text) {
        depth += c == '(' ? 1 : c == ')' ? -1 : 0;
        if (c == ',' && depth <= 0) {
            parts.emplace_back();
        } else {
            parts.back() += c;
        }
    }
    return parts;
}

/// The place of the sign that separates a name from its source, not of a comparison.
std::size_t equals_in(const std::string& text) {
    const std::size_t at = text.find('=');
    const bool comparison = at != std::string::npos && (text.substr(at + 1).starts_with('=') ||
                                                        (at > 0 && std::string("<>!").find(text[at - 1]) != std::string::npos));
    return comparison ? std::string::npos : at;
}

std::pair<double, double> pair_of(const std::string& text, const std::string& whole) {
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos)
        throw Error(ErrorCode::InvalidInput, "'" + whole + "' is not a range", "--remap", "LO,HI, LO,HI:A,B or GRID=LO,HI:A,B");
    return {parse_number("--remap", text.substr(0, comma)), parse_number("--remap", text.substr(comma + 1))};
}

}  // namespace

std::vector<std::string> names_of(const HexMesh& mesh) {
    std::vector<std::string> names;
    for (const Attribute& attribute : mesh.attributes) names.push_back(attribute.name);
    return names;
}

std::vector<GridField> parse_grid_fields(const std::vector<std::string>& texts) {
    std::vector<GridField> fields;
    for (const std::string& text : texts) {
        for (const std::string& part : parts_of(text)) {
            const std::size_t equals = equals_in(part);
            GridField field{part.substr(0, equals), equals == std::string::npos ? part : part.substr(equals + 1)};
            if (field.name.empty() || field.source.empty())
                throw Error(ErrorCode::InvalidInput, "'" + text + "' has an empty name or field", "--fields", "A,B=C");
            if (std::ranges::find(fields, field.name, &GridField::name) != fields.end())
                throw Error(ErrorCode::InvalidInput, "two grids are named '" + field.name + "'", "--fields", "different names");
            fields.push_back(std::move(field));
        }
    }
    return fields;
}

Remap parse_remap(const std::string& text) {
    Remap remap;
    const std::size_t equals = text.find('='), begin = equals == std::string::npos ? 0 : equals + 1;
    if (equals != std::string::npos) remap.grid = text.substr(0, equals);
    const std::size_t colon = text.find(':', begin);
    std::tie(remap.low, remap.high) = pair_of(text.substr(begin, colon - begin), text);
    if (colon != std::string::npos) std::tie(remap.to_low, remap.to_high) = pair_of(text.substr(colon + 1), text);
    if (remap.low == remap.high)
        throw Error(ErrorCode::InvalidInput, "'" + text + "' has no width", "--remap", "two different values LO,HI");
    return remap;
}

void apply(const Remap& remap, HexMesh& mesh) {
    auto field = mesh.attributes.begin();
    if (!remap.grid.empty()) field = std::ranges::find(mesh.attributes, remap.grid, &Attribute::name);
    if (field == mesh.attributes.end()) {
        const std::vector<std::string> names = names_of(mesh);
        throw Error(ErrorCode::InvalidInput, "no grid \"" + remap.grid + "\"" + detail::did_you_mean(remap.grid, names),
                    "--remap", "the grids are: " + join(names));
    }
    if (field->channels != 1)
        throw Error(ErrorCode::InvalidInput, "is a vector", "--remap " + field->name,
                    "its length or a component: --fields NAME=length(V)");
    const double factor = (remap.to_high - remap.to_low) / (remap.high - remap.low);
    detail::change_values(*field, [remap, factor](double value) { return remap.to_low + (value - remap.low) * factor; });
}

std::string beyond(const std::string& field, const Range& given, const Range& found) {
    constexpr double kRounding = 1e-5;  // of 32-bit floats in differences of large values
    const double slack = kRounding * std::max({given.max - given.min, std::abs(given.min), std::abs(given.max)});
    if (found.min >= given.min - slack && found.max <= given.max + slack) return {};
    return text(field, " ", given.min, "…", given.max, " becomes ", found.min, "…", found.max,
                ": the scheme overshoots between points (--clamp ends it)");
}

}  // namespace subvol::cli
