// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "subvol/detail/cut_handle.h"
#include "subvol/view_state.h"

namespace subvol::detail {

/// The handles of all planes that the camera sees.
[[nodiscard]] std::vector<CutHandle> cut_handles(const ViewState& state, const ViewBody& body);

}  // namespace subvol::detail
