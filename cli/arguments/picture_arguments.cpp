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
    constexpr int kSides = 4, kMostPerSecond = 240;
    add_options(app, options_of(eye));
    add_option(app, Option("views", views)
                        .between(kSides, kSides)
                        .help("N", "4: one picture of four, from the front, the side, above and iso")
                        .instead_of({"view", "camera"}));
    add_option(app, Option("fps", frames_per_second).between(1, kMostPerSecond).help("N", "pictures per second of a video"));
}

void PictureArguments::add_light_to(CLI::App& app) {
    add_options(app, options_of(choices));
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
    look = chosen_look(choices, has_boundary, OptionNames::Flags);
}

Vec3 PictureArguments::background_color() const {
    if (background) return parse_background(*background);
    return background_of(look);
}

std::vector<View> PictureArguments::make_views(const Box& box, std::span<const Vec3> points) const {
    const int width = eye.size.width - legend_px, height = eye.size.height;
    if (views) return make_sheet(box, points, width / 2, height / 2);
    const Camera first = find_camera(eye, box, points, static_cast<double>(width) / height, OptionNames::Flags);
    if (!eye.turntable) return {View(first, width, height)};
    std::vector<View> frames;
    for (const Camera& frame : turntable(first, box.center(), *eye.turntable)) frames.emplace_back(frame, width, height);
    return frames;
}

std::vector<View> PictureArguments::make_sheet(const Box& box, std::span<const Vec3> points, int width, int height) const {
    std::vector<View> sheet;
    for (const char* side : {"-y", "+x", "+z", "iso"}) {
        ViewOptions one = eye;
        one.view = side;
        sheet.emplace_back(find_camera(one, box, points, static_cast<double>(width) / height, OptionNames::Flags), width,
                           height);
    }
    return sheet;
}

Optics PictureArguments::make_optics(const Box& box, const Range& field, const Range& colors) const {
    return picture_optics(look_options(field), box, field, colors);
}

void PictureArguments::check() const {
    const Box any{{0, 0, 0}, {1, 1, 1}};
    const auto [width, height] = eye.size;
    (void)find_camera(eye, any, {}, static_cast<double>(width) / height, OptionNames::Flags);
    (void)find_transfer_function(colors_of({.look = look, .colors = choices.colors.value_or("")}), {0, 1}, false);
    (void)background_color();
    if (views && (width % 2 != 0 || height % 2 != 0)) {
        throw Error(ErrorCode::InvalidInput, "a sheet of four views has quarters of whole pixels",
                    text("--size ", width, "x", height), "an even width and height");
    }
    if (legend && !legend_inside()) check_output(*legend, {".svg"});
    if (!unit.empty() && !legend) throw Error(ErrorCode::InvalidInput, "is shown by a legend only", "--unit", "--legend");
}

LegendOptions PictureArguments::legend_options(const ShownField& field, const ShownField& colors) const {
    const Range range = shown_range(choices, colors.range, OptionNames::Flags);
    const std::string& known = unit.empty() ? colors.unit : unit;
    LegendOptions options{.title = colors.name + (known.empty() ? "" : " [" + known + "]"), .min = range.min, .max = range.max};
    options.note = legend_note;
    options.names = legend_names;
    if (field.name != colors.name) {
        const Range opacities = shown_range(choices, field.range, OptionNames::Flags);
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
