// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gl_tets.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/optics.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// The data of a picture for the device, without the order.
///
/// clip:      how the volume is cut open
/// eye_value: whether the value at the eye is needed
/// throws:    Error(InvalidInput) if extinctions are beyond 32-bit floats
[[nodiscard]] GlTetFrame make_tet_frame(const TetMesh& mesh, const Box& box, const View& view, const Optics& optics,
                                        const RayClip& clip, bool eye_value);

}  // namespace subvol::detail
