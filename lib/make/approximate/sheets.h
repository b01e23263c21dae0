// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "subvol/limit.h"
#include "subvol/mesh_sets.h"
#include "subvol/topology.h"

namespace subvol::detail {

// A sheet of a hexahedral mesh is the cells on the way from edge to opposite edge, from face to face:
//
//     •───•───•───•        •───•─•─•───•      Split, it becomes two sheets, and each of its cells two cells: the mesh stays
//     │   │ s │   │        │   │ │ │   │      one of hexahedra, and no new irregular edge comes about. Where two split
//     •───•───•───•   →    •───•─•─•───•      sheets cross, a cell becomes four, where three cross, eight.
//     │   │ s │   │        │   │ │ │   │
//     •───•───•───•        •───•─•─•───•

/// The edge on which an edge goes on beyond one of its ends: the single one there that shares no face with it; else kNone.
[[nodiscard]] Index edge_beyond(const Topology& topology, Index edge, Index end);

struct SplitMesh {
    HexMesh mesh;
    std::vector<PartOfCell> parts;  ///< for each cell of the mesh
};

/// A flag for each edge: whether its sheet is to be split, which is the same for all edges of a sheet.
///
/// A cell that asks for more points has the sheets split across the directions in which control values bend most, those at
/// least half as much as in the first. Bends are |a − b − c + d| over the range of a field's channel, with b and c at the ends
/// of an edge and a and d beyond them, which is 16 times what interpolation by cubics adds to the mean of b and c.
///
/// mesh:  with the fields; cells: a flag for each, whether it asks
[[nodiscard]] std::vector<std::uint8_t> edges_to_split(const HexMesh& mesh, const Topology& topology,
                                                       std::span<const std::uint8_t> cells);

/// Splits sheets. The points of the mesh keep their numbers; where the new ones lie, `graded_places` says.
///
/// mesh: its attributes are not used; topology: its own
[[nodiscard]] SplitMesh split_sheets(const HexMesh& mesh, const Topology& topology, std::span<const std::uint8_t> edges);

/// Where the points of a split mesh should lie in the mesh that was split, so that cells grow from split sheets to others step
/// by step: at a jump of sizes interpolation is of second order alone.
///
/// topology: of the split mesh
/// returns:  a place in a cell of the mesh that was split, for each point
[[nodiscard]] std::vector<LimitQuery> graded_places(const SplitMesh& split, const Topology& topology);

}  // namespace subvol::detail
