// SPDX-License-Identifier: Apache-2.0
// A ray is sampled where it is in the limit's box. The place that is picked is the sample that most of the light
// comes from; of an opaque body it is where the ray enters.
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "session_state.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kPlaces = 400;
constexpr double kOpaque = 0.999;
constexpr int kHalvings = 20;  // of the interval in which a ray enters an opaque body

/// The depths at which a ray is in a box; first > second: nowhere.
std::pair<double, double> depths_in(const Box& box, const Ray& ray) {
    double from = 0, to = std::numeric_limits<double>::infinity();
    for (int c = 0; c < 3; ++c) {
        if (ray.direction[c] == 0) {
            if (ray.origin[c] < box.lower[c] || ray.origin[c] > box.upper[c]) return {1, 0};
            continue;
        }
        const double a = (box.lower[c] - ray.origin[c]) / ray.direction[c],
                     b = (box.upper[c] - ray.origin[c]) / ray.direction[c];
        from = std::max(from, std::min(a, b));
        to = std::min(to, std::max(a, b));
    }
    return {from, to};
}

}  // namespace

void PickedField::make() const {
    std::call_once(made_, [&] {
        if (body_->points.volume) {
            kernels_.emplace(*body_->points.volume, RbfFieldOptions{.channel = body_->channel});
        } else {
            limit_.emplace(body_->mesh, ProbeOptions{.limit = {.scheme = scheme_}});
        }
    });
}

Box PickedField::box() const {
    make();
    return limit_ ? limit_->box() : body_->box;
}

std::vector<std::optional<Picked>> PickedField::at(std::span<const Vec3> places) const {
    make();
    std::vector<std::optional<Picked>> found(places.size());
    if (kernels_) {
        for (std::size_t k = 0; k < places.size(); ++k) {
            if (const auto jet = kernels_->value_and_gradient(places[k]))
                found[k] = {places[k], jet->value, jet->gradient, kNone};
        }
        return found;
    }
    const ProbeResult probed = limit_->at(places);
    for (std::size_t k = 0; k < places.size(); ++k) {
        if (probed.inside(k))
            found[k] = {places[k], probed.fields[0].values[k], probed.fields[0].gradients[k],
                        body_->tets ? kNone : probed.cells[k]};
    }
    return found;
}

std::optional<Picked> pick(const PickedField& field, const Optics& optics, const Ray& ray) {
    const auto [from, to] = depths_in(field.box(), ray);
    if (!(from < to)) return std::nullopt;
    const auto place = [&](double depth) { return ray.origin + depth * ray.direction; };
    const auto found_at = [&](double depth) {
        const Vec3 one = place(depth);
        return field.at(std::span(&one, 1)).front();
    };
    const std::vector<Vec3> places = places_on_line(place(from), place(to), kPlaces);
    const auto found = field.at(places);
    const double step = glm::distance(places[0], places[1]);
    double passing = 1, most = 0;
    std::size_t brightest = 0;
    for (std::size_t k = 0; k < kPlaces; ++k) {
        if (!found[k]) continue;
        const double stops = passing * (1 - std::exp(-optics.extinction(found[k]->value) * step));
        passing -= stops;
        if (stops <= most) continue;
        most = stops;
        brightest = k;
    }
    if (!(most > 0)) return std::nullopt;
    const double width = (to - from) / (kPlaces - 1);
    double at = from + width * static_cast<double>(brightest);
    if (most > kOpaque && brightest > 0 && !found[brightest - 1]) {  // opaque from its boundary on
        double outside = at - width;
        for (int k = 0; k < kHalvings; ++k) {
            const double middle = 0.5 * (outside + at);
            (found_at(middle) ? at : outside) = middle;
        }
    }
    return found_at(at);
}

}  // namespace subvol::detail
