// SPDX-License-Identifier: Apache-2.0
#include "given_figures.h"

#include <algorithm>

namespace subvol::detail {

namespace {

void put(const PartMeasure& given, PartMeasure& part) {
    part.given_volume = given.volume;
    for (std::size_t f = 0; f < std::min(given.fields.size(), part.fields.size()); ++f) {
        const FieldMeasure& from = given.fields[f];
        if (given.volume != 0 && !from.derived) part.fields[f].given = {from.integral, from.mean, from.min, from.max};
    }
}

void move_to_own_place(const HexMesh& mesh, bool at_cells, LimitExtreme& extreme) {
    if (extreme.cell == kNone) return;
    const auto& cell = mesh.cells[extreme.cell];
    extreme.uvw = at_cells ? Vec3(0.5) : glm::round(extreme.uvw);
    extreme.place = Vec3(0.0);
    for (const Index p : cell) extreme.place += mesh.points[p] / 8.0;
    if (!at_cells) extreme.place = mesh.points[cell[extreme.corner().value()]];
}

}  // namespace

void move_to_own_places(const HexMesh& mesh, const Attribute& attribute, LimitExtreme& min, LimitExtreme& max) {
    if (attribute.function != nullptr) return;
    for (LimitExtreme* const extreme : {&min, &max}) move_to_own_place(mesh, attribute.constant, *extreme);
}

HexMesh as_given(HexMesh mesh) {
    for (Attribute& field : mesh.attributes) {
        if (field.cells.empty()) continue;
        field.constant = true;
        field.function = nullptr;
        field.arguments.clear();
    }
    return mesh;
}

std::optional<LimitMeasure> with_given_figures(
    const MeasureOptions& options,
    const std::function<std::optional<LimitMeasure>(const MeasureOptions& options, bool given)>& measured) {
    std::optional<LimitMeasure> limit = measured(options, false);
    if (!limit) return limit;
    MeasureOptions linear = options;
    linear.scheme = {.kind = Scheme::Linear};
    linear.bins = 1;
    const auto given = measured(linear, true);
    if (!given) return limit;
    put(given->whole, limit->whole);
    for (std::size_t k = 0; k < std::min(given->parts.size(), limit->parts.size()); ++k) put(given->parts[k], limit->parts[k]);
    return limit;
}

}  // namespace subvol::detail
