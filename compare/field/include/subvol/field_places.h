// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <string_view>

#include "subvol/field_samples.h"
#include "subvol/names.h"
#include "subvol/refine.h"

namespace subvol {

/// Where in a mesh: anywhere; at interior edges that do not have four cells; at the boundary.
enum class PlaceKind { Anywhere, Extraordinary, Boundary };

template <>
struct NameTable<PlaceKind> {
    static constexpr Name<PlaceKind> rows[] = {
        {PlaceKind::Anywhere, "anywhere"}, {PlaceKind::Extraordinary, "extraordinary"}, {PlaceKind::Boundary, "boundary"}};
};

/// Random places in the cells of a mesh, and the limit of a field (`scalar_field`) there (to level 6); all have weight 1.
///
/// within:  for the last two kinds, how far from the edge or face a place may lie, in cells: (0,1]
/// returns: no places if the mesh has no such edge or face
/// throws:  Error(InvalidInput) as `evaluate_limit` and `scalar_field`
[[nodiscard]] FieldSamples random_places(const HexMesh& mesh, std::string_view field, PlaceKind kind, double within,
                                         std::size_t count, std::uint64_t seed, Scheme scheme = Scheme::Mcq);

/// The vertices that are new at level `level` + 1 of a refinement, with the scheme's values there; all have weight 1. These are
/// the places where [mnmq2007] measures (table 2). The given mesh is level 0.
///
/// most:   beyond about so many, those of some cells, evenly chosen in their order, stand for all; a vertex that several cells
///         share has the weight of its share
/// throws: Error(InvalidInput) as `refine` and `scalar_field`
[[nodiscard]] FieldSamples new_vertices(const HexMesh& mesh, std::string_view field, int level = 0, Scheme scheme = Scheme::Mcq,
                                        std::size_t most = std::numeric_limits<std::size_t>::max());

}  // namespace subvol
