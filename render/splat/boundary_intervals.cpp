// SPDX-License-Identifier: Apache-2.0
// Where the ray of each pixel is inside a closed surface: a rasterizer that finds all crossings of each ray, not the nearest
// one.
//
//     sign         +1      +1      −1      −1          +1 where the ray enters a shell, −1 where it leaves one
//     ray   -------|-------|-------|-------|------->   sorted by depth
//     sum      0       1       2       1       0       the number of shells that the ray is in; it is inside where this is > 0
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
#include <span>
#include <string>

#include "clip_triangle.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

constexpr int kBandRows = 8;
constexpr std::int64_t kSnap = 4096;   // units a pixel
constexpr double kSnapTie = 0x1p-16;   // more than a division on any device is off
constexpr double kGuard_px = 1 << 17;  // triangles that reach further out are clipped: edge functions could overflow
constexpr std::size_t kChunksOfTriangles = 64;

struct SnappedPoint {
    std::int64_t x, y;
};

/// A triangle in the picture, with its plane in eye space. Those near no pixel's centre are left out, which
/// are most where the surface is finer than the pixels.
struct ScreenTriangle {
    std::array<std::array<std::int32_t, 2>, 3> snapped;  // corners, ordered so that the area is positive
    std::int32_t sign;                                   // +1 where a ray enters the solid
    std::uint32_t id;
    Vec3 normal;
    double offset, z_min, z_max;

    [[nodiscard]] std::array<SnappedPoint, 3> corners() const {
        return {{{snapped[0][0], snapped[0][1]}, {snapped[1][0], snapped[1][1]}, {snapped[2][0], snapped[2][1]}}};
    }
};
static_assert(kGuard_px * kSnap < 2147483647.0, "corners have 32 bits");

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

int first_pixel(std::int64_t snapped) {
    return static_cast<int>(std::ceil(static_cast<double>(snapped) / static_cast<double>(kSnap) - 0.5));
}
int last_pixel(std::int64_t snapped) {
    return static_cast<int>(std::floor(static_cast<double>(snapped) / static_cast<double>(kSnap) - 0.5));
}

/// The pixels whose centres are in the box around a triangle, and in some rows of the picture.
struct PixelBlock {
    int x0, x1, y0, y1;  // the last ones included

    [[nodiscard]] bool empty() const { return x0 > x1 || y0 > y1; }
};

PixelBlock pixels_near(const std::array<SnappedPoint, 3>& t, const View& view, int y_begin, int y_end) {
    const auto [x_low, x_high] = std::minmax({t[0].x, t[1].x, t[2].x});
    const auto [y_low, y_high] = std::minmax({t[0].y, t[1].y, t[2].y});
    return {std::max(0, first_pixel(x_low)), std::min(view.width() - 1, last_pixel(x_high)),
            std::max(y_begin, first_pixel(y_low)), std::min(y_end - 1, last_pixel(y_high))};
}

class TriangleSetup {
public:
    TriangleSetup(const View& view, double near) : view_(view), planes_(clip_planes(view, near)) {}

    void add(std::uint32_t id, const std::array<Vec3, 3>& eye, std::vector<ScreenTriangle>& out) {
        id_ = id;
        polygon_.assign(eye.begin(), eye.end());
        for (const auto& plane : planes_) {
            const bool cut = std::any_of(polygon_.begin(), polygon_.end(), [&](const Vec3& p) { return is_outside(plane, p); });
            if (cut) clip_polygon(polygon_, plane, scratch_);
        }
        const Vec3 normal = glm::cross(eye[1] - eye[0], eye[2] - eye[0]);
        for (std::size_t i = 2; i < polygon_.size(); ++i) emit({polygon_[0], polygon_[i - 1], polygon_[i]}, eye, normal, out);
    }

private:
    void emit(const std::array<Vec3, 3>& part, const std::array<Vec3, 3>& eye, const Vec3& normal,
              std::vector<ScreenTriangle>& out) {
        ScreenTriangle t;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec2 px = view_.to_pixels(part[k]);
            t.snapped[k] = {static_cast<std::int32_t>(snap(px.x)), static_cast<std::int32_t>(snap(px.y))};
        }
        const auto corners = t.corners();
        const std::int64_t twice_area = area(corners[0], corners[1], corners[2]);
        if (twice_area == 0 || pixels_near(corners, view_, 0, view_.height()).empty()) return;
        // Triangles are counter-clockwise as seen from outside. As rows run downwards, the area is negative where they face the
        // eye.
        t.sign = twice_area < 0 ? 1 : -1;
        if (twice_area < 0) std::swap(t.snapped[1], t.snapped[2]);
        t.normal = normal;
        t.offset = glm::dot(normal, eye[0]);
        t.z_min = std::min({part[0].z, part[1].z, part[2].z});
        t.z_max = std::max({part[0].z, part[1].z, part[2].z});
        t.id = id_;
        out.push_back(t);
    }

    const View& view_;
    std::vector<ClipPlane> planes_;
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
    const PixelBlock block = pixels_near(corners, view, y_begin, y_end);
    if (block.empty()) return;
    const auto [x0, x1, y0, y1] = block;
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
        std::sort(sorted.data() + begin, sorted.data() + ends[i], [](const Hit& l, const Hit& r) {
            // Where two shells touch, the entry into one comes before the exit from the other: no gap opens.
            return l.depth != r.depth ? l.depth < r.depth : l.sign > r.sign;
        });
    }
}

/// Turns the sorted hits of one pixel into intervals.
void resolve(std::span<const Hit> hits, float near, std::vector<float>& depths, std::vector<std::uint32_t>& triangles) {
    int inside = 0;  // number of shells that the eye is in
    for (const Hit& hit : hits) inside -= hit.sign;
    inside = std::max(inside, 0);
    float enter = near;
    std::uint32_t triangle = PixelIntervals::kNoTriangle;
    for (const Hit& hit : hits) {
        if (hit.sign > 0 && inside++ == 0) {
            enter = hit.depth;
            triangle = hit.triangle;
        }
        if (hit.sign < 0 && inside > 0 && --inside == 0 && hit.depth > enter) {
            depths.insert(depths.end(), {enter, hit.depth});
            triangles.push_back(triangle);
        }
    }
}

std::vector<std::vector<ScreenTriangle>> project(const Surface& surface, const View& view, double near) {
    std::vector<std::vector<ScreenTriangle>> chunks(kChunksOfTriangles);
    const std::size_t count = surface.triangles.size();
    tbb::parallel_for(std::size_t{0}, kChunksOfTriangles, [&](std::size_t chunk) {
        TriangleSetup setup(view, near);
        for (std::size_t i = count * chunk / kChunksOfTriangles; i < count * (chunk + 1) / kChunksOfTriangles; ++i) {
            const auto& t = surface.triangles[i];
            setup.add(static_cast<std::uint32_t>(i),
                      {view.to_eye(surface.points[t[0]]), view.to_eye(surface.points[t[1]]), view.to_eye(surface.points[t[2]])},
                      chunks[chunk]);
        }
    });
    return chunks;
}

struct Band {
    std::vector<std::uint32_t> counts;  // intervals of each pixel
    std::vector<float> depths;
    std::vector<std::uint32_t> triangles;
    std::size_t hits = 0;
};

}  // namespace

bool needs_clipping(const Surface& surface, const View& view, double near) {
    const auto planes = clip_planes(view, near);
    std::atomic<bool> needed = false;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, surface.points.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i < range.end() && !needed; ++i) {
            const Vec3 p = view.to_eye(surface.points[i]);
            if (std::any_of(planes.begin(), planes.end(), [&](const auto& plane) { return is_outside(plane, p); }))
                needed = true;
        }
    });
    return needed;
}

PixelIntervals boundary_intervals(const Surface& surface, const View& view, double near, double middle) {
    const auto chunks = project(surface, view, near);
    const int band_count = (view.height() + kBandRows - 1) / kBandRows;
    // The triangles of each band, so that a band does not go through all of them.
    std::vector<std::vector<const ScreenTriangle*>> of_band(static_cast<std::size_t>(band_count));
    for (const auto& chunk : chunks) {
        for (const auto& t : chunk) {
            const PixelBlock block = pixels_near(t.corners(), view, 0, view.height());
            for (int band = block.y0 / kBandRows; band <= block.y1 / kBandRows; ++band) {
                of_band[static_cast<std::size_t>(band)].push_back(&t);
            }
        }
    }

    struct Scratch {
        std::vector<Hit> hits, sorted;
        std::vector<std::uint32_t> ends;
    };
    std::vector<Band> bands(static_cast<std::size_t>(band_count));
    tbb::enumerable_thread_specific<Scratch> scratches;
    tbb::parallel_for(0, band_count, [&](int b) {
        const int y0 = b * kBandRows, y1 = std::min(view.height(), y0 + kBandRows);
        Band& band = bands[static_cast<std::size_t>(b)];
        auto& [hits, sorted, ends] = scratches.local();
        hits.clear();
        for (const auto* t : of_band[static_cast<std::size_t>(b)]) rasterize(*t, view, middle, y0, y1, hits);
        const std::size_t pixels = static_cast<std::size_t>(y1 - y0) * static_cast<std::size_t>(view.width());
        sort_hits(hits, pixels, ends, sorted);
        band.hits = hits.size();
        band.counts.resize(pixels);
        for (std::size_t i = 0, begin = 0; i < pixels; begin = ends[i++]) {
            if (ends[i] == begin) continue;
            const std::size_t before = band.depths.size();
            resolve(std::span(sorted).subspan(begin, ends[i] - begin), static_cast<float>(near - middle), band.depths,
                    band.triangles);
            band.counts[i] = static_cast<std::uint32_t>((band.depths.size() - before) / 2);
        }
    });

    PixelIntervals result;
    result.offsets.reserve(pixel_count(view.width(), view.height()) + 1);
    result.offsets.push_back(0);
    for (const Band& band : bands) {
        for (const auto count : band.counts) result.offsets.push_back(result.offsets.back() + count);
        result.depths.insert(result.depths.end(), band.depths.begin(), band.depths.end());
        result.triangles.insert(result.triangles.end(), band.triangles.begin(), band.triangles.end());
        result.hits += band.hits;
    }
    return result;
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
