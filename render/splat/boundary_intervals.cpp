// SPDX-License-Identifier: Apache-2.0
// Where the ray of each pixel is inside a closed surface: a rasterizer that finds all crossings of each ray, not the nearest
// one.
//
//     sign         +1      +1      −1      −1          +1 where the ray enters a shell, −1 where it leaves one
//     ray   -------|-------|-------|-------|------->   sorted by depth
//     sum      0       1       2       1       0       how often the surface goes round; not 0: inside
//
// Where a surface folds, a ray may leave it before it has entered it: the sum is −1 in the part that is turned inside out,
// which is inside like the rest. It must not be counted as 0 there, or the ray would be one shell further in for the rest of
// its way.
//
// A missed or doubled crossing would exchange inside and outside for the rest of a ray, so coverage has to be exact: vertices
// are snapped to 1/4096 of a pixel, and the edge functions E(p) = (b − a) × (p − a) [pineda1988] are 64-bit integers. A pixel
// centre on an edge has E = 0. Of the two triangles that share the edge, the one that owns it (owns_edge) takes the centre: the
// other one tests E − 1 ≥ 0. Triangles that come near the eye or lie far beside the picture are clipped first, so that the
// integers cannot overflow. Bands of rows are worked on in parallel. The shaders splat_gl/shaders/boundary_*.comp cover bitwise
// the same pixels on the GPU.
#include "boundary_intervals.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "clip_triangle.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

constexpr int kSnapBits = 12;
constexpr std::int64_t kSnap = 1 << kSnapBits;  // units a pixel
constexpr double kSnapTie = 0x1p-16;            // more than a division on any device is off
constexpr double kGuard_px = 1 << 17;           // triangles that reach further out are clipped: edge functions could overflow
constexpr std::size_t kChunksOfTriangles = 64;

struct SnappedPoint {
    std::int64_t x, y;
};

/// The pixels whose centres are in the box around a triangle.
struct PixelBlock {
    int x0, x1, y0, y1;  // the last ones included

    [[nodiscard]] bool empty() const { return x0 > x1 || y0 > y1; }
};

/// A triangle in the picture, with its plane in eye space. Those near no pixel's centre are left out, which
/// are most where the surface is finer than the pixels.
struct ScreenTriangle {
    std::array<std::array<std::int32_t, 2>, 3> snapped;  // corners, ordered so that the area is positive
    std::int32_t sign;                                   // +1 where a ray enters the solid
    std::uint32_t id;
    PixelBlock block;
    Vec3 normal;
    double offset, z_min, z_max;

    [[nodiscard]] std::array<SnappedPoint, 3> corners() const {
        return {{{snapped[0][0], snapped[0][1]}, {snapped[1][0], snapped[1][1]}, {snapped[2][0], snapped[2][1]}}};
    }
};
static_assert(kGuard_px * kSnap < 2147483647.0, "corners have 32 bits");

/// A point of the surface in eye space and in the picture, found once for all its triangles.
struct ScreenPoint {
    Vec3 eye;
    std::array<std::int32_t, 2> snapped;  // if it is not outside
    bool outside;                         // of a plane that triangles are clipped by
};

/// A crossing of the surface by the ray of a pixel; pixels are numbered within the band.
struct Hit {
    std::uint32_t pixel;
    float depth;
    std::int8_t sign;
    std::uint32_t triangle;
};

/// Rounds to the nearest unit. Between two of them is a little less than a half, as in shaders/boundary_points.comp: points in
/// the middle are frequent where numbers are round, and the rounding of a division must not decide about them.
std::int64_t snap(double px) {
    const double below = std::floor(std::abs(px) * static_cast<double>(kSnap) + (0.5 + kSnapTie));
    return static_cast<std::int64_t>(px < 0 ? -below : below);
}

SnappedPoint center(int x, int y) {
    return {x * kSnap + kSnap / 2, y * kSnap + kSnap / 2};
}

/// Twice the area of (a, b, p): positive or negative for the two sides of ab.
std::int64_t area(const SnappedPoint& a, const SnappedPoint& b, const SnappedPoint& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

/// Whether the triangle on the positive side of ab owns the points on this edge; its neighbour has the edge as ba.
bool owns_edge(const SnappedPoint& a, const SnappedPoint& b) {
    return a.y != b.y ? b.y > a.y : b.x < a.x;
}

std::vector<ClipPlane> clip_planes(const View& view, double near) {
    std::vector<ClipPlane> planes{{{0, 0, 1}, -near}};
    const double reach = kGuard_px * view.pixel();
    for (const auto& side : {Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0)}) {
        planes.push_back(view.perspective() ? ClipPlane{side + Vec3(0, 0, reach), 0} : ClipPlane{side, reach});
    }
    return planes;
}

bool is_outside(const ClipPlane& plane, const Vec3& p) {
    return glm::dot(plane.normal, p) + plane.offset < 0;
}

/// The first pixel whose centre is not before a place, and the last one whose centre is not behind it.
int first_pixel(std::int64_t snapped) {
    return static_cast<int>((snapped - kSnap / 2 + kSnap - 1) >> kSnapBits);
}
int last_pixel(std::int64_t snapped) {
    return static_cast<int>((snapped - kSnap / 2) >> kSnapBits);
}

PixelBlock pixels_near(const std::array<SnappedPoint, 3>& t, const View& view) {
    const auto [x_low, x_high] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [y_low, y_high] = std::minmax({t[0].y, t[1].y, t[2].y});
    return {std::max(0, first_pixel(x_low)), std::min(view.width() - 1, last_pixel(x_high)), std::max(0, first_pixel(y_low)),
            std::min(view.height() - 1, last_pixel(y_high))};
}

std::array<std::int32_t, 2> snapped_in(const View& view, const Vec3& eye) {
    const Vec2 px = view.to_pixels(eye);
    return {static_cast<std::int32_t>(snap(px.x)), static_cast<std::int32_t>(snap(px.y))};
}

class TriangleSetup {
public:
    TriangleSetup(const View& view, const std::vector<ClipPlane>& planes, std::vector<ScreenTriangle>& out)
        : view_(view), planes_(planes), out_(out) {}

    void add(std::uint32_t id, const ScreenPoint& a, const ScreenPoint& b, const ScreenPoint& c) {
        id_ = id;
        eye_ = {a.eye, b.eye, c.eye};
        if (!a.outside && !b.outside && !c.outside) return emit(eye_, {a.snapped, b.snapped, c.snapped});
        polygon_.assign(eye_.begin(), eye_.end());
        for (const auto& plane : planes_) {
            const bool cut = std::any_of(polygon_.begin(), polygon_.end(), [&](const Vec3& p) { return is_outside(plane, p); });
            if (cut) clip_polygon(polygon_, plane, scratch_);
        }
        for (std::size_t i = 2; i < polygon_.size(); ++i) {
            const std::array part{polygon_[0], polygon_[i - 1], polygon_[i]};
            emit(part, {snapped_in(view_, part[0]), snapped_in(view_, part[1]), snapped_in(view_, part[2])});
        }
    }

private:
    void emit(const std::array<Vec3, 3>& part, const std::array<std::array<std::int32_t, 2>, 3>& snapped) {
        ScreenTriangle t;
        t.snapped = snapped;
        const auto corners = t.corners();
        const std::int64_t twice_area = area(corners[0], corners[1], corners[2]);
        if (twice_area == 0) return;
        t.block = pixels_near(corners, view_);
        if (t.block.empty()) return;
        // Triangles are counter-clockwise as seen from outside. As rows run downwards, the area is negative where they face the
        // eye.
        t.sign = twice_area < 0 ? 1 : -1;
        if (twice_area < 0) std::swap(t.snapped[1], t.snapped[2]);
        t.normal = glm::cross(eye_[1] - eye_[0], eye_[2] - eye_[0]);
        t.offset = glm::dot(t.normal, eye_[0]);
        t.z_min = std::min({part[0].z, part[1].z, part[2].z});
        t.z_max = std::max({part[0].z, part[1].z, part[2].z});
        t.id = id_;
        out_.push_back(t);
    }

    const View& view_;
    const std::vector<ClipPlane>& planes_;
    std::vector<ScreenTriangle>& out_;
    std::array<Vec3, 3> eye_;
    std::vector<Vec3> polygon_, scratch_;
    std::uint32_t id_ = 0;
};

double depth_at(const ScreenTriangle& t, const View& view, double x_px, double y_px) {
    const Vec2 s = view.slopes(x_px, y_px);
    const double z = view.perspective() ? t.offset / (t.normal.x * s.x + t.normal.y * s.y + t.normal.z)
                                        : (t.offset - t.normal.x * s.x - t.normal.y * s.y) / t.normal.z;
    return std::isfinite(z) ? std::clamp(z, t.z_min, t.z_max) : t.z_min;  // seen edge-on
}

/// The edge function of one side of a triangle, updated from pixel to pixel; 0 or more inside.
struct Edge {
    std::int64_t right, down, at_row;

    Edge(const SnappedPoint& a, const SnappedPoint& b, int x, int y)
        : right((a.y - b.y) * kSnap),
          down((b.x - a.x) * kSnap),
          at_row(area(a, b, center(x, y)) + (owns_edge(a, b) ? 0 : -1)) {}
};

void rasterize(const ScreenTriangle& t, const View& view, double middle, int y_begin, int y_end, std::vector<Hit>& hits) {
    const auto corners = t.corners();
    const int x0 = t.block.x0, x1 = t.block.x1, y0 = std::max(t.block.y0, y_begin), y1 = std::min(t.block.y1, y_end - 1);
    std::array<Edge, 3> edges{Edge(corners[0], corners[1], x0, y0), Edge(corners[1], corners[2], x0, y0),
                              Edge(corners[2], corners[0], x0, y0)};
    for (int y = y0; y <= y1; ++y) {
        std::int64_t a = edges[0].at_row, b = edges[1].at_row, c = edges[2].at_row;
        for (int x = x0; x <= x1; ++x) {
            if ((a | b | c) >= 0) {
                const auto pixel = static_cast<std::uint32_t>(y - y_begin) * static_cast<std::uint32_t>(view.width()) +
                                   static_cast<std::uint32_t>(x);
                hits.push_back({pixel, static_cast<float>(depth_at(t, view, x + 0.5, y + 0.5) - middle),
                                static_cast<std::int8_t>(t.sign), t.id});
            }
            a += edges[0].right;
            b += edges[1].right;
            c += edges[2].right;
        }
        for (Edge& edge : edges) edge.at_row += edge.down;
    }
}

/// Sorts hits by pixel, and those of a pixel by depth.
void sort_hits(std::vector<Hit>& hits, std::size_t pixels, std::vector<std::uint32_t>& ends, std::vector<Hit>& sorted) {
    ends.assign(pixels + 1, 0);
    for (const Hit& hit : hits) ++ends[hit.pixel + 1];
    for (std::size_t i = 1; i <= pixels; ++i) ends[i] += ends[i - 1];
    sorted.resize(hits.size());
    for (const Hit& hit : hits) sorted[ends[hit.pixel]++] = hit;
    for (std::size_t i = 0, begin = 0; i < pixels; begin = ends[i++]) {
        if (ends[i] < begin + 2) continue;
        // Where two shells touch, the entry into one comes before the exit from the other: no gap opens.
        const auto before = [](const Hit& l, const Hit& r) { return l.depth != r.depth ? l.depth < r.depth : l.sign > r.sign; };
        if (ends[i] > begin + 2) {
            std::sort(sorted.data() + begin, sorted.data() + ends[i], before);
        } else if (before(sorted[begin + 1], sorted[begin])) {
            std::swap(sorted[begin], sorted[begin + 1]);
        }
    }
}

/// Whether an interval is one of a surface that folds, and not two sides of a silhouette in the wrong order, which only the
/// roundings of their depths decide.
bool is_long(float enter, float exit) {
    constexpr float kRoundings = 16 * std::numeric_limits<float>::epsilon();
    return exit - enter > kRoundings * std::max(std::abs(enter), std::abs(exit));
}

/// Turns the sorted hits of one pixel into intervals.
void resolve(std::span<const Hit> hits, float near, std::vector<float>& depths, std::vector<std::uint32_t>& triangles) {
    int inside = 0;  // how often the surface goes round the eye, and then round the place behind each hit
    for (const Hit& hit : hits) inside -= hit.sign;
    float enter = near;
    std::uint32_t triangle = PixelIntervals::kNoTriangle;
    bool is_turned = false;  // whether the interval begins where the ray leaves the surface
    for (const Hit& hit : hits) {
        if (inside == 0) {
            enter = hit.depth;
            triangle = hit.triangle;
            is_turned = hit.sign < 0;
        }
        inside += hit.sign;
        if (inside == 0 && hit.depth > enter && (!is_turned || is_long(enter, hit.depth))) {
            depths.push_back(enter);
            depths.push_back(hit.depth);
            triangles.push_back(triangle);
        }
    }
}

std::vector<ScreenPoint> project_points(const Surface& surface, const View& view, const std::vector<ClipPlane>& planes) {
    std::vector<ScreenPoint> points(surface.points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 1024), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end(); ++i) {
            ScreenPoint& p = points[i];
            p.eye = view.to_eye(surface.points[i]);
            p.outside = std::any_of(planes.begin(), planes.end(), [&](const auto& plane) { return is_outside(plane, p.eye); });
            if (!p.outside) p.snapped = snapped_in(view, p.eye);
        }
    });
    return points;
}

std::vector<std::vector<ScreenTriangle>> project(const Surface& surface, const View& view, double near) {
    const auto planes = clip_planes(view, near);
    const std::vector<ScreenPoint> points = project_points(surface, view, planes);
    const std::size_t count = surface.triangles.size();
    std::vector<std::vector<ScreenTriangle>> chunks(std::clamp<std::size_t>(count / 1024, 1, kChunksOfTriangles));
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t chunk) {
        TriangleSetup setup(view, planes, chunks[chunk]);
        for (std::size_t i = count * chunk / chunks.size(); i < count * (chunk + 1) / chunks.size(); ++i) {
            const auto& t = surface.triangles[i];
            setup.add(static_cast<std::uint32_t>(i), points[t[0]], points[t[1]], points[t[2]]);
        }
    });
    return chunks;
}

/// The triangles of bands of rows, so that a band does not go through all of them: those of band b are
/// triangles[offsets[b]] to triangles[offsets[b + 1]], in the order of the surface.
struct BandLists {
    std::vector<std::size_t> offsets;
    std::vector<const ScreenTriangle*> triangles;
};

BandLists list_bands(const std::vector<std::vector<ScreenTriangle>>& chunks, int bands, int band_rows) {
    BandLists lists{std::vector<std::size_t>(static_cast<std::size_t>(bands) + 2), {}};
    const auto each = [&](const auto& visit) {
        for (const auto& chunk : chunks) {
            for (const auto& t : chunk) {
                for (int b = t.block.y0 / band_rows; b <= t.block.y1 / band_rows; ++b) visit(t, static_cast<std::size_t>(b));
            }
        }
    };
    each([&](const ScreenTriangle&, std::size_t b) { ++lists.offsets[b + 2]; });
    for (std::size_t b = 2; b < lists.offsets.size(); ++b) lists.offsets[b] += lists.offsets[b - 1];
    lists.triangles.resize(lists.offsets.back());
    each([&](const ScreenTriangle& t, std::size_t b) { lists.triangles[lists.offsets[b + 1]++] = &t; });
    return lists;
}

/// Puts bands one below the other.
PixelIntervals joined(const std::vector<PixelIntervals>& bands) {
    PixelIntervals result;
    std::vector<std::size_t> pixels(bands.size() + 1), intervals(bands.size() + 1);
    for (std::size_t b = 0; b < bands.size(); ++b) {
        pixels[b + 1] = pixels[b] + bands[b].offsets.size() - 1;
        intervals[b + 1] = intervals[b] + bands[b].triangles.size();
        result.hits += bands[b].hits;
    }
    result.offsets.resize(pixels.back() + 1);
    result.depths.resize(2 * intervals.back());
    result.triangles.resize(intervals.back());
    tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t b) {
        const auto before = static_cast<std::uint32_t>(intervals[b]);
        for (std::size_t i = 1; i < bands[b].offsets.size(); ++i) result.offsets[pixels[b] + i] = before + bands[b].offsets[i];
        std::ranges::copy(bands[b].depths, result.depths.begin() + static_cast<std::ptrdiff_t>(2 * intervals[b]));
        std::ranges::copy(bands[b].triangles, result.triangles.begin() + static_cast<std::ptrdiff_t>(intervals[b]));
    });
    return result;
}

}  // namespace

bool needs_clipping(std::span<const Vec3> points, const View& view, double near) {
    const auto planes = clip_planes(view, near);
    std::atomic<bool> needed = false;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end() && !needed; ++i) {
            const Vec3 p = view.to_eye(points[i]);
            if (std::any_of(planes.begin(), planes.end(), [&](const auto& plane) { return is_outside(plane, p); }))
                needed = true;
        }
    });
    return needed;
}

struct BoundaryRaster::State {
    /// The memory that finding a band takes.
    struct Scratch {
        std::vector<Hit> hits, sorted;
        std::vector<std::uint32_t> ends;
    };

    State(const Surface& surface, const View& picture, double near_depth, double middle_depth, int rows)
        : view(picture),
          near(near_depth),
          middle(middle_depth),
          band_rows(rows),
          chunks(project(surface, picture, near_depth)) {
        lists = list_bands(chunks, bands(), band_rows);
    }

    [[nodiscard]] int bands() const { return (view.height() + band_rows - 1) / band_rows; }

    const View& view;
    double near, middle;
    int band_rows;
    std::vector<std::vector<ScreenTriangle>> chunks;
    BandLists lists{};
    tbb::enumerable_thread_specific<Scratch> scratches{};
};

BoundaryRaster::BoundaryRaster(const Surface& surface, const View& view, double near, double middle, int band_rows)
    : state_(std::make_unique<State>(surface, view, near, middle, band_rows)) {
}
BoundaryRaster::~BoundaryRaster() = default;

int BoundaryRaster::band_count() const {
    return state_->bands();
}

int BoundaryRaster::first_row(int band) const {
    return std::min(band * state_->band_rows, state_->view.height());
}

void BoundaryRaster::find(int band, PixelIntervals& result) const {
    const int y0 = first_row(band), y1 = first_row(band + 1);
    const auto b = static_cast<std::size_t>(band);
    const std::size_t pixels = static_cast<std::size_t>(y1 - y0) * static_cast<std::size_t>(state_->view.width());
    auto& [hits, sorted, ends] = state_->scratches.local();
    hits.clear();
    for (std::size_t i = state_->lists.offsets[b]; i < state_->lists.offsets[b + 1]; ++i) {
        rasterize(*state_->lists.triangles[i], state_->view, state_->middle, y0, y1, hits);
    }
    sort_hits(hits, pixels, ends, sorted);
    result.hits = hits.size();
    result.offsets.assign(pixels + 1, 0);
    result.depths.clear();
    result.triangles.clear();
    result.depths.reserve(hits.size());
    result.triangles.reserve(hits.size() / 2);
    const auto near = static_cast<float>(state_->near - state_->middle);
    for (std::size_t i = 0, begin = 0; i < pixels; begin = ends[i++]) {
        if (ends[i] != begin) resolve(std::span(sorted).subspan(begin, ends[i] - begin), near, result.depths, result.triangles);
        result.offsets[i + 1] = static_cast<std::uint32_t>(result.triangles.size());
    }
}

PixelIntervals boundary_intervals(const Surface& surface, const View& view, double near, double middle) {
    const BoundaryRaster raster(surface, view, near, middle);
    std::vector<PixelIntervals> bands(static_cast<std::size_t>(raster.band_count()));
    tbb::parallel_for(0, raster.band_count(), [&](int band) { raster.find(band, bands[static_cast<std::size_t>(band)]); });
    return joined(bands);
}

void check_for_gl(const PixelIntervals& intervals) {
    for (std::size_t i = 0; i + 1 < intervals.offsets.size(); ++i) {
        const std::uint32_t count = intervals.offsets[i + 1] - intervals.offsets[i];
        if (count <= kMostGlIntervals) continue;
        throw Error(ErrorCode::MissingCapability, "a ray is inside the volume " + std::to_string(count) + " times", {},
                    "at most " + std::to_string(kMostGlIntervals) + " times with OpenGL, or the CPU backend");
    }
}

}  // namespace subvol::detail
