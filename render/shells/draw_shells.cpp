// SPDX-License-Identifier: Apache-2.0
#include "subvol/draw_shells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "boundary_intervals.h"
#include "boundary_light.h"
#include "clip_intervals.h"
#include "clip_triangle.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol {

using namespace detail;

namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kNothing = 0xffffffff;
constexpr double kSmoothCosine = 0.766;  // of 40 degrees, as of boundaries
constexpr int kRows = 16;                // of the picture, which one task fills

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

/// A triangle before the eye, as a polygon of the picture.
struct Drawn {
    std::vector<Vec2> outline;
    int top = 0, bottom = -1;
};

/// The first triangle that each ray meets.
class ShellRaster {
public:
    ShellRaster(const Surface& surface, const View& fine, const Clip& clip)
        : depth(fine.width(), fine.height(), kFar), triangle(fine.width(), fine.height(), kNothing), fine_(fine), clip_(clip) {
        for (const Vec3& p : surface.points) eye.push_back(fine.to_eye(p));
        std::vector<Drawn> drawn(surface.triangles.size());
        tbb::parallel_for(std::size_t{0}, drawn.size(), [&](std::size_t i) { drawn[i] = outline_of(surface.triangles[i]); });
        tbb::parallel_for(0, (fine.height() + kRows - 1) / kRows, [&](int band) {
            const int first = band * kRows, last = std::min(fine.height(), first + kRows) - 1;
            for (std::size_t i = 0; i < drawn.size(); ++i) {
                if (drawn[i].top <= last && drawn[i].bottom >= first) fill(surface, drawn[i], i, first, last);
            }
        });
    }

    std::vector<Vec3> eye;  // the points of the surface
    Raster<float> depth;
    Raster<std::uint32_t> triangle;

private:
    [[nodiscard]] Drawn outline_of(const std::array<Index, 3>& corners) const {
        std::vector<Vec3> polygon, scratch;
        double far = 0;
        for (const Index p : corners) {
            polygon.push_back(eye[p]);
            far = std::max(far, std::abs(eye[p].z));
        }
        if (fine_.perspective()) clip_polygon(polygon, {Vec3(0, 0, 1), -1e-6 * far}, scratch);
        Drawn drawn;
        if (polygon.size() < 3) return drawn;
        double top = kFar, bottom = -kFar;
        for (const Vec3& corner : polygon) {
            drawn.outline.push_back(fine_.to_pixels(corner));
            top = std::min(top, drawn.outline.back().y);
            bottom = std::max(bottom, drawn.outline.back().y);
        }
        drawn.top = static_cast<int>(std::ceil(std::clamp(top - 0.5, -1.0, 1e6)));
        drawn.bottom = static_cast<int>(std::floor(std::clamp(bottom - 0.5, -1.0, 1e6)));
        return drawn;
    }

    void fill(const Surface& surface, const Drawn& drawn, std::size_t number, int first, int last) {
        const auto& [a, b, c] = surface.triangles[number];
        const Vec3 flat = glm::cross(eye[b] - eye[a], eye[c] - eye[a]);
        const double offset = glm::dot(flat, eye[a]);
        const std::size_t corners = drawn.outline.size();
        for (int y = std::max({0, first, drawn.top}); y <= std::min(last, drawn.bottom); ++y) {
            // The row's part within the polygon.
            double left = kFar, right = -kFar;
            for (std::size_t k = 0; k < corners; ++k) {
                const Vec2 &p = drawn.outline[k], &q = drawn.outline[(k + 1) % corners];
                const double t = (y + 0.5 - p.y) / (q.y - p.y);
                if (!(t >= 0 && t <= 1)) continue;
                const double x = p.x + t * (q.x - p.x);
                left = std::min(left, x);
                right = std::max(right, x);
            }
            if (!(left <= right)) continue;
            const int begin = static_cast<int>(std::ceil(std::clamp(left - 0.5, -1.0, 1e6)));
            const int end = static_cast<int>(std::floor(std::clamp(right - 0.5, -1.0, 1e6)));
            for (int x = std::max(0, begin); x <= std::min(fine_.width() - 1, end); ++x) {
                const Vec2 slopes = fine_.slopes(x + 0.5, y + 0.5);
                const double z = fine_.perspective() ? offset / glm::dot(flat, Vec3(slopes, 1))
                                                     : (offset - glm::dot(flat, Vec3(slopes, 0))) / flat.z;
                if (!(z < double{depth.at(x, y)}) || z <= 0) continue;
                if (!clip_.planes.empty() || clip_.box) {
                    const Ray ray = fine_.ray(x + 0.5, y + 0.5);
                    if (clip_.removes(ray.origin + z * ray.direction)) continue;
                }
                depth.at(x, y) = static_cast<float>(z);
                triangle.at(x, y) = static_cast<std::uint32_t>(number);
            }
        }
    }

    const View& fine_;
    const Clip& clip_;
};

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
    ShellLight(const ColoredSurface& shells, const ShellRaster& hits, const View& fine, const Optics& optics,
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
    const ShellRaster& hits_;
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
    const View fine(view.camera(), samples * view.width(), samples * view.height());
    const ShellRaster hits(shells.surface, fine, options.clip);
    const Raster<float> enters = entries(boundary, fine, options.clip);
    const ShellLight light(shells, hits, fine, optics, options.shading);
    tbb::parallel_for(0, view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            PixelRays rays;
            for (int k = 0; k < samples * samples; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const bool volume = enters.at(column, row) < kFar;
                rays.of_volume += volume;
                if (hits.triangle.at(column, row) == kNothing) continue;
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
