// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <openvdb/openvdb.h>

#include "subvol/vdb_grid.h"

namespace subvol {

/// floats: the same grid if it is one of floats
struct VdbGrid::Data {
    openvdb::GridBase::Ptr grid;
    openvdb::FloatGrid::Ptr floats;
    GridReport report;
};

namespace detail {

/// Wraps a grid and counts what its report says.
[[nodiscard]] VdbGrid make_vdb_grid(const openvdb::GridBase::Ptr& grid);

}  // namespace detail

}  // namespace subvol
