// SPDX-License-Identifier: Apache-2.0
#include "point_settler.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/limit_place.h"
#include "subvol/detail/parallel_each.h"
#include "surface_shape.h"

namespace subvol::detail {

/// A point on its way along an edge.
struct PointSettler::Moving {
    std::size_t point;
    double low = 0, high = 1;  // the crossing is between them
    double t = 0;
    bool done = false;
};

namespace {

constexpr int kMostSettlingRounds = 12;                       // of Newton's method on an edge
constexpr double kEdgeTolerance = 1e-9;                       // of an edge
constexpr std::size_t kSettledAtOnce = std::size_t{1} << 20;  // points that are moved to the limit at a time

Vec3 place_on_edge(const SurfacePoint& point, double t, int level) {
    const auto end = [&](std::size_t e) {
        return std::ldexp(1.0, -level) * Vec3(point.at[e][0], point.at[e][1], point.at[e][2]);
    };
    return (1 - t) * end(0) + t * end(1);
}

/// Against the gradient, or outwards on the hull.
Vec3 normal_of(const SurfacePoint& point, const LimitSamples& samples, std::size_t i, const Cut& cut) {
    const Mat3& jacobian = samples.jacobians[i];
    Vec3 normal(0.0);
    if (cut.iso && point.a != point.b) {
        normal = -detail::world_gradient(jacobian, samples.attributes[0].derivatives[i]);
    } else if (point.side < 6) {
        const int axis = point.side / 2;
        normal = glm::cross(jacobian[(axis + 1) % 3], jacobian[(axis + 2) % 3]) * (point.side % 2 == 1 ? 1.0 : -1.0);
    }
    const double length = glm::length(normal);
    return length > 0 ? normal / length : Vec3(0.0);
}

}  // namespace

void SettledPoints::resize(std::size_t count, std::span<const ProbedField> like) {
    places.resize(count);
    positions.resize(count);
    normals.resize(count);
    fields = without_points(like);
    for (ProbedField& field : fields) {
        field.values.resize(count * field.channels);
        field.gradients.resize(count * field.channels);
    }
}

void SettledPoints::add(const SettledPoints& from, std::size_t point) {
    places.push_back(from.places[point]);
    positions.push_back(from.positions[point]);
    normals.push_back(from.normals[point]);
    add_fields(from.fields, point, fields);
}

void take_fields(const LimitSamples& samples, std::size_t i, const Vec3& step, std::size_t point,
                 std::span<ProbedField> fields) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
        const LimitAttribute& from = samples.attributes[f];
        for (std::size_t k = 0; k < from.channels; ++k) {
            const Vec3& derivatives = from.derivatives[i * from.channels + k];
            fields[f].values[point * from.channels + k] = from.values[i * from.channels + k] + glm::dot(derivatives, step);
            fields[f].gradients[point * from.channels + k] = world_gradient(samples.jacobians[i], derivatives);
        }
    }
}

void add_fields(std::span<const ProbedField> from, std::size_t point, std::span<ProbedField> to) {
    for (std::size_t f = 0; f < to.size(); ++f) {
        for (std::size_t k = 0; k < to[f].channels; ++k) {
            to[f].values.push_back(from[f].values[point * to[f].channels + k]);
            to[f].gradients.push_back(from[f].gradients[point * to[f].channels + k]);
        }
    }
}

std::vector<ProbedField> fields_of(const HexMesh& mesh) {
    std::vector<ProbedField> fields;
    for (const Attribute& attribute : mesh.attributes) {
        fields.push_back({attribute.name, static_cast<std::size_t>(attribute.channels), {}, {}});
    }
    return fields;
}

std::vector<ProbedField> without_points(std::span<const ProbedField> fields) {
    std::vector<ProbedField> none;
    for (const ProbedField& field : fields) none.push_back({field.name, field.channels, {}, {}});
    return none;
}

PointSettler::PointSettler(const HexMesh& mesh, const Topology& topology, const LimitExtent& whole, const SchemeOptions& scheme,
                           Progress* progress)
    : fields_(fields_of(mesh)), topology_(topology), limit_(mesh, {.scheme = scheme}, whole), progress_(progress) {
}

SettledPoints PointSettler::settle(const SurfaceSoup& soup, const Cut& cut, int level) const {
    SettledPoints settled;
    settled.resize(soup.points.size(), fields_);
    for (std::size_t begin = 0; begin < soup.points.size(); begin += kSettledAtOnce) {
        report_progress(progress_, "to the limit", begin, soup.points.size());
        std::vector<Moving> moving;
        for (std::size_t p = begin; p < std::min(soup.points.size(), begin + kSettledAtOnce); ++p) {
            const SurfacePoint& point = soup.points[p];
            const double difference = point.off[0] - point.off[1];
            moving.push_back({p, 0, 1, point.a == point.b || difference == 0 ? 0 : point.off[0] / difference});
        }
        move(soup, cut, level, moving, settled);
    }
    return settled;
}

void PointSettler::move(const SurfaceSoup& soup, const Cut& cut, int level, std::vector<Moving>& moving,
                        SettledPoints& settled) const {
    std::vector<LimitQuery> queries;
    for (int round = 0; !moving.empty(); ++round) {
        queries.clear();
        for (const Moving& one : moving) {
            queries.push_back({soup.points[one.point].cell, place_on_edge(soup.points[one.point], one.t, level)});
        }
        const LimitSamples samples = limit_.at(queries);
        parallel_each(moving.size(), [&](std::size_t i) {
            Moving& one = moving[i];
            const SurfacePoint& point = soup.points[one.point];
            const Vec3 along = place_on_edge(point, 1, level) - place_on_edge(point, 0, level);
            double by = 0;
            if (point.a != point.b) {
                const double off = samples.attributes[0].values[i] - *cut.iso;
                const double slope = glm::dot(samples.attributes[0].derivatives[i], along);
                if ((off >= 0) == (point.off[0] >= 0)) {
                    one.low = one.t;
                } else {
                    one.high = one.t;
                }
                double next = one.t - off / slope;
                if (!(next > one.low && next < one.high)) next = off == 0 ? one.t : 0.5 * (one.low + one.high);
                by = next - one.t;
            }
            const bool last = std::abs(by) < 1e-3 || round + 1 == kMostSettlingRounds;
            if (!last) {
                one.t += by;
                return;
            }
            // What is left is linear to within the square of the step.
            const Vec3 step = by * along;
            settled.places[one.point] = {queries[i].cell, glm::clamp(queries[i].uvw + step, Vec3(0.0), Vec3(1.0))};
            settled.positions[one.point] = samples.positions[i] + samples.jacobians[i] * step;
            settled.normals[one.point] = normal_of(point, samples, i, cut);
            take_fields(samples, i, step, one.point, settled.fields);
            one.done = std::abs(by) < kEdgeTolerance || round + 1 == kMostSettlingRounds || std::abs(by) < 1e-3;
        });
        std::erase_if(moving, [](const Moving& one) { return one.done; });
    }
}

double PointSettler::deviation(const SurfaceSoup& soup, const SettledPoints& settled, int level) const {
    std::vector<double> bends(3 * soup.triangles.size(), 0);
    std::vector<std::size_t> hull;
    for (std::size_t t = 0; t < soup.triangles.size(); ++t) {
        if (soup.hull[t] != 0) hull.push_back(t);
    }
    parallel_each(soup.triangles.size(), [&](std::size_t t) {
        if (soup.hull[t] != 0) return;
        for (std::size_t k = 0; k < 3; ++k) {
            const Index a = soup.triangles[t][k], b = soup.triangles[t][(k + 1) % 3];
            bends[3 * t + k] =
                kTriangleBend * bend(settled.positions[a], settled.positions[b], settled.normals[a], settled.normals[b]);
        }
    });
    add_hull_bends(soup, settled, level, hull, bends);
    if (bends.empty()) return 0;
    const std::size_t most = bends.size() - 1 - bends.size() / 1000;
    std::nth_element(bends.begin(), bends.begin() + static_cast<std::ptrdiff_t>(most), bends.end());
    return bends[most];
}

/// Measures triangles on the hull by the limit in the middle of their edges.
void PointSettler::add_hull_bends(const SurfaceSoup& soup, const SettledPoints& settled, int level,
                                  const std::vector<std::size_t>& hull, std::vector<double>& bends) const {
    constexpr std::size_t kMostProbes = 40000;
    struct Probe {
        Index a, b;
    };
    const std::size_t stride = 1 + 3 * hull.size() / kMostProbes;
    std::vector<Probe> probes;
    std::vector<LimitQuery> queries;
    for (std::size_t i = 0; i < 3 * hull.size(); i += stride) {
        const auto& t = soup.triangles[hull[i / 3]];
        const Index a = t[i % 3], b = t[(i + 1) % 3];
        const SurfacePoint &from = soup.points[a], &to = soup.points[b];
        if (from.cell != to.cell || from.a != from.b || to.a != to.b) continue;
        const Vec3 middle = 0.5 * (place_on_edge(from, 0, level) + place_on_edge(to, 0, level));
        if (!on_hull(from.cell, middle)) continue;
        probes.push_back({a, b});
        queries.push_back({from.cell, middle});
    }
    bends.reserve(bends.size() + probes.size());
    for (std::size_t t : hull) bends[3 * t] = bends[3 * t + 1] = bends[3 * t + 2] = 0;
    const LimitSamples samples = limit_.at(queries);
    std::size_t next = 0;
    for (std::size_t i = 0; i < probes.size(); ++i) {
        const Vec3 &a = settled.positions[probes[i].a], &b = settled.positions[probes[i].b];
        // Each sample represents `stride` boundary edges.
        const double far = kTriangleBend * distance_to_line(samples.positions[i], a, b);
        for (std::size_t n = 0; n < stride && next < 3 * hull.size(); ++n, ++next) bends[3 * hull[next / 3] + next % 3] = far;
    }
}

bool PointSettler::on_hull(Index cell, const Vec3& uvw) const {
    for (std::size_t f = 0; f < 6; ++f) {
        const double t = uvw[static_cast<int>(f / 2)];
        if (t == (f % 2 == 0 ? 0.0 : 1.0) && topology_.face_on_hull(topology_.cell_faces[cell][f])) return true;
    }
    return false;
}

}  // namespace subvol::detail
