#include "subvol/transfer_function.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "subvol/error.h"
#include "subvol/srgb.h"

namespace subvol {
namespace {

using Rgb = std::array<double, 3>;

// sRGB, equally spaced over the range. viridis: N. J. Smith, S. van der Walt, E. Firing, matplotlib 2.0 (CC0), every 16th of
// its 256 entries.
constexpr std::array<Rgb, 17> kViridis{{{0.267004, 0.004874, 0.329415},
                                        {0.282327, 0.094955, 0.417331},
                                        {0.278826, 0.175490, 0.483397},
                                        {0.258965, 0.251537, 0.524736},
                                        {0.229739, 0.322361, 0.545706},
                                        {0.199430, 0.387607, 0.554642},
                                        {0.172719, 0.448791, 0.557885},
                                        {0.149039, 0.508051, 0.557250},
                                        {0.127568, 0.566949, 0.550556},
                                        {0.120638, 0.625828, 0.533488},
                                        {0.157851, 0.683765, 0.501686},
                                        {0.246070, 0.738910, 0.452024},
                                        {0.369214, 0.788888, 0.382914},
                                        {0.515992, 0.831158, 0.294279},
                                        {0.678489, 0.863742, 0.189503},
                                        {0.845561, 0.887322, 0.099702},
                                        {0.993248, 0.906157, 0.143936}}};

// K. Moreland, "Diverging Color Maps for Scientific Visualization", ISVC 2009: every other entry of its 33 (bytes).
constexpr std::array<Rgb, 17> kCoolwarmBytes{{{59, 76, 192},
                                              {77, 104, 215},
                                              {98, 130, 234},
                                              {119, 154, 247},
                                              {141, 176, 254},
                                              {163, 194, 255},
                                              {184, 208, 249},
                                              {204, 217, 238},
                                              {221, 221, 221},
                                              {236, 211, 197},
                                              {245, 196, 173},
                                              {247, 177, 148},
                                              {244, 154, 123},
                                              {236, 127, 99},
                                              {222, 96, 77},
                                              {203, 62, 56},
                                              {180, 4, 38}}};

constexpr std::array<Rgb, 9> kGrey{{{0, 0, 0},
                                    {.125, .125, .125},
                                    {.25, .25, .25},
                                    {.375, .375, .375},
                                    {.5, .5, .5},
                                    {.625, .625, .625},
                                    {.75, .75, .75},
                                    {.875, .875, .875},
                                    {1, 1, 1}}};

constexpr std::array<Rgb, 3> kIvory{{{.80, .62, .40}, {.95, .86, .70}, {1, .97, .90}}};

constexpr const char* kPresets = "viridis, coolwarm, grey, surface, constant";
constexpr double kDefaultOpacity = 0.5;
constexpr double kSurfaceOpacity = 0.9;
constexpr double kSurfaceRamp = 0.05;  // of the range

struct Range {
    double min, max;

    [[nodiscard]] double at(double t) const { return min + t * (max - min); }
};

/// A constant field has no range to spread colours over: it gets one of width 1, itself in the middle.
Range usable_range(double min, double max) {
    if (!std::isfinite(min) || !std::isfinite(max) || min > max || !std::isfinite(max - min)) {
        throw Error(ErrorCode::InvalidInput, "the field's range is not finite or upside down", "transfer function");
    }
    constexpr double kNarrow = 1e-12;  // relative: narrower, and neighbouring knots would round to one value
    const double magnitude = std::max({std::abs(min), std::abs(max), 1e-300});
    if (max - min > kNarrow * magnitude) return {min, max};
    const double half = std::max(0.5, magnitude * kNarrow);
    return {min - half, max + half};
}

std::vector<TransferFunction::ColorKnot> spread(std::span<const Rgb> table, Range range, double scale = 1) {
    std::vector<TransferFunction::ColorKnot> knots;
    for (std::size_t i = 0; i < table.size(); ++i) {
        const double t = static_cast<double>(i) / static_cast<double>(table.size() - 1);
        knots.push_back({range.at(t), linear_from_srgb(Vec3(table[i][0], table[i][1], table[i][2]) / scale)});
    }
    return knots;
}

TransferFunction ramp(std::vector<TransferFunction::ColorKnot> color, Range range) {
    return {std::move(color), {{range.min, 0}, {range.max, kDefaultOpacity}}};
}

TransferFunction surface(Range range) {
    const double width = range.max - range.min;
    const Range positive{0, range.max > 0 ? range.max : width};
    return {spread(kIvory, positive), {{0, 0}, {kSurfaceRamp * width, kSurfaceOpacity}}};
}

TransferFunction constant(Range range) {
    return {{{range.min, Vec3(1)}, {range.max, Vec3(1)}}, {{range.min, kDefaultOpacity}, {range.max, kDefaultOpacity}}};
}

[[noreturn]] void refuse(const char* list, std::size_t knot, const char* message, const char* allowed = "") {
    throw Error(ErrorCode::InvalidInput, message, std::string("transfer function, ") + list + " knot " + std::to_string(knot),
                allowed);
}

template <class Knot>
void check_values(const std::vector<Knot>& knots, const char* list) {
    if (knots.empty()) throw Error(ErrorCode::InvalidInput, std::string("has no ") + list + " knot", "transfer function");
    for (std::size_t i = 0; i < knots.size(); ++i) {
        if (!std::isfinite(knots[i].value)) refuse(list, i, "the value is not finite");
        if (i > 0 && !(knots[i - 1].value < knots[i].value)) refuse(list, i, "the values do not ascend");
    }
}

bool in_unit(double x) {
    return x >= 0 && x <= 1;
}

}  // namespace

TransferFunction transfer_function_preset(const std::string& name, double min, double max) {
    const Range range = usable_range(min, max);
    if (name == "viridis") return ramp(spread(kViridis, range), range);
    if (name == "coolwarm") return ramp(spread(kCoolwarmBytes, range, 255), range);
    if (name == "grey") return ramp(spread(kGrey, range), range);
    if (name == "surface") return surface(range);
    if (name == "constant") return constant(range);
    throw Error(ErrorCode::InvalidInput, "there is no transfer function '" + name + "'", {}, kPresets);
}

void validate(const TransferFunction& function) {
    check_values(function.color, "colour");
    check_values(function.opacity, "opacity");
    for (std::size_t i = 0; i < function.color.size(); ++i) {
        const Vec3& rgb = function.color[i].rgb;
        if (!in_unit(rgb.x) || !in_unit(rgb.y) || !in_unit(rgb.z)) refuse("colour", i, "the colour is out of range", "[0,1]");
    }
    for (std::size_t i = 0; i < function.opacity.size(); ++i) {
        if (!in_unit(function.opacity[i].alpha)) refuse("opacity", i, "the opacity is out of range", "[0,1]");
    }
}

}  // namespace subvol
