// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "settled_cut.h"
#include "subvol/detail/surface_share.h"

namespace subvol::detail {

/// What is known of a surface in some of its cells.
///
/// improve, slack_world: as of `add_cut`
/// fields: at the points of all cuts, one after the other
struct SurfaceShare {
    bool improve = true;
    double slack_world = 0;
    std::vector<SettledCut> cuts{};
    std::vector<ProbedField> fields{};
};

[[nodiscard]] std::string bytes_of(const SurfaceShare& share);

/// A share of a surface that passes no cell.
[[nodiscard]] std::string empty_surface_share();

}  // namespace subvol::detail
