// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gl_tets.h"
#include "subvol/optics.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// What of a picture is the device's, without the order.
///
/// eye_value: whether it is needed
/// throws:    Error(InvalidInput) if extinctions are beyond 32-bit floats
[[nodiscard]] GlTetFrame make_tet_frame(const TetMesh& mesh, const Box& box, const View& view, const Optics& optics,
                                        bool eye_value);

}  // namespace subvol::detail
