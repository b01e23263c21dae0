// SPDX-License-Identifier: Apache-2.0
#include "picture_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <charconv>
#include <limits>

#include "choices.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "subvol/camera_fit.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/picture_size.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/legend.h"
#include "subvol/srgb.h"
#include "text.h"

namespace subvol::cli {

PictureSize parse_size(const std::string& option, const std::string& text) {
    using detail::kMostPixels, detail::kMostSide;
    const std::size_t cross = text.find('x');
    const auto side = [&](std::string_view digits) -> std::int64_t {
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        const bool digits_only = !digits.empty() && digits.find_first_not_of("0123456789") == std::string_view::npos;
        if (!digits_only || number == 0) {
            throw Error(ErrorCode::InvalidInput, "'" + detail::shortened(text) + "' is not a picture size", option,
                        "write it as 640x480 or 512");
        }
        return error == std::errc() ? number : std::numeric_limits<std::int64_t>::max();
    };
    const std::int64_t width = side(std::string_view(text).substr(0, cross));
    const std::int64_t height = cross == std::string::npos ? width : side(std::string_view(text).substr(cross + 1));
    if (width > kMostSide || height > kMostSide || width * height > kMostPixels) {
        throw Error(ErrorCode::InvalidInput, "'" + detail::shortened(text) + "' is too large a picture", option,
                    subvol::cli::text("1 to ", kMostSide, " pixels a side, ", kMostPixels, " in all"));
    }
    return {static_cast<int>(width), static_cast<int>(height)};
}

double parse_value(const std::string& option, const std::string& text, const Range& range) {
    if (!text.ends_with('%')) return parse_number(option, text);
    return range.min + parse_number(option, text.substr(0, text.size() - 1)) / 100 * (range.max - range.min);
}

Range parse_range(const std::string& option, const std::string& text, const Range& whole) {
    const char* const allowed = "MIN,MAX, or per cents such as 10%,90%";
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a range", option, allowed);
    const Range range{parse_value(option, text.substr(0, comma), whole), parse_value(option, text.substr(comma + 1), whole)};
    if (!(range.min < range.max)) {
        throw Error(ErrorCode::InvalidInput, "'" + text + "' is not ascending", option, allowed);
    }
    return range;
}

Vec3 parse_background(const std::string& text) {
    struct Named {
        const char* name;
        int rgb;
    };
    constexpr std::array<Named, 14> kNamed{{{"white", 0xffffff},
                                            {"black", 0},
                                            {"lightgrey", 0xe4e6e9},
                                            {"lightgray", 0xe4e6e9},
                                            {"grey", 0x808080},
                                            {"gray", 0x808080},
                                            {"darkgrey", 0x404040},
                                            {"darkgray", 0x404040},
                                            {"red", 0xff0000},
                                            {"green", 0x008000},
                                            {"blue", 0x0000ff},
                                            {"yellow", 0xffff00},
                                            {"navy", 0x000080},
                                            {"ivory", 0xfffff0}}};
    const auto from_bytes = [](int rgb) { return linear_from_srgb(Vec3(rgb >> 16, rgb >> 8 & 255, rgb & 255) / 255.0); };
    for (const auto& [name, rgb] : kNamed) {
        if (text == name) return from_bytes(rgb);
    }
    if (text.starts_with('#')) {
        int rgb = 0;
        const auto [end, error] = std::from_chars(text.data() + 1, text.data() + text.size(), rgb, 16);
        if (text.size() == 7 && text[1] != '-' && error == std::errc() && end == text.data() + text.size())
            return from_bytes(rgb);
        throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a colour", "--background", "write it as #rrggbb");
    }
    if (text.find(',') == std::string::npos) {
        std::vector<std::string> names;
        for (const auto& named : kNamed) names.emplace_back(named.name);
        throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a colour" + detail::did_you_mean(text, names),
                    "--background", "three numbers 0..1 such as 1,.5,0; #rrggbb; or " + join(names));
    }
    const Vec3 color = parse_vector("--background", text);
    for (int c = 0; c < 3; ++c) {
        if (color[c] >= 0 && color[c] <= 1) continue;
        throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a colour", "--background", "each number in 0..1");
    }
    return color;
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

void PictureArguments::add_some_to(CLI::App& app, std::initializer_list<std::string_view> names) {
    const std::size_t before = app.get_options().size();
    add_to(app);
    const std::vector<CLI::Option*> all = app.get_options();
    for (auto option = all.begin() + static_cast<std::ptrdiff_t>(before); option != all.end(); ++option) {
        if (std::ranges::find(names, (*option)->get_name()) == names.end()) app.remove_option(*option);
    }
}

void PictureArguments::add_camera_to(CLI::App& app) {
    app.add_option("--size", size, "width and height of the picture in pixels (default 512x512)")->type_name("WxH");
    auto* place = app.add_option("--camera", camera,
                                 "ex,ey,ez,tx,ty,tz,ux,uy,uz,fovy (eye, target, up, vertical field of view in degrees), or a "
                                 "JSON file with eye, target, up, fovy_deg or ortho_height");
    place->type_name("CAMERA");
    app.add_option("--view", view, "the side to look from: +x -x +y -y +z -z iso (default iso)")
        ->type_name("SIDE")
        ->check(offered({"+x", "-x", "+y", "-y", "+z", "-z", "iso"}))
        ->excludes(place);
    app.add_option("--views", views, "4: one picture of four, from the front, the side, above and iso")
        ->type_name("N")
        ->transform(whole_number(4, 4))
        ->excludes("--view")
        ->excludes(place);
    app.add_flag("--fit", fit, "move the camera along its line of sight until the whole box is in the picture");
    app.add_flag("--ortho", orthographic,
                 "use an orthographic camera, as high as the box needs or as the JSON file's ortho_height");
    app.add_option("--turntable", turntable_frames,
                   "N pictures of one turn about the camera's up axis; -o NAME.png (or .exr) writes NAME_0000.png and so on, "
                   ".mp4, .webm and .gif write a video (with the program ffmpeg)")
        ->type_name("N")
        ->transform(whole_number(1, 100000));
    app.add_option("--fps", frames_per_second, "pictures per second of a video (default 30)")
        ->type_name("N")
        ->transform(whole_number(1, 240));
}

void PictureArguments::add_light_to(CLI::App& app) {
    LookOptions any;
    std::vector<Option> described = options_of(any);  // of which it counts whether they were given
    described[0].value = &look_name;
    described[1].value = &transfer_function;
    described[2].value = &opacity_unit_world;
    described[3].value = &clamp;
    add_options(app, described);
    app.add_option("--range,--tf-range", transfer_range,
                   "the range that the colour map and the percentages of --opacity cover: MIN,MAX, per cents of the field's "
                   "range such as 10%,90%, or field (default: the field's "
                   "range; a map from a file keeps its own values)")
        ->type_name("MIN,MAX|field");
    app.add_option(
           "--opacity", opacity,
           "opacities instead of those of --tf, linear in between: at values of the field or per cent of its range, such "
           "as 0%:0,50%:.2,100%:.9")
        ->type_name("V:A,V:A,…");
    app.add_option("--legend", legend,
                   "a colour bar with the opacities and the field's name, at the right of the picture, or in a file of its own")
        ->type_name("[FILE.svg]")
        ->expected(0, 1);
    app.add_option("--unit", unit, "the field's unit, which the legend shows")->type_name("TEXT");
    app.add_flag("--axes", axes, "draw the directions of x, y and z in the lower left corner");
    app.add_flag("--edges", edges, "splat: draw the edges of the control mesh over the picture, hidden lines hidden");
    app.add_option(
           "--background", background,
           "the background of a .png: linear red, green, blue in 0..1, #rrggbb (sRGB), or a name such as white (default: light "
           "grey for solid and isosurface, white for xray, black for volume)")
        ->type_name("COLOR");
}

void PictureArguments::settle_look(bool has_boundary) {
    const std::string name = look_name.value_or(
        has_boundary && !transfer_function && !opacity && !opacity_unit_world && !transfer_range ? "solid" : "volume");
    look = named<Look>(name, "--look");
}

Vec3 PictureArguments::background_color() const {
    if (background) return parse_background(*background);
    return background_of(look);
}

Camera camera_of_option(const std::string& option, const std::string& text, const Box& box, double aspect) {
    try {
        return parse_camera(text, box, aspect);
    } catch (const Error& error) {
        const std::string where = error.where().empty() ? "" : error.where() + ": ";
        throw Error(error.code(), where + error.message(), option, error.allowed());
    }
}

Camera PictureArguments::make_camera(const Box& box, std::span<const Vec3> points, double aspect) const {
    Camera given = camera_of_option(camera ? "--camera" : "--view", camera.value_or(view), box, aspect);
    const bool made_orthographic = orthographic && given.ortho_height == 0;
    if (made_orthographic) given = orthographic_camera(given, box, aspect);
    // A named view shows the whole box, so all pictures of its turntable do.
    if (turntable_frames && (fit || !camera || made_orthographic)) return fit_turntable(given, box, *turntable_frames, aspect);
    if (!camera && !points.empty()) return fit_camera_to_points(given, points, aspect);
    return fit ? fit_camera(given, box, aspect) : given;
}

std::vector<View> PictureArguments::make_views(const Box& box, std::span<const Vec3> points) const {
    const PictureSize whole = parse_size("--size", size);
    const int width = whole.width - legend_px, height = whole.height;
    const Camera first = make_camera(box, points, static_cast<double>(width) / height);
    if (views) return make_sheet(box, points, width / 2, height / 2);
    if (!turntable_frames) return {View(first, width, height)};
    std::vector<View> frames;
    for (const Camera& frame : turntable(first, box.center(), *turntable_frames)) frames.emplace_back(frame, width, height);
    return frames;
}

std::vector<View> PictureArguments::make_sheet(const Box& box, std::span<const Vec3> points, int width, int height) const {
    std::vector<View> sheet;
    for (const char* side : {"-y", "+x", "+z", "iso"}) {
        PictureArguments one = *this;
        one.view = side;
        sheet.emplace_back(one.make_camera(box, points, static_cast<double>(width) / height), width, height);
    }
    return sheet;
}

Range PictureArguments::shown_range(const Range& field) const {
    if (!transfer_range || *transfer_range == "field") return field;
    return parse_range("--range", *transfer_range, field);
}

LookOptions PictureArguments::look_options(const Range& field) const {
    LookOptions options{.look = look,
                        .colors = transfer_function.value_or(""),
                        .stretch = transfer_range.has_value(),
                        .opacity_unit_world = opacity_unit_world,
                        .clamp = clamp};
    const Range range = shown_range(field);
    if (transfer_range && *transfer_range != "field") options.range = range;
    if (!opacity) return options;
    try {
        options.opacity = parse_opacity(*opacity, range.min, range.max);
    } catch (const Error& error) {
        throw Error(error.code(), error.where() + ": " + error.message(), "--opacity", error.allowed());
    }
    return options;
}

Optics PictureArguments::make_optics(const Box& box, const Range& field, const Range& colors) const {
    return picture_optics(look_options(field), box, field, colors);
}

void PictureArguments::check() const {
    const Box any{{0, 0, 0}, {1, 1, 1}};
    const auto [width, height] = parse_size("--size", size);
    (void)camera_of_option(camera ? "--camera" : "--view", camera.value_or(view), any, static_cast<double>(width) / height);
    (void)find_transfer_function(colors_of({.look = look, .colors = transfer_function.value_or("")}), {0, 1}, false);
    (void)background_color();
    if (views && (width % 2 != 0 || height % 2 != 0)) {
        throw Error(ErrorCode::InvalidInput, "a sheet of four views has quarters of whole pixels", "--size " + size,
                    "an even width and height");
    }
    if (legend && !legend_inside()) check_output(*legend, {".svg"});
    if (!unit.empty() && !legend) throw Error(ErrorCode::InvalidInput, "is shown by a legend only", "--unit", "--legend");
}

LegendOptions PictureArguments::legend_options(const ShownField& field, const ShownField& colors) const {
    const Range range = shown_range(colors.range);
    const std::string& known = unit.empty() ? colors.unit : unit;
    LegendOptions options{.title = colors.name + (known.empty() ? "" : " [" + known + "]"), .min = range.min, .max = range.max};
    options.note = legend_note;
    if (field.name != colors.name) {
        const Range opacities = shown_range(field.range);
        options.opacity_title = field.name;
        options.opacity_min = opacities.min;
        options.opacity_max = opacities.max;
    }
    return options;
}

Facts PictureArguments::write_legend(const Optics& optics, const LegendOptions& options) const {
    Facts facts;
    if (!legend || legend_inside()) return facts;
    subvol::write_legend(*legend, optics.function(), options);
    facts["legend"] = *legend;
    return facts;
}

}  // namespace subvol::cli
