// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "input.h"
#include "picture_notes.h"
#include "render_arguments.h"
#include "subvol/hex_mesh.h"
#include "subvol/shells.h"

namespace subvol::cli {

/// A mesh that is shown, with the field of the opacities first and that of the colours last.
struct ShownMesh {
    HexMesh mesh;
    Shells shells{};

    [[nodiscard]] ShownField field() const;
    [[nodiscard]] ShownField colors() const;
    /// The bounding box of the mesh; without cells, of its points.
    [[nodiscard]] Box box() const;
};

/// Reads the mesh with its shells and beams. A scheme of tetrahedra refines it, and leaves those out.
///
/// alone:  Take: of shells without cells the mesh has points alone
/// throws: Error(InvalidInput), also if a point is too far away to be drawn
[[nodiscard]] WithFacts<ShownMesh> load_shown_mesh(const std::string& input, const CommonOptions& options,
                                                   const RenderArguments& arguments, Progress* progress,
                                                   ShellsAlone alone = ShellsAlone::Refuse);

/// `make_notes` with the shells and beams on their limit.
[[nodiscard]] PictureNotes make_notes(const ShownMesh& shown, const ShownColors& colors, RenderArguments& arguments,
                                      Progress* progress, Facts& facts);

}  // namespace subvol::cli
