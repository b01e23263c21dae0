// SPDX-License-Identifier: Apache-2.0
// What all splatters share: the scene, which depends on neither view nor colours, the tables of colours and opacities, and the
// sheets of a picture.
//
//     volume, options ─► scene: form and table of the kernel, thinnest kernel, half weight, clip
//     scene, optics   ─► classification: pre-integrated extinction and emission, colours of a second channel
//     scene, view     ─► sheets: planes of constant eye depth from the nearest to the farthest part of the volume
//
// Sizes, values and ranges are refused where 32-bit floats lose them. A kernel is compact, radial (a table over e) or separable
// (a table over |ξ|). A volume without a boundary ends at half of the weight that its kernels add up to inside, a median over
// places. The number of sheets is such that four of them fall into the depth reach of the finest kernels, but for a small part
// of the volume; fewer where kernels hardly bend; and grows with the square root of the inverse of the image tolerance.
#include "splat_scene.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "boundary_intervals.h"
#include "kernel_axes.h"
#include "sheet_count.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol::detail {

namespace {

// The squares of lengths and their inverses have to be normal floats.
constexpr double kLeastSize_world = 1e-12, kMostSize_world = 1e18;
constexpr double kLeastRange = 1e-30, kMostRange = 1e37;
constexpr double kRounding = 0x1p-24;  // of a 32-bit float, relative

[[noreturn]] void refuse(std::string_view what, double amount, const char* allowed) {
    throw Error(ErrorCode::InvalidInput,
                std::string(what) + number_text(amount) + ", beyond what kernels hold in 32-bit floats", {}, allowed);
}

/// Returns the largest absolute value.
float check_channel(const RbfVolume& volume, std::size_t channel) {
    if (channel >= volume.channels.size()) {
        throw Error(ErrorCode::InvalidInput, "there is no channel " + std::to_string(channel), {},
                    "the volume has " + std::to_string(volume.channels.size()));
    }
    float largest = 0;
    for (const float v : volume.channels[channel].values) {
        if (!std::isfinite(v)) refuse("a value is ", static_cast<double>(v), "up to 3e38");
        largest = std::max(largest, std::abs(v));
    }
    return largest;
}

/// largest: the largest absolute value of the channel
void check_range(const RbfChannel& channel, float largest, double min, double max) {
    const double range = max - min;
    if (!(range >= kLeastRange && range <= kMostRange)) refuse("the transfer function's range is ", range, "1e-30 to 1e37");
    const double most_rounding = 0.1 * range;  // if it is more, the field is noise
    if (double{largest} * kRounding <= most_rounding) return;
    for (const float v : channel.values) {
        const double value = static_cast<double>(v), rounding = std::abs(value) * kRounding;
        if (rounding > most_rounding && value + rounding >= min && value - rounding <= max) {
            refuse("beside a value of " + number_text(value) + " the transfer function's range is ", range,
                   "a wider range, or kernels of the field less its mean");
        }
    }
}

bool finite(const PreintegratedTable& table) {
    const auto all = [](const auto& values) {
        return std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); });
    };
    return all(table.unit) &&
           std::all_of(table.rows.begin(), table.rows.end(), [&](const auto& row) { return all(row.mean) && all(row.bend); });
}

/// bounded: there is a boundary, which has normals
void check_shading(const Shading& shading, const RbfChannel& channel, bool bounded) {
    for (const double part : {shading.ambient, shading.diffuse, shading.specular, shading.shininess}) {
        if (!(part >= 0) || !std::isfinite(part)) {
            throw Error(ErrorCode::InvalidInput, "a part of the shading is " + number_text(part), {}, "0 or more");
        }
    }
    if (!(shading.head >= 0 && shading.head <= 1))
        throw Error(ErrorCode::InvalidInput, "the light at the eye is the part " + number_text(shading.head), {}, "0 to 1");
    const bool flat = std::all_of(channel.gradients.begin(), channel.gradients.end(),
                                  [](const auto& g) { return g[0] == 0 && g[1] == 0 && g[2] == 0; });
    const bool constant =
        std::all_of(channel.values.begin(), channel.values.end(), [&](float v) { return v == channel.values.front(); });
    if (flat && !constant && !bounded) {
        throw Error(ErrorCode::InvalidInput, "shading needs gradients, and these points have none", {},
                    "points with a correction");
    }
}

ColorTable color_table(const Optics& optics, double min, double max) {
    constexpr int kCells = PreintegratedTable::kCells;
    ColorTable table{.min = min, .max = max, .rows = {}};
    if (!(table.min < table.max)) table.max = table.min + 1;
    const auto color_at = [&](int i) {
        const Vec3 c = optics.color(table.min + (table.max - table.min) * i / kCells);
        return std::array{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z), 0.0f};
    };
    for (int i = -1; i <= kCells; ++i) {
        ColorTable::Row row{color_at(std::max(i, 0)), {}};
        if (i >= 0 && i < kCells) {
            const auto next = color_at(i + 1);
            for (std::size_t c = 0; c < 3; ++c) row.step[c] = next[c] - row.color[c];
        }
        table.rows.push_back(row);
    }
    return table;
}

// Steps of a kernel's table, linear between them: the error is an eighth of the squared step times the second derivative, which
// is some hundreds for the narrowest kernels.
constexpr std::size_t kSteps = 4096;

template <class Value>
std::vector<float> sampled(const Value& value) {
    std::vector<float> table(kSteps + 1);
    for (std::size_t i = 0; i < kSteps; ++i) table[i] = static_cast<float>(value(static_cast<double>(i) / kSteps));
    return table;
}

/// How the splatter evaluates a kernel, and the kernel's table if it needs one.
std::pair<KernelForm, std::vector<float>> kernel_profile(const Kernel& kernel) {
    if (std::holds_alternative<CompactKernel>(kernel)) return {KernelForm::Compact, {}};
    const double radius = support_radius(kernel);
    if (is_radial(kernel)) {
        return {KernelForm::Radial, sampled([&](double e) { return radial_value(kernel, radius * std::sqrt(e)); })};
    }
    if (std::holds_alternative<TableKernel>(kernel)) {
        throw Error(ErrorCode::InvalidInput, "kernels tabulated in three dimensions cannot be splatted", {},
                    "radial or separable kernels");
    }
    // A product of one function over three axes: at the origin it is the third power of that function.
    const double root = std::cbrt(kernel_value(kernel, Vec3(0.0)));
    return {KernelForm::Separable,
            sampled([&](double t) { return kernel_value(kernel, Vec3(radius * t, 0, 0)) / (root * root); })};
}

constexpr std::size_t kPlaces = 101;

double weight_at(const RbfVolume& volume, const Vec3& x) {
    const bool radial = is_radial(volume.kernel);
    const double radius = support_radius(volume.kernel), reach = radial ? 1 : 3;  // the corner of a cube has e = 3
    double sum = 0;
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const Vec3 d = x - volume.centers[i];
        const auto& f = volume.frames[i];
        const double reach_x = reach * static_cast<double>(f[0]), reach_y = reach * static_cast<double>(f[3]);
        if (d.x * d.x >= reach_x || d.y * d.y >= reach_y) continue;
        const Vec3 scaled = radius * (inverse_symmetric_root(f) * d);
        sum += radial ? radial_value(volume.kernel, glm::length(scaled)) : kernel_value(volume.kernel, scaled);
    }
    return sum;
}

/// What the weights of the kernels add up to inside the volume: the median over the places of at most kPlaces kernels.
double weight_inside(const RbfVolume& volume) {
    if (volume.size() == 0) return 1;
    const std::size_t places = std::min(kPlaces, volume.size());
    std::vector<double> weights(places);
    tbb::parallel_for(std::size_t{0}, places, [&](std::size_t k) {
        weights[k] = weight_at(volume, volume.centers[(2 * k + 1) * volume.size() / (2 * places)]);
    });
    std::nth_element(weights.begin(), weights.begin() + static_cast<std::ptrdiff_t>(places / 2), weights.end());
    return weights[places / 2];
}

std::string kind_of(const RbfVolume& volume) {
    std::string kind = to_json(volume.kernel);
    for (const RbfChannel& channel : volume.channels) kind += channel.name + (channel.hessians.empty() ? "\n" : " bent\n");
    return kind + std::to_string(volume.boundary.points.size()) + " " + std::to_string(volume.boundary.triangles.size());
}

/// The row of a value in cells, and its place within.
std::pair<std::size_t, float> row_of(float x) {
    const float cell = std::clamp(std::floor(x), -1.0f, static_cast<float>(PreintegratedTable::kCells));
    return {static_cast<std::size_t>(static_cast<int>(cell) + 1), x - cell};
}

/// The box of the boundary, or of the kernels if there is none.
Box reach_of(const RbfVolume& volume) {
    Box box;
    for (const Vec3& point : volume.boundary.points) box.add(point);
    if (!box.empty()) return box;
    const double widening = is_radial(volume.kernel) ? 1 : 3;  // the corner of a cube has e = 3
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const Mat3 s = widening * matrix(volume.frames[i]);
        const Vec3 half(std::sqrt(s[0][0]), std::sqrt(s[1][1]), std::sqrt(s[2][2]));
        box.add(volume.centers[i] - half);
        box.add(volume.centers[i] + half);
    }
    return box;
}

}  // namespace

std::array<float, 4> Classification::light_at(float x) const {
    const auto [i, s] = row_of(x);
    const PreintegratedTable::Row& row = table.rows[i];
    std::array<float, 4> light;
    for (std::size_t c = 0; c < 4; ++c) light[c] = std::max(row.mean[c] + (2 * s - 1) * row.bend[c], 0.0f);
    return light;
}

std::array<float, 3> Classification::color_at(float x) const {
    const auto [i, s] = row_of(x);
    const ColorTable::Row& row = colors.rows[i];
    return {row.color[0] + s * row.step[0], row.color[1] + s * row.step[1], row.color[2] + s * row.step[2]};
}

namespace {

/// A bound of the least semi-axis: λ1 = det / (λ2 λ3), and λ2 λ3 ≤ (trace / 2)².
float thinnest_of(const RbfVolume& volume) {
    const auto least = [](float a, float b) { return std::min(a, b); };
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, volume.size(), 1 << 16), std::numeric_limits<float>::infinity(),
        [&](const auto& kernels, float thinnest) {
            for (std::size_t i = kernels.begin(); i < kernels.end(); ++i) {
                const Mat3 s = matrix(volume.frames[i]);
                const double half_trace = (s[0][0] + s[1][1] + s[2][2]) / 2;
                const double reach = std::sqrt(std::max(0.0, glm::determinant(s))) / half_trace;
                thinnest = reach > 0 ? std::min(thinnest, static_cast<float>(reach)) : 0;
            }
            return thinnest;
        },
        least);
}

}  // namespace

SplatScene make_scene(const RbfVolume& volume, const SplatOptions& options) {
    check_options(options);
    if (!(options.image_tolerance > 0) || !std::isfinite(options.image_tolerance)) {
        throw Error(ErrorCode::InvalidInput, "the tolerance of the picture is " + number_text(options.image_tolerance), {},
                    "more than 0");
    }
    const float largest_value = check_channel(volume, options.channel);
    const float largest_color = options.color_channel ? check_channel(volume, *options.color_channel) : 0;
    const Box box = box_of(volume);
    const double size = box.diagonal();
    if (!(size >= kLeastSize_world && size <= kMostSize_world)) refuse("the volume's diagonal is ", size, "1e-12 to 1e18");

    const auto [form, kernel_table] = kernel_profile(volume.kernel);
    SplatScene scene{.volume = &volume,
                     .channel = options.channel,
                     .color_channel = options.color_channel,
                     .largest_value = largest_value,
                     .largest_color = largest_color,
                     .form = form,
                     .kernel_table = kernel_table,
                     .normalized = options.normalized,
                     .image_tolerance = options.image_tolerance,
                     .needed_sheets = options.needed_sheets,
                     .shading = options.shading,
                     .kind = kind_of(volume),
                     .middle = 0.5 * (box.lower + box.upper),
                     .diagonal = size,
                     .thinnest = thinnest_of(volume)};
    if (scene.color_channel == scene.channel) scene.color_channel.reset();
    scene.bent = !scene.opacity_values().hessians.empty() || !scene.color_values().hessians.empty();
    if (volume.boundary.triangles.empty()) scene.half_weight = static_cast<float>(0.5 * weight_inside(volume));
    if (scene.shading) {
        check_shading(*scene.shading, scene.opacity_values(), !volume.boundary.triangles.empty());
        scene.boundary_normals = corner_normals(volume.boundary);
    }
    set_clip(scene, options.clip);
    count_bends(scene, volume, scene.bends);
    scene.shadows = options.shadows;
    scene.occlusion_world = options.ambient_occlusion * size;
    return scene;
}

void set_kernels(SplatScene& scene, const RbfVolume& volume, const Clip& clip) {
    if (kind_of(volume) != scene.kind) {
        throw Error(ErrorCode::InvalidInput, "the kernels are those of another volume", {},
                    "the same channels, kernel and boundary as before");
    }
    const float largest_value = check_channel(volume, scene.channel);
    scene.largest_color = scene.color_channel ? check_channel(volume, *scene.color_channel) : 0;
    scene.largest_value = largest_value;
    scene.volume = &volume;
    scene.thinnest = thinnest_of(volume);
    scene.bends = {};
    count_bends(scene, volume, scene.bends);
    scene.reach = {};
    set_clip(scene, clip);
}

void set_clip(SplatScene& scene, const Clip& clip) {
    validate(clip);
    if (scene.reach.empty() && !clip.empty()) scene.reach = reach_of(*scene.volume);
    scene.clip = RayClip(without_far_faces(clip, scene.reach), scene.diagonal);
}

bool is_solid(const SplatScene& scene, const Optics& optics) {
    if (!scene.shading || scene.half_weight > 0) return false;
    const double least = static_cast<double>(kOpaqueDepth) / (kSolidSkin * scene.diagonal);
    return std::ranges::all_of(optics.knots(), [&](double knot) { return optics.extinction(knot) > least; });
}

Classification classify(const SplatScene& scene, const Optics& optics) {
    Classification classification{make_preintegrated_table(optics), {}, 0};
    for (const auto& row : classification.table.rows) {
        classification.most_extinction = std::max(classification.most_extinction, row.mean[0] + std::abs(row.bend[0]));
    }
    check_range(scene.opacity_values(), scene.largest_value, classification.table.min, classification.table.max);
    if (!finite(classification.table)) {
        throw Error(ErrorCode::InvalidInput, "the extinction is beyond 32-bit floats", {}, "a larger opacity unit");
    }
    if (scene.color_channel) {
        const auto& knots = optics.function().color;
        classification.colors = color_table(optics, knots.front().value, knots.back().value);
        check_range(scene.color_values(), scene.largest_color, classification.colors.min, classification.colors.max);
    } else if (scene.clip.has_slices() || is_solid(scene, optics)) {
        classification.colors = color_table(optics, classification.table.min, classification.table.max);
    }
    return classification;
}

namespace {

/// Counts kernels by a number of each, beside its volume. Counts are whole numbers, so the threads may add in any order.
void count_kernels(const SplatScene& scene, const RbfVolume& kernels, ReachCounts& counts, const auto& number) {
    const double widening = scene.form == KernelForm::Separable ? 3 : 1;
    const double size = scene.diagonal * scene.diagonal * scene.diagonal;
    using Range = tbb::blocked_range<std::size_t>;
    const auto joined = [](ReachCounts some, const ReachCounts& others) {
        some.add(others);
        return some;
    };
    counts.add(tbb::parallel_reduce(
        Range(0, kernels.size(), 1 << 16), ReachCounts(),
        [&](const Range& range, ReachCounts some) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) {
                const Mat3 s = widening * matrix(kernels.frames[i]);
                some.add(static_cast<float>(number(i, s)), std::sqrt(std::max(0.0, glm::determinant(s))) / size);
            }
            return some;
        },
        joined));
}

/// frame: S of the kernel
double bend_of(const RbfChannel& channel, std::size_t i, const Mat3& frame) {
    const auto& g = channel.gradients[i];
    const Vec3 gradient(g[0], g[1], g[2]);
    const double rise = std::sqrt(std::max(0.0, glm::dot(gradient, frame * gradient)));
    double bend = std::abs(double{channel.moments[i]});
    if (!channel.hessians.empty()) {
        const Mat3 rest = matrix(channel.hessians[i]) * frame, square = rest * rest;
        bend += std::sqrt(std::max(0.0, square[0][0] + square[1][1] + square[2][2])) / 2;
    }
    return bend > 0 || rise > 0 ? std::min(bend / std::max(rise, 1e-30), 1e30) : 1;
}

}  // namespace

void count_reaches(const SplatScene& scene, const View& view, const RbfVolume& kernels, ReachCounts& counts) {
    const Vec3& forward = view.axes()[2];
    count_kernels(scene, kernels, counts,
                  [&](std::size_t, const Mat3& frame) { return std::sqrt(std::max(0.0, glm::dot(forward, frame * forward))); });
}

void count_bends(const SplatScene& scene, const RbfVolume& kernels, ReachCounts& counts) {
    count_kernels(scene, kernels, counts, [&](std::size_t i, const Mat3& frame) {
        const double bend = bend_of(kernels.channels[scene.channel], i, frame);
        return scene.color_channel ? std::max(bend, bend_of(kernels.channels[*scene.color_channel], i, frame)) : bend;
    });
}

int sheets_needed(const SplatScene& scene, const DepthRange& depths, const SheetCounts& counts) {
    // A kernel's section changes over its reach like (1−e)³. Linear interpolation between sheets a quarter of it apart is right
    // to about 1e-3 of what the kernel adds (measured against the dense grid, see docs/science.md), and the error falls with
    // the square of the distance.
    constexpr double kSheetsPerReach = 4, kFewest = 64, kTolerance = 1e-3;
    constexpr double kMost = 16384;
    // Kernels in this part of the volume may have fewer sheets: a fine boundary layer is a small part of the picture, though
    // most kernels may be in it.
    constexpr double kFinestPart = 0.05;
    // All but this part of the volume has kernels that bend by kBend at most, when a quarter of a reach is needed. The less
    // they bend, the more of them show one wave of the field, and sheets need not be closer for that. Where the rest needs more
    // of them, a picture has more sheets than its stack (finer_sheets.h).
    constexpr double kBentPart = 0.1, kBend = 0.2;
    const double finer = std::sqrt(kTolerance / scene.image_tolerance), range = depths.max - depths.min;
    const double fewest = std::clamp(kFewest * finer, 16.0, kFewest);
    if (counts.reaches.kernels() == 0) return static_cast<int>(fewest);
    // Where weights end the volume, where sums are not divided by them, or where light arrives through the volume, what is
    // between sheets does not follow from the field alone.
    const bool by_field = scene.half_weight == 0 && scene.normalized && !scene.shadowed();
    const double bend = by_field ? double{counts.bends.finest(1 - kBentPart)} : kBend;
    const double straight = std::max(1.0, kBend / std::max(bend, 1e-9));
    const double reach = std::max(straight * double{counts.reaches.finest(kFinestPart)}, 1e-9 * range);
    return static_cast<int>(std::clamp(std::ceil(kSheetsPerReach * finer * range / reach) + 1, fewest, kMost));
}

DepthRange depth_range_of(const SplatScene& scene, const View& view) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    using Ends = std::array<double, 2>;
    using Range = tbb::blocked_range<std::size_t>;
    const RbfVolume& volume = *scene.volume;
    const auto joined = [](const Ends& a, const Ends& b) { return Ends{std::min(a[0], b[0]), std::max(a[1], b[1])}; };
    const auto ends_of = [&](std::size_t count, const auto& ends_at) {
        return tbb::parallel_reduce(
            Range(0, count, 1 << 13), Ends{kInfinity, -kInfinity},
            [&](const Range& range, Ends ends) {
                for (std::size_t i = range.begin(); i < range.end(); ++i) ends = joined(ends, ends_at(i));
                return ends;
            },
            joined);
    };
    Ends ends = ends_of(volume.boundary.points.size(), [&](std::size_t i) {
        const double z = view.to_eye(volume.boundary.points[i]).z;
        return Ends{z, z};
    });
    if (scene.half_weight > 0) {
        const Vec3& forward = view.axes()[2];
        ends = joined(ends, ends_of(volume.size(), [&](std::size_t i) {
                          const double z = view.to_eye(volume.centers[i]).z;
                          const double reach = std::sqrt(std::max(0.0, glm::dot(forward, matrix(volume.frames[i]) * forward)));
                          return Ends{z - reach, z + reach};
                      }));
    }
    const double near = nearest_depth(view, scene.diagonal), z_min = std::max(ends[0], near);
    // Where all is behind the eye, the picture is empty.
    return {z_min, std::max(ends[1], z_min + near + std::numeric_limits<double>::min()), near};
}

SheetStack make_sheets(const SplatScene& scene, const View& view, int count) {
    const double middle = view.to_eye(scene.middle).z;
    const auto [z_min, z_max, near] = depth_range_of(scene, view);
    if (count == 0) count = scene.needed_sheets;
    if (count == 0) {
        SheetCounts counts{{}, scene.bends};
        count_reaches(scene, view, *scene.volume, counts.reaches);
        count = sheets_needed(scene, {z_min, z_max, near}, counts);
    }
    return {.count = count,
            .first = static_cast<float>(z_min - middle),
            .distance = static_cast<float>((z_max - z_min) / (count - 1)),
            .middle = static_cast<float>(middle),
            .near = static_cast<float>(near - middle)};
}

}  // namespace subvol::detail

namespace subvol {

std::vector<Option> options_of(SplatOptions& options) {
    return {
        Option("backend", options.method).help("NAME", "where to splat: auto (default: a GPU, else the CPU), gl, cpu"),
        Option("device", options.device)
            .between(0, 1000)
            .help("N", "the OpenGL device's number in `info --gl` (default: the first GPU)")
            .not_with("backend", {"cpu"}),
        Option("sheets", options.sheets)
            .between(2, 65536)
            .or_none()
            .help(
                "N",
                "splat: number of planes over the volume's depth (default: as many as the kernels need for --tolerance-image)"),
        Option("shadows", options.shadows).help("splat: the volume shadows itself from the light at the upper left"),
        Option("ambient-occlusion", options.ambient_occlusion)
            .between(0, 1)
            .help("R", "splat: darken hollows that are narrower than this part of the box's diagonal, such as .1")};
}

}  // namespace subvol
