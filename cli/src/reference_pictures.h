#pragma once

#include <optional>

#include "picture_output.h"
#include "reference_arguments.h"
#include "report.h"
#include "subvol/refine.h"
#include "subvol/render.h"
#include "subvol/vdb.h"

namespace subvol::cli {

/// One picture by a reference method; what it took goes into the report, lost rays become a warning.
[[nodiscard]] Picture draw_tets(const TetsRenderer& renderer, const View& view, const Optics& optics,
                                const ReferenceArguments& arguments, Progress* progress, Report& report);

/// mesh:   refined already; its first attribute is drawn
/// device: as `PtOptions::device`
[[nodiscard]] Picture draw_projected_tets(const HexMesh& mesh, const View& view, const Optics& optics,
                                          const ReferenceArguments& arguments, std::optional<int> device, Progress* progress,
                                          Report& report);

/// levels: of the dense grids; none: raised until the picture stays the same
[[nodiscard]] Picture draw_dense(const HexMesh& mesh, const RefineOptions& refine, std::optional<int> levels, const View& view,
                                 const Optics& optics, const ReferenceArguments& arguments, Progress* progress, Report& report);

[[nodiscard]] Picture draw_grid(const Voxels& voxels, const View& view, const Optics& optics,
                                const ReferenceArguments& arguments, Progress* progress, Report& report);

}  // namespace subvol::cli
