// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/index.h"
#include "subvol/vec.h"

namespace subvol {

namespace detail {
struct PlaceFunction;
}

/// What a file of finite volumes says of the gradient of a field on its boundary.
struct GradientsAtPoints {
    std::vector<Index> points;  ///< points of the mesh, ascending
    /// For each of these points the gradients of all channels, in the field's unit per world length
    std::vector<Vec3> gradients;
};

/// A named array at the points of a mesh.
struct Attribute {
    std::string name;
    int channels = 1;
    std::vector<double> values;  ///< `channels` numbers for each point: channel c of point p is values[p * channels + c]
    /// The least and the greatest value of each channel, as 0 and 1 of a fraction: where the limit of the values is evaluated
    /// it is kept within them, as interpolating schemes overshoot between points. Empty: none; infinite: no bound
    std::vector<std::array<double, 2>> bounds = {};
    /// For a quantity that is not linear, such as the length of a vector: at each place of the volume the field is this
    /// function of the limit of the arguments there, not the limit of its values. None: it is that limit
    std::shared_ptr<const detail::PlaceFunction> function = {};
    /// Arguments of the function, at each point. The values are those of the function at the points
    std::vector<double> arguments = {};
    /// For a field that the file has at cells: `channels` numbers for each cell, which `values` are made of. Files that are
    /// written have these. Empty: a field at points
    std::vector<double> cells = {};
    /// The field is `cells`, the same everywhere in a cell; `values` are means over the cells at each point. It has no function
    bool constant = false;
    GradientsAtPoints walls = {};  ///< what is known of the gradient on the boundary beside the limit
    bool derived = false;  ///< made of derivatives of a limit, which the cells as they were given have not at their points
    std::shared_ptr<const Attribute> potential = {};  ///< for the gradient of a scalar: the scalar
};

/// A hexahedral control mesh with attributes at its points.
struct HexMesh {
    std::vector<Vec3> points;
    /// 8 point ids in VTK corner order: 0-3 the bottom counter-clockwise, 4-7 above them; parameters u along 0→1, v along 0→3,
    /// w along 0→4
    std::vector<std::array<Index, 8>> cells;
    std::vector<Attribute> attributes;
    /// Boundary edges to be kept sharp, besides those that the default rule finds; two point ids each, smaller first
    std::vector<std::array<Index, 2>> creases;
    /// Interior faces that schemes treat as a boundary from both sides; four point ids each, in cyclic order
    std::vector<std::array<Index, 4>> sharp_faces;
    std::optional<double> time = {};  ///< time of the step that the mesh is, if it was read from a file of steps

    [[nodiscard]] const Attribute* find_attribute(std::string_view name) const;
};

/// The attribute of that name with one channel; without a name, the first with one channel.
///
/// throws: Error(InvalidInput) if there is no attribute of that name with one channel; lists those that exist
[[nodiscard]] const Attribute& scalar_field(const HexMesh& mesh, std::string_view name = {});

/// Checks the mesh for all later stages.
///
/// throws: Error(InvalidInput) if there is no cell, a corner is out of range or listed twice in a cell, a used point is not
///         finite, an attribute has the wrong length, or its value at a used point is not finite; names the cell or point
///         (counted from 0)
void validate(const HexMesh& mesh);

/// The mesh without the points that no cell uses; the others keep their order.
[[nodiscard]] HexMesh without_unused_points(HexMesh mesh);

/// Turns left-handed cells into right-handed ones by exchanging their bottom and top. Cells that share faces are of one hand if
/// they see these from two sides; which hand, their whole volume decides. So a cell through which a point was moved is folded,
/// but not turned.
///
/// returns: how many were turned
std::size_t orient_cells(HexMesh& mesh);

/// The signed volume of a trilinear cell, exact (2³ Gauss points). corners: 8 points in VTK order
[[nodiscard]] double cell_volume(const std::array<Vec3, 8>& corners);

/// The box of the points that cells use.
[[nodiscard]] Box bounds(const HexMesh& mesh);

/// The mesh with no attribute but this one. throws: as `scalar_field`
[[nodiscard]] HexMesh with_scalar_field(const HexMesh& mesh, std::string_view field);

}  // namespace subvol
