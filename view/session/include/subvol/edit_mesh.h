// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "subvol/camera.h"
#include "subvol/hex_mesh.h"

namespace subvol {

/// How far control points take part in an edit: a number from 0 to 1 for each.
using Selection = std::vector<double>;

/// The points in a box.
[[nodiscard]] Selection select_box(const HexMesh& mesh, const Box& box);

/// The points in a ball, fully in the middle and less and less towards its rim: (1 − d²/r²)².
[[nodiscard]] Selection select_ball(const HexMesh& mesh, const Vec3& center, double radius_world);

/// The points that a picture has in a rectangle of pixels, whatever lies before them.
[[nodiscard]] Selection select_pixels(const HexMesh& mesh, const View& view, const Vec2& first, const Vec2& last);

/// The middle of the selected points, weighted. throws: Error(InvalidInput) if none is selected
[[nodiscard]] Vec3 middle_of(const HexMesh& mesh, const Selection& selection);

/// All of these move the selected points, each by its share of the whole motion.
void move_points(HexMesh& mesh, const Selection& selection, const Vec3& by);
void rotate_points(HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& axis, double angle_deg);
void scale_points_about(HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& factors);

/// Turns the points about an axis through `center`, from nothing at the lower end of the selection along the axis to the whole
/// angle at its upper end.
void twist_points(HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& axis, double angle_deg);

/// Bends the part of the selection along `axis`: its lower end stays, and its middle line becomes an arc of this angle towards
/// `toward`; what lies beside it turns along.
void bend_points(HexMesh& mesh, const Selection& selection, const Vec3& center, const Vec3& axis, const Vec3& toward,
                 double angle_deg);

/// Moves values towards `value` by the share `strength` of the way.
void paint_values(std::span<double> values, const Selection& selection, double value, double strength);

}  // namespace subvol
