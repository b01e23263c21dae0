// SPDX-License-Identifier: Apache-2.0
// A file may lack a field that it names, or have it at some of its points alone, as solvers write results of a set of nodes.
// A mesh has values everywhere, so such a field is that of the cells that have it at all of their points.
#include "field_gaps.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "input.h"
#include "quantities.h"
#include "subvol/field_bounds.h"
#include "subvol/part_of_limit.h"
#include "subvol/warp.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr std::string_view kWhere = "where:";  // begins regions by a quantity

/// The quantities that a command is asked for.
std::vector<std::string> asked_quantities(const CommonOptions& options) {
    std::vector<std::string> asked = options.at_rest;
    if (options.field) asked.push_back(*options.field);
    if (options.density) asked.push_back(*options.density);
    for (const std::string& region : options.only) {
        if (region.starts_with(kWhere)) asked.push_back(region.substr(kWhere.size()));
    }
    if (options.warp) asked.push_back(of_option("--warp", [&] { return parse_warp(*options.warp); }).field);
    return asked;
}

bool is_in_name(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || static_cast<unsigned char>(c) >= 128;
}

/// Whether a quantity is of a field: its name stands there, alone, with a component (V.x, V_x), and not as a part of the name
/// of another field.
bool refers_to(std::string_view quantity, std::string_view field, const std::vector<FieldInfo>& fields) {
    if (quantity == field) return true;
    for (std::size_t at = quantity.find(field); at != std::string_view::npos; at = quantity.find(field, at + 1)) {
        if (at > 0 && (is_in_name(quantity[at - 1]) || quantity[at - 1] == '.')) continue;
        std::size_t end = at + field.size();
        if (end == quantity.size() || !is_in_name(quantity[end])) return true;
        if (quantity[end] != '_') continue;
        while (end < quantity.size() && is_in_name(quantity[end])) ++end;
        const std::string_view word = quantity.substr(at, end - at);
        if (std::ranges::find(fields, word, &FieldInfo::name) == fields.end()) return true;
    }
    return false;
}

bool is_asked_for(const std::vector<std::string>& quantities, const std::string& field, const ReadResult& read) {
    return std::ranges::any_of(quantities,
                               [&](const std::string& quantity) { return refers_to(quantity, field, read.fields); });
}

bool has_values(const Attribute& field, const HexMesh& mesh, std::size_t cell) {
    const auto channels = static_cast<std::size_t>(field.channels);
    const auto all_there = [&](const std::vector<double>& values, std::size_t tuple) {
        return std::none_of(&values[tuple * channels], &values[tuple * channels] + channels,
                            [](double value) { return std::isnan(value); });
    };
    if (!field.cells.empty()) return all_there(field.cells, cell);
    return std::ranges::all_of(mesh.cells[cell], [&](Index p) { return all_there(field.values, p); });
}

}  // namespace

void refuse_unread(const ReadResult& read, const std::string& input, const CommonOptions& options) {
    const std::vector<std::string> asked = asked_quantities(options);
    for (const UnreadField& field : read.unread) {
        const bool other = std::ranges::find(read.fields, field.name, &FieldInfo::name) != read.fields.end();
        if (other || !is_asked_for(asked, field.name, read)) continue;
        throw NoSuchField({ErrorCode::InvalidInput, field.why, text(input, ", field '", field.name, "'")});
    }
}

Facts take_incomplete(ReadResult& read, const std::string& input, const CommonOptions& options) {
    Facts facts;
    const std::vector<std::string> quantities = asked_quantities(options);
    std::vector<Attribute> asked;
    for (Attribute& field : read.incomplete) {
        if (is_asked_for(quantities, field.name, read)) asked.push_back(std::move(field));
    }
    if (asked.empty()) return facts;
    HexMesh& mesh = read.mesh;
    std::vector<std::uint8_t> kept(mesh.cells.size());
    std::vector<std::string> names;
    for (const Attribute& field : asked) names.push_back("'" + field.name + "'");
    for (std::size_t c = 0; c < kept.size(); ++c) {
        kept[c] = std::ranges::all_of(asked, [&](const Attribute& field) { return has_values(field, mesh, c); });
    }
    const auto cells = static_cast<std::size_t>(std::ranges::count(kept, 1));
    if (cells == 0)
        throw Error(ErrorCode::InvalidInput, "no cell has " + join(names) + " at all of its points", input,
                    "info shows where fields are missing, and the range of the values that are there");
    const std::size_t before = mesh.cells.size();
    if (!read.shells.empty()) {
        facts.warn("shells and beams are left out with " + join(names));
        read.shells = {};
    }
    for (Attribute& field : asked) {
        const auto info = std::ranges::find(read.fields, field.name, &FieldInfo::name);
        if (info != read.fields.end()) info->missing = 0;
        mesh.attributes.push_back(std::move(field));
    }
    mesh = only_cells(mesh, kept);
    if (const std::vector<std::string> fractions = bound_fractions(mesh); !fractions.empty())
        facts.warn(bounded_fractions_text(fractions));
    read.sets = sets_of_cells(std::move(read.sets), kept);
    read.cell_means.clear();
    read.cell_parts.clear();
    facts["cells_with_field"] = cells;
    facts.note(text(count_text(cells), " of ", counted(before, "cell"), cells == 1 ? " has " : " have ", join(names)));
    return facts;
}

}  // namespace subvol::cli
