// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "mesh_format.h"

namespace subvol::detail {

/// The files of solvers and of their meshers. The only thing that is known outside of this room, and only if it is built in.
[[nodiscard]] FormatFamily solver_formats();

}  // namespace subvol::detail
