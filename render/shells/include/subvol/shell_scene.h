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
///
/// control: as they were read, for edges drawn over the picture
struct ShellScene {
    ColoredSurface drawn;
    Surface boundary;
    Shells control;
    Optics optics;
    int samples = 1;
    Clip clip{};

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

}  // namespace subvol
