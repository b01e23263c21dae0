// SPDX-License-Identifier: Apache-2.0
#include "subvol/draw_shells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "boundary_intervals.h"
#include "boundary_light.h"
#include "clip_intervals.h"
#include "clip_triangle.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/triangle_raster.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol {

// Triangles into pixels. A triangle before the eye is a convex polygon of the picture, of 3 corners, or 4 where it is cut off
// before the eye. In a row it covers what lies between the polygon's outermost edges; the depth z follows from its plane:
//
//      n·x = n·a        x = z (s, 1), s the ray's slopes:   z = n·a / n·(s, 1)
//
// Bands of rows are filled in parallel, each from the triangles that reach it, in their order.
namespace detail {

namespace {

constexpr int kRows = 16;  // of the picture, which one task fills

struct Outline {
    std::array<Vec2, 4> corners{};
    std::size_t count = 0;
    int top = 0, bottom = -1;
};

Outline outline_of(const std::array<Vec3, 3>& triangle, const View& view) {
    const auto [a, b, c] = triangle;
    const double far = std::max({std::abs(a.z), std::abs(b.z), std::abs(c.z)}), near = 1e-6 * far;
    Outline outline;
    const auto add = [&](const Vec3& corner) { outline.corners[outline.count++] = view.to_pixels(corner); };
    if (view.perspective() && std::min({a.z, b.z, c.z}) < near) {
        std::vector<Vec3> polygon{a, b, c}, scratch;
        clip_polygon(polygon, {Vec3(0, 0, 1), -near}, scratch);
        if (polygon.size() < 3) return {};
        for (const Vec3& corner : polygon) add(corner);
    } else {
        for (const Vec3& corner : triangle) add(corner);
    }
    const auto corners = std::span(outline.corners).first(outline.count);
    const auto [top, bottom] = std::ranges::minmax(corners, {}, &Vec2::y);
    outline.top = static_cast<int>(std::ceil(std::clamp(top.y - 0.5, -1.0, 1e6)));
    outline.bottom = static_cast<int>(std::floor(std::clamp(bottom.y - 0.5, -1.0, 1e6)));
    return outline;
}

/// The columns of a row whose centres lie within the polygon; the second is before the first if there are none.
std::array<int, 2> columns_of(const Outline& outline, int row, int width) {
    double left = TriangleRaster::kFar, right = -left;
    for (std::size_t k = 0; k < outline.count; ++k) {
        const Vec2 &p = outline.corners[k], &q = outline.corners[(k + 1) % outline.count];
        const double t = (row + 0.5 - p.y) / (q.y - p.y);
        if (!(t >= 0 && t <= 1)) continue;
        const double x = p.x + t * (q.x - p.x);
        left = std::min(left, x);
        right = std::max(right, x);
    }
    if (!(left <= right)) return {0, -1};
    const int begin = static_cast<int>(std::ceil(std::clamp(left - 0.5, -1.0, 1e6)));
    const int end = static_cast<int>(std::floor(std::clamp(right - 0.5, -1.0, 1e6)));
    return {std::max(0, begin), std::min(width - 1, end)};
}

}  // namespace

TriangleRaster::TriangleRaster(const Surface& surface, const View& view, const Clip& clip)
    : eye(surface.points.size()), depth(view.width(), view.height(), kFar), triangle(view.width(), view.height(), kNothing) {
    const std::size_t triangles = surface.triangles.size(), bands = (depth.height + kRows - 1) / kRows;
    parallel_each(eye.size(), [&](std::size_t p) { eye[p] = view.to_eye(surface.points[p]); });
    const auto corners_of = [&](std::size_t t) {
        const auto& [a, b, c] = surface.triangles[t];
        return std::array{eye[a], eye[b], eye[c]};
    };
    std::vector<Outline> outlines(triangles);
    parallel_each(triangles, [&](std::size_t t) { outlines[t] = outline_of(corners_of(t), view); });
    std::vector<std::vector<std::uint32_t>> of_band(bands);
    for (std::uint32_t t = 0; t < triangles; ++t) {
        const int first = std::max(0, outlines[t].top), last = std::min(view.height() - 1, outlines[t].bottom);
        for (int band = first / kRows; first <= last && band <= last / kRows; ++band) {
            of_band[static_cast<std::size_t>(band)].push_back(t);
        }
    }
    const bool cuts = !clip.planes.empty() || clip.box;
    const auto fill = [&](std::uint32_t t, int first, int last) {
        const auto [a, b, c] = corners_of(t);
        const Vec3 flat = glm::cross(b - a, c - a);
        const double offset = glm::dot(flat, a);
        for (int y = std::max({0, first, outlines[t].top}); y <= std::min(last, outlines[t].bottom); ++y) {
            const auto [begin, end] = columns_of(outlines[t], y, view.width());
            for (int x = begin; x <= end; ++x) {
                const Vec2 slopes = view.slopes(x + 0.5, y + 0.5);
                const double z = view.perspective() ? offset / glm::dot(flat, Vec3(slopes, 1))
                                                    : (offset - glm::dot(flat, Vec3(slopes, 0))) / flat.z;
                if (!(z < double{depth.at(x, y)}) || z <= 0 || z > view.ray_end(x + 0.5, y + 0.5)) continue;
                if (cuts) {
                    const Ray ray = view.ray(x + 0.5, y + 0.5);
                    if (clip.removes(ray.origin + z * ray.direction)) continue;
                }
                depth.at(x, y) = static_cast<float>(z);
                triangle.at(x, y) = t;
            }
        }
    };
    tbb::parallel_for(std::size_t{0}, bands, [&](std::size_t band) {
        const int first = static_cast<int>(band) * kRows, last = std::min(view.height(), first + kRows) - 1;
        for (const std::uint32_t t : of_band[band]) fill(t, first, last);
    });
}

}  // namespace detail

using namespace detail;

namespace {

constexpr float kFar = TriangleRaster::kFar;
constexpr double kSmoothCosine = 0.766;  // of 40 degrees, as of boundaries

using Corners = std::array<Vec3, 3>;

/// Normals at the corners of each triangle: the mean over the triangles at the point that are bent little, whichever way these
/// are turned.
std::vector<Corners> two_sided_normals(const Surface& surface) {
    std::vector<Vec3> flat(surface.triangles.size());
    parallel_each(flat.size(), [&](std::size_t i) {
        const auto& [a, b, c] = surface.triangles[i];
        flat[i] = glm::cross(surface.points[b] - surface.points[a], surface.points[c] - surface.points[a]);
    });
    using AtPoint = std::pair<Index, Index>;  // a point and a triangle there
    const Buckets<AtPoint> at = bucket_sort<AtPoint>(
        flat.size(), surface.points.size(),
        [&](std::size_t i, const auto& sink) {
            for (const Index p : surface.triangles[i]) sink({p, static_cast<Index>(i)});
        },
        [](const AtPoint& record) { return record.first; });
    std::vector<Corners> normals(flat.size());
    tbb::parallel_for(std::size_t{0}, flat.size(), [&](std::size_t i) {
        const double length = glm::length(flat[i]);
        for (std::size_t k = 0; k < 3; ++k) {
            Vec3 sum(0.0);
            const Index p = surface.triangles[i][k];
            for (std::size_t n = at.offsets[p]; n < at.offsets[p + 1]; ++n) {
                const Index j = at.records[n].second;
                const double cosine = glm::dot(flat[i], flat[j]);
                if (std::abs(cosine) >= kSmoothCosine * length * glm::length(flat[j])) sum += cosine < 0 ? -flat[j] : flat[j];
            }
            normals[i][k] = sum;
        }
    });
    return normals;
}

/// The depths at which rays enter the volume first; infinite where they miss it.
Raster<float> entries(const Surface& boundary, const View& fine, const Clip& clip) {
    Raster<float> depths(fine.width(), fine.height(), kFar);
    if (boundary.triangles.empty()) return depths;
    Box box;
    for (const Vec3& point : boundary.points) box.add(point);
    const double middle = fine.to_eye(box.center()).z;
    PixelIntervals intervals = boundary_intervals(boundary, fine, nearest_depth(fine, box.diagonal()), middle);
    const RayClip cuts(clip, box.diagonal());
    if (!cuts.empty()) intervals = clip_intervals(intervals, fine, cuts, middle);
    for (std::size_t ray = 0; ray < depths.values.size(); ++ray) {
        const std::uint32_t first = intervals.offsets[ray];
        if (first < intervals.offsets[ray + 1]) {
            depths.values[ray] = static_cast<float>(double{intervals.depths[2 * first]} + middle);
        }
    }
    return depths;
}

/// The colour of the shells where rays meet them.
class ShellLight {
public:
    /// Keeps references to all of them.
    ShellLight(const ColoredSurface& shells, const TriangleRaster& hits, const View& fine, const Optics& optics,
               const Shading& shading)
        : shells_(shells),
          hits_(hits),
          fine_(fine),
          optics_(optics),
          shading_(shading),
          normals_(two_sided_normals(shells.surface)) {}

    [[nodiscard]] Vec3 color_at(int column, int row) const {
        const std::uint32_t number = hits_.triangle.at(column, row);
        const auto& corners = shells_.surface.triangles[number];
        const Corners at{hits_.eye[corners[0]], hits_.eye[corners[1]], hits_.eye[corners[2]]};
        const Vec2 slopes = fine_.slopes(column + 0.5, row + 0.5);
        const double z{hits_.depth.at(column, row)};
        const Vec3 place = fine_.perspective() ? z * Vec3(slopes, 1) : Vec3(slopes, z);
        const Vec3 flat = glm::cross(at[1] - at[0], at[2] - at[0]);
        Vec3 normal(0.0);
        double sum = 0, value = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double share =
                std::max(0.0, glm::dot(flat, glm::cross(at[(k + 2) % 3] - at[(k + 1) % 3], place - at[(k + 1) % 3])));
            sum += share;
            value += share * shells_.values[corners[k]];
            normal += share * normals_[number][k];
        }
        value = sum > 0 ? value / sum : shells_.values[corners[0]];
        const auto& [right, up, forward] = fine_.axes();
        normal = sum > 0 ? Vec3(glm::dot(right, normal), glm::dot(up, normal), glm::dot(forward, normal)) : flat;
        const Vec3 to_eye = fine_.perspective() ? -glm::normalize(place) : Vec3(0, 0, -1);
        const double length = glm::length(normal);
        if (length > 0) normal = (glm::dot(normal, to_eye) < 0 ? -1.0 : 1.0) * normal / length;
        const BoundaryLight light = surface_light(shading_, normal, to_eye);
        return double{light.diffuse} * optics_.color(value) + double{light.specular};
    }

private:
    const ColoredSurface& shells_;
    const TriangleRaster& hits_;
    const View& fine_;
    const Optics& optics_;
    const Shading& shading_;
    std::vector<Corners> normals_;
};

/// What the rays of a pixel meet. before, behind: sums of the colours of shells on this side of the volume and beyond
struct PixelRays {
    Vec3 before{0.0}, behind{0.0};
    int of_volume = 0, over_volume = 0, alone = 0, under_volume = 0;
    float nearest = kFar;

    [[nodiscard]] bool any() const { return over_volume + alone + under_volume > 0; }
    [[nodiscard]] bool any_first() const { return over_volume + alone > 0; }

    /// The picture's colour is that of the rays that meet the volume, alike for all of them; where a shell lies over the volume
    /// nothing is left of it.
    void mix_into(std::span<float, 4> pixel, double rays) const {
        const double left = of_volume > 0 ? 1.0 - double(over_volume) / of_volume : 1.0 - double(alone) / rays;
        const double opacity = of_volume > 0 ? std::min(1.0, double{pixel[3]} * rays / of_volume) : 0.0;
        const Vec3 added = (before + (1 - opacity) * behind) / rays;
        for (std::size_t c = 0; c < 3; ++c) {
            pixel[c] = static_cast<float>(left * double{pixel[c]} + added[static_cast<int>(c)]);
        }
        const double covered = (over_volume + alone + (1 - opacity) * under_volume) / rays;
        pixel[3] = static_cast<float>(std::min(1.0, left * double{pixel[3]} + covered));
    }
};

void check_sizes(const Image& image, std::span<const float> depth, const ColoredSurface& shells, const View& view) {
    if (shells.values.size() != shells.surface.points.size()) {
        throw Error(ErrorCode::InvalidInput,
                    "there are " + std::to_string(shells.values.size()) + " values for " +
                        std::to_string(shells.surface.points.size()) + " points",
                    "shells");
    }
    if (view.width() != image.width || view.height() != image.height ||
        (!depth.empty() && depth.size() != image.rgba.size() / 4)) {
        throw Error(ErrorCode::InvalidInput, "the picture, its depths and the view are not of one size", "shells");
    }
}

}  // namespace

void draw_shells(Image& image, std::span<float> depth, const ColoredSurface& shells, const Surface& boundary, const View& view,
                 const Optics& optics, const ShellOptions& options) {
    check_sizes(image, depth, shells, view);
    if (shells.surface.triangles.empty()) return;
    const int samples = options.samples;
    const View fine = view.resized(samples * view.width(), samples * view.height());
    const TriangleRaster hits(shells.surface, fine, options.clip);
    const Raster<float> enters = entries(boundary, fine, options.clip);
    const ShellLight light(shells, hits, fine, optics, options.shading);
    tbb::parallel_for(0, view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            PixelRays rays;
            for (int k = 0; k < samples * samples; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const bool volume = enters.at(column, row) < kFar;
                rays.of_volume += volume;
                if (hits.triangle.at(column, row) == TriangleRaster::kNothing) continue;
                const bool first = hits.depth.at(column, row) <= enters.at(column, row);
                (first ? rays.before : rays.behind) += light.color_at(column, row);
                ++(!first ? rays.under_volume : volume ? rays.over_volume : rays.alone);
                if (first) rays.nearest = std::min(rays.nearest, hits.depth.at(column, row));
            }
            if (rays.any()) rays.mix_into(image.pixel(x, y), samples * samples);
            if (depth.empty() || !rays.any_first()) continue;
            float& seen = depth[pixel_index(view.width(), x, y)];
            seen = std::min(seen, rays.nearest);
        }
    });
}

}  // namespace subvol
