// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cstdint>

#include "quantity_source.h"
#include "subvol/detail/small_letters.h"
#include "subvol/quantity.h"

namespace subvol {
namespace {

bool has_one_of(std::string_view name, std::span<const std::string_view> parts) {
    const std::string text = detail::small_letters(name);
    return std::ranges::any_of(parts, [&](std::string_view part) { return text.find(part) != std::string::npos; });
}

/// Whether a name ends in a word "Id", "ids" or "ID": GlobalNodeId and node_id do, Fluid and solid do not.
bool ends_in_id(std::string_view name) {
    for (const std::string_view end : {"Id", "Ids", "ID", "IDs"}) {
        if (name.ends_with(end)) return true;
    }
    const std::string text = detail::small_letters(name);
    return text == "id" || text == "ids" || text.ends_with("_id") || text.ends_with("_ids") || text.ends_with(" id") ||
           text.ends_with(":id");
}

constexpr std::array<std::string_view, 7> kMarks{"vtkoriginal", "iblank",     "ghost",  "pedigree",
                                                 "globalnode",  "globalelem", "normals"};

constexpr std::array<std::string_view, 29> kPhysical{
    "temp",    "pres",     "stress",    "mises",  "strain",    "eqps",   "energy",   "enthalpy",  "entropy",    "density",
    "rho",     "veloc",    "speed",     "mach",   "displ",     "force",  "heat",     "flux",      "saturation", "porosity",
    "permeab", "concentr", "vorticity", "damage", "potential", "charge", "moisture", "viscosity", "humidity"};

/// What solvers say about their own results.
constexpr std::array<std::string_view, 3> kEstimates{"error", "residual", "estimat"};

/// Whether an array of that name numbers or marks points or cells: `GlobalNodeId`, `vtkOriginalPointIds`, `IBlank`,
/// `vtkGhostType`. A name such as `Fluid` does not.
bool is_identifier(std::string_view name) {
    return ends_in_id(name) || has_one_of(name, kMarks);
}

bool is_constant(const Attribute& attribute) {
    const auto channels = static_cast<std::size_t>(attribute.channels);
    for (std::size_t i = channels; i < attribute.values.size(); ++i) {
        if (attribute.values[i] != attribute.values[i % channels]) return false;
    }
    return true;
}

/// How sensible it is to show an attribute that nobody asked for; 0: not at all.
int merit_of(const Attribute& attribute) {
    const bool scalar = attribute.channels == 1;
    if (is_identifier(attribute.name)) return 0;
    if (is_constant(attribute)) return scalar ? 2 : 1;
    if (has_one_of(attribute.name, kEstimates)) return 3;
    if (!scalar) return detail::is_stress(attribute) ? 5 : 4;
    return has_one_of(attribute.name, kPhysical) ? 7 : 6;
}

/// The scalar that stands for a vector or a tensor, and what a user is told about it.
SelectedField scalar_of(const HexMesh& mesh, const Attribute& attribute) {
    constexpr int kSymmetric = 6, kFull = 9;
    const std::string quoted = "\"" + attribute.name + "\"";
    if (detail::is_stress(attribute)) {
        const std::string name = "mises(" + detail::quoted_name(attribute.name) + ")";
        return {field_of(mesh, name, name), "field " + quoted + " is a stress tensor: its von Mises stress is taken"};
    }
    Attribute length = detail::length_of(attribute);
    if (attribute.channels == kSymmetric || attribute.channels == kFull) {
        return {std::move(length), "field " + quoted + " is a tensor: its norm is taken"};
    }
    return {std::move(length), "field " + quoted + " is a vector: its length is taken"};
}

SelectedField density(const HexMesh& mesh, std::string warning) {
    return {{"density", 1, std::vector<double>(mesh.points.size(), 1.0)}, std::move(warning)};
}

}  // namespace

bool detail::is_stress(const Attribute& attribute) {
    constexpr std::array<std::string_view, 2> parts{"stress", "sigma"};
    return attribute.channels == 6 && (has_one_of(attribute.name, parts) || attribute.name == "S");
}

SelectedField select_field(const HexMesh& mesh, const std::optional<std::string>& name, Progress* progress) {
    if (name) {
        Attribute found = field_of(mesh, *name, *name, progress);
        if (found.channels == 1) return {std::move(found), {}};
        if (detail::named_field(mesh, *name)) return scalar_of(mesh, found);
        return {detail::length_of(found), "\"" + *name + "\" is a vector or a tensor: its length is taken"};
    }
    const Attribute* best = nullptr;
    int best_merit = 0;
    for (const Attribute& attribute : mesh.attributes) {
        const int merit = merit_of(attribute);
        if (merit > best_merit) {
            best = &attribute;
            best_merit = merit;
        }
    }
    if (best != nullptr && best->channels == 1) return {*best, {}};
    if (best != nullptr) {
        SelectedField selected = scalar_of(mesh, *best);
        return {std::move(selected.scalar), "no scalar field: " + selected.warning};
    }
    if (mesh.attributes.empty()) return density(mesh, "no field: density 1 everywhere");
    return density(mesh, "the only fields are identifiers and flags (" + detail::list_of(mesh) + "): density 1 everywhere");
}

Shells with_fields_of(Shells shells, const HexMesh& mesh) {
    HexMesh points;
    points.points = shells.points;
    points.attributes = std::move(shells.attributes);
    shells.attributes.clear();
    for (const Attribute& wanted : mesh.attributes) {
        // Without a field the volume has density 1 everywhere, and so have they.
        const bool made = wanted.name == "density" && points.find_attribute("density") == nullptr;
        Attribute field = made ? Attribute{wanted.name, 1, std::vector<double>(points.points.size(), 1.0)}
                               : select_field(points, wanted.name).scalar;
        field.name = wanted.name;
        shells.attributes.push_back(std::move(field));
    }
    return shells;
}

}  // namespace subvol
