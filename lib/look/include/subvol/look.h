// SPDX-License-Identifier: Apache-2.0
#pragma once

/// What pictures have in common, whatever draws them.
///
/// - `Camera`, `View`: where the eye is, and the rays of a picture of some size.
/// - `TransferFunction`: colour and opacity of a value; JSON, ParaView's files.
/// - `Optics`: absorption and light along a ray; tables of segments.
/// - `Clip`: planes and boxes that cut away.
/// - `LookChoices`: what a user asks of a picture, from which the rest is made.
///
/// Rooms: `color` (the presets are a table in `transfer_function_presets.cpp`), `light` (cameras, light along rays, shading),
/// `overlay` (legends, scales, lines and letters on finished pictures).
///
///     value ── TransferFunction ──► colour, opacity ── Optics, along the rays of a View ──► pixel
///     finished picture ── draw_legend, draw_axes, draw_text ──► picture with what explains it

#include "subvol/camera.h"
#include "subvol/camera_fit.h"
#include "subvol/clamped.h"
#include "subvol/clip.h"
#include "subvol/color_map_file.h"
#include "subvol/color_name.h"
#include "subvol/color_scale.h"
#include "subvol/legend.h"
#include "subvol/optics.h"
#include "subvol/overlay.h"
#include "subvol/picture_look.h"
#include "subvol/shading.h"
#include "subvol/srgb.h"
#include "subvol/transfer_function.h"
#include "subvol/view_options.h"
