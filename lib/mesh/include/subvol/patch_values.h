// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "subvol/mesh_sets.h"
#include "subvol/names.h"

namespace subvol {

/// What lies beyond a patch, which decides where patches with different values meet.
///
/// Open:  something flows through it: inlets and outlets
/// Wall:  nothing flows through it
/// Plane: the body goes on: symmetry, a period, the third dimension of a flat case
enum class PatchRole : std::uint8_t { Open, Wall, Plane };

/// A field on faces of the boundary.
struct FieldOnPatches {
    std::string name;
    int channels = 1;
    std::vector<double> values;       ///< `channels` for each face; not a number: unknown
    std::vector<std::uint8_t> along;  ///< for each face: vectors have no component along its normal, and nothing else is known
    /// For each face: the field does not change across it. Empty: no face is known to be so
    std::vector<std::uint8_t> level = {};

    [[nodiscard]] bool is_level(std::size_t face) const { return face < level.size() && level[face] != 0; }
};

/// What a file of finite volumes says of fields on the faces of its patches.
struct ValuesOnPatches {
    struct Side {
        CellSide side;
        Index face = 0;
    };
    std::vector<Side> sides;       ///< the sides of the mesh's cells, each with the face that it is a part of
    std::vector<Index> patches;    ///< for each face, the number of its patch in the file
    std::vector<PatchRole> roles;  ///< for each face, the role of that patch
    std::vector<FieldOnPatches> fields;
};

/// What becomes of the values that a file has on patches of its boundary, where those at cells become values at points.
///
/// Meet:   points on the patches get them
/// Normal: the same, but vectors at points of walls get only the component along the normal, so that little flows through (at
///         concave edges), and a layer that is thinner than a cell leaves the cells' means
/// Ignore: points on the boundary have what cells say
enum class PatchValuesUse { Meet, Normal, Ignore };

template <>
struct NameTable<PatchValuesUse> {
    static constexpr Name<PatchValuesUse> rows[] = {
        {PatchValuesUse::Meet, "meet"}, {PatchValuesUse::Normal, "normal"}, {PatchValuesUse::Ignore, "ignore"}};
};

/// What `meet_patch_values` changed.
struct PatchValuesReport {
    std::size_t fields = 0;  ///< how many fields got values on patches
    std::size_t points = 0;  ///< how many points got a value, for the field with the most
    /// The largest change of a channel's integral over the volume (by an eighth of each cell's volume at its corners), as a
    /// part of the integral of its absolute value
    double most_of_mean = 0;
    std::string most_changed;  ///< field with this change
};

}  // namespace subvol
