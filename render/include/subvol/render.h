// SPDX-License-Identifier: Apache-2.0
#pragma once

/// All of subvol::render: splatters, projected tetrahedra, ray marchers.

#include "subvol/boundary_shading.h"
#include "subvol/draw_shells.h"
#include "subvol/flow_surface.h"
#include "subvol/gl_device.h"
#include "subvol/lines_in_volume.h"
#include "subvol/method.h"
#include "subvol/picture_maker.h"
#include "subvol/pixel_rows.h"
#include "subvol/progressive.h"
#include "subvol/render_brick_tets.h"
#include "subvol/render_bricks.h"
#include "subvol/render_dense.h"
#include "subvol/render_field.h"
#include "subvol/render_grid.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"
#include "subvol/shell_scene.h"
#include "subvol/splat.h"
#include "subvol/splat_options.h"
#include "subvol/splat_shares.h"
