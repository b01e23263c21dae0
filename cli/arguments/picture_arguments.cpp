// SPDX-License-Identifier: Apache-2.0
#include "picture_arguments.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <limits>

#include "choices.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "subvol/camera_fit.h"
#include "subvol/color_name.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/picture_size.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/legend.h"
#include "subvol/option.h"
#include "subvol/srgb.h"
#include "text.h"

namespace subvol::cli {

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
    constexpr int kMostPerSecond = 240;
    constexpr double kLongest_s = 1e6;
    add_options(app, options_of(eye));
    add_option(app, Option("views", views)
                        .help("N|SIDE,…",
                              "several sides in one picture, with their names: front,iso, or 4 (front, right, top and iso)")
                        .instead_of({"view", "camera"}));
    add_option(app, Option("fps", frames_per_second).between(1, kMostPerSecond).help("N", "pictures per second of a video"));
    add_option(app, Option("duration", duration_s)
                        .between(1e-3, kLongest_s)
                        .help("S", "the length of a video in seconds, whatever the number of its pictures")
                        .instead_of({"fps"}));
}

void PictureArguments::add_light_to(CLI::App& app) {
    add_options(app, options_of(choices));
    app.add_option("--legend", legend,
                   "a colour bar with the opacities and the field's name, at the right of the picture, or in a file of its own")
        ->type_name("[FILE.svg]")
        ->expected(0, 1);
    constexpr double kSmallest = 0.25, kLargest = 8;
    add_option(app,
               Option("legend-side", legend_style.side).help("SIDE", "right or bottom: where --legend stands in the picture"));
    add_option(app, Option("legend-size", legend_style.size)
                        .between(kSmallest, kLargest)
                        .help("F", "the size of the letters and the bar of --legend in the picture, 1 by default"));
    add_option(app, Option("legend-format", legend_format)
                        .help("FORMAT", "how --legend writes numbers: %.2f, %g, %.3e (default: as many digits as they need)"));
    add_option(app, Option("unit", unit).help("TEXT", "the field's unit, which the legend shows"));
    add_option(app, Option("axes", axes).help("draw the directions of x, y and z in the lower left corner"));
    add_option(app, Option("scale-bar", scale_bar)
                        .help("draw a bar of a round length in the lower right corner, at the depth of the box's centre"));
    add_option(app, Option("edges", edges)
                        .help("draw the edges of the control mesh into the picture, also where it is cut; hidden lines hidden, "
                              "and in a volume "
                              "as far as what is before them is opaque"));
    add_option(app, Option("extremes", extremes)
                        .help("mark the places of the least and the largest value, with the values: of the limit, as probe "
                              "--stats finds them, as "
                              "far as --clip leaves it"));
    add_option(app, Option("background", background)
                        .help("COLOR",
                              "the background: linear red, green, blue in 0..1, #rrggbb (sRGB), a name, or none (.png with "
                              "alpha); default: light "
                              "grey for solid and isosurface, white for xray, black for volume"));
}

void PictureArguments::settle_look(bool has_boundary) {
    look = chosen_look(choices, has_boundary, OptionNames::Flags);
}

void PictureArguments::refuse_isosurfaces_of_level_set() const {
    if (look != Look::Isosurface) return;
    throw Error(ErrorCode::InvalidInput, "a level set is drawn as the surface where its distance is 0",
                choices.iso.empty() ? "--look isosurface" : "--iso", "without it; --method grid with it draws other distances");
}

Vec3 PictureArguments::background_color() const {
    if (background && *background != "none") return parse_color(*background, "--background");
    return background_of(look);
}

PictureSize PictureArguments::size_of_body() const {
    PictureSize size = eye.size;
    (legend_style.side == LegendSide::Right ? size.width : size.height) -= legend_px;
    size.height -= caption_px;
    return size;
}

std::vector<View> PictureArguments::make_views(const Box& box, std::span<const Vec3> points) const {
    const auto [width, height] = size_of_body();
    if (views) return make_sheet(box, points);
    const Camera first = find_camera(eye, box, points, static_cast<double>(width) / height, OptionNames::Flags);
    if (!eye.turntable) return {View(first, width, height)};
    std::vector<View> frames;
    for (const Camera& frame : turntable(first, box.center(), *eye.turntable)) frames.emplace_back(frame, width, height);
    return frames;
}

std::vector<std::string> PictureArguments::sheet_views() const {
    if (!views) return {};
    if (*views == "4") return {"front", "right", "top", "iso"};
    std::vector<std::string> names;
    for (std::size_t begin = 0; begin <= views->size();) {
        const std::size_t end = std::min(views->find(',', begin), views->size());
        names.push_back(views->substr(begin, end - begin));
        begin = end + 1;
    }
    constexpr std::size_t kMost = 16;
    if (names.size() < 2 || names.size() > kMost || std::ranges::any_of(names, [](const auto& name) { return name.empty(); }))
        throw Error(ErrorCode::InvalidInput, "'" + *views + "' are not several views", "--views",
                    "4, or 2 to 16 sides such as front,iso");
    return names;
}

int PictureArguments::sheet_columns() const {
    const std::size_t count = sheet_views().size();
    int columns = 1;
    while (static_cast<std::size_t>(columns * columns) < count) ++columns;
    return columns;
}

int PictureArguments::sheet_rows() const {
    return (static_cast<int>(sheet_views().size()) + sheet_columns() - 1) / sheet_columns();
}

std::vector<View> PictureArguments::make_sheet(const Box& box, std::span<const Vec3> points) const {
    const std::vector<std::string> sides = sheet_views();
    const int columns = sheet_columns(), rows = sheet_rows();
    const PictureSize body = size_of_body();
    const int width = body.width / columns, height = body.height / rows;
    std::vector<View> sheet;
    for (const std::string& side : sides) {
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
    for (const std::string& side : sheet_views()) (void)camera_of_option("--views", side, any);
    if (const int columns = std::max(1, sheet_columns()); views && width % columns != 0) {
        throw Error(ErrorCode::InvalidInput, text("a sheet of ", columns, " views side by side has parts of whole pixels"),
                    text("--size ", width, "x", height), text("a width that is a multiple of ", columns));
    }
    if (legend && !legend_inside()) check_output(*legend, {".svg"});
    const bool styled = legend_style.side != LegendSide::Right || legend_style.size != 1;
    if (styled && !legend_inside())
        throw Error(ErrorCode::InvalidInput, "is about a legend in the picture", "--legend-side, --legend-size",
                    "--legend without a file");
    if (legend_format && !legend) throw Error(ErrorCode::InvalidInput, "is about a legend", "--legend-format", "--legend");
    if (legend_format && !is_tick_format(*legend_format))
        throw Error(ErrorCode::InvalidInput, "'" + *legend_format + "' is not a format of one number", "--legend-format",
                    "such as %.2f, %g or %.3e");
    if (!unit.empty() && !legend) throw Error(ErrorCode::InvalidInput, "is shown by a legend only", "--unit", "--legend");
}

LegendOptions PictureArguments::legend_options(const ShownField& field, const ShownField& colors) const {
    const Range range = shown_range(choices, colors.range, OptionNames::Flags);
    const std::string& known = unit.empty() ? colors.unit : unit;
    LegendOptions options{.title = legend_title(colors.name, known),
                          .min = range.min,
                          .max = range.max,
                          .shape = color_shape(choices, OptionNames::Flags)};
    options.note = legend_note;
    options.names = legend_names;
    if (choices.colors == "categories") name_categories(options, colors.categories);
    options.format = legend_format.value_or("");
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
