// SPDX-License-Identifier: Apache-2.0
// Cases of studies that draw pictures, and the references that these are compared with. A case draws its scene by its method:
// as often as the case says, of which the least time counts. The picture may also be that of the closed form of a model, or a
// file that another program made with the same camera. It is compared with the reference by the case's metrics and written
// beside maps of the difference and of its sign. If the reference is drawn by the same method, no finer than the case, nothing
// is compared.
//
// A reference is refined until its picture changes by less than the tolerance. The picture of the step before tells how well
// each metric is known: its value between the two is the metric's floor, because the error of the finer one is less than its
// change as long as each step makes it smaller by half or more. Cases take the floors over from their reference.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "report.h"
#include "study_input.h"
#include "study_work.h"
#include "subvol/detail/atomic_file.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/image.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "subvol/model.h"
#include "subvol/option.h"
#include "subvol/picture_maker.h"
#include "subvol/picture_metrics.h"
#include "subvol/placed_image.h"
#include "subvol/render_field.h"
#include "subvol/view_options.h"
#include "text.h"

namespace subvol::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kExactStep = 1e-3;  // of the diagonal

/// The options of a case as those of pictures: a volume without light.
MethodOptions picture_options(const StudyCase& item, const HexMesh& mesh) {
    const Method method = named<Method>(item.text("method"), "study");
    PictureSettings settings;
    set_options(item, options_of(settings, method));
    MethodOptions options = settings.chosen();
    options.style.method = method;
    if (draws_kernels(method)) {
        options.kernels.sample = study_sampling(item, mesh, options.kernels.sample);
        options.drop_invisible = item.flag("visible_only");
    }
    if (method == Method::Dense && !item.has("levels")) {
        options.max_levels = item.whole("max_levels");
        options.image_tolerance = item.number("tolerance");
    }
    return options;
}

/// Puts facts of a picture among the results, under the names that studies have for them.
void keep_facts(const Facts& facts, CaseResult& result) {
    constexpr std::pair<std::string_view, const char*> kMetrics[]{
        {"points", "kernels"}, {"tets", "tets"}, {"lost_rays", "lost_rays"}, {"image_change", "last_change"}};
    const auto number = [&](std::string_view name) -> std::optional<double> {
        const FactValue* fact = facts.find(name);
        if (fact == nullptr) return std::nullopt;
        if (const auto* count = std::get_if<std::uint64_t>(&fact->value)) return static_cast<double>(*count);
        if (const auto* count = std::get_if<std::int64_t>(&fact->value)) return static_cast<double>(*count);
        return std::get<double>(fact->value);
    };
    for (const auto& [fact, metric] : kMetrics) {
        if (const auto found = number(fact)) result.metrics[metric] = *found;
    }
    for (const char* primitives : {"points", "tets", "micro_cells"}) {
        if (const auto found = number(primitives)) result.metrics["primitives"] = *found;
    }
    if (const FactValue* device = facts.find("device")) result.notes["device"] = std::get<std::string>(device->value);
}

/// Draws as often as the case says; the last picture, and the least time of one.
Image draw(const StudyCase& item, const HexMesh& mesh, const View& view, const Optics& optics, CaseResult& result) {
    const MethodOptions options = picture_options(item, mesh);
    const Method method = options.style.method;
    const detail::Stopwatch watch;
    std::shared_ptr<const Voxels> voxels;
    PictureBody body{.mesh = mesh};
    if (method == Method::Grid) {
        voxels = study_grid(item, mesh, result).voxels();
        body = {.voxels = voxels.get()};
        result.metrics["primitives"] = result.metrics["voxels"];
    }
    PictureMaker maker(std::move(body), options);
    Facts facts = maker.prepare(optics);
    if (method != Method::Dense) result.costs["prepare_seconds"] = watch.seconds();
    double least = std::numeric_limits<double>::infinity();
    Picture picture;
    for (int i = 0; i < std::max(item.whole("repeat"), 1); ++i) {
        const detail::Stopwatch drawing;
        picture = maker.draw(view, optics);
        least = std::min(least, drawing.seconds());
    }
    result.costs["draw_seconds"] = least;
    result.costs["frames_per_second"] = 1 / least;
    facts.merge(picture.facts);
    keep_facts(facts, result);
    if (draws_kernels(method)) {
        const FactValue* dropped = facts.find("dropped");
        result.metrics["sampled"] =
            result.metrics["kernels"] + (dropped != nullptr ? static_cast<double>(std::get<std::uint64_t>(dropped->value)) : 0);
    }
    if (method == Method::Dense) {
        const double levels = static_cast<double>(std::get<std::int64_t>(facts.find("levels")->value));
        result.metrics["levels_drawn"] = levels;
        if (!options.kernels.levels) result.metrics["converged"] = std::get<bool>(facts.find("converged")->value) ? 1 : 0;
    }
    return std::move(picture.image);
}

/// The picture of the closed form of a model. step: a part of its diagonal
Image draw_exact(const StudyCase& item, const HexMesh& mesh, const View& view, const Optics& optics, double step) {
    Box box = bounds(mesh);
    const double diagonal = box.diagonal();
    const Vec3 margin(.1 * diagonal);  // the surface of the closed form may bulge beyond the mesh
    box.add(box.lower - margin);
    box.add(box.upper + margin);
    const ModelField field = model_field(item.text("input.model"));
    return render_field(field, box, view, optics,
                        {.step_world = step * diagonal, .samples = std::max(item.whole("samples"), 1)});
}

/// Whether two cameras give the same picture. size: of the scene
bool same_view(const View& a, const View& b, double size) {
    constexpr double kSame = 1e-5;
    double most = glm::length(a.eye() - b.eye()) / size;
    for (std::size_t k = 0; k < 3; ++k) most = std::max(most, glm::length(a.axes()[k] - b.axes()[k]));
    return a.perspective() == b.perspective() && most < kSame && std::abs(a.pixel() - b.pixel()) < kSame * a.pixel();
}

/// A picture that was made elsewhere; it must be of the case's camera.
Image read_foreign(const StudyCase& item, const HexMesh& mesh, const View& view) {
    const Box box = bounds(mesh);
    const std::string& description = item.text("file.camera");
    const View theirs(parse_camera(description, box, static_cast<double>(view.width()) / view.height()), view.width(),
                      view.height());
    if (!same_view(view, theirs, box.diagonal())) {
        throw Error(ErrorCode::InvalidInput, "the camera is not that of the case", description,
                    "the numbers " + camera_text(view.camera()));
    }
    return read_image(item.text("file"));
}

/// The picture of a case by any method.
Image picture_of(const StudyCase& item, const HexMesh& mesh, const View& view, const Optics& optics, CaseResult& result) {
    const std::string& method = item.text("method");
    if (method == "file") return read_foreign(item, mesh, view);
    if (method != "exact") return draw(item, mesh, view, optics, result);
    return draw_exact(item, mesh, view, optics, item.has("step") ? item.number("step") : kExactStep);
}

/// A mesh with its view and colours.
struct Scene {
    HexMesh mesh;
    Optics optics;
    View view;
};

Scene scene_of(const StudyCase& item) {
    HexMesh mesh = study_mesh(item);
    Optics optics = study_optics(item, mesh);
    View view = study_view(item, mesh, optics);
    return {std::move(mesh), std::move(optics), std::move(view)};
}

/// Stores the camera and the counts of a case.
void describe(const Scene& scene, CaseResult& result) {
    result.notes["camera_used"] = camera_text(scene.view.camera());
    result.metrics["points"] = static_cast<double>(scene.mesh.points.size());
    result.metrics["cells"] = static_cast<double>(scene.mesh.cells.size());
}

/// Draws the picture and stores its costs and counts. own_bytes is the growth of the peak after the mesh was loaded.
template <class Draw>
Image measured(const Scene& scene, CaseResult& result, const Draw& draw_picture) {
    const auto before = static_cast<double>(peak_memory_bytes());
    const double cpu = cpu_seconds();
    const detail::Stopwatch watch;
    Image image = draw_picture();
    result.costs["seconds"] = watch.seconds();
    result.costs["cpu_seconds"] = cpu_seconds() - cpu;
    result.costs["peak_bytes"] = static_cast<double>(peak_memory_bytes());
    result.costs["own_bytes"] = result.costs["peak_bytes"] - before;
    describe(scene, result);
    return image;
}

/// Takes over how good the reference is: its level, its change, and the floors of the case's metrics.
void keep_reference(const StudyCase& item, const CaseResult& reference, CaseResult& result) {
    for (const auto& [metric, source] : {std::pair{"reference_level", "levels_drawn"},
                                         {"reference_change", "last_change"},
                                         {"reference_converged", "converged"}}) {
        if (const auto found = reference.metrics.find(source); found != reference.metrics.end())
            result.metrics[metric] = found->second;
    }
    std::istringstream names(item.text("metrics"));
    for (std::string name; std::getline(names, name, ',');) {
        const auto floor = reference.metrics.find("floor_" + name);
        if (floor != reference.metrics.end()) result.metrics[floor->first] = floor->second;
    }
}

/// Whether the reference is drawn by the method of the case, as fine or less: then a difference says nothing about the case.
bool is_own_reference(const StudyCase& item, const StudyCase& reference, const CaseResult& made, const CaseResult& result) {
    if (item.text("method") != reference.text("method")) return false;
    const auto level = [](const CaseResult& one) {
        const auto found = one.metrics.find("levels_drawn");
        return found == one.metrics.end() ? 0 : found->second;
    };
    return level(result) >= level(made);
}

void write_pictures(const StudyCase& item, const CasePlace& place, const Image& image, const Image& reference,
                    CaseResult& result) {
    fs::create_directories(place.folder / "pictures");
    const auto write = [&](const char* kind, const std::string& ending, const Image& picture) {
        result.files[kind] = "pictures/" + case_file(item, ending);
        write_image(place.folder / result.files[kind], picture, Vec3(0.0), {}, result.notes["camera_used"]);
    };
    write("picture", ".png", image);
    write("difference", "_difference.png", log_heatmap(difference_map(image, reference)));
    write("sign", "_sign.png", sign_heatmap(image, reference));
    if (item.flag("exr")) write("exr", ".exr", image);
}

}  // namespace

CaseResult run_picture_case(const StudyCase& item, const CasePlace& place) {
    CaseResult result;
    const Scene scene = scene_of(item);
    const Image image = measured(scene, result, [&] { return picture_of(item, scene.mesh, scene.view, scene.optics, result); });
    const auto reference_case = reference_of(item);
    // If the reference is a part of another picture, only that part is left, and its size is refused below.
    const Image reference =
        common_pixels(whole_image(image), read_placed_image(place.references / (reference_case->id + ".exr"))).b;
    const auto made = read_finished_case(place.references / (reference_case->id + ".json"), *reference_case, place.references);
    if (made) keep_reference(item, *made, result);
    if (made && is_own_reference(item, *reference_case, *made, result)) {
        result.notes["own_reference"] = "the reference is drawn by the same method, no finer: nothing is compared";
    } else {
        for (const auto& [name, value] : measure_pictures(image, reference, item.text("metrics"))) result.metrics[name] = value;
    }
    write_pictures(item, place, image, reference, result);
    result.notes["reference"] = reference_case->id;
    return result;
}

CaseResult run_reference(const StudyCase& item, const CasePlace& place) {
    CaseResult result;
    const Scene scene = scene_of(item);
    Image before;
    const Image image = measured(scene, result, [&] {
        if (item.text("method") == "exact") {
            constexpr int kMostSteps = 5;
            double step = 2 * kExactStep;
            Image finer = draw_exact(item, scene.mesh, scene.view, scene.optics, step);
            for (int k = 0; k < kMostSteps && result.metrics["converged"] == 0; ++k) {
                before = std::exchange(finer, draw_exact(item, scene.mesh, scene.view, scene.optics, step /= 2));
                result.metrics["last_change"] = compare_images(finer, before).rmse;
                result.metrics["converged"] = result.metrics["last_change"] < item.number("tolerance") ? 1 : 0;
            }
            return finer;
        }
        Image finest = draw(item, scene.mesh, scene.view, scene.optics, result);
        StudyCase coarser = item;
        coarser.values["levels"] = std::max(result.metrics["levels_drawn"] - 1, 0.0);
        CaseResult unused;
        before = draw(coarser, scene.mesh, scene.view, scene.optics, unused);
        return finest;
    });
    std::string names;
    for (const std::string& name : study_metrics()) names += name + ",";
    for (const auto& [name, value] : measure_pictures(before, image, names)) result.metrics["floor_" + name] = value;
    fs::create_directories(place.references / "cameras");
    result.files = {{"exr", item.id + ".exr"}, {"picture", item.id + ".png"}};
    for (const auto& [kind, name] : result.files)
        write_image(place.references / name, image, Vec3(0.0), {}, result.notes["camera_used"]);
    result.files["camera"] = "cameras/" + item.id + ".json";
    detail::write_text_file(place.references / result.files["camera"], json_of(facts_of(scene.view.camera())).dump(2) + "\n");
    return result;
}

}  // namespace subvol::cli
