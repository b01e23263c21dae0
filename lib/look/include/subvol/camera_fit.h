// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "subvol/camera.h"

namespace subvol {

/// The camera, moved until it sees all points with a margin of 5 %, with their outline in the middle of the picture; an
/// orthographic camera gets the height for that. Direction and field of view do not change. Closer than `fit_camera` of the
/// points' box, whose corners are often empty.
///
/// throws: Error(InvalidInput) if there are no points or the camera is not valid
[[nodiscard]] Camera fit_camera_to_points(const Camera& camera, std::span<const Vec3> points, double aspect = 1);

}  // namespace subvol
