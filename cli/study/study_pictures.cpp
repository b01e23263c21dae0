// SPDX-License-Identifier: Apache-2.0
#include <limits>
#include <map>

#include "report.h"
#include "splat_arguments.h"
#include "study_input.h"
#include "study_metrics.h"
#include "study_work.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "subvol/placed_image.h"
#include "subvol/render_dense.h"
#include "subvol/render_grid.h"
#include "subvol/render_projected.h"
#include "subvol/render_tets.h"
#include "subvol/splat.h"
#include "subvol/visible_points.h"
#include "text.h"

namespace subvol::cli {
namespace {

namespace fs = std::filesystem;

/// What all methods draw.
struct Scene {
    const StudyCase& of;
    const HexMesh& mesh;
    const View& view;
    const Optics& optics;
    CaseResult& result;

    [[nodiscard]] int repeats() const { return std::max(of.whole("repeat"), 1); }
};

/// Draws as often as the case says; the last picture, and the least time of one.
template <class Draw>
Image repeated(const Scene& scene, const Draw& draw) {
    double least = std::numeric_limits<double>::infinity();
    Image image;
    for (int i = 0; i < scene.repeats(); ++i) {
        const detail::Stopwatch watch;
        image = draw();
        least = std::min(least, watch.seconds());
    }
    scene.result.costs["draw_seconds"] = least;
    return image;
}

Image splats(const Scene& scene) {
    const detail::Stopwatch watch;
    RbfVolume volume = sample_rbf_points(scene.mesh, study_sampling(scene.of, scene.mesh)).volume;
    scene.result.metrics["sampled"] = static_cast<double>(volume.size());
    if (scene.of.flag("visible_only")) volume = drop_invisible(volume, 0, scene.optics.function()).volume;
    scene.result.metrics["kernels"] = scene.result.metrics["primitives"] = static_cast<double>(volume.size());
    Splatter splatter(volume, {.method = splat_method(scene.of.text("method"), scene.of.text("backend")),
                               .sheets = scene.of.whole("sheets")});
    scene.result.costs["prepare_seconds"] = watch.seconds();
    return repeated(scene, [&] {
        SplatResult drawn = splatter.draw(scene.view, scene.optics);
        scene.result.notes["device"] = drawn.report.device;
        return std::move(drawn.image);
    });
}

HexMesh refined(const Scene& scene) {
    return refine(scene.mesh, {.levels = scene.of.whole("levels")});
}

Image tets(const Scene& scene) {
    const detail::Stopwatch watch;
    const HexMesh fine = refined(scene);
    const TetsRenderer renderer(fine);
    scene.result.costs["prepare_seconds"] = watch.seconds();
    return repeated(scene, [&] {
        TetsResult drawn = renderer.draw(scene.view, scene.optics, {.samples = scene.of.whole("samples")});
        scene.result.metrics["tets"] = scene.result.metrics["primitives"] = static_cast<double>(drawn.report.tets);
        scene.result.metrics["lost_rays"] = static_cast<double>(drawn.report.lost_rays);
        return std::move(drawn.image);
    });
}

Image projected_tets(const Scene& scene) {
    const detail::Stopwatch watch;
    const HexMesh fine = refined(scene);
    ProjectedRenderer renderer(fine);
    scene.result.costs["prepare_seconds"] = watch.seconds();
    return repeated(scene, [&] {
        ProjectedResult drawn =
            renderer.draw(scene.view, scene.optics, {.order = named<ProjectedOrder>(scene.of.text("order"), "order")});
        scene.result.metrics["tets"] = scene.result.metrics["primitives"] = static_cast<double>(drawn.report.tets);
        scene.result.notes["device"] = drawn.report.device;
        return std::move(drawn.image);
    });
}

Image dense(const Scene& scene) {
    const auto levels = scene.of.has("levels") ? std::optional(scene.of.whole("levels")) : std::nullopt;
    return repeated(scene, [&] {
        DenseResult drawn = render_dense(scene.mesh, {}, scene.view, scene.optics,
                                         {.levels = levels,
                                          .max_levels = scene.of.whole("max_levels"),
                                          .image_tolerance = scene.of.number("tolerance"),
                                          .samples = scene.of.whole("samples")});
        auto& metrics = scene.result.metrics;
        metrics["levels_drawn"] = drawn.report.levels;
        metrics["primitives"] = static_cast<double>(drawn.report.micro_cells);
        metrics["lost_rays"] = static_cast<double>(drawn.report.lost_rays);
        if (drawn.report.image_change) metrics["last_change"] = *drawn.report.image_change;
        if (!levels) metrics["converged"] = drawn.report.converged ? 1 : 0;
        return std::move(drawn.image);
    });
}

Image grid(const Scene& scene) {
    const detail::Stopwatch watch;
    const auto voxels = study_grid(scene.of, scene.mesh, scene.result).voxels();
    scene.result.metrics["primitives"] = scene.result.metrics["voxels"];
    scene.result.costs["prepare_seconds"] = watch.seconds();
    return repeated(
        scene, [&] { return render_grid(*voxels, scene.view, scene.optics, {.samples = scene.of.whole("samples")}).image; });
}

using Draw = Image (*)(const Scene&);

const std::map<std::string, Draw> kDraw{{"splat", splats},      {"sheets", splats}, {"footprints", splats}, {"tets", tets},
                                        {"pt", projected_tets}, {"dense", dense},   {"grid", grid}};

Image draw(const Scene& scene) {
    const auto found = kDraw.find(scene.of.text("method"));
    if (found != kDraw.end()) return found->second(scene);
    throw Error(ErrorCode::InvalidInput, "the method '" + scene.of.text("method") + "' draws no picture", "study");
}

/// Draws the picture and stores its costs and counts. own_bytes is the growth of the peak after the mesh was loaded.
Image measured(const StudyCase& of, const HexMesh& mesh, CaseResult& result) {
    const Optics optics = study_optics(of, mesh);
    const View view = study_view(of, mesh, optics);
    const auto before = static_cast<double>(peak_memory_bytes());
    const double cpu = cpu_seconds();
    const detail::Stopwatch watch;
    Image image = draw({of, mesh, view, optics, result});
    result.costs["seconds"] = watch.seconds();
    result.costs["cpu_seconds"] = cpu_seconds() - cpu;
    result.costs["peak_bytes"] = static_cast<double>(peak_memory_bytes());
    result.costs["own_bytes"] = result.costs["peak_bytes"] - before;
    result.metrics["points"] = static_cast<double>(mesh.points.size());
    result.metrics["cells"] = static_cast<double>(mesh.cells.size());
    return image;
}

}  // namespace

CaseResult run_picture_case(const StudyCase& of, const CasePlace& place) {
    CaseResult result;
    const HexMesh mesh = study_mesh(of);
    const Image image = measured(of, mesh, result);
    const auto reference_case = reference_of(of);
    // Of a reference that is a part of another picture only that part is left, whose size is refused below.
    const Image reference =
        common_pixels(whole_image(image), read_placed_image(place.references / (reference_case->id + ".exr"))).b;
    for (const auto& [name, value] : picture_metrics(image, reference, of.text("metrics"))) result.metrics[name] = value;

    if (const auto made =
            read_finished_case(place.references / (reference_case->id + ".json"), *reference_case, place.references)) {
        for (const auto& [own, its] : {std::pair{"reference_level", "levels_drawn"}, {"reference_change", "last_change"}}) {
            if (const auto found = made->metrics.find(its); found != made->metrics.end()) result.metrics[own] = found->second;
        }
    }

    const fs::path folder = place.folder / "pictures";
    fs::create_directories(folder);
    result.files["picture"] = "pictures/" + case_file(of, ".png");
    result.files["difference"] = "pictures/" + case_file(of, "_difference.png");
    write_image(place.folder / result.files["picture"], image);
    write_image(place.folder / result.files["difference"], difference_heatmap(image, reference));
    result.notes["reference"] = reference_case->id;
    return result;
}

CaseResult run_reference(const StudyCase& of, const CasePlace& place) {
    CaseResult result;
    const HexMesh mesh = study_mesh(of);
    const Image image = measured(of, mesh, result);
    fs::create_directories(place.references);
    result.files = {{"exr", of.id + ".exr"}, {"picture", of.id + ".png"}};
    for (const auto& [kind, name] : result.files) write_image(place.references / name, image);
    return result;
}

}  // namespace subvol::cli
