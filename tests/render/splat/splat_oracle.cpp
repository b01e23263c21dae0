// SPDX-License-Identifier: Apache-2.0
#include "splat_oracle.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <glm/matrix.hpp>
#include <limits>

#include "corner_normals.h"

namespace subvol::test {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastWeight = 0.02;  // below it a sheet has no value
constexpr double kThick = 0.5;         // optical depth above which a stretch is composited in steps
constexpr double kAimed = 0.45;        // the optical depth at which steps aim
constexpr double kSkin_px = 0.05;      // a volume that is opaque within this is a surface

/// S^(−1/2) by the iteration of Denman and Beavers.
Mat3 inverse_root(const Mat3& s) {
    const double scale = (s[0][0] + s[1][1] + s[2][2]) / 3;
    Mat3 root = s / scale, inverse(1.0);
    for (int i = 0; i < 40; ++i) {
        const Mat3 next = 0.5 * (root + glm::inverse(inverse));
        inverse = 0.5 * (inverse + glm::inverse(root));
        root = next;
    }
    return inverse / std::sqrt(scale);
}

/// An interval of depth, and the triangle where it is entered.
struct Interval {
    Vec2 depths;
    std::size_t triangle;
};
constexpr std::size_t kNone = ~std::size_t{0};

/// The intervals of depth in which a ray is inside a closed surface, from `near` on: all triangles, one by one.
///
/// edge_ray: nearly the same ray. It decides between the triangles at an edge, and on which side of the outline the ray is
std::vector<Interval> intervals_inside(const Surface& surface, const Ray& ray, const Ray& edge_ray, double near) {
    struct Crossing {
        double depth;
        int sign;  // +1 where the ray enters
        std::size_t triangle;
    };
    std::vector<Crossing> crossings;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto& triangle = surface.triangles[t];
        std::array<Vec3, 3> p;
        for (std::size_t k = 0; k < 3; ++k) p[k] = surface.points[triangle[k]] - edge_ray.origin;
        // The signed volumes of the ray's direction with each side: all of one sign if the ray goes through the triangle.
        const auto side = [&](const Vec3& a, const Vec3& b) { return glm::dot(edge_ray.direction, glm::cross(a, b)); };
        const bool first = side(p[0], p[1]) > 0;
        if ((side(p[1], p[2]) > 0) != first || (side(p[2], p[0]) > 0) != first) continue;
        const Vec3 normal = glm::cross(p[1] - p[0], p[2] - p[0]);
        const double depth = glm::dot(surface.points[triangle[0]] - ray.origin, normal) / glm::dot(ray.direction, normal);
        crossings.push_back({depth, first ? -1 : 1, t});
    }
    std::sort(crossings.begin(), crossings.end(), [](const auto& a, const auto& b) { return a.depth < b.depth; });
    std::vector<Interval> intervals;
    int inside = 0;
    for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
        inside += crossings[i].sign;
        const Vec2 interval(std::max(near, crossings[i].depth), crossings[i + 1].depth);
        if (inside <= 0 || !(interval[0] < interval[1])) continue;
        if (!intervals.empty() && intervals.back().depths[1] == interval[0]) {
            intervals.back().depths[1] = interval[1];  // the ray is in several shells
        } else {
            intervals.push_back({interval, crossings[i].depth < near ? kNone : crossings[i].triangle});
        }
    }
    return intervals;
}

/// The values of a ray on one sheet.
struct SheetSample {
    bool known = false;
    double weight = 0, value = 0, color_value = 0;
    double diffuse = 1, specular = 0;
};

class Oracle {
public:
    Oracle(const RbfVolume& volume, const View& view, const Optics& optics, const SplatOptions& options, Emission emission)
        : volume_(volume), view_(view), optics_(optics), options_(options), emission_(emission) {
        for (const auto& frame : volume.frames) {
            inverses_.push_back(glm::inverse(matrix(frame)));
            roots_.push_back(support_radius(volume.kernel) * inverse_root(matrix(frame)));
        }
        diagonal_ = box_of(volume).diagonal();
        near_ = view.perspective() ? 1e-4 * diagonal_ : 0;
        if (volume.boundary.triangles.empty()) set_half_weight();
        if (options.shading) normals_ = detail::corner_normals(volume.boundary);
        place_sheets();
    }

    [[nodiscard]] SplatResult draw() const {
        SplatResult result{Image(view_.width(), view_.height()), {}, {}};
        result.depth.resize(result.image.rgba.size() / 4);
        tbb::parallel_for(0, view_.height(), [&](int y) {
            for (int x = 0; x < view_.width(); ++x) {
                const auto pixel = static_cast<std::size_t>(y * view_.width() + x);
                const Ray ray = view_.ray(x + .5, y + .5);
                // A centre on the outline belongs to the picture as if it lay a little to the left, and less above.
                const Ray edge_ray = view_.ray(x + .5 - 1e-7, y + .5 - 1e-10);
                const std::vector<Interval> intervals = half_weight_ > 0
                                                            ? std::vector<Interval>{{{near_, kInfinity}, kNone}}
                                                            : intervals_inside(volume_.boundary, ray, edge_ray, near_);
                draw_pixel(ray, intervals, result.image.pixel(x, y), result.depth[pixel]);
            }
        });
        return result;
    }

private:
    void set_half_weight() {
        std::vector<double> weights;
        for (const Vec3& center : volume_.centers) weights.push_back(sample(center, Vec3(0.0)).weight);
        std::sort(weights.begin(), weights.end());
        half_weight_ = 0.5 * weights[weights.size() / 2];
    }

    void place_sheets() {
        z_first_ = kInfinity, z_last_ = -kInfinity;
        const auto add = [&](const Vec3& p, double reach) {
            z_first_ = std::min(z_first_, view_.to_eye(p).z - reach);
            z_last_ = std::max(z_last_, view_.to_eye(p).z + reach);
        };
        for (const Vec3& p : volume_.boundary.points) add(p, 0);
        for (std::size_t i = 0; half_weight_ > 0 && i < volume_.size(); ++i) {
            const Vec3& forward = view_.axes()[2];
            add(volume_.centers[i], std::sqrt(glm::dot(forward, matrix(volume_.frames[i]) * forward)));
        }
        z_first_ = std::max(z_first_, near_);
    }

    [[nodiscard]] double depth(int sheet) const { return z_first_ + (z_last_ - z_first_) * sheet / (options_.sheets - 1); }

    [[nodiscard]] double weight(std::size_t i, const Vec3& d, double e) const {
        if (is_radial(volume_.kernel)) return radial_value(volume_.kernel, support_radius(volume_.kernel) * std::sqrt(e));
        return kernel_value(volume_.kernel, roots_[i] * d);
    }

    /// A kernel's value and gradient at an offset d from its centre.
    [[nodiscard]] double value(const RbfChannel& channel, std::size_t i, const Vec3& d, Vec3& gradient) const {
        const Vec3 g(channel.gradients[i][0], channel.gradients[i][1], channel.gradients[i][2]), q = inverses_[i] * d;
        const Mat3 h = channel.hessians.empty() ? Mat3(0.0) : matrix(channel.hessians[i]);
        const auto moment = static_cast<double>(channel.moments[i]);
        gradient = g + 2 * moment * q + h * d;
        return static_cast<double>(channel.values[i]) + glm::dot(g, d) + moment * glm::dot(d, q) + 0.5 * glm::dot(d, h * d);
    }

    [[nodiscard]] SheetSample sample(const Vec3& x, const Vec3& direction) const {
        SheetSample s;
        Vec3 gradient(0.0), of_kernel;
        for (std::size_t i = 0; i < volume_.size(); ++i) {
            const Vec3 d = x - volume_.centers[i];
            const double w = weight(i, d, glm::dot(d, inverses_[i] * d));
            if (w == 0) continue;
            s.weight += w;
            if (options_.color_channel) {
                s.color_value += w * value(volume_.channels[*options_.color_channel], i, d, of_kernel);
            }
            s.value += w * value(volume_.channels[options_.channel], i, d, of_kernel);
            gradient += w * of_kernel;
        }
        s.known = !options_.normalized || s.weight > kLeastWeight;
        if (options_.normalized && s.known) {
            s.value /= s.weight;
            s.color_value /= s.weight;
            gradient /= s.weight;
        }
        if (options_.shading && s.known) light(s, gradient, -glm::normalize(direction));
        return s;
    }

    /// Blinn and Phong's light, half of it from the eye and half from the key light.
    void light(SheetSample& s, const Vec3& gradient, const Vec3& to_eye) const {
        const Shading& shading = *options_.shading;
        const auto& [right, up, forward] = view_.axes();
        const Vec3 to_key = glm::normalize(shading.key.x * right + shading.key.y * up + shading.key.z * forward);
        const Vec3 normal = gradient / std::max(glm::length(gradient), 1e-300);
        const double head = std::abs(glm::dot(normal, to_eye)), side = std::abs(glm::dot(normal, to_key));
        const double halfway = std::abs(glm::dot(normal, glm::normalize(to_key + to_eye)));
        // Shading has half its effect where the gradient is a quarter of the function's range over the volume's diagonal.
        const double range = optics_.knots().back() - optics_.knots().front();
        const double change = glm::length(gradient) * diagonal_ / (0.25 * range);
        const double surface = change * change / (1 + change * change);
        s.diffuse = 1 + surface * (shading.ambient + shading.diffuse * (shading.head * head + (1 - shading.head) * side) - 1);
        s.specular =
            surface * shading.specular * 0.5 * (std::pow(head, shading.shininess) + std::pow(halfway, shading.shininess));
    }

    /// The boundary as a surface: lit by its normals, from the outer side only.
    void light_boundary(SheetSample& s, const Interval& interval, const Ray& ray) const {
        if (!options_.shading || interval.triangle == kNone || !s.known) return;
        const Shading& shading = *options_.shading;
        const auto& triangle = volume_.boundary.triangles[interval.triangle];
        const Vec3 place = ray.origin + interval.depths[0] * ray.direction;
        const Vec3 p[3] = {volume_.boundary.points[triangle[0]], volume_.boundary.points[triangle[1]],
                           volume_.boundary.points[triangle[2]]};
        const Vec3 flat = glm::cross(p[1] - p[0], p[2] - p[0]);
        Vec3 normal(0.0);
        for (std::size_t k = 0; k < 3; ++k) {
            const auto& n = normals_[interval.triangle][k];
            const Vec3 &a = p[(k + 1) % 3], &b = p[(k + 2) % 3];
            normal += glm::dot(flat, glm::cross(b - a, place - a)) * Vec3(n[0], n[1], n[2]);
        }
        normal = glm::normalize(normal);
        const auto& [right, up, forward] = view_.axes();
        const Vec3 to_key = glm::normalize(shading.key.x * right + shading.key.y * up + shading.key.z * forward);
        const Vec3 to_eye = -glm::normalize(ray.direction);
        const double head = std::max(0.0, glm::dot(normal, to_eye)), side = std::max(0.0, glm::dot(normal, to_key));
        const double halfway = std::max(0.0, glm::dot(normal, glm::normalize(to_key + to_eye)));
        const double diffuse = shading.ambient + shading.diffuse * (shading.head * head + (1 - shading.head) * side);
        const double specular =
            shading.specular * 0.5 * (std::pow(head, shading.shininess) + std::pow(halfway, shading.shininess));
        const double opacity = 1 - std::exp(-optics_.extinction(s.value) * pixel_at(interval.depths[0]));
        const double cover = std::max(0.0, 2 * opacity - 1);
        s.diffuse += cover * (diffuse - s.diffuse);
        s.specular += cover * (specular - s.specular);
    }

    [[nodiscard]] double pixel_at(double z) const { return view_.pixel() * (view_.perspective() ? z : 1); }

    /// Whether the volume is opaque from its boundary on.
    [[nodiscard]] bool is_surface(const SheetSample& enter, const Interval& interval, const Ray& ray) const {
        if (half_weight_ > 0 || !enter.known) return false;
        const double skin = kSkin_px * pixel_at(interval.depths[0]);
        return optics_.extinction(enter.value) * skin * glm::length(ray.direction) > -std::log(1e-4) &&
               interval.depths[1] - interval.depths[0] > skin;
    }

    void draw_pixel(const Ray& ray, const std::vector<Interval>& intervals, std::span<float, 4> pixel,
                    float& depth_seen) const {
        Segment seen;
        double depths = 0;
        std::vector<SheetSample> enters, exits;
        for (const Interval& interval : intervals) {
            if (half_weight_ > 0) break;
            enters.push_back(sample(ray.origin + interval.depths[0] * ray.direction, ray.direction));
            exits.push_back(sample(ray.origin + interval.depths[1] * ray.direction, ray.direction));
            light_boundary(enters.back(), interval, ray);
        }
        SheetSample front, back;
        for (int sheet = 0; sheet < options_.sheets && !intervals.empty(); ++sheet, front = back) {
            const double z1 = depth(sheet);
            back = sample(ray.origin + z1 * ray.direction, ray.direction);
            if (sheet == 0) continue;
            const double z0 = depth(sheet - 1);
            const SheetSample &f = front.known ? front : back, &b = back.known ? back : front;
            for (std::size_t i = 0; i < intervals.size(); ++i) {
                const Interval& interval = intervals[i];
                Vec2 part(std::max(interval.depths[0], z0), std::min(interval.depths[1], z1));
                if (half_weight_ > 0) cut_at_half_weight(front.weight, back.weight, z0, z1, part);
                if (!(part[0] < part[1])) continue;
                const bool at_enter = part[0] > z0 && half_weight_ == 0 && enters[i].known;
                const bool at_exit = part[1] < z1 && half_weight_ == 0 && exits[i].known;
                SheetSample ends[2] = {between(f, b, (part[0] - z0) / (z1 - z0)), between(f, b, (part[1] - z0) / (z1 - z0))};
                if (at_enter) ends[0] = enters[i];
                if (at_exit) ends[1] = exits[i];
                if (!ends[0].known) ends[0] = ends[1];
                if (!ends[1].known) ends[1] = ends[0];
                if (!ends[0].known) continue;
                if (half_weight_ == 0 && interval.depths[0] >= z0 && is_surface(enters[i], interval, ray)) {
                    depths += seen.transmittance * interval.depths[0];
                    composite(seen, surface(enters[i]));
                } else {
                    composite_stretch(ends[0], ends[1], part, glm::length(ray.direction), seen, depths);
                }
            }
        }
        const double opacity = 1 - seen.transmittance;
        for (std::size_t c = 0; c < 3; ++c) pixel[c] = static_cast<float>(seen.color[static_cast<int>(c)]);
        pixel[3] = static_cast<float>(opacity);
        depth_seen = static_cast<float>(opacity > 0 ? depths / opacity : kInfinity);
    }

    /// Without a boundary the volume ends where the sum of weights, linear between sheets, is half of its value inside.
    void cut_at_half_weight(double w0, double w1, double z0, double z1, Vec2& part) const {
        if (w0 <= half_weight_ && w1 <= half_weight_) part[1] = part[0];
        const double crossing = z0 + (half_weight_ - w0) / (w1 - w0) * (z1 - z0);
        if (w0 <= half_weight_ && w1 > half_weight_) part[0] = std::max(part[0], crossing);
        if (w0 > half_weight_ && w1 <= half_weight_) part[1] = std::min(part[1], crossing);
    }

    [[nodiscard]] static SheetSample between(const SheetSample& f, const SheetSample& b, double t) {
        SheetSample s = f;
        s.value += t * (b.value - f.value);
        s.color_value += t * (b.color_value - f.color_value);
        s.diffuse += t * (b.diffuse - f.diffuse);
        s.specular += t * (b.specular - f.specular);
        return s;
    }

    [[nodiscard]] Segment surface(const SheetSample& s) const {
        const Vec3 color = optics_.color(options_.color_channel ? s.color_value : s.value);
        return {s.diffuse * color + Vec3(s.specular), 0};
    }

    /// Composites a stretch, in steps of a thin optical depth where it is not thin.
    void composite_stretch(const SheetSample& front, const SheetSample& back, const Vec2& depth, double length, Segment& seen,
                           double& depths) const {
        double begin = 0, step = 1;
        while (begin < 1 && seen.transmittance >= 1e-4) {
            const double end = std::min(begin + step, 1.0);
            const SheetSample f = between(front, back, begin), b = between(front, back, end);
            const double part = (end - begin) * depth_length(depth) * length;
            const Segment thin = optics_.integrate(f.value, b.value, part);
            const double thickness = -std::log(std::max(thin.transmittance, 1e-300));
            if (thickness > kThick) {
                step = (end - begin) * std::clamp(kAimed / thickness, 0.0625, 0.9);
                continue;
            }
            const Segment stretch = classify(f, b, part);
            depths += seen.transmittance * (1 - stretch.transmittance) * (depth[0] + 0.5 * (begin + end) * depth_length(depth));
            composite(seen, stretch);
            step = 2 * (end - begin);
            begin = end;
        }
    }
    [[nodiscard]] static double depth_length(const Vec2& depth) { return depth[1] - depth[0]; }

    [[nodiscard]] Segment classify(const SheetSample& front, const SheetSample& back, double length) const {
        Segment s = optics_.integrate(front.value, back.value, length);
        const double opacity = 1 - s.transmittance;
        if (options_.color_channel) {
            s.color = 0.5 * opacity * (optics_.color(front.color_value) + optics_.color(back.color_value));
        } else if (emission_ == Emission::Preintegrated && opacity > 1e-6) {
            const Segment thin = optics_.integrate(front.value, back.value, 1e-6 * length);  // its front hardly covers its back
            s.color = opacity / (1 - thin.transmittance) * thin.color;
        }
        s.color = 0.5 * (front.diffuse + back.diffuse) * s.color + Vec3(0.5 * (front.specular + back.specular) * opacity);
        return s;
    }

    const RbfVolume& volume_;
    const View& view_;
    const Optics& optics_;
    const SplatOptions& options_;
    Emission emission_;
    std::vector<Mat3> inverses_, roots_;
    std::vector<detail::CornerNormals> normals_;
    double diagonal_ = 0, near_ = 0, half_weight_ = 0, z_first_ = 0, z_last_ = 0;
};

}  // namespace

SplatResult draw_oracle(const RbfVolume& volume, const View& view, const Optics& optics, const SplatOptions& options,
                        Emission emission) {
    return Oracle(volume, view, optics, options, emission).draw();
}

}  // namespace subvol::test
