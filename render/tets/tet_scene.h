// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "boundary_scene.h"
#include "pixel_rect.h"
#include "ray_walker.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"
#include "tet_mesh.h"

namespace subvol::detail {

/// Tetrahedra, and the boundary at which rays enter them.
class TetScene {
public:
    /// mesh:   a valid one, perhaps a part of a larger one
    /// values: one for each point
    /// box:    of the whole mesh
    /// throws: as build_tet_mesh and BoundaryScene
    TetScene(const HexMesh& mesh, std::span<const double> values, const Box& box, Progress* progress = nullptr);
    TetScene(TetMesh tets, const Box& box, Progress* progress = nullptr);
    TetScene(TetScene&&) = delete;

    [[nodiscard]] const TetMesh& tets() const { return tets_; }
    /// Of points, tetrahedra and boundary.
    [[nodiscard]] std::size_t bytes() const;

    /// Draws a part of a picture.
    TraceCounts draw(const View& view, const Optics& optics, int samples, const RayClip& clip, const PixelRect& part,
                     Progress* progress, Image& image) const;

private:
    TetMesh tets_;
    BoundaryScene boundary_;
};

}  // namespace subvol::detail
