// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"
#include "subvol/refine.h"

namespace subvol {

struct DenseOptions {
    RefineOptions refine{};  ///< scheme, tension and creases; its levels and progress are not used
    /// 0 to 8; none: the lowest level, up to max_levels, whose boundary lies within a quarter of a pixel of the limit's and
    /// whose colours within 1/256, both in the mean over the picture (RMS), as the nodes of level 1 tell.
    std::optional<int> levels{};
    int max_levels = 6;
    /// Without levels: one level after the other is drawn, until the RMS by which the RGB of all pixels changes is less; the
    /// last level is as costly as all others together.
    std::optional<double> image_tolerance{};
    /// Bytes that grids may take at once: if they need more, parts of the picture are drawn one after the other, and the cells
    /// of each part are refined anew. A part of 16 × 16 pixels takes what it needs.
    std::size_t memory = std::size_t{2} << 30;
    int samples = 1;  ///< n × n rays for each pixel on a regular grid, 1..16
    Clip clip{};      ///< how the volume is cut open
    Progress* progress = nullptr;
};

struct DenseReport {
    int levels = 0;
    /// How far the boundary, or the lines where colours jump if that is more, lie from those of the limit (RMS, estimated), if
    /// the level was chosen by it; `error_color` is the same for colours and opacities elsewhere.
    std::optional<double> error_px{}, error_color{};
    /// RMS by which the picture changed at the last level; none if only one level was drawn.
    std::optional<double> image_change{};
    bool converged = false;          ///< whether the two errors were below their tolerance, or image_change was
    std::size_t blocks = 0;          ///< control cells in the picture whose values are visible, and not hidden by others
    std::size_t skipped_blocks = 0;  ///< the other control cells
    std::size_t micro_cells = 0;     ///< the cells at this level of all control cells that were looked at
    std::size_t passes = 0;
    std::size_t rays = 0;  ///< rays that met a visible block
    std::size_t segments = 0;
    std::size_t lost_rays = 0;
    std::size_t bytes = 0;                       ///< the most that grids took at once
    double seconds_build = 0, seconds_draw = 0;  ///< over all levels
};

struct DenseResult {
    Image image;
    DenseReport report;
};

/// The picture of the limit volume by rays through dense grids. Each control cell becomes the scheme's level-L grid with its
/// vertices on the limit, and each micro-cell is split into tetrahedra that match those of its neighbours on any mesh. Each
/// segment is integrated exactly. Cells whose values are invisible are skipped, and cells inside an opaque volume that no ray
/// comes to. Bitwise the same for any number of threads and any `memory`.
///
/// field:  the attribute of the control mesh that is shown, as in scalar_field
/// throws: Error(InvalidInput) if an option is out of range, and as scalar_field and `refine`
/// cost:   memory: 42 bytes (level 5) to 63 (level 2) for each vertex of the grids that are kept; each pass refines its cells
///         once
/// source: docs/adr/0012
[[nodiscard]] DenseResult render_dense(const HexMesh& mesh, std::string_view field, const View& view, const Optics& optics,
                                       const DenseOptions& options = {});

}  // namespace subvol
