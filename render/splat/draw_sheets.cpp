// SPDX-License-Identifier: Apache-2.0
#include "subvol/draw_sheets.h"

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

bool is_cut(const Clip& clip, const Vec3& place) {
    for (const CutPlane& plane : clip.planes) {
        if (glm::dot(place - plane.point, plane.normal) > 0) return true;
    }
    return clip.box && glm::min(glm::max(place, clip.box->lower), clip.box->upper) != place;
}

/// A triangle before the eye, as a polygon of the picture.
struct Drawn {
    std::vector<Vec2> outline;
    int top = 0, bottom = -1;
};

/// The first triangle that each ray meets.
class SheetRaster {
public:
    SheetRaster(const Surface& surface, const View& fine, const Clip& clip) : fine_(fine), clip_(clip) {
        const std::size_t rays = static_cast<std::size_t>(fine.width()) * static_cast<std::size_t>(fine.height());
        depth.assign(rays, kFar);
        triangle.assign(rays, kNothing);
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
    std::vector<float> depth;
    std::vector<std::uint32_t> triangle;

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
                const auto at =
                    static_cast<std::size_t>(y) * static_cast<std::size_t>(fine_.width()) + static_cast<std::size_t>(x);
                if (!(z < static_cast<double>(depth[at])) || z <= 0) continue;
                if (!clip_.planes.empty() || clip_.box) {
                    const Ray ray = fine_.ray(x + 0.5, y + 0.5);
                    if (is_cut(clip_, ray.origin + z * ray.direction)) continue;
                }
                depth[at] = static_cast<float>(z);
                triangle[at] = static_cast<std::uint32_t>(number);
            }
        }
    }

    const View& fine_;
    const Clip& clip_;
};

/// The depths at which rays enter the volume first; infinite where they miss it.
std::vector<float> entries(const Surface& boundary, const View& fine, const Clip& clip) {
    std::vector<float> depths(static_cast<std::size_t>(fine.width()) * static_cast<std::size_t>(fine.height()), kFar);
    if (boundary.triangles.empty()) return depths;
    Box box;
    for (const Vec3& point : boundary.points) box.add(point);
    const double middle = fine.to_eye(box.center()).z;
    PixelIntervals intervals = boundary_intervals(boundary, fine, nearest_depth(fine, box.diagonal()), middle);
    const RayClip cuts(clip, box.diagonal());
    if (!cuts.empty()) intervals = clip_intervals(intervals, fine, cuts, middle);
    for (std::size_t ray = 0; ray < depths.size(); ++ray) {
        const std::uint32_t first = intervals.offsets[ray];
        if (first < intervals.offsets[ray + 1]) {
            depths[ray] = static_cast<float>(static_cast<double>(intervals.depths[2 * first]) + middle);
        }
    }
    return depths;
}

}  // namespace

void draw_sheets(Image& image, std::span<float> depth, const ColoredSurface& sheets, const Surface& boundary, const View& view,
                 const Optics& optics, const Shading& shading, int samples, const Clip& clip) {
    if (sheets.values.size() != sheets.surface.points.size()) {
        throw Error(ErrorCode::InvalidInput,
                    "there are " + std::to_string(sheets.values.size()) + " values for " +
                        std::to_string(sheets.surface.points.size()) + " points",
                    "sheets");
    }
    if (view.width() != image.width || view.height() != image.height ||
        (!depth.empty() && depth.size() != image.rgba.size() / 4)) {
        throw Error(ErrorCode::InvalidInput, "the picture, its depths and the view are not of one size", "sheets");
    }
    if (sheets.surface.triangles.empty()) return;
    const View fine(view.camera(), samples * view.width(), samples * view.height());
    const SheetRaster hits(sheets.surface, fine, clip);
    const std::vector<float> enters = entries(boundary, fine, clip);
    const std::vector<Corners> normals = two_sided_normals(sheets.surface);

    const auto color_at = [&](std::size_t ray, int column, int row) {
        const std::uint32_t number = hits.triangle[ray];
        const auto& corners = sheets.surface.triangles[number];
        const Corners at{hits.eye[corners[0]], hits.eye[corners[1]], hits.eye[corners[2]]};
        const Vec2 slopes = fine.slopes(column + 0.5, row + 0.5);
        const auto z = static_cast<double>(hits.depth[ray]);
        const Vec3 place = fine.perspective() ? z * Vec3(slopes, 1) : Vec3(slopes, z);
        const Vec3 flat = glm::cross(at[1] - at[0], at[2] - at[0]);
        Vec3 normal(0.0);
        double sum = 0, value = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double share =
                std::max(0.0, glm::dot(flat, glm::cross(at[(k + 2) % 3] - at[(k + 1) % 3], place - at[(k + 1) % 3])));
            sum += share;
            value += share * sheets.values[corners[k]];
            normal += share * normals[number][k];
        }
        value = sum > 0 ? value / sum : sheets.values[corners[0]];
        const auto& [right, up, forward] = fine.axes();
        normal = sum > 0 ? Vec3(glm::dot(right, normal), glm::dot(up, normal), glm::dot(forward, normal)) : flat;
        const Vec3 to_eye = fine.perspective() ? -glm::normalize(place) : Vec3(0, 0, -1);
        const double length = glm::length(normal);
        if (length > 0) normal = (glm::dot(normal, to_eye) < 0 ? -1.0 : 1.0) * normal / length;
        const BoundaryLight light = surface_light(shading, normal, to_eye);
        return static_cast<double>(light.diffuse) * optics.color(value) + static_cast<double>(light.specular);
    };

    tbb::parallel_for(0, view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            Vec3 before(0.0), behind(0.0);  // the volume
            int of_volume = 0, over_volume = 0, alone = 0, under_volume = 0;
            double nearest = static_cast<double>(kFar);
            for (int k = 0; k < samples * samples; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const auto ray =
                    static_cast<std::size_t>(row) * static_cast<std::size_t>(fine.width()) + static_cast<std::size_t>(column);
                const bool volume = enters[ray] < kFar;
                of_volume += volume;
                if (hits.triangle[ray] == kNothing) continue;
                const bool first = hits.depth[ray] <= enters[ray];
                (first ? before : behind) += color_at(ray, column, row);
                if (!first) {
                    ++under_volume;
                    continue;
                }
                ++(volume ? over_volume : alone);
                nearest = std::min(nearest, static_cast<double>(hits.depth[ray]));
            }
            if (over_volume + alone + under_volume == 0) continue;
            const double all = samples * samples;
            const auto pixel = image.pixel(x, y);
            // The picture's colour is that of the rays that meet the volume, alike for all of them; of those over which a sheet
            // lies none is left.
            const double left =
                of_volume > 0 ? 1.0 - static_cast<double>(over_volume) / of_volume : 1.0 - static_cast<double>(alone) / all;
            const double opacity = of_volume > 0 ? std::min(1.0, static_cast<double>(pixel[3]) * all / of_volume) : 0.0;
            const Vec3 added = (before + (1 - opacity) * behind) / all;
            for (std::size_t c = 0; c < 3; ++c) {
                pixel[c] = static_cast<float>(left * static_cast<double>(pixel[c]) + added[static_cast<int>(c)]);
            }
            const double covered = (over_volume + alone + (1 - opacity) * under_volume) / all;
            pixel[3] = static_cast<float>(std::min(1.0, left * static_cast<double>(pixel[3]) + covered));
            if (depth.empty() || over_volume + alone == 0) continue;
            float& seen =
                depth[static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width()) + static_cast<std::size_t>(x)];
            seen = std::min(seen, static_cast<float>(nearest));
        }
    });
}

}  // namespace subvol
