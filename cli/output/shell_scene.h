// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "picture_notes.h"
#include "subvol/clip.h"
#include "subvol/draw_shells.h"
#include "subvol/refine.h"
#include "subvol/shells.h"

namespace subvol::cli {

/// The shells and beams of a picture on the limit, and the boundary of the volume that may hide them.
///
/// control: as they were read, for --edges
struct ShellScene {
    ColoredSurface drawn;
    Surface boundary;
    Shells control;
    Optics optics;
    int samples = 1;
    Clip clip{};

    void draw_into(Picture& picture, const View& view) const;
};

/// The picture without cells, into which shells are drawn.
[[nodiscard]] Picture empty_picture(const View& view);

/// Puts shells and beams on the limit. Null if there are none.
///
/// mesh:   with the field that is shown and, last, the one of the colours
/// shells: with the fields of their file, or with the same
/// levels: no more than these, if given
[[nodiscard]] std::shared_ptr<const ShellScene> make_shell_scene(const HexMesh& mesh, const Shells& shells,
                                                                 RefineOptions refine, std::optional<int> levels,
                                                                 const Optics& optics, int samples, const Clip& clip,
                                                                 Facts& facts);

}  // namespace subvol::cli
