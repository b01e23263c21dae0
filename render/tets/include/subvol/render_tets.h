// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "subvol/camera.h"
#include "subvol/hex_mesh.h"
#include "subvol/image.h"
#include "subvol/optics.h"
#include "subvol/progress.h"

namespace subvol {

/// samples: n × n rays a pixel on a regular grid, 1..16
struct TetsOptions {
    int samples = 1;
    Progress* progress = nullptr;
};

struct TetsReport {
    std::size_t tets = 0;
    std::size_t degenerate_tets = 0;  // of zero volume: crossed, never sampled
    std::size_t inverted_tets = 0;
    std::size_t rays = 0;       // that met the volume
    std::size_t segments = 0;   // tetrahedra crossed, over all rays
    std::size_t lost_rays = 0;  // that met the volume and could not be followed to its other side
    std::size_t bytes = 0;      // of points, tetrahedra and boundary, without Embree's tree
    double seconds_build = 0;   // of the renderer, the same in all its pictures
    double seconds_draw = 0;
};

struct TetsResult {
    Image image;
    TetsReport report;
};

/// The reference: rays through the mesh split into tetrahedra, Embree for the entry, then from cell to cell through shared
/// faces, each segment integrated exactly with the value linear in the tetrahedron.
///
/// Keeps the tetrahedra and Embree's tree from picture to picture; mesh and scalar need not stay. Pictures are bitwise the same
/// for any number of threads.
/// source: docs/science.md
class TetsRenderer {
public:
    /// scalar: one value a point of the mesh
    /// throws: Error(InvalidInput) if scalar.size() != mesh.points.size(), or a value at a used point is not finite
    TetsRenderer(const HexMesh& mesh, std::span<const double> scalar, Progress* progress = nullptr);
    ~TetsRenderer();
    TetsRenderer(TetsRenderer&&) noexcept;
    TetsRenderer& operator=(TetsRenderer&&) noexcept;

    /// throws: Error(InvalidInput) if samples is out of range
    [[nodiscard]] TetsResult draw(const View& view, const Optics& optics, const TetsOptions& options = {}) const;
    [[nodiscard]] double seconds_build() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// One picture of a TetsRenderer.
[[nodiscard]] TetsResult render_tets(const HexMesh& mesh, std::span<const double> scalar, const View& view,
                                     const Optics& optics, const TetsOptions& options = {});

}  // namespace subvol
