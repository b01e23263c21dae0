// SPDX-License-Identifier: Apache-2.0
// The light on the boundary of a volume where rays enter it. The rays of a pixel are cut into intervals inside the boundary;
// each interval names the triangle, or the face of a cut, through which it begins.
//
//     interval ─► depth z ─► place z (s, 1), or (s, z) of parallel rays ─► shares of the corners ─► normal ─► light there
//
// On a triangle the normal is the sum of its corners' normals, weighted by the shares; on a face of the cut it is that of the
// plane. If there is a light volume, the light that arrives is taken a little before the surface, as the nodes behind it would
// be dark.
//
// Finished pictures are changed by the first hits of n × n rays in each pixel: lit by the mean of their light, or given the
// colours of values on the boundary. There, rays that enter through a cut or begin inside keep their share of the colour that
// was drawn. The picture of an opaque body is made of first hits alone, where values are known at its cuts, too.
#include "boundary_light.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "clip_intervals.h"
#include "subvol/boundary_shading.h"
#include "subvol/error.h"
#include "subvol/raster.h"

namespace subvol::detail {

namespace {

/// The points of a surface in eye space.
std::vector<Vec3> eye_points(const Surface& surface, const View& view) {
    std::vector<Vec3> eye(surface.points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, eye.size(), 4096), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) eye[i] = view.to_eye(surface.points[i]);
    });
    return eye;
}

/// The shares of a triangle's corners in a place on it (eye space), each at least 0; their sum is not 1.
std::array<double, 3> shares_at(const std::array<Vec3, 3>& eye, const Vec3& place) {
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

/// The light just before a surface: on it, the nodes of the light volume behind it would be dark. In eye space.
std::array<float, 2> light_before(const LightVolume& light, const View& view, const Vec3& place, const Vec3& normal,
                                  const Shading& shading) {
    constexpr double kNodesBefore = 1.5;
    const Vec3 before = place + kNodesBefore * light.spacing_world * (normal + glm::normalize(shading.key));
    const auto& [right, up, forward] = view.axes();
    return light.at(view.eye() + before.x * right + before.y * up + before.z * forward);
}

/// What the lights depend on besides the intervals.
struct LitSurface {
    const Surface& surface;
    const std::vector<CornerNormals>& normals;
    const Shading& shading;
    double middle;                       // the depth that those of the intervals are relative to
    const std::vector<CutPlane>& faces;  // of the clip
    const LightVolume* light = nullptr;
};

/// The places where rays enter a surface.
class EntryShader {
public:
    /// lit, view: are kept by reference
    EntryShader(const LitSurface& lit, const View& view) : lit_(lit), view_(view), eye_(eye_points(lit.surface, view)) {}

    /// The light at the entry into an interval, which has a triangle or a face of the clip.
    ///
    /// shares: set to those of the triangle's corners
    [[nodiscard]] SurfaceLight at(const PixelIntervals& intervals, std::size_t i, const Vec2& slopes,
                                  std::array<double, 3>& shares) const {
        const std::uint32_t triangle = intervals.triangles[i];
        const double z = static_cast<double>(intervals.depths[2 * i]) + lit_.middle;
        const Vec3 place = view_.perspective() ? z * Vec3(slopes, 1) : Vec3(slopes, z);
        const Vec3 normal =
            turned(view_, triangle >= PixelIntervals::kFirstFace ? lit_.faces[triangle - PixelIntervals::kFirstFace].normal
                                                                 : normal_at(triangle, place, shares));
        const double length = glm::length(normal);
        if (!(length > 0)) return {};
        const Vec3 to_eye = view_.perspective() ? -glm::normalize(place) : Vec3(0, 0, -1);
        std::array<float, 2> arrives{1, 1};
        if (lit_.light) arrives = light_before(*lit_.light, view_, place, normal / length, lit_.shading);
        return surface_light(lit_.shading, normal / length, to_eye, arrives);
    }

private:
    /// Interpolates the normals of a triangle at a place on it (eye space).
    [[nodiscard]] Vec3 normal_at(std::uint32_t triangle, const Vec3& place, std::array<double, 3>& shares) const {
        const auto& [a, b, c] = lit_.surface.triangles[triangle];
        shares = shares_at({eye_[a], eye_[b], eye_[c]}, place);
        Vec3 sum(0.0);
        const CornerNormals& corners = lit_.normals[triangle];
        for (std::size_t k = 0; k < 3; ++k) sum += shares[k] * Vec3(corners[k][0], corners[k][1], corners[k][2]);
        return sum;
    }

    const LitSurface& lit_;
    const View& view_;
    std::vector<Vec3> eye_;
};

std::vector<SurfaceLight> lights_of(const PixelIntervals& intervals, const LitSurface& lit, const View& view) {
    std::vector<SurfaceLight> lights(intervals.triangles.size());
    const EntryShader shader(lit, view);
    tbb::parallel_for(0, view.height(), [&](int y) {
        std::array<double, 3> shares{};
        for (int x = 0; x < view.width(); ++x) {
            const auto pixel = pixel_index(view.width(), x, y);
            const Vec2 slopes = view.slopes(x + 0.5, y + 0.5);
            for (std::size_t i = intervals.offsets[pixel]; i < intervals.offsets[pixel + 1]; ++i) {
                if (intervals.triangles[i] == PixelIntervals::kNoTriangle) continue;
                lights[i] = shader.at(intervals, i, slopes, shares);
            }
        }
    });
    return lights;
}

}  // namespace

std::vector<SurfaceLight> entry_lights(const PixelIntervals& intervals, const SplatScene& scene, const View& view) {
    const double middle = view.to_eye(scene.middle).z;
    return lights_of(intervals,
                     {scene.volume->boundary, scene.boundary_normals, *scene.shading, middle, scene.clip.faces(), scene.light},
                     view);
}

}  // namespace subvol::detail

namespace subvol {

using namespace detail;

namespace {

/// The rays of some rows of a picture, and where they are inside.
struct RayHits {
    const PixelIntervals& intervals;
    const View& fine;       // a pixel for each ray
    std::size_t first_ray;  // the number in the picture of the first one that is here

    /// The first interval of a ray; none if it meets nothing.
    [[nodiscard]] std::optional<std::size_t> first(int column, int row) const {
        const auto ray = pixel_index(fine.width(), column, row) - first_ray;
        if (intervals.offsets[ray] == intervals.offsets[ray + 1]) return {};
        return intervals.offsets[ray];
    }
};

/// The first hits of a picture's rays on a boundary or a cut, which are found in bands of rows and shaded as they are asked
/// for.
class FirstHits {
public:
    FirstHits(const Surface& boundary, const View& view, const Shading& shading, int samples, const Clip& clip)
        : samples_(samples), fine_(view.resized(samples * view.width(), samples * view.height())) {
        Box box;
        for (const Vec3& point : boundary.points) box.add(point);
        cuts_ = RayClip(clip, box.diagonal());
        is_cut_ = !cuts_.empty() || fine_.ends_rays();
        middle_ = fine_.to_eye(box.center()).z;
        const double near = nearest_depth(fine_, box.diagonal());
        raster_.emplace(boundary, fine_, near, middle_, samples * std::max(1, kRowsOfBand / samples));
        normals_ = corner_normals(boundary);
        lit_.emplace(LitSurface{boundary, normals_, shading, middle_, cuts_.faces()});
        shader_.emplace(*lit_, fine_);
    }
    FirstHits(const FirstHits&) = delete;
    FirstHits& operator=(const FirstHits&) = delete;

    /// Calls `visit` with the hits of each row of pixels, and its number. Several rows at once.
    template <class Visit>
    void each_row(const PixelRows& rows, const Visit& visit, Progress* progress = nullptr) const {
        const int height = fine_.height() / samples_, begin = std::max(rows.first, 0), end = std::min(rows.end, height);
        std::atomic<int> rows_done = 0;
        tbb::enumerable_thread_specific<PixelIntervals> bands;
        tbb::parallel_for(0, raster_->band_count(), [&](int band) {
            const int first = std::max(begin, raster_->first_row(band) / samples_),
                      last = std::min(end, raster_->first_row(band + 1) / samples_);
            if (first >= last) return;
            PixelIntervals& intervals = bands.local();
            const int first_row = raster_->first_row(band);
            raster_->find(band, intervals);
            if (is_cut_) intervals = clip_rows(intervals, first_row, fine_, cuts_, middle_);
            const RayHits hits{intervals, fine_, pixel_index(fine_.width(), 0, first_row)};
            for (int y = first; y < last; ++y) visit(hits, y);
            report_progress(progress, "draw", static_cast<double>(rows_done += last - first) / (end - begin));
        });
    }

    /// shares: set to those of the corners of the triangle
    [[nodiscard]] SurfaceLight light(const RayHits& hits, std::size_t interval, int column, int row,
                                     std::array<double, 3>& shares) const {
        if (hits.intervals.triangles[interval] == PixelIntervals::kNoTriangle) return {};
        return shader_->at(hits.intervals, interval, fine_.slopes(column + 0.5, row + 0.5), shares);
    }
    /// Where a ray enters an interval.
    [[nodiscard]] Vec3 place(const RayHits& hits, std::size_t interval, int column, int row) const {
        const Vec2 slopes = fine_.slopes(column + 0.5, row + 0.5);
        const double z = depth(hits, interval);
        const auto& [right, up, forward] = fine_.axes();
        const Vec2 across = fine_.perspective() ? z * slopes : slopes;
        return fine_.eye() + across.x * right + across.y * up + z * forward;
    }
    /// The depth at which a ray enters an interval.
    [[nodiscard]] double depth(const RayHits& hits, std::size_t interval) const {
        return static_cast<double>(hits.intervals.depths[2 * interval]) + middle_;
    }

private:
    static constexpr int kRowsOfBand = 8;

    int samples_;
    View fine_;  // a pixel for each ray
    RayClip cuts_;
    double middle_;
    bool is_cut_;  // or rays have ends
    std::optional<BoundaryRaster> raster_{};
    std::vector<CornerNormals> normals_{};
    std::optional<LitSurface> lit_{};
    std::optional<EntryShader> shader_{};
};

/// Colours of the values on a boundary, in its light.
class BoundaryColors {
public:
    /// All are kept by reference.
    BoundaryColors(const FirstHits& hits, const Surface& boundary, std::span<const double> values, const Optics& optics)
        : hits_(hits), boundary_(boundary), values_(values), optics_(optics) {
        if (values.size() == boundary.points.size()) return;
        throw Error(
            ErrorCode::InvalidInput,
            "there are " + std::to_string(values.size()) + " values for " + std::to_string(boundary.points.size()) + " points",
            "boundary");
    }

    /// The colour where a ray enters an interval, which has a triangle.
    [[nodiscard]] Vec3 at(const RayHits& hits, std::size_t interval, int column, int row) const {
        const auto& corners = boundary_.triangles[hits.intervals.triangles[interval]];
        std::array<double, 3> shares{};
        const SurfaceLight light = hits_.light(hits, interval, column, row, shares);
        double sum = 0, value = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            sum += shares[k];
            value += shares[k] * values_[corners[k]];
        }
        return lit(light, sum > 0 ? value / sum : values_[corners[0]]);
    }
    /// The colour where a ray enters an interval through a cut; none if there is no value.
    [[nodiscard]] std::optional<Vec3> at_cut(const RayHits& hits, std::size_t interval, int column, int row,
                                             const BoundaryCut& cut) const {
        const std::optional<double> value = cut.value_at(hits_.place(hits, interval, column, row));
        if (!value) return {};
        std::array<double, 3> shares{};
        return lit(hits_.light(hits, interval, column, row, shares), *value);
    }

private:
    [[nodiscard]] Vec3 lit(const SurfaceLight& light, double value) const {
        return static_cast<double>(light.diffuse) * optics_.color(value) + static_cast<double>(light.specular);
    }

    const FirstHits& hits_;
    const Surface& boundary_;
    std::span<const double> values_;
    const Optics& optics_;
};

}  // namespace

void light_boundary(Image& image, const Surface& boundary, const View& view, const Shading& shading, int samples,
                    const Clip& clip) {
    const FirstHits hits(boundary, view, shading, samples, clip);
    hits.each_row({}, [&](const RayHits& rays, int y) {
        std::array<double, 3> shares{};
        for (int x = 0; x < view.width(); ++x) {
            double diffuse = 0, specular = 0;
            int met = 0;
            for (int k = 0; k < samples * samples; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const auto first = rays.first(column, row);
                if (!first) continue;
                const SurfaceLight light = hits.light(rays, *first, column, row, shares);
                diffuse += static_cast<double>(light.diffuse);
                specular += static_cast<double>(light.specular);
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
    const FirstHits hits(boundary, view, shading, samples, clip);
    const BoundaryColors colors(hits, boundary, values, optics);
    hits.each_row({}, [&](const RayHits& rays, int y) {
        for (int x = 0; x < view.width(); ++x) {
            Vec3 color(0.0);
            int met = 0, as_drawn = 0;  // rays that meet the boundary; or that enter through a cut, or inside
            for (int k = 0; k < samples * samples; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const auto first = rays.first(column, row);
                if (!first) continue;
                if (rays.intervals.triangles[*first] >= PixelIntervals::kFirstFace) {
                    ++as_drawn;
                    continue;
                }
                color += colors.at(rays, *first, column, row);
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

BoundaryPicture draw_boundary(const Surface& boundary, std::span<const double> values, const View& view, const Optics& optics,
                              const Shading& shading, int samples, const PixelRows& rows, Progress* progress,
                              const BoundaryCut& cut) {
    const FirstHits hits(boundary, view, shading, samples, cut.clip);
    const BoundaryColors colors(hits, boundary, values, optics);
    BoundaryPicture picture{Image(view.width(), view.height()), {}, 0};
    picture.depth.assign(picture.image.rgba.size() / 4, std::numeric_limits<float>::infinity());
    const int rays_of_pixel = samples * samples;
    std::atomic<std::size_t> rays_inside = 0;
    const auto draw_row = [&](const RayHits& rays, int y) {
        for (int x = 0; x < view.width(); ++x) {
            Vec3 color(0.0);
            double depth = 0;
            int met = 0;
            for (int k = 0; k < rays_of_pixel; ++k) {
                const int row = y * samples + k / samples, column = x * samples + k % samples;
                const auto first = rays.first(column, row);
                if (!first) continue;
                const std::uint32_t entered = rays.intervals.triangles[*first];
                std::optional<Vec3> seen;
                if (entered < PixelIntervals::kFirstFace)
                    seen = colors.at(rays, *first, column, row);
                else if (entered != PixelIntervals::kNoTriangle)
                    seen = colors.at_cut(rays, *first, column, row, cut);
                if (!seen) {
                    ++rays_inside;
                    continue;
                }
                color += *seen;
                depth += hits.depth(rays, *first);
                ++met;
            }
            if (met == 0) continue;
            const auto pixel = picture.image.pixel(x, y);
            for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(color[static_cast<int>(c)] / rays_of_pixel);
            pixel[3] = static_cast<float>(met) / static_cast<float>(rays_of_pixel);
            picture.depth[pixel_index(view.width(), x, y)] = static_cast<float>(depth / met);
        }
    };
    hits.each_row(rows, draw_row, progress);
    picture.rays_inside = rays_inside;
    return picture;
}

}  // namespace subvol
