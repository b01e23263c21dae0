#pragma once

#include <openvdb/Grid.h>

#include "subvol/vdb.h"

namespace subvol {

struct VdbGrid::Data {
    openvdb::FloatGrid::Ptr grid;
    GridReport report;
};

/// Wraps a grid and counts what its report says.
[[nodiscard]] VdbGrid make_vdb_grid(openvdb::FloatGrid::Ptr grid);

}  // namespace subvol
