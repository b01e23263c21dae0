// SPDX-License-Identifier: Apache-2.0
#include "shell_scene.h"

#include <algorithm>
#include <limits>

#include "input.h"
#include "subvol/boundary_values.h"
#include "subvol/limit_shells.h"

namespace subvol::cli {
namespace {

constexpr double kTubeRadius = 0.004;        // of the diagonal
constexpr std::size_t kMostQuads = 200'000;  // that a level more may make

int levels_of(const Shells& shells, std::optional<int> most) {
    int levels = 1;
    for (std::size_t quads = 16 * shells.quads.size() + 8 * shells.lines.size(); levels < 4 && quads <= kMostQuads; quads *= 4)
        ++levels;
    return most ? std::min(levels, *most) : levels;
}

}  // namespace

void ShellScene::draw_into(Picture& picture, const View& view) const {
    draw_shells(picture.image, picture.depth, drawn, boundary, view, optics, {.samples = samples, .clip = clip});
}

Picture empty_picture(const View& view) {
    Picture picture{Image(view.width(), view.height()), {}};
    picture.depth.assign(picture.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    return picture;
}

std::shared_ptr<const ShellScene> make_shell_scene(const HexMesh& mesh, const Shells& shells, RefineOptions refine,
                                                   std::optional<int> levels, const Optics& optics, int samples,
                                                   const Clip& clip, Facts& facts) {
    if (shells.empty()) return nullptr;
    const Shells control = with_fields_of(shells, mesh);
    return facts.timed(refine.progress, "sheets", [&] {
        refine.levels = levels_of(control, levels);
        const Shells fine = limit_shells(mesh, control, refine);
        Box box = bounds(mesh);
        for (const Vec3& p : fine.points) box.add(p);
        ShellSurface drawn = shell_surface(fine, kTubeRadius * box.diagonal());
        ColoredSurface colored;
        const std::vector<double>& values = fine.attributes.back().values;
        for (const Index p : drawn.sources) colored.values.push_back(values[p]);
        colored.surface = std::move(drawn.surface);
        Surface boundary;
        if (!mesh.cells.empty()) {
            refine.levels = picture_levels(mesh, levels);
            boundary = boundary_values(mesh, refine).surface;
        }
        return std::make_shared<const ShellScene>(
            ShellScene{std::move(colored), std::move(boundary), control, optics, std::max(1, samples), clip});
    });
}

}  // namespace subvol::cli
