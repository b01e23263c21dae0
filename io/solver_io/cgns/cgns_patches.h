// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <unordered_map>
#include <vector>

#include "cgns_tree.h"
#include "mesh_file.h"

namespace subvol::detail {

/// The triangles, quads and polygons of a zone by their numbers, as vertices from 1.
using CgnsFaces = std::unordered_map<std::int64_t, std::vector<std::int64_t>>;

/// Whether a zone has boundary conditions.
[[nodiscard]] bool has_boundary_conditions(const CgnsTree& tree, const std::string& zone);

/// Makes patches of the boundary conditions of a zone. Those of one family are one patch of its name; others have their own.
///
/// grid:     of a structured zone, else null
/// into:     has the points and cells of the zone
/// left_out: conditions that cannot be read, and those at cells
void read_boundary_conditions(const CgnsTree& tree, const std::string& zone, const StructuredGrid* grid, const CgnsFaces& faces,
                              MeshFile& into, LeftOut& left_out);

}  // namespace subvol::detail
