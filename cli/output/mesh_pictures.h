// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "body_input.h"
#include "picture_notes.h"
#include "render_arguments.h"

namespace subvol::cli {

/// A mesh that is shown, in memory or in pieces, with the field of the opacities first and that of the colours last.
///
/// box: of the mesh; without cells, of its points
struct ShownBody {
    BodyInput body;
    ShownField field, colors;
    Box box{};
};

/// Reads the mesh with its shells and beams. A scheme of tetrahedra refines it, and leaves those out.
///
/// app:    of the command; options that bricks cannot have are refused
/// alone:  Take: of shells without cells the mesh has points alone
/// throws: Error(InvalidInput), also if a point is too far away to be drawn
[[nodiscard]] WithFacts<ShownBody> load_shown_body(const std::string& input, const CommonOptions& options,
                                                   const RenderArguments& arguments, const CLI::App& app, Progress* progress,
                                                   ShellsAlone alone = ShellsAlone::Refuse);

/// `make_notes` with the shells and beams on their limit.
[[nodiscard]] PictureNotes make_notes(const ShownBody& shown, const ShownColors& colors, RenderArguments& arguments,
                                      Progress* progress, Facts& facts);

}  // namespace subvol::cli
