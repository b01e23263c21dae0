// SPDX-License-Identifier: Apache-2.0
// The verb `slice`: a field of the limit on a plane.
//
//     plane ─► raster of places, each with its cell and value ─┬─► colours, contour lines, labels, axes, legend ─► picture
//                                                              └─► squares and lines, or a row for each place  ─► .vtp, .csv
//
// Places outside the volume have no cell and stay empty. N contours lie at min + (max − min) c / (N + 1), c from 1 to N; others
// at round values, or where they are asked for. Area,
// mean and extremes on the plane are given of the limit, and beside them of the cells as the file has them; of a mesh in
// memory the extremes are searched for between the places, of bricks they are those of the places. Contour lines are light on
// dark colours and dark on light ones. The coordinates along a side are x, y or z where the side is parallel to one of them.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <tuple>

#include "body_input.h"
#include "input.h"
#include "limit_warning.h"
#include "mesh_figures.h"
#include "numbers.h"
#include "options.h"
#include "outputs.h"
#include "picture_arguments.h"
#include "places_input.h"
#include "refine_arguments.h"
#include "slice_picture.h"
#include "subvol/color_name.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/round_ticks.h"
#include "subvol/error.h"
#include "subvol/limit_slice.h"
#include "subvol/measure.h"
#include "subvol/option.h"
#include "subvol/picture_look.h"
#include "tet_refinement.h"
#include "text.h"
#include "verb.h"

namespace subvol::cli {
namespace {

/// The box of the points of some cells. cells: a flag for each
Box box_of(const HexMesh& mesh, std::span<const std::uint8_t> cells) {
    Box box;
    for (std::size_t c = 0; c < cells.size(); ++c) {
        for (const Index p : mesh.cells[c]) {
            if (cells[c] != 0) box.add(mesh.points[p]);
        }
    }
    return box;
}

class SliceVerb : public Verb {
public:
    explicit SliceVerb(CLI::App& program)
        : Verb(
              program, "slice", "Sample a field on a plane and write an image, a surface or a table.",
              "  subvol slice part.vtu -o slice.png --plane 0,0,0,0,0,1\n"
              "  subvol slice part.vtu -o slice.png --plane 0,0,0,1,1,0 --contours 10\n"
              "  subvol slice part.vtu -o slice.png --contours 300,350 --title Inlet\n"
              "  subvol slice part.vtu -o slice.vtp --plane 0,0,0,0,1,0 --field Temp\n"
              "\n"
              "The picture is seen from where the normal points, with z up (y in planes of constant z). .png: coloured by "
              "value, with a legend. .svg, .pdf: the same with lines and letters as shapes. .exr: in linear light, without a "
              "legend. .csv: a row for each place inside. .vtp: "
              "squares, and the contour lines. JSON: plane, width, height, step, inside, contours, area, mean, min, min_at, "
              "max, "
              "max_at of the limit on the plane, and file_area, file_mean, file_min, file_min_at, file_max, file_max_at of the "
              "cells as the file has them.") {
        add_input(app(), "FILE", input_, input_help())->required();
        add_option(app(),
                   Option("output", output_).also("o").help("FILE", "the file to write (.png, .svg, .pdf, .exr, .vtp, .csv)"))
            ->required();
        add_option(app(),
                   Option("plane", plane_)
                       .help("PX,PY,PZ,NX,NY,NZ", "a point of the plane and its normal (default: the box's centre, and z)"))
            ->transform(number_list(6, "0,0,0,0,0,1: a point of the plane and its normal"));
        add_options(app(), options_of(options_));
        add_option(app(),
                   Option("contours", contours_)
                       .help("N|V,V,…|round",
                             "lines at N values between the least and the largest on the plane, at values or per cents of "
                             "that range (one: V,), or at round values"));
        add_option(app(), Option("contour-labels", contour_labels_).help("write the values of --contours on the lines"));
        add_option(
            app(),
            Option("axes", axes_)
                .help(
                    "coordinates along the sides of the picture: x, y or z where a side is parallel to one, else lengths from "
                    "the plane's point"));
        add_option(app(),
                   Option("extremes", extremes_).help("mark the least and the largest value on the plane, with the values"));
        add_option(app(), Option("tf", function_).help("FILE|NAME", "the colours: a preset, or a colour map of ParaView"));
        add_option(
            app(),
            Option("range", range_)
                .also("tf-range")
                .help("MIN,MAX",
                      "the values of the first and of the last colour, or per cents of those on the plane (default: these)"));
        constexpr std::array<std::string_view, 5> kShape{"log", "symlog", "bands", "below", "above"};
        for (const Option& option : options_of(choices_)) {
            if (std::ranges::find(kShape, option.name) != kShape.end()) add_option(app(), option);
        }
        add_option(app(), Option("title", title_).help("TEXT", "a line of text above the picture"));
        add_option(app(), Option("background", background_).help("COLOR", "the colour outside the volume, but of an .exr"));
        add_option(app(), Option("no-legend", no_legend_).help("the picture alone"));
        add_option(app(), Option("unit", unit_).help("TEXT", "of the field, for the legend").instead_of({"no-legend"}));
        scheme_.add_scheme_to(app());
        set_essentials({"--output", "--plane", "--resolution", "--contours", "--axes", "--tf", "--range", "--field", "--json"});
    }

    int run(Report& report) override {
        check_output(output_, {".png", ".svg", ".pdf", ".exr", ".vtp", ".csv"});
        const Vec3 background = parse_color(background_, "--background");
        check_notes();
        (void)contour_values({.min = 0, .max = 1});
        // What is wrong with these is said before the slice is computed.
        if (range_) (void)parse_range(*range_, {.min = 0, .max = 1}, "--range");
        (void)find_transfer_function(function_, {.min = 0, .max = 1});
        std::vector<double> plane;
        if (!plane_.empty()) plane = parse_numbers("--plane", plane_, 6, "0,0,0,0,0,1");
        report.if_long("a lower --resolution");
        const LimitSlice slice = this->slice(plane, report);
        const std::vector<double> values = contour_values({.min = slice.min, .max = slice.max});
        warn_of_empty_lines(values, slice, report);
        const auto lines = contour_lines(slice, values);
        if (output_.ends_with(".vtp") || output_.ends_with(".csv")) {
            write_slice(output_, slice, lines);
        } else {
            write_slice_picture(output_, slice, lines, picture_of(slice, plane, background), report);
        }
        report["output"] = output_;
        report["plane"] = plane;
        report["width"] = slice.width;
        report["height"] = slice.height;
        report["step"] = glm::length(slice.right);
        report["inside"] = slice.inside;
        say_figures(slice, report);
        if (contours_) report["contours"] = values;
        return 0;
    }

private:
    /// The figures of the limit on the plane, and beside them those of the cells as they were given.
    void say_figures(const LimitSlice& slice, Report& report) const {
        using detail::number_text;
        const SliceFigures& limit = limit_figures_;
        report["area"] = limit.area;
        report["mean"] = limit.mean;
        report["min"] = slice.min;
        report["min_at"] = json_of(slice.min_at);
        report["max"] = slice.max;
        report["max_at"] = json_of(slice.max_at);
        report["file_area"] = file_.area;
        report["file_mean"] = file_.mean;
        report["file_min"] = file_.min.value;
        report["file_min_at"] = place_of(file_.min);
        report["file_max"] = file_.max.value;
        report["file_max_at"] = place_of(file_.max);
        const auto both = [](double of_limit, double of_file) {
            return number_text(of_limit, 5) + (std::isfinite(of_file) ? " · file " + number_text(of_file, 5) : "");
        };
        report.say(text("area ", both(limit.area, file_.area), "  ", slice.field, " mean ", both(limit.mean, file_.mean),
                        "  min ", both(slice.min, file_.min.value), "  max ", both(slice.max, file_.max.value)));
        report.all_said();
    }

    [[nodiscard]] SliceOptions options(Report& report) const {
        SliceOptions options = options_;
        options.limit = {.scheme = scheme_.options(0, report.progress()).scheme, .progress = report.progress()};
        options.progress = report.progress();
        return options;
    }

    /// plane: a point and a normal, or empty; becomes that of the box's centre and z
    [[nodiscard]] LimitSlice slice(std::vector<double>& plane, Report& report) {
        const TetRefinement tets(scheme_);
        report["input"] = input_;
        CommonOptions reading = common();
        reading.parts_in_whole = !tets.asked();
        BodyInput body = report.unpack(open_body(input_, reading, app(), report.progress()));
        const std::string field = report.unpack(body.select(common(), OtherFields::Drop));
        known_unit_ = unit_of(body.of_file, field);
        report.merge(body.refine(tets, 2, report.progress()));
        const MeshSource source = body.source();
        if (!tets.asked()) report.warn(limit_warning(input_, source, options(report).limit.scheme, report.progress()));
        SliceOptions asked = options(report);
        asked.cells = body.in_part;
        const Vec3 center = asked.cells.empty() ? source.bounds().center() : box_of(*source.mesh(), asked.cells).center();
        if (plane.empty()) plane = {center.x, center.y, center.z, 0, 0, 1};
        LimitSlice slice = report.timed("slice", [&] {
            return slice_limit(source, {}, {plane[0], plane[1], plane[2]}, {plane[3], plane[4], plane[5]}, asked);
        });
        limit_figures_ = report.timed("figures", [&] { return figures_of(source, slice, asked.limit, asked.cells); });
        file_ = report.timed("file", [&] { return given_figures_of(source, slice, asked.cells, report.progress()); });
        // Of bricks the extremes are those of the places.
        const Range range = body.range(field);
        if (const HexMesh* mesh = source.mesh()) {
            const SliceExtremes found =
                report.timed("extremes", [&] { return find_slice_extremes(*mesh, slice, asked.limit, asked.cells); });
            file_.min = found.min;
            file_.max = found.max;
            const Attribute* const shown = mesh->find_attribute(field);
            if (shown != nullptr && !is_model(input_))
                report.warn(range_warning(*shown, range, {.min = slice.min, .max = slice.max}));
        } else {
            report.warn(range_warning(field, range, {.min = slice.min, .max = slice.max}, true));
            report.note(
                "of bricks the extremes are those of the places, and volumes are not compared: probe --stats does both");
        }
        return slice;
    }

    [[nodiscard]] SlicePicture picture_of(const LimitSlice& slice, const std::vector<double>& plane,
                                          const Vec3& background) const {
        const ValueRange whole{.min = slice.min, .max = slice.max};
        const ValueRange range = range_ ? parse_range(*range_, whole, "--range") : whole;
        const ColorShape shape = color_shape(choices_, OptionNames::Flags);
        SlicePicture picture{.function = shaped(find_transfer_function(function_, range), shape),
                             .background = background,
                             .title = title_,
                             .axes = axes_,
                             .extremes = extremes_,
                             .contour_labels = contour_labels_,
                             .point = {plane[0], plane[1], plane[2]}};
        picture.function.opacity = {{range.min, 1}, {range.max, 1}};  // a slice is opaque
        if (!no_legend_ && !output_.ends_with(".exr")) {
            picture.legend = LegendOptions{.title = legend_title(slice.field, unit_.empty() ? known_unit_ : unit_),
                                           .min = range.min,
                                           .max = range.max,
                                           .shape = shape};
        }
        return picture;
    }

    /// The values of the lines for the range of a plane.
    ///
    /// throws: Error(InvalidInput) if --contours has neither a number of lines nor values
    [[nodiscard]] std::vector<double> contour_values(const Range& range) const {
        std::vector<double> values;
        if (!contours_) return values;
        constexpr int kMost = 1000, kRound = 11;
        if (*contours_ == "round") {
            if (!(range.min < range.max)) return values;
            for (const detail::Tick& tick : detail::round_ticks(range.min, range.max, kRound)) {
                const double end = 1e-3 * (range.max - range.min);  // lines there would be a few pixels at most
                if (tick.value > range.min + end && tick.value < range.max - end) values.push_back(tick.value);
            }
            return values;
        }
        if (!contours_->empty() && std::ranges::all_of(*contours_, [](char c) { return c >= '0' && c <= '9'; })) {
            const double count = parse_number("--contours", *contours_);
            if (!(count >= 1 && count <= kMost)) {
                throw Error(ErrorCode::InvalidInput, text("\"", *contours_, "\" is not a number of lines from 1 to ", kMost),
                            "--contours", text(*contours_, ",: one line at that value"));
            }
            for (int c = 0; c < static_cast<int>(count); ++c)
                values.push_back(range.min + (range.max - range.min) * (c + 1) / (count + 1));
            return values;
        }
        const ValueRange whole{.min = range.min, .max = range.max};
        for (std::size_t begin = 0; begin < contours_->size();) {
            const std::size_t end = std::min(contours_->find(',', begin), contours_->size());
            values.push_back(parse_value(contours_->substr(begin, end - begin), whole, "--contours"));
            begin = end + 1;
        }
        if (values.empty() || values.size() > kMost) {
            throw Error(ErrorCode::InvalidInput, "takes a number of lines, values with commas between them, or round",
                        "--contours", "10, or 300,350,400");
        }
        return values;
    }

    /// Says which lines no place of the plane is on.
    static void warn_of_empty_lines(const std::vector<double>& values, const LimitSlice& slice, Report& report) {
        std::string list;
        for (const double value : values) {
            if (!(value >= slice.min && value <= slice.max)) list += (list.empty() ? "" : ", ") + detail::number_text(value, 6);
        }
        if (!list.empty())
            report.warn(text("no place of the plane has the value of --contours ", list, ": they are from ", slice.min, " to ",
                             slice.max));
    }

    /// throws: Error(InvalidInput) if something is to be drawn into a file that is not a picture
    void check_notes() const {
        if (contour_labels_ && !contours_)
            throw Error(ErrorCode::InvalidInput, "has no lines to label", "--contour-labels", "--contours N");
        if (!output_.ends_with(".vtp") && !output_.ends_with(".csv")) return;
        for (const auto& [given, name] : {std::pair{contour_labels_, "--contour-labels"},
                                          {axes_, "--axes"},
                                          {extremes_, "--extremes"},
                                          {!title_.empty(), "--title"}}) {
            if (given) throw Error(ErrorCode::InvalidInput, "is drawn into pictures", name, "-o NAME.png, .svg, .pdf or .exr");
        }
    }

    std::string input_, output_, plane_, function_ = "viridis", background_ = "white", unit_, known_unit_;
    std::optional<std::string> range_;
    SliceFigures limit_figures_, file_;  // file_: of the cells as they were given
    SliceOptions options_;
    LookChoices choices_;  // the shape of the colours alone
    std::optional<std::string> contours_;
    std::string title_;
    bool no_legend_ = false, axes_ = false, extremes_ = false, contour_labels_ = false;
    RefineArguments scheme_;
};

}  // namespace

std::unique_ptr<Verb> make_slice_verb(CLI::App& program) {
    return std::make_unique<SliceVerb>(program);
}

}  // namespace subvol::cli
