// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "input.h"
#include "picture_output.h"
#include "render_arguments.h"
#include "report.h"
#include "splat_pictures.h"
#include "subvol/bricks.h"
#include "subvol/hex_mesh.h"
#include "subvol/shells.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// A mesh that is shown, with the field of the opacities first and that of the colours last.
struct ShownMesh {
    HexMesh mesh;
    Shells sheets{};

    [[nodiscard]] ShownField field() const;
    [[nodiscard]] ShownField colors() const;
    /// Of the mesh; without cells, of its points.
    [[nodiscard]] Box box() const;
};

/// Reads the mesh with its shells and beams. A scheme of tetrahedra refines it, and leaves those out.
///
/// alone:  Take: of sheets without cells the mesh has points alone
/// throws: Error(InvalidInput), also if a point is too far away to be drawn
[[nodiscard]] ShownMesh load_shown_mesh(const std::string& input, const CommonOptions& options,
                                        const RenderArguments& arguments, Report& report,
                                        ShellsAlone alone = ShellsAlone::Refuse);

/// `make_notes` with the shells and beams on their limit.
[[nodiscard]] PictureNotes make_notes(const ShownMesh& shown, const ShownColors& colors, RenderArguments& arguments,
                                      Report& report);

/// Draws and writes a picture of the cells for each view, by the method of the arguments.
///
/// app: the verb's, whose options decide on the colours of the boundary
void write_mesh_pictures(const HexMesh& mesh, const std::vector<View>& views, const Optics& optics,
                         const RenderArguments& arguments, SplatWork work, const CLI::App& app, PictureOutput& output,
                         Report& report);

/// Draws and writes a picture of the tetrahedra of a mesh in bricks for each view.
///
/// hull: for a body that is lit
void write_brick_tets(const Bricks& bricks, const BrickFields& fields, std::optional<BrickHull> hull,
                      const std::vector<View>& views, const Optics& optics, const RenderArguments& arguments,
                      const OwnRows& rows, PictureOutput& output, Report& report);

}  // namespace subvol::cli
