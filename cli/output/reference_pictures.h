// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "picture_output.h"
#include "reference_arguments.h"
#include "report.h"
#include "subvol/refine.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"
#include "subvol/vdb_grid.h"

namespace subvol::cli {

/// One picture by a reference method. Its counts and seconds go into the report; lost rays become a warning.
[[nodiscard]] Picture draw_tets(const TetsRenderer& renderer, const View& view, const Optics& optics,
                                const ReferenceArguments& arguments, Progress* progress, Report& report);

/// seconds: a time limit; none: the whole picture, whatever time it takes
[[nodiscard]] Picture draw_projected_tets(ProjectedRenderer& renderer, const View& view, const Optics& optics,
                                          const ReferenceArguments& arguments, std::optional<double> seconds,
                                          Progress* progress, Report& report);

/// levels: of the dense grids; none: raised until the picture changes by less than the tolerance
[[nodiscard]] Picture draw_dense(const HexMesh& mesh, const RefineOptions& refine, std::optional<int> levels, const View& view,
                                 const Optics& optics, const ReferenceArguments& arguments, Progress* progress, Report& report);

[[nodiscard]] Picture draw_grid(const Voxels& voxels, const View& view, const Optics& optics,
                                const ReferenceArguments& arguments, Progress* progress, Report& report);

}  // namespace subvol::cli
