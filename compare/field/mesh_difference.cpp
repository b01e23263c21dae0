// SPDX-License-Identifier: Apache-2.0
#include "subvol/field_metrics.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "closed_surface.h"
#include "subvol/detail/triangle_distance.h"
#include "subvol/error.h"
#include "subvol/probe.h"
#include "subvol/surface.h"

namespace subvol {

namespace {

/// Points outside the reference that are nearer to its limit than this part of the diagonal have the limit's nearest place.
constexpr double kNear = 1e-2;

/// The fields of `test` that the reference has, too, in both meshes in the same order.
struct CommonFields {
    std::vector<Attribute> test, reference;
};

CommonFields common_fields_of(const HexMesh& test, const HexMesh& reference) {
    CommonFields common;
    for (const Attribute& field : test.attributes) {
        const Attribute* const other = reference.find_attribute(field.name);
        if (other == nullptr || other->channels != field.channels) continue;
        common.test.push_back(field);
        common.reference.push_back(*other);
    }
    if (!common.test.empty()) return common;
    throw Error(ErrorCode::InvalidInput, "the two meshes have no field in common", "mesh_difference",
                "fields of the same name and the same number of components");
}

/// A field of plain values: the difference of two functions is none of theirs.
Attribute subtracted(const Attribute& test, std::span<const double> reference) {
    Attribute difference{.name = test.name, .channels = test.channels, .values = test.values};
    for (std::size_t i = 0; i < reference.size(); ++i) difference.values[i] -= reference[i];
    return difference;
}

void subtract_same(const CommonFields& common, MeshDifference& found) {
    for (std::size_t f = 0; f < common.test.size(); ++f) {
        const Attribute &a = common.test[f], &b = common.reference[f];
        Attribute difference = subtracted(a, b.values);
        if (a.cells.size() == b.cells.size()) {
            difference.cells = a.cells;
            for (std::size_t i = 0; i < b.cells.size(); ++i) difference.cells[i] -= b.cells[i];
            difference.constant = a.constant && b.constant;
        }
        found.mesh.attributes.push_back(std::move(difference));
    }
}

/// The place of a surface that is nearest to a point, and how far that is.
struct NearestOfSurface {
    Vec3 place{0.0};
    double distance = 0;
};

NearestOfSurface nearest_of(const Surface& surface, const detail::BoxTree& tree, const Vec3& x) {
    NearestOfSurface best{.distance = std::numeric_limits<double>::infinity()};
    (void)tree.nearest(x, [&](Index t) {
        const auto& corner = surface.triangles[t];
        const Vec3 &a = surface.points[corner[0]], &b = surface.points[corner[1]], &c = surface.points[corner[2]];
        const Vec3 weights = detail::nearest_in_triangle(x, a, b, c).weights;
        const Vec3 place = weights.x * a + weights.y * b + weights.z * c;
        const double distance = glm::distance(x, place);
        if (distance < best.distance) best = {place, distance};
        return distance * distance;
    });
    return best;
}

/// The reference at the points of the first mesh, found in three ways of which each leaves some to the next: in its limit; near
/// to it; at the nearest places of the boundary of its cells, which is near to the limit.
class DifferenceAtPlaces {
public:
    DifferenceAtPlaces(HexMesh reference, const MeshDifferenceOptions& options, MeshDifference& found)
        : reference_(std::move(reference)), options_(options), found_(found), left_(found.mesh.points.size()) {
        std::iota(left_.begin(), left_.end(), Index{0});
    }

    void subtract() {
        const double near = kNear * bounds(reference_).diagonal();
        subtract_at(found_.mesh.points, {}, 0);
        if (!left_.empty()) subtract_at(places_left(), {}, near);
        if (left_.empty()) return;
        const Surface boundary = boundary_surface(reference_);
        const detail::BoxTree tree(detail::triangle_boxes(boundary));
        std::vector<Vec3> places = places_left();
        std::vector<double> distances(places.size());
        tbb::parallel_for(std::size_t{0}, places.size(), [&](std::size_t i) {
            const NearestOfSurface nearest = nearest_of(boundary, tree, places[i]);
            places[i] = nearest.place;
            distances[i] = nearest.distance;
        });
        subtract_at(places, distances, near);
        if (left_.empty()) return;
        throw Error(ErrorCode::InvalidInput, "point " + std::to_string(left_.front()) + " is near no place of the reference",
                    "mesh_difference", "a reference that does not fold at its boundary");
    }

private:
    [[nodiscard]] std::vector<Vec3> places_left() const {
        std::vector<Vec3> places;
        for (const Index p : left_) places.push_back(found_.mesh.points[p]);
        return places;
    }

    /// Takes the points whose places are within `reach` of the limit off those that are left. distances: of the points from
    /// these places; none: 0
    void subtract_at(std::span<const Vec3> places, std::span<const double> distances, double reach) {
        const ProbeOptions asked{.limit = {.scheme = options_.scheme, .progress = options_.progress}, .reach_world = reach};
        const ProbeResult values = probe_limit(reference_, places, asked, options_.progress);
        std::vector<Index> missed;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const Index p = left_[i];
            if (!values.inside(i)) {
                missed.push_back(p);
                continue;
            }
            const double distance = distances.empty() ? values.distances[i] : distances[i];
            found_.outside += distance > 0 ? 1 : 0;
            found_.outside_world = std::max(found_.outside_world, distance);
            for (std::size_t f = 0; f < values.fields.size(); ++f) {
                const std::size_t channels = values.fields[f].channels;
                for (std::size_t c = 0; c < channels; ++c)
                    found_.mesh.attributes[f].values[p * channels + c] -= values.fields[f].values[i * channels + c];
            }
        }
        left_ = std::move(missed);
    }

    HexMesh reference_;
    MeshDifferenceOptions options_;
    MeshDifference& found_;
    std::vector<Index> left_;
};

LargestDifference largest_of(const Attribute& field, const HexMesh& mesh) {
    const bool at_cells = !field.cells.empty();
    const std::vector<double>& values = at_cells ? field.cells : field.values;
    const auto channels = static_cast<std::size_t>(field.channels);
    double largest = -1;
    Index place = 0;
    for (Index k = 0; k < values.size() / channels; ++k) {
        double square = 0;
        for (std::size_t c = 0; c < channels; ++c) square += values[k * channels + c] * values[k * channels + c];
        if (square <= largest) continue;
        largest = square;
        place = k;
    }
    LargestDifference found{.name = field.name, .max = std::sqrt(largest)};
    if (!at_cells) {
        found.point = place;
        found.place = mesh.points[place];
        return found;
    }
    found.cell = place;
    for (const Index p : mesh.cells[place]) found.place += mesh.points[p] / 8.0;
    return found;
}

}  // namespace

Facts facts_of(const MeshDifference& difference) {
    Facts facts;
    facts["same_points"] = difference.same_points;
    facts["outside"] = difference.outside;
    facts["outside_distance"] = difference.outside_world;
    Facts& fields = facts.group("fields");
    for (const LargestDifference& largest : difference.fields) {
        Facts& field = fields.group(largest.name);
        field["max"] = largest.max;
        field["at"] = std::array{largest.place.x, largest.place.y, largest.place.z};
        if (largest.point) field["point"] = *largest.point;
        if (largest.cell) field["cell"] = *largest.cell;
    }
    return facts;
}

MeshDifference mesh_difference(const HexMesh& test, const HexMesh& reference, const MeshDifferenceOptions& options) {
    validate(test);
    validate(reference);
    const CommonFields common = common_fields_of(test, reference);
    MeshDifference found;
    found.mesh = test;
    found.mesh.attributes.clear();
    found.same_points = test.cells == reference.cells && test.points == reference.points;
    if (found.same_points) {
        subtract_same(common, found);
    } else {
        for (const Attribute& field : common.test) found.mesh.attributes.push_back(subtracted(field, {}));
        HexMesh other = reference;
        other.attributes = common.reference;
        DifferenceAtPlaces(std::move(other), options, found).subtract();
    }
    for (const Attribute& field : found.mesh.attributes) found.fields.push_back(largest_of(field, found.mesh));
    return found;
}

}  // namespace subvol
