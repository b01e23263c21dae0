// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "subvol/limit.h"

namespace subvol {

/// A scalar field at places of a volume.
struct FieldSamples {
    std::vector<Vec3> points;
    std::vector<double> values;
    std::vector<double> weights;  ///< the volume that each sample represents, ≥ 0 (world³)

    [[nodiscard]] std::size_t size() const { return points.size(); }
};

/// A field of the limit at every vertex of the level-`level` refinement: exact values, the boundary included.
///
/// field:  as in `scalar_field`
/// throws: Error(InvalidInput) as `refine` and `scalar_field`
[[nodiscard]] FieldSamples limit_samples_at_vertices(const HexMesh& mesh, std::string_view field, int level,
                                                     const LimitOptions& options = {});

/// The same field at `count` evenly spread places inside control cells: the same number in each cell, or one in each of `count`
/// cells where the mesh has more.
[[nodiscard]] FieldSamples limit_samples_in_cells(const HexMesh& mesh, std::string_view field, std::size_t count,
                                                  const LimitOptions& options = {});

}  // namespace subvol
