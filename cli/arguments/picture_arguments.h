// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/camera.h"
#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/legend.h"
#include "subvol/optics.h"
#include "subvol/overlay.h"
#include "subvol/picture_look.h"
#include "subvol/view_options.h"

namespace CLI {
class App;
}

namespace subvol::cli {

/// The range of a field's values.
using Range = ValueRange;

/// A field with the range of its values, and its unit where that is known.
struct ShownField {
    std::string name;
    Range range;
    std::string unit = {};
    std::vector<double> categories = {};  // the different values of integers; none: others, or too many
};

/// The box of the points that are not transparent; the pawn, for example, fills only a small part of its block.
[[nodiscard]] Box visible_bounds(const HexMesh& mesh, const Optics& optics);

/// What a picture shows and how.
struct PictureArguments {
    ViewOptions eye;
    std::optional<std::string> views;  // a sheet: "4" (front, side, top and iso), or the views' names
    int frames_per_second = 30;
    std::optional<double> duration_s;  // of a video, instead
    LookChoices choices;
    Look look = Look::Volume;                  // as settled
    std::optional<std::string> legend;         // the file; empty: inside the picture
    int legend_px = 0;                         // the columns or rows of a legend inside the picture, as settled
    int caption_px = 0;                        // the rows above the body for the title and the time, as settled
    LegendStyle legend_style;                  // without its ink
    std::optional<std::string> legend_format;  // of its ticks; else as many digits as they need
    std::string unit;                          // of the field that the legend shows
    std::string legend_note;                   // what the legend says besides, as settled
    std::vector<std::string> legend_names;     // of the values 1, 2, …, as settled; empty: the legend has a colour bar
    std::string title;                         // above the body
    bool time_label = false;                   // the time of the step below it
    bool axes = false, edges = false, scale_bar = false, extremes = false;
    std::optional<std::string> background;

    void add_to(CLI::App& app);
    /// Only these options, such as "--camera".
    void add_some_to(CLI::App& app, std::initializer_list<std::string_view> names);

    /// Decides on the look, as `chosen_look`.
    void settle_look(bool has_boundary);
    /// throws: Error(InvalidInput) for isosurfaces, of which kernels of the body of a level set have none
    void refuse_isosurfaces_of_level_set() const;
    [[nodiscard]] bool lit() const { return is_lit(look); }
    [[nodiscard]] Vec3 background_color() const;
    /// Whether nothing is behind the picture.
    [[nodiscard]] bool transparent() const { return background == "none"; }
    /// The names of the views of a sheet.
    [[nodiscard]] std::vector<std::string> sheet_views() const;
    /// The pictures of a sheet side by side, and one below the other.
    [[nodiscard]] int sheet_columns() const;
    [[nodiscard]] int sheet_rows() const;

    /// One view, or those of the turntable, or those of a sheet, each a part of the picture. points: a named
    /// view is fitted to them; none: to the box
    [[nodiscard]] std::vector<View> make_views(const Box& box, std::span<const Vec3> points = {}) const;
    /// field: the range of the field that gives the opacities
    [[nodiscard]] LookOptions look_options(const Range& field) const {
        return subvol::look_options(choices, look, field, OptionNames::Flags);
    }
    /// field, colors: the ranges of the field that gives the opacities and of the one that gives the colours, often the same
    [[nodiscard]] Optics make_optics(const Box& box, const Range& field, const Range& colors) const;

    /// Checks before any work is done what can be checked without a mesh: size, camera, colour map, --legend.
    ///
    /// throws: Error(InvalidInput)
    void check() const;

    [[nodiscard]] bool legend_inside() const { return legend && legend->empty(); }
    /// The legend of what is shown: titles and ranges.
    [[nodiscard]] LegendOptions legend_options(const ShownField& field, const ShownField& colors) const;
    /// Writes the --legend into its file, if it has one.
    [[nodiscard]] Facts write_legend(const Optics& optics, const LegendOptions& options) const;

private:
    /// The size without the legend.
    [[nodiscard]] PictureSize size_of_body() const;
    void add_camera_to(CLI::App& app);
    void add_light_to(CLI::App& app);
    [[nodiscard]] std::vector<View> make_sheet(const Box& box, std::span<const Vec3> points) const;
};

}  // namespace subvol::cli
