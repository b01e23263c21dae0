// SPDX-License-Identifier: Apache-2.0
#include "subvol/picture_look.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>

#include "subvol/clamped.h"
#include "subvol/srgb.h"

namespace subvol {

namespace {

constexpr double kOpacityUnitsPerDiagonal = 100;
constexpr double kFaint = 0.02;                 // of the largest opacity: what has less is not framed
constexpr double kAlmostWhole = 0.8;            // of the box's diagonal
constexpr double kSolidUnitsPerDiagonal = 1e6;  // all light ends far within a pixel
const Vec3 kPlainColor(0.72, 0.76, 0.82);       // of a body without a field, sRGB

/// The largest opacity of the values from low to high.
double largest_alpha(const TransferFunction& function, double low, double high) {
    double largest = std::max(alpha_at(function, low), alpha_at(function, high));
    for (const auto& knot : function.opacity) {
        if (knot.value > low && knot.value < high) largest = std::max(largest, knot.alpha);
    }
    return largest;
}

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

std::vector<Option> options_of(LookOptions& options) {
    return {Option("look", options.look)
                .help("NAME",
                      "solid (opaque and lit; the default for meshes without --tf, --opacity and --opacity-unit), volume "
                      "(opacity 0 to .5 over the range, black behind; otherwise the default), xray (on white) or isosurface "
                      "(five lit surfaces)"),
            Option("tf", options.colors)
                .offer({"viridis", "plasma", "inferno", "cividis", "turbo", "coolwarm", "grey", "bone", "xray", "isosurface",
                        "surface", "constant"})
                .help("FILE|NAME",
                      "colour map: viridis (default), plasma, inferno, cividis, turbo, coolwarm, grey, bone, xray, isosurface, "
                      "surface or constant over the field's range, or a ParaView colour-map JSON file (FILE.json:NAME for one "
                      "of several in it)"),
            Option("opacity-unit", options.opacity_unit_world)
                .positive()
                .help("D", "the world distance over which an opacity acts (default: 1/100 of the bounding box's diagonal)"),
            Option("clamp", options.clamp)
                .help("show values beyond the field's range, where interpolating schemes overshoot, as its ends")};
}

std::string colors_of(const LookOptions& options) {
    if (!options.colors.empty()) return options.colors;
    return options.look == Look::Xray ? "xray" : options.look == Look::Isosurface ? "isosurface" : "viridis";
}

Optics picture_optics(const LookOptions& options, const Box& box, const ValueRange& field, const ValueRange& colors) {
    const std::string map = colors_of(options);
    TransferFunction function = find_transfer_function(map, options.range.value_or(field), options.stretch);
    function.color = find_transfer_function(map, options.range.value_or(colors), options.stretch).color;
    if (options.look == Look::Solid) make_solid(function, !(colors.min < colors.max) && options.colors.empty());
    if (!options.opacity.empty()) function.opacity = options.opacity;
    if (options.clamp || field.bounded || colors.bounded) {
        TransferFunction kept = function;
        if (options.clamp || field.bounded) kept.opacity = clamped(function, field.min, field.max).opacity;
        if (options.clamp || colors.bounded) kept.color = clamped(function, colors.min, colors.max).color;
        function = std::move(kept);
    }
    return {std::move(function), options.opacity_unit_world.value_or(opacity_unit_of(options.look, box))};
}

std::vector<Vec3> framed_points(const HexMesh& mesh, Look look, const Optics& optics) {
    if (look == Look::Solid) return mesh.points;
    const TransferFunction& function = optics.function();
    double most = 0;
    for (const auto& knot : function.opacity) most = std::max(most, knot.alpha);
    const std::vector<double>& values = mesh.attributes[0].values;
    std::vector<std::uint8_t> seen(mesh.points.size());
    for (const auto& cell : mesh.cells) {
        double low = values[cell[0]], high = low;
        for (const Index corner : cell) {
            low = std::min(low, values[corner]);
            high = std::max(high, values[corner]);
        }
        if (largest_alpha(function, low, high) <= kFaint * most) continue;
        for (const Index corner : cell) seen[corner] = 1;
    }
    std::vector<Vec3> points;
    Box part;
    for (std::size_t p = 0; p < seen.size(); ++p) {
        if (!seen[p]) continue;
        points.push_back(mesh.points[p]);
        part.add(mesh.points[p]);
    }
    // Almost the whole is framed as the whole, like a grid or kernels of it.
    if (points.empty() || part.diagonal() > kAlmostWhole * bounds(mesh).diagonal()) return {};
    return points;
}

}  // namespace subvol
