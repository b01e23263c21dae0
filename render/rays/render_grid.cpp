// SPDX-License-Identifier: Apache-2.0
// Rays through a grid of voxels, in its index space, where cell i lies between voxels i and i + 1 along each axis. A ray starts
// where it enters the grid, or after the cut, and goes from cell to cell until it leaves, or until its transmittance falls
// below a cutoff:
//
//     empty block      crossed in one step
//     constant block   crossed in one step and integrated with one value
//     cell             the value is trilinear over the active corners, along the ray a cubic in t if all are active
//
// A cell with inactive corners is cut at its middle planes, and the parts in inactive voxels are left out. In each part the
// deviation of the value from a straight line, at both thirds, gives the number of pieces of a polyline. The optics integrate
// each piece, linear in value. A slice ends the ray with the colour of its value. Each tile has its own tracer with a cursor,
// and counts are added up in the end.
#include "subvol/render_grid.h"

#include <tbb/combinable.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include "pixel_tiles.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/ray_clip.h"
#include "subvol/detail/stopwatch.h"
#include "subvol/optics.h"

namespace subvol::detail {

/// Integrates rays through a grid. Keeps a cursor, so each thread or tile needs its own.
class GridTracer {
public:
    /// Keeps references to grid, optics and clip.
    GridTracer(const Voxels& grid, const Optics& optics, double tolerance, const RayClip& clip);

    /// The light along the ray, from its origin on.
    [[nodiscard]] Segment trace(const Ray& ray);
    [[nodiscard]] const GridTraceReport& counts() const { return counts_; }

private:
    /// A ray in index space.
    struct Line {
        Vec3 origin, direction, inverse;
        double speed;  // world length of a unit of t
    };
    struct Stretch {
        double begin, end;
    };
    /// Cells lower … upper, both included: cell i lies between voxels i and i + 1.
    struct Cells {
        Voxel lower, upper;
    };

    [[nodiscard]] Line to_index(const Ray& ray) const;
    [[nodiscard]] bool clip(const Line& line, Stretch& inside) const;
    [[nodiscard]] Voxel cell_at(const Line& line, double t, const Cells& within) const;
    [[nodiscard]] Cells covered(const Voxel& cell, const VoxelBlock& block) const;
    void add_cell(const Line& line, const Voxel& cell, Stretch stretch, Segment& light);
    [[nodiscard]] std::optional<double> value_at(const Line& line, const Voxel& cell, const VoxelBlock& block, double t);
    void add_voxel_part(const Line& line, const Voxel& cell, const VoxelCorners& corners, Stretch stretch, Segment& light);

    const Optics& optics_;
    const RayClip& clip_;
    RayCut cut_;
    double value_tolerance_;
    Mat3 to_index_;
    Mat3 to_world_;
    Vec3 origin_;
    Cells cells_;
    std::unique_ptr<VoxelCursor> cursor_;
    GridTraceReport counts_;
};

namespace {

constexpr unsigned kAll = 0xff;
constexpr double kMostPieces = 64;

constexpr std::size_t at(int axis) {
    return static_cast<std::size_t>(axis);
}

double range_of(std::span<const double> knots) {
    return knots.back() - knots.front();
}

// Trilinear, over the active corners alone. u: the place in the cell, in [0,1]³.
double value_in(const VoxelCorners& corners, const Vec3& u) {
    double sum = 0, weights = 0;
    for (unsigned k = 0; k < 8; ++k) {
        if (!(corners.active >> k & 1)) continue;
        const double weight = (k & 1 ? u.x : 1 - u.x) * (k & 2 ? u.y : 1 - u.y) * (k & 4 ? u.z : 1 - u.z);
        sum += weight * corners.values[k];
        weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
}

}  // namespace

GridTracer::GridTracer(const Voxels& grid, const Optics& optics, double tolerance, const RayClip& clip)
    : optics_(optics),
      clip_(clip),
      value_tolerance_(tolerance * range_of(optics.knots())),
      to_index_(glm::inverse(grid.to_world())),
      to_world_(grid.to_world()),
      origin_(grid.origin()),
      cursor_(grid.cursor()) {
    const auto [lower, upper] = grid.range();
    // The first voxels reach half a voxel into the cells before them.
    cells_ = {{lower[0] - 1, lower[1] - 1, lower[2] - 1}, upper};
}

GridTracer::Line GridTracer::to_index(const Ray& ray) const {
    const Vec3 direction = to_index_ * ray.direction;
    return {to_index_ * (ray.origin - origin_), direction, 1.0 / direction, glm::length(ray.direction)};
}

bool GridTracer::clip(const Line& line, Stretch& inside) const {
    inside = {0, std::numeric_limits<double>::infinity()};
    for (int k = 0; k < 3; ++k) {
        const double lower = cells_.lower[at(k)], upper = cells_.upper[at(k)] + 1.0;
        if (line.direction[k] == 0) {
            if (line.origin[k] < lower || line.origin[k] > upper) return false;
            continue;
        }
        const double a = (lower - line.origin[k]) * line.inverse[k], b = (upper - line.origin[k]) * line.inverse[k];
        inside = {std::max(inside.begin, std::min(a, b)), std::min(inside.end, std::max(a, b))};
    }
    return inside.begin < inside.end;
}

Voxel GridTracer::cell_at(const Line& line, double t, const Cells& within) const {
    Voxel cell;
    for (int k = 0; k < 3; ++k) {
        const double x = std::floor(line.origin[k] + t * line.direction[k]);
        cell[at(k)] = static_cast<std::int32_t>(std::clamp<double>(x, within.lower[at(k)], within.upper[at(k)]));
    }
    return cell;
}

// The cells whose voxels are all in the block of `cell`; only the cell itself if its voxels are not.
GridTracer::Cells GridTracer::covered(const Voxel& cell, const VoxelBlock& block) const {
    Cells cells{cell, cell};
    if (block.kind == VoxelBlock::Kind::Mixed) return cells;
    for (std::size_t k = 0; k < 3; ++k) {
        if (cell[k] == block.lower[k] + block.size - 1) return {cell, cell};
        cells.lower[k] = std::max(block.lower[k], cells_.lower[k]);
        cells.upper[k] = std::min(block.lower[k] + block.size - 2, cells_.upper[k]);
    }
    return cells;
}

/// The value at a place in a cell; none where its voxel is not active.
std::optional<double> GridTracer::value_at(const Line& line, const Voxel& cell, const VoxelBlock& block, double t) {
    const Vec3 place = glm::clamp(line.origin - Vec3(cell[0], cell[1], cell[2]) + t * line.direction, 0.0, 1.0);
    const VoxelCorners corners = cursor_->corners(cell);
    unsigned nearest = 0;
    for (int k = 0; k < 3; ++k) nearest |= place[k] >= 0.5 ? 1u << k : 0u;
    if (!(corners.active >> nearest & 1)) return std::nullopt;
    return block.kind == VoxelBlock::Kind::Constant ? block.value : value_in(corners, place);
}

void GridTracer::add_voxel_part(const Line& line, const Voxel& cell, const VoxelCorners& corners, Stretch stretch,
                                Segment& light) {
    const Vec3 base = line.origin - Vec3(cell[0], cell[1], cell[2]);
    const auto value_at = [&](double t) { return value_in(corners, glm::clamp(base + t * line.direction, 0.0, 1.0)); };
    const double length = stretch.end - stretch.begin;
    const double front = value_at(stretch.begin), back = value_at(stretch.end);
    double pieces = 1;
    if (value_tolerance_ > 0) {  // a cubic that is straight at both thirds is straight
        const double one = value_at(stretch.begin + length / 3), two = value_at(stretch.begin + 2 * length / 3);
        const double bend = std::max(std::abs(one - (2 * front + back) / 3), std::abs(two - (front + 2 * back) / 3));
        pieces = std::clamp(std::ceil(std::sqrt(bend / value_tolerance_)), 1.0, kMostPieces);
    }
    double last = front;
    for (double i = 1; i <= pieces; ++i) {
        const double next = i == pieces ? back : value_at(stretch.begin + i / pieces * length);
        composite(light, optics_.integrate(last, next, length / pieces * line.speed));
        last = next;
    }
}

void GridTracer::add_cell(const Line& line, const Voxel& cell, Stretch stretch, Segment& light) {
    const VoxelCorners corners = cursor_->corners(cell);
    if (corners.active == 0) return;
    ++counts_.cells;
    if (corners.active == kAll) return add_voxel_part(line, cell, corners, stretch, light);
    // Some corners are inactive: the stretch is cut at the middle planes, where one voxel ends and the next begins.
    std::array<double, 5> ends{stretch.begin, stretch.end, stretch.end, stretch.end, stretch.end};
    for (int k = 0; k < 3; ++k) {
        const double t = (cell[at(k)] + 0.5 - line.origin[k]) * line.inverse[k];
        if (t > stretch.begin && t < stretch.end) ends[at(k) + 1] = t;
    }
    std::sort(ends.begin(), ends.end());
    for (std::size_t i = 0; i + 1 < ends.size(); ++i) {
        if (!(ends[i] < ends[i + 1])) continue;
        const Vec3 middle = line.origin + 0.5 * (ends[i] + ends[i + 1]) * line.direction;
        unsigned corner = 0;
        for (int k = 0; k < 3; ++k) corner |= middle[k] - cell[at(k)] >= 0.5 ? 1u << k : 0u;
        if (corners.active >> corner & 1) add_voxel_part(line, cell, corners, {ends[i], ends[i + 1]}, light);
    }
}

Segment GridTracer::trace(const Ray& ray) {
    Segment light;
    const Line line = to_index(ray);
    Stretch inside;
    if (!clip(line, inside)) return light;
    clip_.cut(ray, cut_);
    inside.begin = std::max(inside.begin, cut_.near);
    if (cut_.empty() || !(inside.begin < inside.end)) return light;
    auto slice = cut_.slices.begin();
    const auto cells_before = counts_.cells;
    bool met = false;
    double t = inside.begin;
    Voxel cell = cell_at(line, t, cells_);
    while (light.transmittance >= kRayCutoff) {
        const VoxelBlock block = cursor_->block(cell);
        const Cells passed = covered(cell, block);
        int axis = 0;
        double end = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            if (line.direction[k] == 0) continue;
            const double plane = line.direction[k] > 0 ? passed.upper[at(k)] + 1.0 : passed.lower[at(k)];
            const double crossed = (plane - line.origin[k]) * line.inverse[k];
            if (crossed < end) {
                end = crossed;
                axis = k;
            }
        }
        end = std::max(end, t);
        const auto add = [&](double to) {
            if (clip_.slices_alone() || to < t) return;
            if (passed.lower == passed.upper) {
                if (to > t) add_cell(line, cell, {t, to}, light);
            } else if (++counts_.blocks; block.kind == VoxelBlock::Kind::Constant) {
                met = true;
                composite(light, optics_.integrate(block.value, block.value, (to - t) * line.speed));
            }
        };
        for (; slice != cut_.slices.end() && slice->depth <= end + slice->tolerance; ++slice) {
            if (!slice->meets(t, end)) continue;
            const double crossing = slice->within(t, end);
            std::optional<double> value;
            for (const double depth :
                 {crossing, crossing + slice->tolerance, crossing - slice->tolerance}) {  // a voxel may end here
                if (!value) value = value_at(line, cell_at(line, depth, passed), block, depth);
            }
            if (!value) continue;
            add(crossing);
            met = true;
            ++counts_.rays;
            composite(light, {optics_.color(*value), 0});
            return light;
        }
        add(std::min(end, cut_.far));
        if (end >= cut_.far) break;
        cell = cell_at(line, end, passed);
        cell[at(axis)] = line.direction[axis] > 0 ? passed.upper[at(axis)] + 1 : passed.lower[at(axis)] - 1;
        if (cell[at(axis)] < cells_.lower[at(axis)] || cell[at(axis)] > cells_.upper[at(axis)]) break;
        t = end;
    }
    if (met || counts_.cells > cells_before) ++counts_.rays;
    return light;
}

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

void check(const Voxels& grid, const GridOptions& options) {
    check_samples(options.samples);
    if (!(options.tolerance > 0 && std::isfinite(options.tolerance))) {
        throw Error(ErrorCode::InvalidInput, "the tolerance is " + number_text(options.tolerance), {}, "a positive number");
    }
    const double volume = glm::determinant(grid.to_world());
    if (volume == 0 || !std::isfinite(volume)) {
        throw Error(ErrorCode::InvalidInput, "the axes of the grid's voxels lie in a plane");
    }
}

// Traces, and adds its counts to the sums when its tile is done.
class CountedTracer {
public:
    CountedTracer(GridTracer tracer, tbb::combinable<GridTraceReport>& sums) : tracer_(std::move(tracer)), sums_(&sums) {}
    CountedTracer(CountedTracer&&) = delete;
    ~CountedTracer() {
        GridTraceReport& sum = sums_->local();
        sum.rays += tracer_.counts().rays;
        sum.cells += tracer_.counts().cells;
        sum.blocks += tracer_.counts().blocks;
    }
    Segment operator()(const Ray& ray) { return tracer_.trace(ray); }

private:
    GridTracer tracer_;
    tbb::combinable<GridTraceReport>* sums_;
};

}  // namespace

GridResult render_grid(const Voxels& grid, const View& view, const Optics& optics, const GridOptions& options) {
    check(grid, options);
    const std::array<Voxel, 2> range = grid.range();
    const Voxel &lower = range[0], &upper = range[1];
    if (lower[0] > upper[0]) return {{view.width(), view.height()}, {}};
    GridResult result;
    const Stopwatch watch;
    Box box;
    for (unsigned k = 0; k < 8; ++k) {
        const auto end = [&](std::size_t axis) { return (k >> axis & 1) != 0 ? upper[axis] + 0.5 : lower[axis] - 0.5; };
        box.add(grid.to_world() * Vec3(end(0), end(1), end(2)));
    }
    const RayClip clip(options.clip, box.diagonal());
    tbb::combinable<GridTraceReport> sums;
    result.image = draw_in_tiles(view, options.samples, options.progress,
                                 [&] { return CountedTracer(GridTracer(grid, optics, options.tolerance, clip), sums); });
    sums.combine_each([&](const GridTraceReport& sum) {
        result.report.rays += sum.rays;
        result.report.cells += sum.cells;
        result.report.blocks += sum.blocks;
    });
    result.report.seconds_draw = watch.seconds();
    return result;
}

}  // namespace subvol
