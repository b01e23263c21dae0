// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "subvol/legend.h"
#include "subvol/optics.h"
#include "subvol/picture_drawer.h"
#include "subvol/surface.h"

namespace subvol::detail {

/// The colour of text and lines on a background, in linear light.
[[nodiscard]] Vec3 ink_on(const Vec3& background);

/// The legend of a state, as `subvol render` has it.
[[nodiscard]] LegendOptions legend_of(const ViewState& state, const ViewBody& body);

/// The columns at the right of the picture that the legend takes; 0 without one.
[[nodiscard]] int legend_columns(const ViewState& state, const ViewBody& body, const Optics& optics);

/// Draws the edges in the depth of a body that is transparent or whose picture has no depths.
///
/// boundary:   of the body
/// draw_ended: its picture where rays end
void draw_edges_within(DrawnPicture& picture, const View& view, const ViewBody& body, const Surface& boundary,
                       const std::function<Image(const View&)>& draw_ended);

/// Marks the inverted cells of an edited mesh, unless the state says otherwise: their edges in red, also where the body hides
/// them.
void draw_inverted(DrawnPicture& picture, const View& view, const ViewBody& body);

/// Draws edges, marks, axes and the legend over a full picture, which the legend makes wider.
///
/// edges: those on an opaque body, by the depths of the picture
void draw_overlays(DrawnPicture& picture, const View& view, const ViewBody& body, const Optics& optics, bool edges);

}  // namespace subvol::detail
