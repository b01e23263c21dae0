// SPDX-License-Identifier: Apache-2.0
// Triangles into pixels. A triangle before the eye is a convex polygon of the picture, of 3 corners, or 4 where it is cut off
// before the eye. In a row it covers what lies between the polygon's outermost edges; the depth z follows from its plane:
//
//      n·x = n·a        x = z (s, 1), s the ray's slopes:   z = n·a / n·(s, 1)
//
// Bands of rows are filled in parallel, each from the triangles that reach it, in their order.
//
// Opaque triangles keep the nearest depth of each ray. It is compared with the depth at which the ray enters the volume: what
// lies before it hides the volume, what lies behind it is added as far as the pixel is transparent. Of translucent triangles
// all layers before the volume are gathered, sorted by depth and composited; of two triangles at one depth, turned the same
// way, the first counts. Light falls on either side, with normals that are means over neighbours bent by less than 40 degrees.
// Pixels are means over n × n rays.
#include "subvol/draw_shells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <tuple>
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

/// The rows of a picture that triangles reach, in bands.
class TriangleRows {
public:
    /// eye: the surface's points in eye space. Keeps references to all of them.
    TriangleRows(const Surface& surface, const std::vector<Vec3>& eye, const View& view, const Clip& clip)
        : surface_(surface),
          eye_(eye),
          view_(view),
          clip_(clip),
          outlines_(surface.triangles.size()),
          of_band_(static_cast<std::size_t>((view.height() + kRows - 1) / kRows)) {
        parallel_each(outlines_.size(), [&](std::size_t t) { outlines_[t] = outline_of(corners_of(t), view); });
        for (std::uint32_t t = 0; t < outlines_.size(); ++t) {
            const int first = std::max(0, outlines_[t].top), last = std::min(view.height() - 1, outlines_[t].bottom);
            for (int band = first / kRows; first <= last && band <= last / kRows; ++band) {
                of_band_[static_cast<std::size_t>(band)].push_back(t);
            }
        }
    }

    /// Calls take(x, y, z, t) where rays meet triangles that the clip leaves, in parallel bands, each in the triangles' order.
    ///
    /// wants(x, y, z): whether take would do something
    template <class Wants, class Take>
    void each(const Wants& wants, const Take& take) const {
        tbb::parallel_for(std::size_t{0}, of_band_.size(), [&](std::size_t band) {
            const int first = static_cast<int>(band) * kRows, last = std::min(view_.height(), first + kRows) - 1;
            for (const std::uint32_t t : of_band_[band]) fill(t, first, last, wants, take);
        });
    }

private:
    [[nodiscard]] std::array<Vec3, 3> corners_of(std::size_t t) const {
        const auto& [a, b, c] = surface_.triangles[t];
        return {eye_[a], eye_[b], eye_[c]};
    }

    template <class Wants, class Take>
    void fill(std::uint32_t t, int first, int last, const Wants& wants, const Take& take) const {
        const bool cuts = !clip_.planes.empty() || clip_.box;
        const auto [a, b, c] = corners_of(t);
        const Vec3 flat = glm::cross(b - a, c - a);
        const double offset = glm::dot(flat, a);
        for (int y = std::max({0, first, outlines_[t].top}); y <= std::min(last, outlines_[t].bottom); ++y) {
            const auto [begin, end] = columns_of(outlines_[t], y, view_.width());
            for (int x = begin; x <= end; ++x) {
                const Vec2 slopes = view_.slopes(x + 0.5, y + 0.5);
                const double z = view_.perspective() ? offset / glm::dot(flat, Vec3(slopes, 1))
                                                     : (offset - glm::dot(flat, Vec3(slopes, 0))) / flat.z;
                if (!(z > 0) || !wants(x, y, z) || z > view_.ray_end(x + 0.5, y + 0.5)) continue;
                if (cuts) {
                    const Ray ray = view_.ray(x + 0.5, y + 0.5);
                    if (clip_.removes(ray.origin + z * ray.direction)) continue;
                }
                take(x, y, z, t);
            }
        }
    }

    const Surface& surface_;
    const std::vector<Vec3>& eye_;
    const View& view_;
    const Clip& clip_;
    std::vector<Outline> outlines_;
    std::vector<std::vector<std::uint32_t>> of_band_;
};

std::vector<Vec3> to_eye(const Surface& surface, const View& view) {
    std::vector<Vec3> eye(surface.points.size());
    parallel_each(eye.size(), [&](std::size_t p) { eye[p] = view.to_eye(surface.points[p]); });
    return eye;
}

}  // namespace

TriangleRaster::TriangleRaster(const Surface& surface, const View& view, const Clip& clip)
    : eye(to_eye(surface, view)), depth(view.width(), view.height(), kFar), triangle(view.width(), view.height(), kNothing) {
    TriangleRows(surface, eye, view, clip)
        .each([&](int x, int y, double z) { return z < double{depth.at(x, y)}; },
              [&](int x, int y, double z, std::uint32_t t) {
                  depth.at(x, y) = static_cast<float>(z);
                  triangle.at(x, y) = t;
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

/// The colour of a surface with the light on it, and its opacity.
struct Lit {
    Vec3 color{0.0};
    double opacity = 1;
};

/// The colour of the shells where rays meet them.
class ShellLight {
public:
    /// Keeps references to all of them.
    ShellLight(const ColoredSurface& shells, const std::vector<Vec3>& eye, const View& fine, const Optics& optics,
               const Shading& shading)
        : shells_(shells),
          eye_(eye),
          fine_(fine),
          optics_(optics),
          shading_(shading),
          normals_(two_sided_normals(shells.surface)) {}

    /// Where a ray meets a triangle at the depth z.
    [[nodiscard]] Lit at(int column, int row, double z, std::uint32_t number) const {
        const auto& corners = shells_.surface.triangles[number];
        const Corners at{eye_[corners[0]], eye_[corners[1]], eye_[corners[2]]};
        const Vec2 slopes = fine_.slopes(column + 0.5, row + 0.5);
        const Vec3 place = fine_.perspective() ? z * Vec3(slopes, 1) : Vec3(slopes, z);
        const Vec3 flat = glm::cross(at[1] - at[0], at[2] - at[0]);
        Vec3 normal(0.0);
        double sum = 0, value = 0, opacity = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const double share =
                std::max(0.0, glm::dot(flat, glm::cross(at[(k + 2) % 3] - at[(k + 1) % 3], place - at[(k + 1) % 3])));
            sum += share;
            value += share * shells_.values[corners[k]];
            if (!shells_.opacities.empty()) opacity += share * double{shells_.opacities[corners[k]]};
            normal += share * normals_[number][k];
        }
        value = sum > 0 ? value / sum : shells_.values[corners[0]];
        opacity = shells_.opacities.empty() ? 1 : sum > 0 ? opacity / sum : double{shells_.opacities[corners[0]]};
        const auto& [right, up, forward] = fine_.axes();
        normal = sum > 0 ? Vec3(glm::dot(right, normal), glm::dot(up, normal), glm::dot(forward, normal)) : flat;
        const Vec3 to_eye = fine_.perspective() ? -glm::normalize(place) : Vec3(0, 0, -1);
        const double length = glm::length(normal);
        if (length > 0) normal = (glm::dot(normal, to_eye) < 0 ? -1.0 : 1.0) * normal / length;
        const SurfaceLight light = surface_light(shading_, normal, to_eye);
        return {double{light.diffuse} * optics_.color(value) + double{light.specular}, opacity};
    }

    /// Whether a ray meets the triangle on the side that its corners turn to.
    [[nodiscard]] bool is_front(std::uint32_t number) const {
        const auto& corners = shells_.surface.triangles[number];
        const Vec3 &a = eye_[corners[0]], &b = eye_[corners[1]], &c = eye_[corners[2]];
        const Vec3 flat = glm::cross(b - a, c - a);
        return (fine_.perspective() ? glm::dot(flat, a) : flat.z) > 0;
    }

private:
    const ColoredSurface& shells_;
    const std::vector<Vec3>& eye_;
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
    ///
    /// ended: rays of the volume have ended at shells, so that what they hide is not in the picture
    void mix_into(std::span<float, 4> pixel, double rays, bool ended) const {
        const double hidden = of_volume > 0 ? double(over_volume) / of_volume : double(alone) / rays;
        const double left = ended ? 1.0 : 1.0 - hidden;
        const double opacity = of_volume > 0 ? std::min(1.0, double{pixel[3]} * rays / of_volume) : 0.0;
        const Vec3 added = (before + (1 - opacity) * behind) / rays;
        for (std::size_t c = 0; c < 3; ++c) {
            pixel[c] = static_cast<float>(left * double{pixel[c]} + added[static_cast<int>(c)]);
        }
        const double covered = (over_volume + alone + (1 - opacity) * under_volume) / rays;
        pixel[3] = static_cast<float>(std::min(1.0, left * double{pixel[3]} + covered));
    }
};

/// What a ray meets of translucent triangles.
struct Layer {
    std::size_t ray = 0;
    double z = 0;
    std::uint32_t triangle = 0;
};

/// The light that translucent layers add to a ray, and the part of what is behind them that they let through.
struct Veil {
    std::array<float, 3> color{};
    float through = 1;
};

/// The layers before the volume, for each ray. Triangles that share an edge may both meet a ray there: one of them counts.
std::vector<Veil> veils_of(const View& fine, const Raster<float>& enters, const ShellLight& light, const TriangleRows& rows) {
    constexpr double kSame = 1e-7;  // of a depth
    const auto width = static_cast<std::size_t>(fine.width());
    std::vector<std::vector<Layer>> of_row(static_cast<std::size_t>(fine.height()));
    rows.each([&](int x, int y, double z) { return z < double{enters.at(x, y)}; },
              [&](int x, int y, double z, std::uint32_t t) {
                  of_row[static_cast<std::size_t>(y)].push_back({static_cast<std::size_t>(x), z, t});
              });
    std::vector<Veil> veils(width * of_row.size());
    parallel_each(of_row.size(), [&](std::size_t row) {
        std::vector<Layer>& layers = of_row[row];
        std::ranges::sort(layers, {}, [](const Layer& l) { return std::tuple(l.ray, l.z, l.triangle); });
        for (std::size_t i = 0; i < layers.size(); ++i) {
            const Layer& layer = layers[i];
            bool again = false;
            for (std::size_t k = i; k > 0 && !again && layers[k - 1].ray == layer.ray; --k) {
                if (layer.z - layers[k - 1].z > kSame * layer.z) break;
                again = light.is_front(layers[k - 1].triangle) == light.is_front(layer.triangle);
            }
            if (again) continue;
            Veil& veil = veils[row * width + layer.ray];
            const Lit lit = light.at(static_cast<int>(layer.ray), static_cast<int>(row), layer.z, layer.triangle);
            const double part = double{veil.through} * lit.opacity;
            for (std::size_t c = 0; c < 3; ++c) veil.color[c] += static_cast<float>(part * lit.color[static_cast<int>(c)]);
            veil.through -= static_cast<float>(part);
        }
        layers = {};
    });
    return veils;
}

/// Draws triangles that let light through before the volume.
void draw_veils(Image& image, const ColoredSurface& shells, const Surface& boundary, const View& view, const Optics& optics,
                const ShellOptions& options) {
    const int samples = options.samples, rays = samples * samples;
    const View fine = view.resized(samples * view.width(), samples * view.height());
    const std::vector<Vec3> eye = to_eye(shells.surface, fine);
    const Raster<float> enters = entries(boundary, fine, options.clip);
    const ShellLight light(shells, eye, fine, optics, options.shading);
    const std::vector<Veil> veils = veils_of(fine, enters, light, TriangleRows(shells.surface, eye, fine, options.clip));
    tbb::parallel_for(0, view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            Vec3 color(0.0);
            double through = 0, to_volume = 0;
            int of_volume = 0;
            for (int k = 0; k < rays; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const Veil& veil = veils[pixel_index(fine.width(), column, row)];
                color += Vec3(veil.color[0], veil.color[1], veil.color[2]);
                through += double{veil.through};
                if (!(enters.at(column, row) < kFar)) continue;
                to_volume += double{veil.through};
                ++of_volume;
            }
            const auto pixel = image.pixel(x, y);
            const double left = of_volume > 0 ? to_volume / of_volume : through / rays;
            for (std::size_t c = 0; c < 3; ++c)
                pixel[c] = static_cast<float>(left * double{pixel[c]} + color[static_cast<int>(c)] / rays);
            pixel[3] = static_cast<float>(std::min(1.0, left * double{pixel[3]} + 1 - through / rays));
        }
    });
}

void check_sizes(const Image& image, std::span<const float> depth, const ColoredSurface& shells, const View& view) {
    if (shells.values.size() != shells.surface.points.size()) {
        throw Error(ErrorCode::InvalidInput,
                    "there are " + std::to_string(shells.values.size()) + " values for " +
                        std::to_string(shells.surface.points.size()) + " points",
                    "shells");
    }
    if (!shells.opacities.empty() && shells.opacities.size() != shells.surface.points.size())
        throw Error(ErrorCode::InvalidInput, "there is not one opacity for each point", "shells");
    if (view.width() != image.width || view.height() != image.height ||
        (!depth.empty() && depth.size() != image.rgba.size() / 4)) {
        throw Error(ErrorCode::InvalidInput, "the picture, its depths and the view are not of one size", "shells");
    }
}

}  // namespace

std::vector<float> depths_of(const Surface& surface, const View& view, const Clip& clip) {
    return std::move(TriangleRaster(surface, view, clip).depth.values);
}

void draw_shells(Image& image, std::span<float> depth, const ColoredSurface& shells, const Surface& boundary, const View& view,
                 const Optics& optics, const ShellOptions& options) {
    check_sizes(image, depth, shells, view);
    if (shells.surface.triangles.empty()) return;
    if (!shells.opacities.empty()) return draw_veils(image, shells, boundary, view, optics, options);
    const int samples = options.samples;
    const View fine = view.resized(samples * view.width(), samples * view.height());
    const Clip uncut;
    const TriangleRaster hits(shells.surface, fine, options.whole ? uncut : options.clip);
    const Raster<float> enters = entries(boundary, fine, options.clip);
    const ShellLight light(shells, hits.eye, fine, optics, options.shading);
    tbb::parallel_for(0, view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            PixelRays rays;
            for (int k = 0; k < samples * samples; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const bool volume = enters.at(column, row) < kFar;
                rays.of_volume += volume;
                if (hits.triangle.at(column, row) == TriangleRaster::kNothing) continue;
                const bool first = hits.depth.at(column, row) <= enters.at(column, row);
                const Lit lit = light.at(column, row, double{hits.depth.at(column, row)}, hits.triangle.at(column, row));
                (first ? rays.before : rays.behind) += lit.color;
                ++(!first ? rays.under_volume : volume ? rays.over_volume : rays.alone);
                if (first) rays.nearest = std::min(rays.nearest, hits.depth.at(column, row));
            }
            if (rays.any()) rays.mix_into(image.pixel(x, y), samples * samples, options.ended);
            if (depth.empty() || !rays.any_first()) continue;
            float& seen = depth[pixel_index(view.width(), x, y)];
            seen = std::min(seen, rays.nearest);
        }
    });
}

}  // namespace subvol
