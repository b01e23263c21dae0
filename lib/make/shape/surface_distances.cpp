// SPDX-License-Identifier: Apache-2.0
#include "surface_distances.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/parallel_each.h"
#include "surface_bodies.h"
#include "surface_sides.h"

namespace subvol::detail {

namespace {

/// The samples that a target's walls are to reach.
std::vector<Vec3> places_on(const WallTarget& target, std::size_t count) {
    const std::vector<SurfaceSample> samples = samples_on(*target.surface, count);
    std::vector<std::uint8_t> reached(count);
    parallel_each(count, [&](std::size_t i) { reached[i] = target.reached(samples[i].place, samples[i].normal) ? 1 : 0; });
    std::vector<Vec3> places;
    for (std::size_t i = 0; i < count; ++i) {
        if (reached[i] != 0) places.push_back(samples[i].place);
    }
    return places;
}

/// A flag for each side of each triangle: whether the edge is that of no other one.
std::vector<std::array<std::uint8_t, 3>> open_sides_of(const Surface& surface) {
    std::vector<std::array<std::uint8_t, 3>> open(surface.triangles.size(), {0, 0, 0});
    each_edge(sides_of(surface, same_place(surface)), [&](std::span<const TriangleSide> sides) {
        if (sides.size() == 1) open[sides[0].triangle][sides[0].side] = 1;
    });
    return open;
}

/// The mean side of the level before that of a boundary, whose quads are two triangles each.
double side_before(const Surface& boundary) {
    double length = 0;
    for (const auto& t : boundary.triangles) {
        const Vec3 &a = boundary.points[t[0]], &b = boundary.points[t[1]], &c = boundary.points[t[2]];
        length += std::min({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
    }
    return length * 2 / static_cast<double>(boundary.triangles.size());
}

}  // namespace

std::vector<SurfaceSample> samples_on(const Surface& surface, std::size_t count) {
    std::vector<double> sums{0};
    for (const auto& t : surface.triangles) {
        const Vec3 &a = surface.points[t[0]], &b = surface.points[t[1]], &c = surface.points[t[2]];
        sums.push_back(sums.back() + glm::length(glm::cross(b - a, c - a)));
    }
    std::vector<SurfaceSample> samples;
    for (std::size_t i = 0; i < count; ++i) {
        const double at = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * sums.back();
        const auto above = std::ranges::upper_bound(sums, at);
        const std::size_t t = std::min<std::size_t>(static_cast<std::size_t>(above - sums.begin()), sums.size() - 1) - 1;
        constexpr double kFirst = 0.7548776662466927, kSecond = 0.5698402909980532;  // 1/g and 1/g² with g³ = g + 1
        double whole = 0;
        double u = std::modf(kFirst * static_cast<double>(i), &whole), v = std::modf(kSecond * static_cast<double>(i), &whole);
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const auto& corners = surface.triangles[t];
        const Vec3& a = surface.points[corners[0]];
        const Vec3 b = surface.points[corners[1]] - a, c = surface.points[corners[2]] - a;
        samples.push_back({a + u * b + v * c, glm::normalize(glm::cross(b, c))});
    }
    return samples;
}

SurfaceDistances::SurfaceDistances(const WallTarget& target, std::size_t places, const Progress* progress)
    : open_sides_(open_sides_of(*target.surface)),
      tree_(*target.surface),
      places_(places_on(target, places)),
      progress_(progress) {
}

bool SurfaceDistances::at_hole(const SurfacePlace& place) const {
    const auto& open = open_sides_[place.triangle];
    for (int k = 0; k < 3; ++k) {
        if (!(place.weights[k] > 0) && open[static_cast<std::size_t>(k + 1) % 3] != 0) return true;
    }
    return false;
}

std::vector<Pull> SurfaceDistances::pulls(const Surface& boundary, double weight) const {
    const SurfaceTree boundary_tree(boundary);
    double length = 0;
    for (const auto& t : boundary.triangles) length += glm::distance(boundary.points[t[0]], boundary.points[t[1]]);
    length *= 2 / static_cast<double>(boundary.triangles.size());  // of a side of the level before, or a fifth more
    const std::size_t first = boundary.points.size(), count = first + places_.size();
    const auto weight_at = [&](double distance) {
        return weight / static_cast<double>(count) / (1 + distance * distance / (length * length));
    };
    std::vector<Pull> made(count);
    parallel_each(first, [&](std::size_t p) {
        if (is_cancelled(progress_)) return;
        const SurfacePlace near = tree_.nearest(boundary.points[p]);
        const auto point = static_cast<Index>(p);
        made[p] = {{point, point, point}, {1, 0, 0}, near.toward, near.distance, at_hole(near) ? 0 : weight_at(near.distance)};
    });
    parallel_each(places_.size(), [&](std::size_t k) {
        if (is_cancelled(progress_)) return;
        const SurfacePlace near = boundary_tree.nearest(places_[k]);
        made[first + k] = {boundary.triangles[near.triangle], near.weights, -near.toward, near.distance,
                           weight_at(near.distance)};
    });
    return made;
}

void SurfaceDistances::add_errors(const Surface& boundary, DistanceSums& sums) const {
    const std::vector<Pull> found = pulls(boundary, 1);
    const std::size_t first = boundary.points.size();
    const auto over_hole = [&](std::size_t k) { return k < first && found[k].weight == 0; };
    ShapeError& error = sums.error;
    const double near = side_before(boundary);
    for (std::size_t k = 0; k < found.size(); ++k) {
        const double distance = found[k].distance;
        if (k < first && !over_hole(k)) {
            ++sums.covered;
            error.covered_rms += distance * distance;
            error.covered_max = std::max(error.covered_max, distance);
        }
        const bool missed = k >= first;
        if (missed && distance < near) ++sums.reached;
        (missed ? error.missed_rms : error.rms) += distance * distance;
        double& most = missed ? error.missed_max : error.max;
        Vec3& at = missed ? error.missed_at : error.max_at;
        if (distance <= most && !std::isnan(at.x)) continue;  // the first place counts, even if it is not off
        most = distance;
        at = missed ? places_[k - first] : boundary.points[k];
    }
    sums.points += first;
    sums.places += places_.size();
    for (const auto& t : boundary.triangles) {
        const Vec3& a = boundary.points[t[0]];
        const double here = glm::length(glm::cross(boundary.points[t[1]] - a, boundary.points[t[2]] - a));
        sums.area += here;
        error.hole_part += here / 3 * static_cast<double>(std::ranges::count_if(t, over_hole));
    }
}

std::vector<std::uint8_t> SurfaceDistances::over_holes(const Surface& boundary) const {
    std::vector<std::uint8_t> flags(boundary.points.size());
    parallel_each(flags.size(), [&](std::size_t p) { flags[p] = at_hole(tree_.nearest(boundary.points[p])) ? 1 : 0; });
    return flags;
}

ShapeError DistanceSums::result() const {
    const auto root = [](double sum, std::size_t count) {
        return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(count, 1)));
    };
    ShapeError made = error;
    made.rms = root(error.rms, points);
    made.covered_rms = root(error.covered_rms, covered);
    made.missed_rms = root(error.missed_rms, places);
    made.reached_part = places > 0 ? static_cast<double>(reached) / static_cast<double>(places) : 1;
    made.hole_part = area > 0 ? error.hole_part / area : 0;
    return made;
}

std::vector<Vec3> SurfaceDistances::places_beyond(const Surface& boundary, double far) const {
    const std::vector<Pull> found = pulls(boundary, 1);
    const std::size_t first = boundary.points.size();
    std::vector<Vec3> places;
    for (std::size_t k = 0; k < found.size(); ++k) {
        if (found[k].distance > far && found[k].weight > 0)
            places.push_back(k < first ? boundary.points[k] : places_[k - first]);
    }
    return places;
}

}  // namespace subvol::detail
