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
};

/// The box of the points that are not transparent; the pawn, for example, fills only a small part of its block.
[[nodiscard]] Box visible_bounds(const HexMesh& mesh, const Optics& optics);

/// The colour behind a picture, in linear light: "r,g,b" in 0..1, "#rrggbb" (sRGB), or a name.
///
/// throws: Error(InvalidInput)
[[nodiscard]] Vec3 parse_background(const std::string& text);

/// What a picture shows and how.
struct PictureArguments {
    ViewOptions eye;
    std::optional<int> views;  // 4: a sheet of front, side, top and iso
    int frames_per_second = 30;
    LookChoices choices;
    Look look = Look::Volume;               // as settled
    std::optional<std::string> legend;      // the file; empty: inside the picture
    int legend_px = 0;                      // the width of a legend inside the picture, as settled
    std::string unit;                       // of the field that the legend shows
    std::string legend_note;                // what the legend says besides, as settled
    std::vector<std::string> legend_names;  // of the values 1, 2, …, as settled; empty: the legend has a colour bar
    std::string title;                      // above the picture
    bool time_label = false;                // the time of the step below it
    bool axes = false, edges = false;
    std::optional<std::string> background;

    void add_to(CLI::App& app);
    /// Only these options, such as "--camera".
    void add_some_to(CLI::App& app, std::initializer_list<std::string_view> names);

    /// Decides on the look, as `chosen_look`.
    void settle_look(bool has_boundary);
    [[nodiscard]] bool lit() const { return is_lit(look); }
    [[nodiscard]] Vec3 background_color() const;

    /// One view, or those of the turntable, or the four of a sheet, each a quarter of the picture. points: a
    /// named view is fitted to them; none: to the box
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
    void add_camera_to(CLI::App& app);
    void add_light_to(CLI::App& app);
    [[nodiscard]] std::vector<View> make_sheet(const Box& box, std::span<const Vec3> points, int width, int height) const;
};

}  // namespace subvol::cli
