// SPDX-License-Identifier: Apache-2.0
#include "field_names.h"

#include <algorithm>
#include <array>
#include <string>

namespace subvol::detail {

namespace {

// Not by tolower, which leaves the I in a Turkish locale.
std::string lower(std::string_view name) {
    std::string text(name);
    std::ranges::transform(text, text.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
    return text;
}

/// Whether a name ends in a word "Id", "ids" or "ID": GlobalNodeId and node_id do, Fluid and solid do not.
bool ends_in_id(std::string_view name) {
    for (const std::string_view end : {"Id", "Ids", "ID", "IDs"}) {
        if (name.ends_with(end)) return true;
    }
    const std::string text = lower(name);
    return text == "id" || text == "ids" || text.ends_with("_id") || text.ends_with("_ids") || text.ends_with(" id") ||
           text.ends_with(":id");
}

constexpr std::array<std::string_view, 7> kMarks{"vtkoriginal", "iblank",     "ghost",  "pedigree",
                                                 "globalnode",  "globalelem", "normals"};

constexpr std::array<std::string_view, 29> kQuantities{
    "temp",    "pres",     "stress",    "mises",  "strain",    "eqps",   "energy",   "enthalpy",  "entropy",    "density",
    "rho",     "veloc",    "speed",     "mach",   "displ",     "force",  "heat",     "flux",      "saturation", "porosity",
    "permeab", "concentr", "vorticity", "damage", "potential", "charge", "moisture", "viscosity", "humidity"};

}  // namespace

bool is_identifier(std::string_view name) {
    const std::string text = lower(name);
    return ends_in_id(name) ||
           std::ranges::any_of(kMarks, [&](std::string_view mark) { return text.find(mark) != std::string::npos; });
}

bool is_physical(std::string_view name) {
    const std::string text = lower(name);
    return std::ranges::any_of(kQuantities, [&](std::string_view part) { return text.find(part) != std::string::npos; });
}

}  // namespace subvol::detail
