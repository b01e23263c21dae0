// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "picture_output.h"
#include "ranked_splats.h"
#include "reference_arguments.h"
#include "report.h"
#include "subvol/refine.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"
#include "subvol/surface.h"
#include "subvol/vdb_grid.h"

namespace subvol::cli {

/// Draws tetrahedra in some rows of a picture: those of a mesh in one piece or in bricks.
using DrawTets = std::function<TetsResult(const View&, const TetsOptions&)>;

/// One picture by a reference method. Its counts and seconds go into the report; lost rays become a warning.
///
/// rows: that this process draws; rank 0 gets those of all ranks
[[nodiscard]] Picture draw_tets(const DrawTets& draw_rows, const View& view, const ReferenceArguments& arguments,
                                const OwnRows& rows, Progress* progress, Report& report);

/// seconds: a time limit; none: the whole picture, whatever time it takes
[[nodiscard]] Picture draw_projected_tets(ProjectedRenderer& renderer, const View& view, const Optics& optics,
                                          const ReferenceArguments& arguments, std::optional<double> seconds,
                                          Progress* progress, Report& report);

/// levels: of the dense grids; none: raised until the picture changes by less than the tolerance
[[nodiscard]] Picture draw_dense(const HexMesh& mesh, const RefineOptions& refine, std::optional<int> levels, const View& view,
                                 const Optics& optics, const ReferenceArguments& arguments, Progress* progress, Report& report);

[[nodiscard]] Picture draw_grid(const Voxels& voxels, const View& view, const Optics& optics,
                                const ReferenceArguments& arguments, Progress* progress, Report& report);

/// The same pictures with light on the boundary; the reference methods have none.
///
/// boundary: empty: the pictures as they are
[[nodiscard]] DrawPicture lit(DrawPicture draw, Surface boundary, const ReferenceArguments& arguments);

/// Draws and writes a picture by `draw_tets` for each view.
///
/// boundary: of `lit`
void write_tets(const DrawTets& draw_rows, const Surface& boundary, const std::vector<View>& views,
                const ReferenceArguments& arguments, const OwnRows& rows, PictureOutput& output, Report& report);

/// Draws and writes a picture by `draw_projected_tets` for each view.
void write_projected_tets(ProjectedRenderer& renderer, const Surface& boundary, const std::vector<View>& views,
                          const Optics& optics, const ReferenceArguments& arguments, std::optional<double> seconds,
                          PictureOutput& output, Report& report);

}  // namespace subvol::cli
