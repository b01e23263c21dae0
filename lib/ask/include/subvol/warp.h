// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol {

/// A displacement of points: a vector field of the mesh, times a factor.
struct Warp {
    std::string field;
    /// Nothing: such that the longest displacement is a tenth of the diagonal of the mesh's box
    std::optional<double> factor = 1;
};

/// "DISPL", "DISPL*20" or "DISPL*auto".
///
/// throws: Error(InvalidInput) if the factor is not a finite number
[[nodiscard]] Warp parse_warp(const std::string& text);

/// The factor of a displacement whose longest one is then a tenth of the diagonal of the mesh's box; nothing if nothing moves.
///
/// throws: Error(InvalidInput) if the field is not a vector of three components
[[nodiscard]] std::optional<double> automatic_factor(const HexMesh& mesh, const std::string& field);

/// Moves the points by the displacement; the mesh's fields stay as they are.
///
/// returns: the factor
/// throws:  Error(InvalidInput) if the field is not a vector of three components, or a factor is asked for and nothing moves
double move_points(HexMesh& mesh, const Warp& warp);

/// The same for other points that have the same fields, such as those of shells. factor: that of the mesh
void move_points(std::vector<Vec3>& points, std::span<const Attribute> attributes, const Warp& warp, double factor);

}  // namespace subvol
