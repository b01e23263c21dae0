// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <string_view>

#include "subvol/camera.h"
#include "subvol/clip.h"
#include "subvol/hex_mesh.h"
#include "subvol/image.h"
#include "subvol/mixed_mesh.h"
#include "subvol/optics.h"
#include "subvol/pixel_rows.h"
#include "subvol/progress.h"

namespace subvol {

struct TetsOptions {
    int samples = 1;   ///< n × n rays for each pixel on a regular grid, 1..16
    Clip clip{};       ///< how the volume is cut open
    PixelRows rows{};  ///< the rows of the picture that are drawn; the others stay empty
    Progress* progress = nullptr;
};

struct TetsReport {
    std::size_t tets = 0;
    std::size_t degenerate_tets = 0;  // of zero volume: rays cross them, and nothing is integrated there
    std::size_t inverted_tets = 0;
    std::size_t rays = 0;       // that met the volume
    std::size_t segments = 0;   // tetrahedra crossed, over all rays
    std::size_t lost_rays = 0;  // that met the volume and could not be followed to its other side
    std::size_t bytes = 0;      // of points, tetrahedra and boundary, without Embree's tree
    double seconds_build = 0;   // of the renderer, the same for all its pictures
    double seconds_draw = 0;
};

struct TetsResult {
    Image image;
    TetsReport report;
};

/// The reference renderer: the mesh is split into tetrahedra, Embree finds where a ray enters, and from there the ray walks
/// from tetrahedron to tetrahedron through shared faces. The value is linear in each; each segment is integrated exactly.
///
/// Keeps the tetrahedra and Embree's tree from picture to picture; the mesh is not needed any more. Pictures are bitwise the
/// same for any number of threads.
/// source: docs/science.md
class TetsRenderer {
public:
    /// field:  the attribute that is shown, as in scalar_field
    /// throws: Error(InvalidInput) as validate(mesh) and scalar_field, or if the mesh has too many cells or points;
    ///         Error(MissingCapability) if Embree cannot be started or has not enough memory
    explicit TetsRenderer(const HexMesh& mesh, std::string_view field = {}, Progress* progress = nullptr);
    /// Tetrahedra as they are, with the value linear in each; all other cells are cut into tetrahedra (`in_tetrahedra`).
    explicit TetsRenderer(const MixedMesh& mesh, std::string_view field = {}, Progress* progress = nullptr);
    ~TetsRenderer();
    TetsRenderer(TetsRenderer&&) noexcept;
    TetsRenderer& operator=(TetsRenderer&&) noexcept;

    /// throws: Error(InvalidInput) if samples is out of range, or as `validate(clip)`
    [[nodiscard]] TetsResult draw(const View& view, const Optics& optics, const TetsOptions& options = {}) const;
    [[nodiscard]] double seconds_build() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// One picture of a TetsRenderer.
[[nodiscard]] TetsResult render_tets(const HexMesh& mesh, std::string_view field, const View& view, const Optics& optics,
                                     const TetsOptions& options = {});

}  // namespace subvol
