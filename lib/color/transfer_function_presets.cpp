// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <span>
#include <utility>

#include "curves.h"
#include "knot_values.h"
#include "subvol/error.h"
#include "subvol/srgb.h"
#include "subvol/transfer_function.h"

namespace subvol {

using namespace detail;
namespace {

using Rgb = std::array<double, 3>;
using ColorKnots = std::vector<TransferFunction::ColorKnot>;

struct Entry {
    int index;
    Rgb rgb;
};

// sRGB. N. J. Smith, S. van der Walt, E. Firing, matplotlib 2.0 (CC0). Of its 256 entries, these are enough for straight lines
// in linear light to be right to 1/512.
constexpr std::array<Entry, 31> kViridis{{
    {0, {0.267004, 0.004874, 0.329415}},   {7, {0.276022, 0.044167, 0.370164}},   {14, {0.281446, 0.084320, 0.407414}},
    {22, {0.283187, 0.125848, 0.444960}},  {32, {0.278826, 0.175490, 0.483397}},  {44, {0.265145, 0.232956, 0.516599}},
    {59, {0.239346, 0.300855, 0.540844}},  {78, {0.203063, 0.379716, 0.553925}},  {100, {0.166617, 0.463708, 0.558119}},
    {121, {0.136408, 0.541173, 0.554483}}, {136, {0.120565, 0.596422, 0.543611}}, {145, {0.121380, 0.629492, 0.531973}},
    {153, {0.134692, 0.658636, 0.517649}}, {160, {0.157851, 0.683765, 0.501686}}, {166, {0.185783, 0.704891, 0.485273}},
    {172, {0.220124, 0.725509, 0.466226}}, {178, {0.259857, 0.745492, 0.444467}}, {184, {0.304148, 0.764704, 0.419943}},
    {190, {0.352360, 0.783011, 0.392636}}, {196, {0.404001, 0.800275, 0.362552}}, {203, {0.468053, 0.818921, 0.323998}},
    {210, {0.535621, 0.835785, 0.281908}}, {217, {0.606045, 0.850733, 0.236712}}, {224, {0.678489, 0.863742, 0.189503}},
    {230, {0.741388, 0.873449, 0.149561}}, {235, {0.793760, 0.880678, 0.120005}}, {239, {0.835270, 0.886029, 0.102646}},
    {243, {0.876168, 0.891125, 0.095250}}, {247, {0.916242, 0.896091, 0.100717}}, {251, {0.955300, 0.901065, 0.118128}},
    {255, {0.993248, 0.906157, 0.143936}},
}};

// sRGB at parts of the range. coolwarm: K. Moreland, "Diverging Color Maps for Scientific Visualization", ISVC 2009. bone:
// MATLAB's (7 grey + reversed hot) / 8. xray: ParaView's X Ray.
struct Stop {
    double part;
    Rgb rgb;
};
constexpr std::array<Stop, 3> kCoolwarm{
    {{0, {59 / 255.0, 76 / 255.0, 192 / 255.0}}, {0.5, {.865, .865, .865}}, {1, {180 / 255.0, 4 / 255.0, 38 / 255.0}}}};
constexpr std::array<Stop, 2> kGrey{{{0, {0, 0, 0}}, {1, {1, 1, 1}}}};
constexpr std::array<Stop, 4> kBone{{{0, {0, 0, 0}},
                                     {23 / 63.0, {23 / 72.0, 23 / 72.0, 32 / 72.0}},
                                     {47 / 63.0, {47 / 72.0, 56 / 72.0, 56 / 72.0}},
                                     {1, {1, 1, 1}}}};
constexpr std::array<Stop, 2> kXray{{{0, {1, 1, 1}}, {1, {0, 0, 0}}}};
constexpr std::array<Rgb, 3> kIvory{{{.80, .62, .40}, {.95, .86, .70}, {1, .97, .90}}};

constexpr const char* kPresets = "viridis, coolwarm, grey, bone, xray, isosurface, surface, constant";
constexpr double kDefaultOpacity = 0.5;
constexpr double kSurfaceOpacity = 0.9;
constexpr double kSurfaceRamp = 0.05;  // of the range
constexpr int kIsosurfaces = 5;
constexpr double kIsosurfaceHalfWidth = 0.01;  // of the range

Vec3 vector(const Rgb& rgb) {
    return {rgb[0], rgb[1], rgb[2]};
}

ColorKnots viridis(ValueRange range) {
    ColorKnots knots;
    for (const auto& [index, rgb] : kViridis) knots.push_back({range.at(index / 255.0), linear_from_srgb(vector(rgb))});
    return knots;
}

ColorKnots spread(std::span<const Stop> stops, ColorSpace space, ValueRange range) {
    ColorKnots knots;
    for (const auto& [part, rgb] : stops) knots.push_back({range.at(part), vector(rgb)});
    return straight_pieces(knots, space);
}

TransferFunction ramp(ColorKnots color, ValueRange range) {
    return {std::move(color), {{range.min, 0}, {range.max, kDefaultOpacity}}};
}

TransferFunction isosurfaces(ValueRange range) {
    TransferFunction function{viridis(range), {}};
    for (int i = 0; i < kIsosurfaces; ++i) {
        const double part = (i + 0.5) / kIsosurfaces;
        function.opacity.push_back({range.at(part - kIsosurfaceHalfWidth), 0});
        function.opacity.push_back({range.at(part), kSurfaceOpacity});
        function.opacity.push_back({range.at(part + kIsosurfaceHalfWidth), 0});
    }
    return function;
}

TransferFunction surface(ValueRange range) {
    const double width = range.max - range.min, end = range.max > 0 ? range.max : width;
    TransferFunction function{{}, {{0, 0}, {kSurfaceRamp * width, kSurfaceOpacity}}};
    for (std::size_t i = 0; i < kIvory.size(); ++i) {
        function.color.push_back({0.5 * static_cast<double>(i) * end, linear_from_srgb(vector(kIvory[i]))});
    }
    return function;
}

TransferFunction constant(ValueRange range) {
    return {{{range.min, Vec3(1)}, {range.max, Vec3(1)}}, {{range.min, kDefaultOpacity}, {range.max, kDefaultOpacity}}};
}

}  // namespace

TransferFunction transfer_function_preset(const std::string& name, double min, double max) {
    const ValueRange range = usable_range(min, max);
    if (name == "viridis") return ramp(viridis(range), range);
    if (name == "coolwarm") return ramp(spread(kCoolwarm, ColorSpace::Diverging, range), range);
    if (name == "grey") return ramp(spread(kGrey, ColorSpace::Rgb, range), range);
    if (name == "bone") return ramp(spread(kBone, ColorSpace::Rgb, range), range);
    if (name == "xray") return ramp(spread(kXray, ColorSpace::Rgb, range), range);
    if (name == "isosurface") return isosurfaces(range);
    if (name == "surface") return surface(range);
    if (name == "constant") return constant(range);
    throw Error(ErrorCode::InvalidInput, "there is no transfer function '" + name + "'", {}, kPresets);
}

}  // namespace subvol
