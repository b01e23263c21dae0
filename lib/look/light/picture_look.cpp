// SPDX-License-Identifier: Apache-2.0
// From what a user chooses to the optics of a picture: a transfer function and the distance, in world units, that its opacities
// are for.
//
//     choices ──► look ──► options, with values and per cents of the field's range as numbers ──► optics
//
// The optics are made in this order, and each step may replace what came before: the colour map, with opacities over the range
// of the one field and colours over that of the other, unless a range was chosen; its scale, its bands and the colours beyond
// it; what the look demands (a solid is opaque, an x-ray of a body without a field has one opacity); opacities that were asked
// for; at last, values beyond the range that look like its ends.
//
// Unless the body is solid, a camera frames the cells that can be seen: those in which the opacity is somewhere more than a
// fiftieth of the largest. If their box is nearly as large as that of the whole, the whole is framed.
#include "subvol/picture_look.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <span>

#include "subvol/clamped.h"
#include "subvol/color_name.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "subvol/srgb.h"

namespace subvol {

namespace {

constexpr double kIsosurfaceHalfWidth = 0.01, kIsosurfaceOpacity = 0.9;  // the width as a part of the range
constexpr double kOpacityUnitsPerDiagonal = 100;
constexpr double kXrayOpacity = 0.5, kXrayUnitsPerDiagonal = 4;  // of a body without a field: one sees how thick it is
constexpr double kFaint = 0.02;                                  // of the largest opacity: what has less is not framed
constexpr double kAlmostWhole = 0.8;                             // of the box's diagonal
constexpr double kSolidUnitsPerDiagonal = 1e6;                   // all light ends far within a pixel
const Vec3 kPlainColor(0.72, 0.76, 0.82);                        // of a body without a field, sRGB

/// The largest opacity of the values from low to high.
double largest_alpha(const TransferFunction& function, double low, double high) {
    double largest = std::max(alpha_at(function, low), alpha_at(function, high));
    for (const auto& knot : function.opacity) {
        if (knot.value > low && knot.value < high) largest = std::max(largest, knot.alpha);
    }
    return largest;
}

/// The cells that can be seen: more opaque somewhere than a part of the largest opacity.
class SeenCells {
public:
    explicit SeenCells(const TransferFunction& function) : function_(function) {
        for (const auto& knot : function.opacity) faint_ = std::max(faint_, kFaint * knot.alpha);
    }

    /// Adds the corners of those of a mesh. owned: a flag for each cell; none: all are looked at
    void add(const HexMesh& mesh, std::span<const std::uint8_t> owned, std::vector<Vec3>& points) const {
        const std::vector<double>& values = mesh.attributes[0].values;
        std::vector<std::uint8_t> seen(mesh.points.size());
        for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
            if (!owned.empty() && owned[c] == 0) continue;
            const auto& cell = mesh.cells[c];
            double low = values[cell[0]], high = low;
            for (const Index corner : cell) {
                low = std::min(low, values[corner]);
                high = std::max(high, values[corner]);
            }
            if (largest_alpha(function_, low, high) <= faint_) continue;
            for (const Index corner : cell) seen[corner] = 1;
        }
        for (std::size_t p = 0; p < seen.size(); ++p) {
            if (seen[p]) points.push_back(mesh.points[p]);
        }
    }

private:
    const TransferFunction& function_;
    double faint_ = 0;
};

}  // namespace

Vec3 background_of(Look look) {
    if (look == Look::Volume) return Vec3(0.0);
    return look == Look::Xray ? Vec3(1.0) : linear_from_srgb(Vec3(0xe4, 0xe6, 0xe9) / 255.0);
}

double opacity_unit_of(Look look, const Box& box) {
    return box.diagonal() / (look == Look::Solid ? kSolidUnitsPerDiagonal : kOpacityUnitsPerDiagonal);
}

void make_solid(TransferFunction& function, bool plain) {
    for (auto& knot : function.opacity) knot.alpha = 1;
    if (!plain) return;
    for (auto& knot : function.color) knot.rgb = linear_from_srgb(kPlainColor);
}

TransferFunction find_transfer_function(const std::string& name, const ValueRange& range, bool stretch) {
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

std::vector<Option> options_of(LookChoices& choices) {
    return {
        Option("look", choices.look)
            .offer(names_of<Look>())
            .help(
                "NAME",
                "solid (opaque and lit; the default for meshes without --opacity and --opacity-unit), volume (opacity 0 to .5 "
                "over the range, black behind; otherwise the default), xray (on white) or isosurface "
                "(five lit surfaces)"),
        Option("tf", choices.colors)
            .offer(transfer_function_names())
            .help(
                "FILE|NAME",
                "colour map over the field's range: viridis (default), plasma, inferno, cividis, turbo, coolwarm, jet, "
                "rainbow, desaturated, blackbody, grey, bone, xray, isosurface, surface, constant or categories (integers); or "
                "a ParaView colour-map JSON file (FILE.json:NAME for one of several in it)"),
        Option("opacity-unit", choices.opacity_unit_world)
            .positive()
            .help("D",
                  "the world distance over which an opacity acts (default: 1/100 of the bounding box's diagonal; 1/4 for xray "
                  "of a body without a field)"),
        Option("clamp", choices.clamp)
            .help("show values beyond the field's range, where interpolating schemes overshoot, as its ends"),
        Option("range", choices.range)
            .also("tf-range")
            .help("MIN,MAX|field",
                  "the range that the colour map and the percentages of --opacity cover: MIN,MAX, per cents of the field's "
                  "range such as 10%,90%, or field (default: the field's range; a map from a file keeps its own values)"),
        Option("opacity", choices.opacity)
            .help("V:A,V:A,…",
                  "opacities instead of those of --tf, linear in between: at values of the field or per cent of its range, "
                  "such as 0%:0,50%:.2,100%:.9; of a solid: of its surface"),
        Option("iso", WordValue{[&choices] { return choices.iso; },
                                [&choices](const std::string& word, const std::string& where) {
                                    if (word.empty()) {
                                        throw Error(ErrorCode::InvalidInput, "no value is given", where,
                                                    "values such as .3,.5");
                                    }
                                    choices.iso = word;
                                },
                                true})
            .help(
                "V,…",
                "lit surfaces of these values, or per cents of the field's range: --look isosurface with these instead of its "
                "five")
            .instead_of({"opacity"}),
        Option("log", choices.log).help("spread the colour map by the logarithm of the values, which are above 0"),
        Option("symlog", choices.symlog)
            .positive()
            .help("C", "spread the colour map logarithmically on both sides of 0, linearly within C")
            .not_with("log"),
        Option("bands", choices.bands).between(1, kMostBands).help("N", "cut the colour map into N colours"),
        Option("below", choices.below)
            .help("COLOR", "the colour of values below the range: #rrggbb, three numbers or a name (default: that of its end)"),
        Option("above", choices.above).help("COLOR", "the colour of values above the range (default: that of its end)")};
}

ColorShape color_shape(const LookChoices& choices, OptionNames names) {
    ColorShape shape{
        .scale = {.logarithmic = choices.log, .linear_within = choices.symlog.value_or(0), .where = option_name("log", names)},
        .bands = choices.bands.value_or(0)};
    if (choices.below) shape.below = parse_color(*choices.below, option_name("below", names));
    if (choices.above) shape.above = parse_color(*choices.above, option_name("above", names));
    return shape;
}

Look chosen_look(const LookChoices& choices, bool has_boundary, OptionNames names) {
    if (choices.look) {
        const auto look = named<Look>(*choices.look, option_name("look", names));
        if (choices.iso.empty() || look == Look::Isosurface) return look;
        throw Error(ErrorCode::InvalidInput, "draws isosurfaces", option_name("iso", names), "without another look");
    }
    if (!choices.iso.empty()) return Look::Isosurface;
    const bool transparent = choices.opacity || choices.opacity_unit_world;
    return has_boundary && !transparent ? Look::Solid : Look::Volume;
}

double parse_value(const std::string& text, const ValueRange& whole, const std::string& where) {
    const bool part = text.ends_with('%');
    double value = 0;
    Option("value", value).read(part ? text.substr(0, text.size() - 1) : text, where);
    return part ? whole.min + value / 100 * (whole.max - whole.min) : value;
}

std::vector<TransferFunction::OpacityKnot> opacity_of_isosurfaces(std::vector<double> values, const ValueRange& range) {
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
    const double half = range.min < range.max ? kIsosurfaceHalfWidth * (range.max - range.min) : kIsosurfaceHalfWidth;
    std::vector<TransferFunction::OpacityKnot> knots;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const double before = i > 0 ? std::min(half, 0.4 * (values[i] - values[i - 1])) : half;
        const double after = i + 1 < values.size() ? std::min(half, 0.4 * (values[i + 1] - values[i])) : half;
        knots.push_back({values[i] - before, 0});
        knots.push_back({values[i], kIsosurfaceOpacity});
        knots.push_back({values[i] + after, 0});
    }
    return knots;
}

ValueRange parse_range(const std::string& text, const ValueRange& whole, const std::string& where) {
    const char* const allowed = "MIN,MAX, or per cents such as 10%,90%";
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) throw Error(ErrorCode::InvalidInput, "'" + text + "' is not a range", where, allowed);
    const ValueRange range{parse_value(text.substr(0, comma), whole, where), parse_value(text.substr(comma + 1), whole, where)};
    if (!(range.min < range.max)) throw Error(ErrorCode::InvalidInput, "'" + text + "' is not ascending", where, allowed);
    return range;
}

ValueRange shown_range(const LookChoices& choices, const ValueRange& field, OptionNames names) {
    if (!choices.range || *choices.range == "field") return field;
    return parse_range(*choices.range, field, option_name("range", names));
}

LookOptions look_options(const LookChoices& choices, Look look, const ValueRange& field, OptionNames names) {
    LookOptions options{.look = look,
                        .colors = choices.colors.value_or(""),
                        .stretch = choices.range.has_value(),
                        .shape = color_shape(choices, names),
                        .opacity_unit_world = choices.opacity_unit_world,
                        .clamp = choices.clamp};
    const ValueRange range = shown_range(choices, field, names);
    if (choices.range && *choices.range != "field") options.range = range;
    if (!choices.iso.empty()) {
        std::vector<double> values;
        for (std::size_t begin = 0; begin <= choices.iso.size();) {
            const std::size_t end = std::min(choices.iso.find(',', begin), choices.iso.size());
            values.push_back(parse_value(choices.iso.substr(begin, end - begin), range, option_name("iso", names)));
            begin = end + 1;
        }
        options.opacity = opacity_of_isosurfaces(std::move(values), range);
    }
    if (!choices.opacity) return options;
    try {
        options.opacity = parse_opacity(*choices.opacity, range.min, range.max);
    } catch (const Error& error) {
        throw Error(error.code(), error.where() + ": " + error.message(), option_name("opacity", names), error.allowed());
    }
    return options;
}

std::string colors_of(const LookOptions& options) {
    if (!options.colors.empty()) return options.colors;
    return options.look == Look::Xray ? "xray" : options.look == Look::Isosurface ? "isosurface" : "viridis";
}

Optics picture_optics(const LookOptions& options, const Box& box, const ValueRange& field, const ValueRange& colors) {
    const std::string map = colors_of(options);
    TransferFunction function = find_transfer_function(map, options.range.value_or(field), options.stretch);
    function.color = find_transfer_function(map, options.range.value_or(colors), options.stretch).color;
    return picture_optics(std::move(function), options, box, field, colors, options.colors.empty());
}

Optics picture_optics(TransferFunction function, const LookOptions& options, const Box& box, const ValueRange& field,
                      const ValueRange& colors, bool plain) {
    function = shaped(function, options.shape);
    if (options.look == Look::Solid) make_solid(function, plain && !(colors.min < colors.max));
    const bool shadow = options.look == Look::Xray && !(field.min < field.max);
    if (shadow) {
        for (auto& knot : function.opacity) knot.alpha = kXrayOpacity;
        const Vec3 darkest = function.color.back().rgb;
        for (auto& knot : function.color) knot.rgb = plain ? darkest : knot.rgb;
    }
    if (!options.opacity.empty()) function.opacity = options.opacity;
    if (options.clamp || field.bounded || colors.bounded) {
        TransferFunction kept = function;
        if (options.clamp || field.bounded) kept.opacity = clamped(function, field.min, field.max).opacity;
        if (options.clamp || colors.bounded) kept.color = clamped(function, colors.min, colors.max).color;
        function = std::move(kept);
    }
    const double unit = shadow ? box.diagonal() / kXrayUnitsPerDiagonal : opacity_unit_of(options.look, box);
    return {std::move(function), options.opacity_unit_world.value_or(unit)};
}

std::vector<Vec3> framed_points(const MeshSource& source, Look look, const Optics& optics, Progress* progress) {
    const HexMesh* const whole = source.mesh();
    if (whole != nullptr && (look == Look::Solid || whole->cells.empty())) return whole->points;
    if (look == Look::Solid) return {};
    const SeenCells seen(optics.function());
    std::vector<Vec3> points;
    if (whole != nullptr) {
        seen.add(*whole, {}, points);
    } else {
        for_each_piece(source.stored(), "frame", progress,
                       [&](std::size_t, const MeshPiece& piece) { seen.add(piece.mesh, piece.owned_cells, points); });
    }
    Box part;
    for (const Vec3& p : points) part.add(p);
    // Almost the whole is framed as the whole, like a grid or kernels of it.
    if (points.empty() || part.diagonal() > kAlmostWhole * source.bounds().diagonal()) return {};
    return points;
}

}  // namespace subvol
