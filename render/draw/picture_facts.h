// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "subvol/camera.h"
#include "subvol/facts.h"
#include "subvol/method.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"
#include "subvol/splat.h"
#include "subvol/surface.h"

namespace subvol::detail {

// What the reports of renderers say of a picture, under the keys that the command and Python have for it, with the warnings
// that follow.

/// method: the one that was asked for; the report has the backend
void add_facts(const SplatReport& splats, Method method, Facts& facts);
/// Of a picture without kernels: an opaque solid by the first hits of its rays.
void add_facts_of_first_hits(const Surface& boundary, Facts& facts);
void add_facts(const TetsReport& tets, Facts& facts);
void add_facts(const ProjectedReport& pt, ProjectedOrder order, Facts& facts);
/// chosen_level: whether the level was given; else it is warned if the picture still changes
void add_facts(const DenseReport& dense, bool chosen_level, Facts& facts);
void add_facts(const GridTraceReport& grid, Facts& facts);

/// "16 CPU threads": what draws where no GPU does.
[[nodiscard]] std::string cpu_threads();

/// Returns how many bodies in the picture are smaller than a pixel, so that a ray may miss them. Many that lie in neighbouring
/// pixels are no bodies but cells that share no points: they are seen together, and do not count.
///
/// boxes: of all bodies
[[nodiscard]] std::size_t count_tiny_bodies(std::span<const Box> boxes, const View& view);

}  // namespace subvol::detail
