// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "subvol/view_state.h"

namespace subvol::detail {

/// The view of the part of a picture that is beside its legend: where places of the body are in the picture.
[[nodiscard]] View seen_view(const ViewState& state, const ViewBody& body);

}  // namespace subvol::detail
