// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "study_input.h"
#include "study_work.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/error.h"
#include "subvol/image.h"
#include "subvol/image_io.h"
#include "subvol/image_metrics.h"
#include "subvol/picture_maker.h"
#include "subvol/picture_metrics.h"
#include "subvol/placed_image.h"
#include "text.h"

namespace subvol::cli {
namespace {

namespace fs = std::filesystem;

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
    if (method == Method::Dense) {
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

/// Draws the picture and stores its costs and counts. own_bytes is the growth of the peak after the mesh was loaded.
Image measured(const StudyCase& item, const HexMesh& mesh, CaseResult& result) {
    const Optics optics = study_optics(item, mesh);
    const View view = study_view(item, mesh, optics);
    const auto before = static_cast<double>(peak_memory_bytes());
    const double cpu = cpu_seconds();
    const detail::Stopwatch watch;
    Image image = draw(item, mesh, view, optics, result);
    result.costs["seconds"] = watch.seconds();
    result.costs["cpu_seconds"] = cpu_seconds() - cpu;
    result.costs["peak_bytes"] = static_cast<double>(peak_memory_bytes());
    result.costs["own_bytes"] = result.costs["peak_bytes"] - before;
    result.metrics["points"] = static_cast<double>(mesh.points.size());
    result.metrics["cells"] = static_cast<double>(mesh.cells.size());
    return image;
}

}  // namespace

CaseResult run_picture_case(const StudyCase& item, const CasePlace& place) {
    CaseResult result;
    const HexMesh mesh = study_mesh(item);
    const Image image = measured(item, mesh, result);
    const auto reference_case = reference_of(item);
    // If the reference is a part of another picture, only that part is left, and its size is refused below.
    const Image reference =
        common_pixels(whole_image(image), read_placed_image(place.references / (reference_case->id + ".exr"))).b;
    for (const auto& [name, value] : measure_pictures(image, reference, item.text("metrics"))) result.metrics[name] = value;

    if (const auto made =
            read_finished_case(place.references / (reference_case->id + ".json"), *reference_case, place.references)) {
        for (const auto& [metric, source] :
             {std::pair{"reference_level", "levels_drawn"}, {"reference_change", "last_change"}}) {
            if (const auto found = made->metrics.find(source); found != made->metrics.end())
                result.metrics[metric] = found->second;
        }
    }

    const fs::path folder = place.folder / "pictures";
    fs::create_directories(folder);
    result.files["picture"] = "pictures/" + case_file(item, ".png");
    result.files["difference"] = "pictures/" + case_file(item, "_difference.png");
    write_image(place.folder / result.files["picture"], image);
    write_image(place.folder / result.files["difference"], difference_heatmap(image, reference));
    result.notes["reference"] = reference_case->id;
    return result;
}

CaseResult run_reference(const StudyCase& item, const CasePlace& place) {
    CaseResult result;
    const HexMesh mesh = study_mesh(item);
    const Image image = measured(item, mesh, result);
    fs::create_directories(place.references);
    result.files = {{"exr", item.id + ".exr"}, {"picture", item.id + ".png"}};
    for (const auto& [kind, name] : result.files) write_image(place.references / name, image);
    return result;
}

}  // namespace subvol::cli
