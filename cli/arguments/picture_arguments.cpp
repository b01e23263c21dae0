// SPDX-License-Identifier: Apache-2.0
#include "picture_arguments.h"

#include <CLI/CLI.hpp>
#include <filesystem>
#include <sstream>

#include "outputs.h"
#include "subvol/error.h"
#include "subvol/legend.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kOpacityUnitsPerDiagonal = 100;

}  // namespace

TransferFunction find_transfer_function(const std::string& name, const Range& range, bool stretch) {
    const std::filesystem::path path(name);
    const std::size_t end = name.find(".json:");  // FILE.json:NAME picks one of several maps
    const bool one_of_several = end != std::string::npos;
    if (!one_of_several && !path.has_extension() && !path.has_parent_path()) {
        return transfer_function_preset(name, range.min, range.max);
    }
    TransferFunction function =
        one_of_several ? read_transfer_function(name.substr(0, end + 5), name.substr(end + 6)) : read_transfer_function(path);
    return stretch ? stretched(function, range.min, range.max) : function;
}

PictureSize parse_size(const std::string& option, const std::string& text) {
    std::istringstream in(text);
    PictureSize size;
    char cross = 'x';
    in >> size.width;
    size.height = size.width;
    if (!in.fail() && !in.eof()) in >> cross >> size.height;
    if (in.fail() || !in.eof() || cross != 'x' || size.width < 1 || size.height < 1) {
        throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a picture size", option, "write it as 640x480 or 512");
    }
    return size;
}

Box visible_bounds(const HexMesh& mesh, const Optics& optics) {
    Box box;
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        if (optics.extinction(mesh.attributes[0].values[p]) > 0) box.add(mesh.points[p]);
    }
    return box;
}

void PictureArguments::add_to(CLI::App& app) {
    add_camera_to(app);
    add_light_to(app);
}

void PictureArguments::add_camera_to(CLI::App& app) {
    app.add_option("--size", size, "width and height of the picture in pixels (default 512x512)")->type_name("WxH");
    auto* place = app.add_option("--camera", camera,
                                 "ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy (eye, target, up, vertical field of view in degrees), or a "
                                 "JSON file with eye, target, up, fovy_deg or ortho_height");
    place->type_name("CAMERA");
    app.add_option("--view", view, "the side to look from: +x -x +y -y +z -z iso (default iso)")
        ->type_name("SIDE")
        ->excludes(place);
    app.add_flag("--fit", fit, "move the camera along its line of sight until the whole box is in the picture");
    app.add_flag("--ortho", orthographic,
                 "use an orthographic camera, as high as the box needs or as the JSON file's ortho_height");
    app.add_option("--turntable", turntable_frames,
                   "N pictures of one turn about the camera's up axis; -o NAME.png (or .exr) writes NAME_0000.png and so on, "
                   ".mp4, .webm and .gif write a video (with the program ffmpeg)")
        ->type_name("N")
        ->check(CLI::Range(1, 100000));
    app.add_option("--fps", frames_per_second, "pictures per second of a video (default 30)")
        ->type_name("N")
        ->check(CLI::Range(1, 240));
}

void PictureArguments::add_light_to(CLI::App& app) {
    app.add_option(
           "--tf", transfer_function,
           "colour map: viridis (default), coolwarm, grey, bone, xray, isosurface, surface or constant over the field's "
           "range, or a ParaView colour-map JSON file (FILE.json:NAME for one of several in it)")
        ->type_name("FILE|NAME");
    app.add_option(
           "--tf-range", transfer_range,
           "the range that the colour map and the percentages of --opacity cover: MIN,MAX or field (default: the field's "
           "range; a map from a file keeps its own values)")
        ->type_name("MIN,MAX|field");
    app.add_option(
           "--opacity", opacity,
           "opacities instead of those of --tf, linear in between: at values of the field or per cent of its range, such "
           "as 0%:0,50%:.2,100%:.9")
        ->type_name("V:A,V:A,…");
    app.add_option("--opacity-unit", opacity_unit_world,
                   "the world distance over which an opacity acts (default: 1/100 of the bounding box's diagonal)")
        ->type_name("D")
        ->check(CLI::PositiveNumber);
    app.add_option("--legend", legend, "also write a colour bar with the opacities and the field's name")
        ->type_name("FILE.svg");
    app.add_option("--background", background, "the background of a .png: linear red, green, blue in 0..1 (default 0,0,0)")
        ->type_name("R,G,B");
}

Camera PictureArguments::make_camera(const Box& box, double aspect) const {
    Camera given = parse_camera(camera.value_or(view), box, aspect);
    const bool made_orthographic = orthographic && given.ortho_height == 0;
    if (made_orthographic) given = orthographic_camera(given, box, aspect);
    // A named view shows the whole box, so all pictures of its turntable do.
    if (turntable_frames && (fit || !camera || made_orthographic)) return fit_turntable(given, box, *turntable_frames, aspect);
    return fit ? fit_camera(given, box, aspect) : given;
}

std::vector<View> PictureArguments::make_views(const Box& box) const {
    const auto [width, height] = parse_size("--size", size);
    const Camera first = make_camera(box, static_cast<double>(width) / height);
    if (!turntable_frames) return {View(first, width, height)};
    std::vector<View> views;
    for (const Camera& frame : turntable(first, box.center(), *turntable_frames)) views.emplace_back(frame, width, height);
    return views;
}

Range PictureArguments::shown_range(const Range& field) const {
    if (!transfer_range || *transfer_range == "field") return field;
    const std::size_t comma = transfer_range->find(',');
    if (comma == std::string::npos) {
        throw Error(ErrorCode::InvalidInput, "'" + *transfer_range + "' is not a range", "--tf-range", "MIN,MAX or field");
    }
    const Range range{parse_number("--tf-range", transfer_range->substr(0, comma)),
                      parse_number("--tf-range", transfer_range->substr(comma + 1))};
    if (!(range.min < range.max)) {
        throw Error(ErrorCode::InvalidInput, "'" + *transfer_range + "' is not ascending", "--tf-range", "MIN,MAX or field");
    }
    return range;
}

Optics PictureArguments::make_optics(const Box& box, const Range& field, const Range& colors) const {
    const Range range = shown_range(field);
    TransferFunction function = find_transfer_function(transfer_function, range, transfer_range.has_value());
    function.color = find_transfer_function(transfer_function, shown_range(colors), transfer_range.has_value()).color;
    if (opacity) function.opacity = parse_opacity(*opacity, range.min, range.max);
    return {std::move(function), opacity_unit_world.value_or(box.diagonal() / kOpacityUnitsPerDiagonal)};
}

void PictureArguments::check() const {
    const Box any{{0, 0, 0}, {1, 1, 1}};
    const auto [width, height] = parse_size("--size", size);
    (void)parse_camera(camera.value_or(view), any, static_cast<double>(width) / height);
    (void)find_transfer_function(transfer_function, {0, 1}, false);
    if (legend) check_output(*legend, {".svg"});
}

void PictureArguments::write_legend(const Optics& optics, const std::string& field, const Range& colors, Report& report) const {
    if (!legend) return;
    const Range range = shown_range(colors);
    subvol::write_legend(*legend, optics.function(), {.title = field, .min = range.min, .max = range.max});
    report["legend"] = *legend;
}

}  // namespace subvol::cli
