// SPDX-License-Identifier: Apache-2.0
#include "subvol/shell_scene.h"

#include <algorithm>
#include <utility>

#include "subvol/boundary_values.h"
#include "subvol/limit_shells.h"
#include "subvol/limit_sides.h"
#include "subvol/quantity.h"

namespace subvol {
namespace {

constexpr double kTubeRadius = 0.004;        // of the diagonal
constexpr std::size_t kMostQuads = 200'000;  // that a level more may make

int levels_of(const Shells& shells, std::optional<int> most) {
    int levels = 1;
    for (std::size_t quads = 16 * shells.quads.size() + 8 * shells.lines.size(); levels < 4 && quads <= kMostQuads; quads *= 4)
        ++levels;
    return most ? std::min(levels, *most) : levels;
}

/// A mesh with the fields that another one has, which were selected from the same ones; without those that it does not know.
HexMesh with_fields_like(const HexMesh& mesh, const HexMesh& like) {
    HexMesh result = mesh;
    result.attributes.clear();
    for (const Attribute& wanted : like.attributes) {
        if (wanted.name == "patch" && mesh.find_attribute(wanted.name) == nullptr) continue;
        const bool made = wanted.name == "density" && mesh.find_attribute("density") == nullptr;
        result.attributes.push_back(made ? Attribute{wanted.name, 1, std::vector<double>(mesh.points.size(), 1.0)}
                                         : select_field(mesh, wanted.name).scalar);
        result.attributes.back().name = wanted.name;
    }
    return result;
}

/// What `make_shell_scene` makes of shells on the limit. control: the shells before; refine: as they were refined
ShellScene scene_of(const HexMesh& mesh, Shells control, const Shells& fine, const RefineOptions& refine,
                    std::optional<int> most, const Optics& optics, int samples, const Clip& clip,
                    std::span<const float> opacities) {
    Box box = bounds(mesh);
    for (const Vec3& p : fine.points) box.add(p);
    ShellSurface drawn = shell_surface(fine, kTubeRadius * box.diagonal());
    ColoredSurface colored;
    const std::vector<double>& values = fine.attributes.back().values;
    for (const Index p : drawn.sources) colored.values.push_back(values[p]);
    if (!opacities.empty()) {
        std::vector<float> of_point(fine.points.size(), 1.0F);
        for (std::size_t q = 0; q < fine.quads.size(); ++q) {
            const float opacity = opacities[q >> static_cast<unsigned>(2 * refine.levels)];  // each level makes four of one
            for (const Index p : fine.quads[q]) of_point[p] = opacity;
        }
        for (const Index p : drawn.sources) colored.opacities.push_back(of_point[p]);
    }
    colored.surface = std::move(drawn.surface);
    return {std::move(colored), boundary_of(mesh, refine, most), std::move(control), optics, std::max(1, samples), clip};
}

}  // namespace

Surface boundary_of(const HexMesh& mesh, RefineOptions refine, std::optional<int> most) {
    if (mesh.cells.empty()) return {};
    refine.levels = picture_levels(mesh, most);
    return boundary_values(mesh, refine).surface;
}

void ShellScene::draw_into(Image& image, std::span<float> depth, const View& view) const {
    draw_shells(image, depth, drawn, boundary, view, optics,
                {.shading = shading_for(optics.function()), .samples = samples, .clip = clip, .whole = whole, .ended = ended});
}

ShellScene make_shell_scene(const HexMesh& mesh, const Shells& shells, RefineOptions refine, std::optional<int> most,
                            const Optics& optics, int samples, const Clip& clip, std::span<const float> opacities) {
    Shells control = with_fields_of(shells, mesh);
    refine.levels = levels_of(control, most);
    const Shells fine = limit_shells(mesh, control, refine);
    return scene_of(mesh, std::move(control), fine, refine, most, optics, samples, clip, opacities);
}

ShellScene make_side_scene(const HexMesh& mesh, const HexMesh& whole, const Shells& sides, RefineOptions refine,
                           std::optional<int> most, const Optics& optics, int samples, const Clip& clip,
                           std::span<const float> opacities) {
    Shells control = with_fields_of(sides, mesh);
    refine.levels = levels_of(control, most);
    const Shells fine = limit_sides(with_fields_like(whole, mesh), control, refine);
    return scene_of(mesh, std::move(control), fine, refine, most, optics, samples, clip, opacities);
}

ShellScene make_opaque_scene(const HexMesh& mesh, ColoredSurface drawn, RefineOptions refine, std::optional<int> most,
                             const Optics& optics, int samples, const Clip& clip) {
    return {std::move(drawn), boundary_of(mesh, std::move(refine), most), {}, optics, std::max(1, samples), clip, true, true};
}

View ended_at(const ShellScene& scene, View view) {
    constexpr float kBeyond = 1 + 2e-4F;  // so that what touches an opaque boundary from inside does not open it
    View fine = view.resized(scene.samples * view.width(), scene.samples * view.height());
    std::vector<float> ends = depths_of(scene.drawn.surface, fine, scene.whole ? Clip{} : scene.clip);
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const auto width = static_cast<std::size_t>(fine.width());
        const double before = fine.ray_end(static_cast<double>(i % width) + 0.5, static_cast<double>(i / width) + 0.5);
        ends[i] = std::min(kBeyond * ends[i], static_cast<float>(before));
    }
    fine.end_rays(std::move(ends));
    return fine.resized(view.width(), view.height());
}

}  // namespace subvol
