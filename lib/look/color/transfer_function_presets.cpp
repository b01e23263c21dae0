// SPDX-License-Identifier: Apache-2.0
// Transfer functions by name, over a range of values. A name is looked up in small letters, also by its aliases; each preset
// makes colour knots, in linear light, and opacity knots, both at values of the field:
//
//     entries of a table                       viridis
//     stops, mixed in a space of colours       coolwarm, grey, bone, jet, rainbow, desaturated, blackbody, xray
//     polynomials, sampled evenly              plasma, inferno, cividis, turbo
//     a colour for each integer                categories
//
// These get an opacity from 0 to one half over the range, but for categories, whose opacity is the same everywhere, as that of
// the white preset "constant" is. "isosurface" has viridis with five narrow peaks, and "surface" ivory with an opacity that
// rises steeply from the value 0 on. An unknown name is an error that lists the names, and says which one may be meant.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "curves.h"
#include "subvol/detail/knot_values.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/small_letters.h"
#include "subvol/error.h"
#include "subvol/srgb.h"
#include "subvol/transfer_function.h"

namespace subvol {

using namespace detail;
namespace {

using Rgb = std::array<double, 3>;
using ColorKnots = std::vector<TransferFunction::ColorKnot>;

struct TableColor {
    int index;
    Rgb rgb;
};

// sRGB. N. J. Smith, S. van der Walt, E. Firing, matplotlib 2.0 (CC0). Of its 256 entries, these are enough for straight lines
// in linear light to be right to 1/512.
constexpr std::array<TableColor, 31> kViridis{{
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
// jet, rainbow (blue to red by hue), desaturated and black body: ParaView's Jet, Blue to Red Rainbow, Rainbow Desaturated and
// Black-Body Radiation.
constexpr std::array<Stop, 7> kJet{{{0, {0, 0, .5625}},
                                    {.111111, {0, 0, 1}},
                                    {.365079, {0, 1, 1}},
                                    {.503175, {.5, 1, .5}},
                                    {.634921, {1, 1, 0}},
                                    {.888889, {1, 0, 0}},
                                    {1, {.5, 0, 0}}}};
constexpr std::array<Stop, 5> kRainbow{
    {{0, {0, 0, 1}}, {0.25, {0, 1, 1}}, {0.5, {0, 1, 0}}, {0.75, {1, 1, 0}}, {1, {1, 0, 0}}}};
constexpr std::array<Stop, 8> kDesaturated{{{0, {.278431, .278431, .858824}},
                                            {.143, {0, 0, .360784}},
                                            {.285, {0, 1, 1}},
                                            {.429, {0, .501961, 0}},
                                            {.571, {1, 1, 0}},
                                            {.714, {1, .380392, 0}},
                                            {.857, {.419608, 0, 0}},
                                            {1, {.878431, .301961, .301961}}}};
constexpr std::array<Stop, 4> kBlackBody{{{0, {0, 0, 0}}, {.4, {.901961, 0, 0}}, {.8, {.901961, .901961, 0}}, {1, {1, 1, 1}}}};
constexpr std::array<Stop, 2> kXray{{{0, {1, 1, 1}}, {1, {0, 0, 0}}}};
constexpr std::array<Rgb, 3> kIvory{{{.80, .62, .40}, {.95, .86, .70}, {1, .97, .90}}};

// sRGB as polynomials of the part of the range, coefficients from the highest power down. plasma, inferno: fits of matplotlib's
// maps (N. J. Smith, S. van der Walt, CC0) by M. Zucker (2019, CC0), right to 1/100. cividis: J. R. Nuñez, C. R. Anderton, R.
// S. Renslow, PLoS ONE 13 (2018); turbo: A. Mikhailov, Google (2019, Apache-2.0); both in the form that D3 uses, in 255ths.
using Polynomial = std::array<double, 7>;
using Polynomials = std::array<Polynomial, 3>;
constexpr Polynomials kPlasma{{{-3.658713842777788, 10.02306557647065, -11.10743619062271, 6.130348345893603,
                                -2.689460476458034, 2.176514634195958, 0.05873234392399702},
                               {-22.93153465461149, 71.41361770095349, -82.66631109428045, 42.3461881477227, -7.455851135738909,
                                0.2383834171260182, 0.02333670892565664},
                               {18.19190778539828, -54.07218655560067, 60.13984767418263, -28.51885465332158, 3.110799939717086,
                                0.7539604599784036, 0.5433401826748754}}};
constexpr Polynomials kInferno{{{25.13112622477341, -71.31942824499214, 77.162935699427, -41.70399613139459, 11.60249308247187,
                                 0.1065134194856116, 0.0002189403691192265},
                                {-12.24266895238567, 32.62606426397723, -33.40235894210092, 17.43639888205313,
                                 -3.972853965665698, 0.5639564367884091, 0.001651004631001012},
                                {-23.07032500287172, 73.20951985803202, -81.80730925738993, 44.35414519872813,
                                 -15.9423941062914, 3.932712388889277, -0.01948089843709184}}};
constexpr Polynomials kCividis{{{0, -2710.57 / 255, 7024.72 / 255, -6402.7 / 255, 2381.73 / 255, -35.34 / 255, -4.54 / 255},
                                {0, -67.37 / 255, 176.58 / 255, -131.46 / 255, 52.82 / 255, 170.73 / 255, 32.49 / 255},
                                {0, 2475.67 / 255, -6614.94 / 255, 6167.24 / 255, -2482.43 / 255, 442.36 / 255, 81.24 / 255}}};
constexpr Polynomials kTurbo{{{0, 14825.05 / 255, -38394.49 / 255, 33300.12 / 255, -10793.56 / 255, 1172.33 / 255, 34.61 / 255},
                              {0, 707.56 / 255, 1073.77 / 255, -3574.96 / 255, 1225.33 / 255, 557.33 / 255, 23.31 / 255},
                              {0, 6838.66 / 255, -22569.18 / 255, 27814.0 / 255, -15327.97 / 255, 3211.1 / 255, 27.2 / 255}}};
constexpr int kPolynomialKnots = 48;  // straight lines between so many are right to 1/255

// Tableau's ten colours, sRGB, for categories.
constexpr std::array<int, 10> kCategories{0x1f77b4, 0xff7f0e, 0x2ca02c, 0xd62728, 0x9467bd,
                                          0x8c564b, 0xe377c2, 0x7f7f7f, 0xbcbd22, 0x17becf};
constexpr double kMostCategories = 1000;

// What ParaView calls these maps, in small letters.
struct Alias {
    std::string_view name, preset;
};
constexpr std::array<Alias, 18> kAliases{{{"cool to warm", "coolwarm"},
                                          {"blue to red", "rainbow"},
                                          {"blue to red rainbow", "rainbow"},
                                          {"rainbow desaturated", "desaturated"},
                                          {"black-body radiation", "blackbody"},
                                          {"hot", "blackbody"},
                                          {"grayscale", "grey"},
                                          {"greyscale", "grey"},
                                          {"gray", "grey"},
                                          {"x ray", "xray"},
                                          {"viridis (matplotlib)", "viridis"},
                                          {"plasma (matplotlib)", "plasma"},
                                          {"inferno (matplotlib)", "inferno"},
                                          {"cividis (matplotlib)", "cividis"},
                                          {"bone_matlab", "bone"},
                                          {"jet (matlab)", "jet"},
                                          {"google turbo", "turbo"},
                                          {"categorical", "categories"}}};
constexpr double kDefaultOpacity = 0.5;
constexpr double kSurfaceOpacity = 0.9;
constexpr double kSurfaceRamp = 0.05;  // of the range
constexpr int kIsosurfaces = 5;
constexpr double kIsosurfaceHalfWidth = 0.01;  // of the range

Vec3 vector(const Rgb& rgb) {
    return {rgb[0], rgb[1], rgb[2]};
}

ColorKnots viridis(KnotRange range) {
    ColorKnots knots;
    for (const auto& [index, rgb] : kViridis) knots.push_back({range.at(index / 255.0), linear_from_srgb(vector(rgb))});
    return knots;
}

double value_of(const Polynomial& coefficients, double t) {
    double value = 0;
    for (const double c : coefficients) value = value * t + c;
    return std::clamp(value, 0.0, 1.0);
}

ColorKnots sampled(const Polynomials& rgb, KnotRange range) {
    ColorKnots knots;
    for (int i = 0; i <= kPolynomialKnots; ++i) {
        const double t = static_cast<double>(i) / kPolynomialKnots;
        knots.push_back({range.at(t), linear_from_srgb(Vec3(value_of(rgb[0], t), value_of(rgb[1], t), value_of(rgb[2], t)))});
    }
    return knots;
}

ColorKnots spread(std::span<const Stop> stops, ColorSpace space, KnotRange range) {
    ColorKnots knots;
    for (const auto& [part, rgb] : stops) knots.push_back({range.at(part), vector(rgb)});
    return straight_pieces(knots, space);
}

TransferFunction ramp(ColorKnots color, KnotRange range) {
    return {std::move(color), {{range.min, 0}, {range.max, kDefaultOpacity}}};
}

TransferFunction isosurfaces(KnotRange range) {
    TransferFunction function{viridis(range), {}};
    for (int i = 0; i < kIsosurfaces; ++i) {
        const double part = (i + 0.5) / kIsosurfaces;
        function.opacity.push_back({range.at(part - kIsosurfaceHalfWidth), 0});
        function.opacity.push_back({range.at(part), kSurfaceOpacity});
        function.opacity.push_back({range.at(part + kIsosurfaceHalfWidth), 0});
    }
    return function;
}

TransferFunction surface(KnotRange range) {
    const double width = range.max - range.min, end = range.max > 0 ? range.max : width;
    TransferFunction function{{}, {{0, 0}, {kSurfaceRamp * width, kSurfaceOpacity}}};
    for (std::size_t i = 0; i < kIvory.size(); ++i) {
        function.color.push_back({0.5 * static_cast<double>(i) * end, linear_from_srgb(vector(kIvory[i]))});
    }
    return function;
}

TransferFunction constant(KnotRange range) {
    return {{{range.min, Vec3(1)}, {range.max, Vec3(1)}}, {{range.min, kDefaultOpacity}, {range.max, kDefaultOpacity}}};
}

/// The colour of an integer. Each ten repeat those of the ten before, lighter, then darker.
Vec3 category_color(double number) {
    const auto index = static_cast<std::size_t>(std::fmod(std::fmod(number - 1, 30) + 30, 30));
    const int rgb = kCategories[index % kCategories.size()];
    const Vec3 color = Vec3(rgb >> 16, rgb >> 8 & 255, rgb & 255) / 255.0;
    const Vec3 toward(index < 20 ? 1.0 : 0.0);
    return linear_from_srgb(index < 10 ? color : (color + toward) / 2.0);
}

/// Another colour for each integer, from half below it to half above it.
TransferFunction categories(KnotRange range) {
    const double first = std::round(range.min), last = std::round(range.max);
    if (last - first >= kMostCategories) {
        throw Error(ErrorCode::InvalidInput, "categories: the range has too many integers", "transfer function",
                    "at most 1000");
    }
    TransferFunction function = constant(range);
    function.color.clear();
    for (double number = first; number <= last; ++number) {
        function.color.push_back({number - 0.5, category_color(number)});
        function.color.push_back({number + 0.5, category_color(number)});
    }
    part_equal_values(function.color);
    return function;
}

/// sequence: of colours alone, with the usual opacity
struct Preset {
    std::string_view name;
    bool sequence;
    TransferFunction (*make)(KnotRange);
};

template <const auto& kStops, ColorSpace kSpace>
TransferFunction through(KnotRange range) {
    return ramp(spread(kStops, kSpace, range), range);
}

template <const Polynomials& kCurves>
TransferFunction along(KnotRange range) {
    return ramp(sampled(kCurves, range), range);
}

constexpr std::array<Preset, 17> kPresets{{{"viridis", true, [](KnotRange range) { return ramp(viridis(range), range); }},
                                           {"plasma", true, along<kPlasma>},
                                           {"inferno", true, along<kInferno>},
                                           {"cividis", true, along<kCividis>},
                                           {"turbo", true, along<kTurbo>},
                                           {"coolwarm", true, through<kCoolwarm, ColorSpace::Diverging>},
                                           {"grey", true, through<kGrey, ColorSpace::Rgb>},
                                           {"bone", true, through<kBone, ColorSpace::Rgb>},
                                           {"jet", true, through<kJet, ColorSpace::Rgb>},
                                           {"rainbow", true, through<kRainbow, ColorSpace::Hsv>},
                                           {"desaturated", true, through<kDesaturated, ColorSpace::Rgb>},
                                           {"blackbody", true, through<kBlackBody, ColorSpace::Rgb>},
                                           {"xray", false, through<kXray, ColorSpace::Rgb>},
                                           {"isosurface", false, isosurfaces},
                                           {"surface", false, surface},
                                           {"constant", false, constant},
                                           {"categories", false, categories}}};

}  // namespace

std::vector<std::string> color_map_names() {
    std::vector<std::string> names;
    for (const Preset& preset : kPresets) {
        if (preset.sequence) names.emplace_back(preset.name);
    }
    return names;
}

std::vector<std::string> transfer_function_names() {
    std::vector<std::string> names;
    for (const Preset& preset : kPresets) names.emplace_back(preset.name);
    return names;
}

TransferFunction transfer_function_preset(const std::string& given, double min, double max) {
    const KnotRange range = usable_range(min, max);
    std::string name = detail::small_letters(given);
    const auto alias = std::ranges::find(kAliases, name, &Alias::name);
    if (alias != kAliases.end()) name = alias->preset;
    const auto preset = std::ranges::find(kPresets, name, &Preset::name);
    if (preset != kPresets.end()) return preset->make(range);
    const std::vector<std::string> names = transfer_function_names();
    std::string list;
    for (const std::string& known : names) list += (list.empty() ? "" : ", ") + known;
    throw Error(ErrorCode::InvalidInput, "there is no transfer function '" + given + "'" + detail::did_you_mean(given, names),
                {}, list);
}

}  // namespace subvol
