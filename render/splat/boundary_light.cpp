// SPDX-License-Identifier: Apache-2.0
#include "boundary_light.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "clip_intervals.h"
#include "subvol/boundary_shading.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// The shares of a triangle's corners in a place on it (eye space), each at least 0; their sum is not 1.
std::array<double, 3> shares_at(const Surface& surface, const View& view, std::uint32_t triangle, const Vec3& place) {
    std::array<Vec3, 3> eye;
    for (std::size_t k = 0; k < 3; ++k) eye[k] = view.to_eye(surface.points[surface.triangles[triangle][k]]);
    const Vec3 flat = glm::cross(eye[1] - eye[0], eye[2] - eye[0]);
    std::array<double, 3> shares;
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 &a = eye[(k + 1) % 3], &b = eye[(k + 2) % 3];
        shares[k] = std::max(0.0, glm::dot(flat, glm::cross(b - a, place - a)));
    }
    return shares;
}

/// A direction of the world in eye space.
Vec3 turned(const View& view, const Vec3& direction) {
    const auto& [right, up, forward] = view.axes();
    return {glm::dot(right, direction), glm::dot(up, direction), glm::dot(forward, direction)};
}

/// Interpolates the normals of a triangle at a place on it (eye space).
Vec3 normal_at(const Surface& surface, const CornerNormals& corners, const View& view, std::uint32_t triangle,
               const Vec3& place) {
    const std::array<double, 3> shares = shares_at(surface, view, triangle, place);
    Vec3 sum(0.0);
    for (std::size_t k = 0; k < 3; ++k) sum += shares[k] * Vec3(corners[k][0], corners[k][1], corners[k][2]);
    return turned(view, sum);
}

BoundaryLight light_on(const Shading& shading, const Vec3& normal, const Vec3& to_eye) {
    const Vec3 to_key = glm::normalize(shading.key);
    const double head = std::max(0.0, glm::dot(normal, to_eye)), side = std::max(0.0, glm::dot(normal, to_key));
    const double halfway = std::max(0.0, glm::dot(normal, glm::normalize(to_key + to_eye)));
    const double gloss = std::pow(head, shading.shininess) + std::pow(halfway, shading.shininess);
    return {static_cast<float>(shading.ambient + shading.diffuse * 0.5 * (head + side)),
            static_cast<float>(shading.specular * 0.5 * gloss)};
}

/// What the lights depend on besides the intervals.
struct LitSurface {
    const Surface& surface;
    const std::vector<CornerNormals>& normals;
    const Shading& shading;
    double middle;                       // the depth that those of the intervals are relative to
    const std::vector<CutPlane>& faces;  // of the clip
};

std::vector<BoundaryLight> lights_of(const PixelIntervals& intervals, const LitSurface& lit, const View& view) {
    std::vector<BoundaryLight> lights(intervals.triangles.size());
    tbb::parallel_for(0, view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            const auto pixel =
                static_cast<std::size_t>(y) * static_cast<std::size_t>(view.width()) + static_cast<std::size_t>(x);
            const Vec2 slopes = view.slopes(x + 0.5, y + 0.5);
            for (std::size_t i = intervals.offsets[pixel]; i < intervals.offsets[pixel + 1]; ++i) {
                const std::uint32_t triangle = intervals.triangles[i];
                if (triangle == PixelIntervals::kNoTriangle) continue;
                const double z = static_cast<double>(intervals.depths[2 * i]) + lit.middle;
                const Vec3 place = view.perspective() ? z * Vec3(slopes, 1) : Vec3(slopes, z);
                const Vec3 normal = triangle >= PixelIntervals::kFirstFace
                                        ? turned(view, lit.faces[triangle - PixelIntervals::kFirstFace].normal)
                                        : normal_at(lit.surface, lit.normals[triangle], view, triangle, place);
                const double length = glm::length(normal);
                if (!(length > 0)) continue;
                const Vec3 to_eye = view.perspective() ? -glm::normalize(place) : Vec3(0, 0, -1);
                lights[i] = light_on(lit.shading, normal / length, to_eye);
            }
        }
    });
    return lights;
}

}  // namespace

std::vector<BoundaryLight> entry_lights(const PixelIntervals& intervals, const SplatScene& scene, const View& view) {
    const double middle = view.to_eye(scene.middle).z;
    return lights_of(intervals, {scene.volume->boundary, scene.boundary_normals, *scene.shading, middle, scene.clip.faces()},
                     view);
}

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

/// The first hits of a picture's rays on a boundary, and the light there.
struct FirstHits {
    View fine;  // a pixel for each ray
    double middle;
    PixelIntervals intervals;
    std::vector<BoundaryLight> lights;

    FirstHits(const Surface& boundary, const View& view, const Shading& shading, int samples, const RayClip& clip)
        : fine(view.camera(), samples * view.width(), samples * view.height()) {
        Box box;
        for (const Vec3& point : boundary.points) box.add(point);
        middle = fine.to_eye(box.center()).z;
        intervals = boundary_intervals(boundary, fine, fine.perspective() ? 1e-4 * box.diagonal() : 0.0, middle);
        if (!clip.empty()) intervals = clip_intervals(intervals, fine, clip, middle);
        const std::vector<CornerNormals> normals = corner_normals(boundary);
        lights = lights_of(intervals, {boundary, normals, shading, middle, clip.faces()}, fine);
    }
};

}  // namespace

void light_boundary(Image& image, const Surface& boundary, const View& view, const Shading& shading, int samples,
                    const Clip& clip) {
    const RayClip cuts(clip);
    const FirstHits hits(boundary, view, shading, samples, cuts);
    const PixelIntervals& intervals = hits.intervals;
    tbb::parallel_for(0, view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            double diffuse = 0, specular = 0;
            int met = 0;
            for (int k = 0; k < samples * samples; ++k) {
                const auto row = static_cast<std::size_t>(y * samples + k / samples);
                const auto id =
                    row * static_cast<std::size_t>(hits.fine.width()) + static_cast<std::size_t>(x * samples + k % samples);
                if (intervals.offsets[id] == intervals.offsets[id + 1]) continue;
                diffuse += static_cast<double>(hits.lights[intervals.offsets[id]].diffuse);
                specular += static_cast<double>(hits.lights[intervals.offsets[id]].specular);
                ++met;
            }
            // A ray may hit the body just beside the outline of these triangles: there the surface is seen edge-on.
            if (met == 0) diffuse = shading.ambient;
            const auto pixel = image.pixel(x, y);
            for (std::size_t c = 0; c < 3; ++c) {
                const double color = static_cast<double>(pixel[c]) * diffuse + static_cast<double>(pixel[3]) * specular;
                pixel[c] = static_cast<float>(color / std::max(met, 1));
            }
        }
    });
}

void color_boundary(Image& image, const Surface& boundary, std::span<const double> values, const View& view,
                    const Optics& optics, const Shading& shading, int samples, const Clip& clip) {
    if (values.size() != boundary.points.size()) {
        throw Error(
            ErrorCode::InvalidInput,
            "there are " + std::to_string(values.size()) + " values for " + std::to_string(boundary.points.size()) + " points",
            "boundary");
    }
    const RayClip cuts(clip);
    const FirstHits hits(boundary, view, shading, samples, cuts);
    const auto color_of = [&](std::size_t interval, int x, int y) {
        const std::uint32_t triangle = hits.intervals.triangles[interval];
        const Vec2 slopes = hits.fine.slopes(x + 0.5, y + 0.5);
        const double z = static_cast<double>(hits.intervals.depths[2 * interval]) + hits.middle;
        const Vec3 place = hits.fine.perspective() ? z * Vec3(slopes, 1) : Vec3(slopes, z);
        const std::array<double, 3> shares = shares_at(boundary, hits.fine, triangle, place);
        double sum = 0, value = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            sum += shares[k];
            value += shares[k] * values[boundary.triangles[triangle][k]];
        }
        value = sum > 0 ? value / sum : values[boundary.triangles[triangle][0]];
        const BoundaryLight& light = hits.lights[interval];
        return static_cast<double>(light.diffuse) * optics.color(value) + static_cast<double>(light.specular);
    };
    tbb::parallel_for(0, view.height(), [&](int y) {
        for (int x = 0; x < view.width(); ++x) {
            Vec3 color(0.0);
            int met = 0, as_drawn = 0;  // rays that meet the boundary; or that enter through a cut, or inside
            for (int k = 0; k < samples * samples; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const auto ray = static_cast<std::size_t>(row) * static_cast<std::size_t>(hits.fine.width()) +
                                 static_cast<std::size_t>(column);
                const std::size_t first = hits.intervals.offsets[ray];
                if (first == hits.intervals.offsets[ray + 1]) continue;
                if (hits.intervals.triangles[first] >= PixelIntervals::kFirstFace) {
                    ++as_drawn;
                    continue;
                }
                color += color_of(first, column, row);
                ++met;
            }
            if (met == 0) continue;
            const auto pixel = image.pixel(x, y);
            const float drawn = static_cast<float>(as_drawn) / static_cast<float>(met + as_drawn);
            for (std::size_t c = 0; c < 3; ++c) {
                const float own = pixel[3] * static_cast<float>(color[static_cast<int>(c)] / met);
                pixel[c] = drawn > 0 ? own + drawn * (pixel[c] - own) : own;
            }
        }
    });
}

}  // namespace subvol
