// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mixed_split.h"
#include "point_kind.h"
#include "subvol/mixed_mesh.h"

namespace subvol::detail {

/// The boundary of a mixed mesh, as the rules need it.
///
/// faces:   oriented outward; the fourth corner of a triangle is kNone
/// creases: sharp edges, sorted; smaller end first
/// kinds:   of each point
struct MixedBoundary {
    std::vector<std::array<Index, 4>> faces;
    std::vector<std::array<Index, 2>> creases;
    std::vector<PointKind> kinds;
};

/// Creases are the boundary edges that mesh.creases names, that belong to one cell only, that have more than two boundary
/// faces, or that are bent by more than the angle. A point with two creases moves along them; one with another number of
/// creases, or where several sheets of the boundary meet, stays.
///
/// throws: Error(InvalidInput) if a face has more than two cells, or a crease of the mesh is not on the boundary
[[nodiscard]] MixedBoundary find_boundary(const MixedMesh& mesh, std::optional<double> crease_angle_deg);

/// The boundary of the next level.
[[nodiscard]] MixedBoundary split_boundary(const MixedBoundary& parent, const SplitNumbers& numbers);

}  // namespace subvol::detail
