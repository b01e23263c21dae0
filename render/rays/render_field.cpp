// SPDX-License-Identifier: Apache-2.0
#include "subvol/render_field.h"

#include <algorithm>
#include <cmath>

#include "pixel_tiles.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/ray_clip.h"

namespace subvol {

using namespace detail;

namespace {

using FieldFunction = std::function<std::optional<double>(const Vec3&)>;

constexpr double kEndTolerance = 1e-9;  // of a step
constexpr double kMaxSteps = 1e9;

struct Interval {
    double begin, end;
};

// The part of the ray in front of the eye that lies in the box.
Interval clip(const Ray& ray, const Box& box) {
    Interval inside{0, std::numeric_limits<double>::infinity()};
    for (int k = 0; k < 3; ++k) {
        if (ray.direction[k] == 0) {
            if (ray.origin[k] < box.lower[k] || ray.origin[k] > box.upper[k]) return {0, 0};
            continue;
        }
        const double a = (box.lower[k] - ray.origin[k]) / ray.direction[k];
        const double b = (box.upper[k] - ray.origin[k]) / ray.direction[k];
        inside.begin = std::max(inside.begin, std::min(a, b));
        inside.end = std::min(inside.end, std::max(a, b));
    }
    return inside;
}

struct Sample {
    double t;
    std::optional<double> value;
};

class Marcher {
public:
    Marcher(const FieldFunction& field, const Box& box, const Optics& optics, double step_world, const RayClip& clip)
        : field_(field), box_(box), optics_(optics), step_world_(step_world), clip_(clip) {}

    Segment operator()(const Ray& ray) {
        clip_.cut(ray, cut_);
        Interval range = clip(ray, box_);
        range = {std::max(range.begin, cut_.near), std::min(range.end, cut_.far)};
        for (const RaySlice& slice : cut_.slices) {
            if (!slice.meets(range.begin, range.end)) continue;
            const double t = slice.within(range.begin, range.end);
            const auto value = value_on(ray, slice, t);
            if (!value) continue;
            range.end = t;
            Segment total;
            if (!clip_.slices_alone()) total = march(ray, range);
            composite(total, {optics_.color(*value), 0});
            return total;
        }
        return clip_.slices_alone() ? Segment{} : march(ray, range);
    }

private:
    Segment march(const Ray& ray, const Interval& range) const {
        Segment total;
        if (!(range.begin < range.end)) return total;
        const double speed = glm::length(ray.direction);
        const double steps = std::max(1.0, std::ceil((range.end - range.begin) * speed / step_world_));
        Sample last = at(ray, range.begin);
        for (double i = 1; i <= steps && total.transmittance > kRayCutoff; ++i) {
            const Sample next = at(ray, range.begin + (range.end - range.begin) * (i / steps));
            composite(total, between(ray, last, next, speed));
            last = next;
        }
        return total;
    }

    // Where the field ends at a slice, its last value.
    std::optional<double> value_on(const Ray& ray, const RaySlice& slice, double t) const {
        std::optional<double> value;
        for (const double depth : {t, t + slice.tolerance, t - slice.tolerance}) {
            if (!value) value = at(ray, depth).value;
        }
        return value;
    }

    Sample at(const Ray& ray, double t) const { return {t, field_(ray.origin + t * ray.direction)}; }

    // Bisects between a sample inside and one outside; returns the last sample inside.
    Sample end_of_field(const Ray& ray, Sample inside, Sample outside) const {
        const double tolerance = kEndTolerance * std::abs(outside.t - inside.t);
        while (std::abs(outside.t - inside.t) > tolerance) {
            const Sample middle = at(ray, 0.5 * (inside.t + outside.t));
            if (middle.t == inside.t || middle.t == outside.t) break;
            (middle.value ? inside : outside) = middle;
        }
        return inside;
    }

    Segment between(const Ray& ray, Sample front, Sample back, double speed) const {
        if (!front.value && !back.value) return {};
        if (!front.value) front = end_of_field(ray, back, front);
        if (!back.value) back = end_of_field(ray, front, back);
        return optics_.integrate(*front.value, *back.value, (back.t - front.t) * speed);
    }

    const FieldFunction& field_;
    const Box& box_;
    const Optics& optics_;
    double step_world_;
    const RayClip& clip_;
    RayCut cut_;
};

}  // namespace

Image render_field(const FieldFunction& field, const Box& box, const View& view, const Optics& optics,
                   const MarchOptions& options) {
    check_samples(options.samples);
    if (box.empty()) return {view.width(), view.height()};
    if (!(options.step_world > 0) || !(box.diagonal() <= kMaxSteps * options.step_world)) {
        throw Error(ErrorCode::InvalidInput, "the step is " + number_text(options.step_world), {},
                    "a positive world length, at least 1e-9 of the diagonal of a finite box");
    }
    const RayClip cuts(options.clip, box.diagonal());
    const Marcher marcher(field, box, optics, options.step_world, cuts);
    return draw_in_tiles(view, options.samples, options.progress, [&] { return marcher; });
}

}  // namespace subvol
