// SPDX-License-Identifier: Apache-2.0
#pragma once

/// All of subvol::vdb: OpenVDB grids and files.

#include "subvol/grid_error.h"
#include "subvol/grid_surface.h"
#include "subvol/join_grids.h"
#include "subvol/nanovdb.h"
#include "subvol/rasterize.h"
#include "subvol/spread_vectors.h"
#include "subvol/vdb_contents.h"
#include "subvol/vdb_grid.h"
#include "subvol/vdb_points.h"
#include "subvol/vdb_sample.h"
