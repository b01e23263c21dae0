// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "subvol/clip.h"
#include "subvol/draw_shells.h"
#include "subvol/refine.h"
#include "subvol/shells.h"

namespace subvol {

/// The shells and beams of a picture on the limit, and the boundary of the volume that may hide them.
struct ShellScene {
    ColoredSurface drawn;
    Surface boundary;
    Shells control;  ///< the shells as they were read, for edges drawn over the picture
    Optics optics;
    int samples = 1;
    Clip clip{};
    bool whole = false, ended = false;  ///< as in ShellOptions

    /// Draws into a finished picture, as `subvol::draw_shells`.
    void draw_into(Image& image, std::span<float> depth, const View& view) const;
};

/// Puts shells and beams on the limit, at level 1 to 4 by their number.
///
/// mesh:   with the field that is shown and, last, the one of the colours; without cells the shells are alone
/// shells: with the fields of their file, or with the same
/// most:   no more levels than these, if given
/// opacities: of the shells' quads, whose points belong to one opacity each, as of `translucent_parts`; empty: they are opaque
/// throws: Error(InvalidInput) as `limit_shells` and `with_fields_of`
[[nodiscard]] ShellScene make_shell_scene(const HexMesh& mesh, const Shells& shells, RefineOptions refine,
                                          std::optional<int> most, const Optics& optics, int samples, const Clip& clip,
                                          std::span<const float> opacities = {});

/// The same of sides of cells, as of `patch_shells`, where they lie in the limit of the mesh that they are of.
///
/// whole: that mesh, with the fields of its file
/// throws: Error(InvalidInput) as `limit_sides` and `with_fields_of`
[[nodiscard]] ShellScene make_side_scene(const HexMesh& mesh, const HexMesh& whole, const Shells& sides, RefineOptions refine,
                                         std::optional<int> most, const Optics& optics, int samples, const Clip& clip,
                                         std::span<const float> opacities = {});

/// Opaque triangles in or about a volume, such as tubes along its streamlines, which the clip of the picture does not cut.
///
/// mesh: of the volume that may hide them, on the limit
[[nodiscard]] ShellScene make_opaque_scene(const HexMesh& mesh, ColoredSurface drawn, RefineOptions refine,
                                           std::optional<int> most, const Optics& optics, int samples, const Clip& clip);

/// The boundary of a volume on the limit, as its pictures have it; empty without cells.
///
/// most: no more levels than these, if given
[[nodiscard]] Surface boundary_of(const HexMesh& mesh, RefineOptions refine, std::optional<int> most);

/// The view with rays that end at the triangles of a scene, so that a volume is drawn up to these: each of the scene's samples.
[[nodiscard]] View ended_at(const ShellScene& scene, View view);

}  // namespace subvol
