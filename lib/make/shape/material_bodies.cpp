// SPDX-License-Identifier: Apache-2.0
#include "material_bodies.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

#include "subvol/surface.h"
#include "surface_distances.h"

namespace subvol::detail {

namespace {

constexpr float kWithin = 0.5F;
constexpr double kTouching = 0.05;  // sides: how near surfaces are that touch

double distance_from(const SharpCurve& curve, const Vec3& x) {
    return glm::distance(CurveTree(curve).nearest(x).point, x);
}

/// Curves with a corner in them are split there.
void split_at(SharpEdges& sharp, Index corner, double same) {
    const Vec3 place = sharp.corners[corner];
    for (std::size_t k = 0; k < sharp.curves.size(); ++k) {
        const SharpCurve curve = sharp.curves[k];
        if (std::ranges::count(curve.corners, corner) > 0 || distance_from(curve, place) > same) continue;
        // Behind the point of the curve's segment that is nearest.
        std::size_t segment = 1;
        double least = -1;
        for (std::size_t i = 1; i < curve.points.size(); ++i) {
            const double distance = distance_from({{curve.points[i - 1], curve.points[i]}, {0, 0}}, place);
            if (least >= 0 && distance >= least) continue;
            least = distance;
            segment = i;
        }
        std::vector<Vec3> ahead(curve.points.begin(), curve.points.begin() + static_cast<std::ptrdiff_t>(segment));
        std::vector<Vec3> behind(curve.points.begin() + static_cast<std::ptrdiff_t>(segment), curve.points.end());
        if (glm::distance(ahead.back(), place) > same) ahead.push_back(place);
        if (glm::distance(behind.front(), place) > same) behind.insert(behind.begin(), place);
        if (curve.closed()) {
            behind.insert(behind.end(), ahead.begin() + 1, ahead.end());
            sharp.curves[k] = {std::move(behind), {corner, corner}};
        } else if (ahead.size() > 1 && behind.size() > 1) {
            sharp.curves[k] = {std::move(ahead), {curve.corners[0], corner}};
            sharp.curves.push_back({std::move(behind), {corner, curve.corners[1]}});
        }
    }
}

/// Adds sharp edges to others. Corners at the same place become one.
void join(SharpEdges& sharp, SharpEdges more, double same) {
    std::vector<Index> numbers;
    for (const Vec3& corner : more.corners) {
        const auto known = std::ranges::find_if(sharp.corners, [&](const Vec3& x) { return glm::distance(x, corner) <= same; });
        numbers.push_back(static_cast<Index>(known - sharp.corners.begin()));
        if (known != sharp.corners.end()) continue;
        sharp.corners.push_back(corner);
        split_at(sharp, numbers.back(), same);
    }
    for (SharpCurve& curve : more.curves) {
        for (Index& corner : curve.corners) {
            if (corner != kNone) corner = numbers[corner];
        }
        sharp.curves.push_back(std::move(curve));
    }
}

}  // namespace

MaterialBodies::MaterialBodies(std::span<const MaterialSurface> surfaces, double side) : order_(surfaces.size()), side_(side) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::vector<double> volumes;
    for (const MaterialSurface& given : surfaces) {
        // Of the bodies, whose triangles are turned as those around them: what they enclose is not that of the triangles as
        // given.
        const SurfaceBodies& body = given_.emplace_back(given.surface);
        volumes.push_back(body.is_open() ? std::abs(enclosed_volume(body.surface())) : body.least_volume());
    }
    std::ranges::stable_sort(order_, {}, [&](std::size_t s) { return volumes[s]; });
    for (const std::size_t s : order_) {
        bodies_.push_back(&given_[s]);
        boxes_.push_back(bounds(given_[s].surface()));
        names_.push_back(surfaces[s].name);
    }
}

Box MaterialBodies::box() const {
    Box box;
    for (const Box& own : boxes_) {
        box.add(own.lower);
        box.add(own.upper);
    }
    return box;
}

Index MaterialBodies::at(const Vec3& x) const {
    Box place;
    place.add(x);
    for (Index m = 0; m < bodies_.size(); ++m) {
        // Nothing winds about a place outside of the box by a half.
        if (meet(boxes_[m], place) && bodies_[m]->likeness(x) > kWithin) return m;
    }
    return kNone;
}

Index MaterialBodies::beside_gap(const Vec3& x) const {
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 step(0.0);
        step[axis] = kTouching * side_;
        const Index before = at(x - step), behind = at(x + step);
        if (before != kNone && behind != kNone) return std::min(before, behind);
    }
    return kNone;
}

float MaterialBodies::likeness(const Vec3& x) const {
    float most = 0;
    for (const SurfaceBodies* body : bodies_) most = std::max(most, body->likeness(x));
    return most;
}

WallTarget MaterialBodies::target(Index material) const {
    WallTarget target{&bodies_[material]->surface()};
    if (bodies_.size() > 1 || bodies_[material]->has_several_walls()) {
        target.reaches = [this, material](const Vec3& place, const Vec3& normal) {
            const Index below = at(place - kTouching * side_ * normal), above = at(place + kTouching * side_ * normal);
            return below != above && std::min(below, above) == material;
        };
    }
    return target;
}

MaterialBodies::Relation MaterialBodies::relation(Index smaller, Index larger) const {
    if (!meet(boxes_[smaller], boxes_[larger])) return Relation::Apart;
    constexpr std::size_t kSamples = 1000;
    std::size_t inside = 0, all = 0;
    for (const SurfaceSample& sample : samples_on(bodies_[smaller]->surface(), kSamples)) {
        const Vec3 below = sample.place - kTouching * side_ * sample.normal,
                   above = sample.place + kTouching * side_ * sample.normal;
        const bool in_below = bodies_[smaller]->likeness(below) > kWithin,
                   in_above = bodies_[smaller]->likeness(above) > kWithin;
        if (in_below == in_above) continue;  // no wall
        ++all;
        inside += bodies_[larger]->likeness(in_below ? below : above) > kWithin ? 1 : 0;
    }
    if (inside == 0) return Relation::Apart;
    return inside == all ? Relation::Within : Relation::Crossing;
}

std::vector<std::optional<double>> MaterialBodies::volumes() const {
    const auto count = static_cast<Index>(bodies_.size());
    std::vector<std::optional<double>> volumes;
    for (Index m = 0; m < count; ++m) {
        volumes.push_back(bodies_[m]->volume());
        std::vector<Index> within;
        for (Index j = 0; j < m; ++j) {
            const Relation here = relation(j, m);
            if (here == Relation::Within) within.push_back(j);
            if (here == Relation::Crossing) volumes[m].reset();
        }
        // Those within others of them are counted with these.
        for (const Index j : within) {
            const bool deeper =
                std::ranges::any_of(within, [&](Index k) { return k > j && relation(j, k) == Relation::Within; });
            const std::optional<double> volume = bodies_[j]->volume();
            if (deeper || !volumes[m]) continue;
            volumes[m] = volume ? std::optional(*volumes[m] - *volume) : std::nullopt;
        }
    }
    return volumes;
}

SharpEdges MaterialBodies::sharp_edges(double angle_deg) const {
    constexpr double kSame = 0.01;  // sides
    const double same = kSame * side_;
    SharpEdges all;
    for (Index m = 0; m < bodies_.size(); ++m) {
        std::deque<CurveTree> before;
        for (const SharpCurve& curve : all.curves) before.emplace_back(curve);
        const auto is_new = [&](const Vec3& x) {
            return std::ranges::all_of(before,
                                       [&](const CurveTree& curve) { return glm::distance(curve.nearest(x).point, x) > same; });
        };
        join(all, detail::sharp_edges(target(m), angle_deg, side_, is_new), same);
    }
    return all;
}

}  // namespace subvol::detail
