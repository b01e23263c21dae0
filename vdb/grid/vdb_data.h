// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "openvdb_grids.h"

#include "subvol/vdb_grid.h"

namespace subvol::detail {

/// What a VdbGrid holds. floats: the same grid if it is one of floats, else null
struct VdbData {
    openvdb::GridBase::Ptr grid;
    openvdb::FloatGrid::Ptr floats;
    GridReport report;

    [[nodiscard]] static const VdbData& of(const VdbGrid& grid) { return *grid.data_; }
    [[nodiscard]] static VdbGrid wrap(VdbData data);
};

/// Wraps a grid and fills its report.
[[nodiscard]] VdbGrid make_vdb_grid(const openvdb::GridBase::Ptr& grid);

}  // namespace subvol::detail
