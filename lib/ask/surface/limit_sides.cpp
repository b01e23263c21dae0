// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_sides.h"

#include <algorithm>
#include <string>
#include <utility>

#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/place_function.h"
#include "subvol/error.h"
#include "subvol/limit_shells.h"

namespace subvol {

namespace {

/// The cells near some points. Any cell at a point stands for all of them, so there is a layer more.
detail::MeshSubset near(const HexMesh& whole, std::span<const CellCorner> points) {
    std::vector<std::uint8_t> cells(whole.cells.size(), 0);
    for (const CellCorner& point : points) {
        if (point.cell >= cells.size()) {
            throw Error(ErrorCode::InvalidInput, "a point is not of the mesh", "sides",
                        "sides of its cells, as of patch_shells");
        }
        cells[point.cell] = 1;
    }
    detail::grow(whole, cells, 1 + detail::kHaloOfLimit);
    return detail::subset(whole, cells);
}

}  // namespace

Shells limit_sides(const HexMesh& whole, const Shells& sides, const RefineOptions& options) {
    detail::MeshSubset part = near(whole, sides.solid);
    Shells control = sides;
    for (CellCorner& point : control.solid) {
        const auto at = std::ranges::lower_bound(part.cells, point.cell);
        point.cell = static_cast<Index>(at - part.cells.begin());
    }
    // Fields in the order of the sides; those that the mesh does not have are 0 until they are put back.
    std::vector<Attribute> fields;
    std::vector<std::uint8_t> of_sides;
    for (const Attribute& field : sides.attributes) {
        const Attribute* found = part.mesh.find_attribute(field.name);
        of_sides.push_back(found == nullptr);
        fields.push_back(found != nullptr ? *found
                                          : Attribute{field.name, field.channels,
                                                      std::vector<double>(part.mesh.points.size() *
                                                                          static_cast<std::size_t>(field.channels))});
    }
    part.mesh.attributes = fields;
    const HexMesh solid = detail::with_arguments(std::move(part.mesh));
    control.attributes.clear();
    for (const Attribute& field : solid.attributes) {
        Attribute& at_points = control.attributes.emplace_back(detail::without_values(field));
        for (const auto& [cell, corner] : control.solid) detail::add_point(field, solid.cells[cell][corner], at_points);
    }
    Shells fine = limit_shells(solid, control, options);
    HexMesh values;
    values.points = fine.points;
    values.attributes = std::move(fine.attributes);
    detail::restore_functions(values, fields);
    fine.attributes = std::move(values.attributes);
    for (std::size_t a = 0; a < fields.size(); ++a) {
        if (of_sides[a] == 0) continue;
        const auto channels = static_cast<std::size_t>(fields[a].channels);
        for (std::size_t q = 0; q < fine.quads.size(); ++q) {
            const Index from = sides.quads[q >> static_cast<unsigned>(2 * options.levels)][0];  // each level makes four of one
            for (const Index p : fine.quads[q])
                std::copy_n(&sides.attributes[a].values[from * channels], channels, &fine.attributes[a].values[p * channels]);
        }
    }
    return fine;
}

}  // namespace subvol
