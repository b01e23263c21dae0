// SPDX-License-Identifier: Apache-2.0
#include "surface_preview.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "subvol/raster.h"
#include "subvol/splat_options.h"

namespace subvol::detail {

namespace {

/// A triangle in pixels, with 1 / depth at its corners (or, of parallel rays, the depth), which is linear in the picture.
struct Drawn {
    std::array<Vec2, 3> at;
    std::array<double, 3> depth;
    Vec3 color{0.0};
    int top = 0, bottom = -1;
};

constexpr int kRows = 16;  // of the picture, which one task fills

double side(const Vec2& a, const Vec2& b, const Vec2& p) {
    return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
}

void fill(const Drawn& triangle, const View& view, const Clip& clip, int first, int last, Preview& preview) {
    const bool perspective = view.perspective();
    const auto& [a, b, c] = triangle.at;
    const double area = side(a, b, c);
    if (area == 0) return;
    const int left = std::max(0, static_cast<int>(std::ceil(std::min({a.x, b.x, c.x}) - 0.5)));
    const int right = std::min(preview.image.width - 1, static_cast<int>(std::floor(std::max({a.x, b.x, c.x}) - 0.5)));
    for (int y = std::max(first, triangle.top); y <= std::min(last, triangle.bottom); ++y) {
        for (int x = left; x <= right; ++x) {
            const Vec2 p(x + 0.5, y + 0.5);
            const double u = side(b, c, p) / area, v = side(c, a, p) / area, w = 1 - u - v;
            if (u < 0 || v < 0 || w < 0) continue;
            const double linear = u * triangle.depth[0] + v * triangle.depth[1] + w * triangle.depth[2];
            const auto depth = static_cast<float>(perspective ? 1 / linear : linear);
            float& nearest = preview.depth[pixel_index(preview.image.width, x, y)];
            if (depth >= nearest || !(depth > 0)) continue;
            if (!clip.empty()) {
                const Ray ray = view.ray(p.x, p.y);
                if (clip.removes(ray.origin + double{depth} * ray.direction)) continue;
            }
            nearest = depth;
            const auto pixel = preview.image.pixel(x, y);
            for (std::size_t k = 0; k < 3; ++k) pixel[k] = static_cast<float>(triangle.color[static_cast<int>(k)]);
            pixel[3] = 1;
        }
    }
}

/// As the boundary of solids is lit, without gloss.
double light_on(const Vec3& normal, const Vec3& to_eye) {
    const Shading shading;
    const double head = std::max(0.0, glm::dot(normal, to_eye));
    const double key = std::max(0.0, glm::dot(normal, glm::normalize(shading.key)));
    return shading.ambient + shading.diffuse * 0.5 * (head + key);
}

}  // namespace

Preview surface_preview(const BoundaryValues& boundary, const View& view, const Optics& optics, const Clip& clip) {
    const Surface& surface = boundary.surface;
    const std::vector<double>& values = boundary.values.back();
    std::vector<Vec3> eye(surface.points.size());
    tbb::parallel_for(std::size_t{0}, eye.size(), [&](std::size_t p) { eye[p] = view.to_eye(surface.points[p]); });
    std::vector<Drawn> drawn(surface.triangles.size());
    tbb::parallel_for(std::size_t{0}, drawn.size(), [&](std::size_t t) {
        const auto& corners = surface.triangles[t];
        Drawn& one = drawn[t];
        double value = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3& place = eye[corners[k]];
            if (view.perspective() && !(place.z > 0)) return;
            one.at[k] = view.to_pixels(place);
            one.depth[k] = view.perspective() ? 1 / place.z : place.z;
            value += values[corners[k]] / 3;
        }
        const double low = std::min({one.at[0].y, one.at[1].y, one.at[2].y});
        const double high = std::max({one.at[0].y, one.at[1].y, one.at[2].y});
        if (!(high > 0) || !(low < view.height())) return;
        one.top = std::max(0, static_cast<int>(std::ceil(low - 0.5)));
        one.bottom = std::min(view.height() - 1, static_cast<int>(std::floor(high - 0.5)));
        if (one.top > one.bottom) return;
        const Vec3 &a = eye[corners[0]], &b = eye[corners[1]], &c = eye[corners[2]];
        // Eye space (right, up, away from the eye) is left-handed: outward normals turn round.
        const Vec3 flat = glm::cross(c - a, b - a);
        const double length = glm::length(flat);
        if (!(length > 0)) return;
        const Vec3 to_eye = view.perspective() ? -glm::normalize(a) : Vec3(0, 0, -1);
        one.color = light_on(flat / length, to_eye) * optics.color(value);
    });
    Preview preview{Image(view.width(), view.height()), {}};
    preview.depth.assign(preview.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    const int bands = (view.height() + kRows - 1) / kRows;
    std::vector<std::vector<std::uint32_t>> of_band(static_cast<std::size_t>(bands));
    for (std::size_t t = 0; t < drawn.size(); ++t) {
        for (int band = drawn[t].top / kRows; band <= drawn[t].bottom / kRows && drawn[t].bottom >= 0; ++band)
            of_band[static_cast<std::size_t>(band)].push_back(static_cast<std::uint32_t>(t));
    }
    tbb::parallel_for(0, bands, [&](int band) {
        for (const std::uint32_t t : of_band[static_cast<std::size_t>(band)])
            fill(drawn[t], view, clip, band * kRows, band * kRows + kRows - 1, preview);
    });
    return preview;
}

}  // namespace subvol::detail
