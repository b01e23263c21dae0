// SPDX-License-Identifier: Apache-2.0
// Which control cell a cell of a level is in. `split_cells` writes the children of each kind at places that depend on the
// parents' numbers alone, so the control cells of a level are found by repeating their numbers in the same order, without
// looking at the cells.
#include "subvol/detail/mixed_shapes.h"

#include <array>
#include <numeric>
#include <string>

#include "subvol/detail/cell_splits.h"
#include "subvol/error.h"
#include "subvol/refine_mixed.h"

namespace subvol {

namespace detail {

HexesOfMixed hexahedra_of(const MixedMesh& mesh) {
    MixedCells others{mesh.tets, mesh.prisms, mesh.pyramids};
    for (const auto& octahedron : mesh.octahedra) cut_octahedron(mesh, octahedron, others.tets);
    HexSplit split = plan_split(mesh.points, mesh.hexes, others);
    HexesOfMixed result;
    result.mesh.points = means(split.sources, mesh.points);
    result.mesh.cells = std::move(split.cells);
    for (const Attribute& attribute : mesh.attributes) {
        result.mesh.attributes.push_back(
            {attribute.name, attribute.channels,
             means(split.sources, attribute.values, static_cast<std::size_t>(attribute.channels))});
    }
    // The split counts through hexahedra, tetrahedra (the octahedra's four each come last), prisms and pyramids.
    const std::size_t tets = mesh.tets.size(), octahedra = mesh.octahedra.size(), prisms = mesh.prisms.size();
    const std::size_t first_prism = tets + octahedra, first_hex = first_prism + prisms + mesh.pyramids.size();
    for (Index& parent : split.parents) {
        std::size_t cell = parent;
        if (cell < mesh.hexes.size()) {
            // Hexahedra come first in the split and last in the count of the mixed mesh.
            cell += first_hex;
        } else if (cell -= mesh.hexes.size(); cell >= tets + 4 * octahedra) {
            cell = cell - tets - 4 * octahedra + first_prism;
        } else if (cell >= tets) {
            cell = tets + (cell - tets) / 4;
        }
        parent = static_cast<Index>(cell);
    }
    result.cells = std::move(split.parents);
    return result;
}

}  // namespace detail

namespace {

/// Each cell's number `times` times.
void repeat(const std::vector<Index>& cells, std::size_t times, std::vector<Index>& into) {
    for (const Index cell : cells) into.insert(into.end(), times, cell);
}

}  // namespace

void detail::check_tet_levels(int levels) {
    if (levels >= 0 && levels <= kMostTetLevels) return;
    throw Error(ErrorCode::InvalidInput, "levels: " + std::to_string(levels), {}, "0 to " + std::to_string(kMostTetLevels));
}

std::vector<Index> control_cells(const MixedMesh& control, int levels) {
    detail::check_tet_levels(levels);
    struct Kinds {
        std::vector<Index> tets, octahedra, prisms, pyramids, hexes;
    };
    Kinds level;
    Index next = 0;
    const auto number = [&](std::vector<Index>& cells, std::size_t count) {
        cells.resize(count);
        std::iota(cells.begin(), cells.end(), next);
        next += static_cast<Index>(count);
    };
    number(level.tets, control.tets.size());
    number(level.octahedra, control.octahedra.size());
    number(level.prisms, control.prisms.size());
    number(level.pyramids, control.pyramids.size());
    number(level.hexes, control.hexes.size());
    // For example the tetrahedra of a level: four of each tetrahedron, then eight of each octahedron, then four of each
    // pyramid.
    for (int l = 0; l < levels; ++l) {  // in the order in which `split_cells` writes the children
        Kinds child;
        repeat(level.tets, 4, child.tets);
        repeat(level.octahedra, 8, child.tets);
        repeat(level.pyramids, 4, child.tets);
        repeat(level.tets, 1, child.octahedra);
        repeat(level.octahedra, 6, child.octahedra);
        repeat(level.prisms, 8, child.prisms);
        repeat(level.pyramids, 6, child.pyramids);
        repeat(level.hexes, 8, child.hexes);
        level = std::move(child);
    }
    std::vector<Index> cells = std::move(level.tets);
    for (const auto* kind : {&level.octahedra, &level.prisms, &level.pyramids, &level.hexes}) repeat(*kind, 1, cells);
    return cells;
}

}  // namespace subvol
