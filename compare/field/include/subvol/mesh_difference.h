// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/scheme.h"

namespace subvol {

struct MeshDifferenceOptions {
    SchemeOptions scheme{};  ///< of the reference's limit
    Progress* progress = nullptr;
};

/// The largest difference of a field at a point.
struct LargestDifference {
    std::string name;
    double max = 0;  ///< its amount, in the field's unit; of a vector or tensor the root of the sum of its channels' squares
    Index point = 0;
    Vec3 place{0.0};
};

struct MeshDifference {
    HexMesh mesh;  ///< the first mesh with the differences as its attributes, under the names of the fields
    /// Both meshes have the same cells and points: values at points, and at cells, were subtracted one by one
    bool same_points = false;
    std::size_t outside = 0;   ///< points outside the reference's limit: they have the value of its nearest place
    double outside_world = 0;  ///< how far the farthest of them lies outside
    std::vector<LargestDifference> fields;
};

/// The report as facts: same_points, outside, outside_distance, and a group of fields with max, at and point of each.
[[nodiscard]] Facts facts_of(const MeshDifference& difference);

/// The difference of each field that two meshes have, test − reference, at the points of the first mesh: its value there minus
/// that of the reference's limit at the place. Fields with another number of channels in the reference are left out.
///
/// throws: Error(InvalidInput) as `LimitProbe`, or if the meshes have no field in common; Error(Cancelled)
/// cost:   that of one subtraction if both have the same cells and points; else as `LimitProbe`
[[nodiscard]] MeshDifference mesh_difference(const HexMesh& test, const HexMesh& reference,
                                             const MeshDifferenceOptions& options = {});

}  // namespace subvol
