// SPDX-License-Identifier: Apache-2.0
#include "flat_faces.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/incident.h"
#include "subvol/detail/parallel_each.h"
#include "surface_shape.h"

namespace subvol::detail {

namespace {

// Points that are nearer to a plane than this part of the bend that is allowed lie in it; so for the fields.
constexpr double kPlanar = 1.0 / 16;

class FlatFaces {
public:
    FlatFaces(const Topology& surface, std::span<const PointKind> kinds, std::span<const Vec3> places, const HullFields& fields,
              double bend_world)
        : surface_(surface), kinds_(kinds), places_(places), fields_(fields), slack_(kPlanar * bend_world) {}

    [[nodiscard]] std::vector<std::uint8_t> flags() const {
        const Topology& t = surface_;
        std::vector<std::uint8_t> straight(t.edges.size()), planar(t.faces.size()), flat(t.faces.size());
        parallel_each(t.edges.size(), [&](std::size_t e) {
            straight[e] = t.edge_is_crease[e] != 0 && each_next_crease(static_cast<Index>(e), [&](Index, Index far) {
                              return goes_straight(t.edges[e][0], t.edges[e][1], far);
                          });
        });
        parallel_each(t.faces.size(), [&](std::size_t f) { planar[f] = is_planar(static_cast<Index>(f)) ? 1 : 0; });
        parallel_each(t.faces.size(), [&](std::size_t f) {
            flat[f] =
                each_face_about(static_cast<Index>(f), [&](Index g) { return planar[g] != 0; }) &&
                std::ranges::all_of(t.face_edges[f], [&](Index e) {
                    return t.edge_is_crease[e] == 0 ||
                           (straight[e] != 0 && each_next_crease(e, [&](Index next, Index) { return straight[next] != 0; }));
                });
        });
        return flat;
    }

private:
    [[nodiscard]] double value(Index p, std::size_t channel) const { return fields_.values[p * fields_.channels + channel]; }

    /// Whether a point lies on the line through two others, and the fields go on along it as between these.
    [[nodiscard]] bool goes_straight(Index from, Index to, Index far) const {
        const Vec3 along = places_[to] - places_[from];
        if (distance_to_line(places_[far], places_[from], places_[to]) > slack_) return false;
        const double length2 = glm::dot(along, along);
        if (!(length2 > 0)) return fields_.channels == 0;
        const double part = glm::dot(places_[far] - places_[from], along) / length2;
        for (std::size_t c = 0; c < fields_.channels; ++c) {
            const double there = value(from, c) + part * (value(to, c) - value(from, c));
            if (!(std::abs(value(far, c) - there) <= slack_)) return false;
        }
        return true;
    }

    /// Whether the points about a face lie in its plane, and the fields are there as linear as between its diagonals.
    [[nodiscard]] bool is_planar(Index face) const {
        const auto& corners = surface_.faces[face];
        const Index a = corners[0], b = corners[1], c = corners[2], d = corners[3];
        const Vec3 u = places_[c] - places_[a], v = places_[d] - places_[b], normal = glm::cross(u, v);
        const double area = glm::length(normal);
        if (!(area > 0)) return false;
        const auto fits = [&](Index p) {
            const Vec3 x = places_[p] - places_[a];
            if (std::abs(glm::dot(normal, x)) > slack_ * area) return false;
            // x = s u + t v in the plane.
            const double s = glm::dot(glm::cross(x, v), normal) / (area * area);
            const double t = glm::dot(glm::cross(u, x), normal) / (area * area);
            for (std::size_t k = 0; k < fields_.channels; ++k) {
                const double there = value(a, k) + s * (value(c, k) - value(a, k)) + t * (value(d, k) - value(b, k));
                if (!(std::abs(value(p, k) - there) <= slack_)) return false;
            }
            return true;
        };
        return each_face_about(face, [&](Index g) { return std::ranges::all_of(surface_.faces[g], fits); });
    }

    /// Whether test(edge, its far end) is true for each crease that goes on at an end of a crease.
    template <class Test>
    [[nodiscard]] bool each_next_crease(Index edge, const Test& test) const {
        for (const Index p : surface_.edges[edge]) {
            if (kinds_[p] != PointKind::Crease) continue;
            for (const Index e : surface_.point_edges[p]) {
                if (e == edge || surface_.edge_is_crease[e] == 0) continue;
                if (!test(e, other_end(surface_, e, p))) return false;
            }
        }
        return true;
    }

    /// Whether a test is true for a face and for all that can be reached from it about its points without crossing a crease:
    /// on these alone the new points in the face depend.
    template <class Test>
    [[nodiscard]] bool each_face_about(Index face, const Test& test) const {
        const Topology& t = surface_;
        if (!test(face)) return false;
        for (std::size_t k = 0; k < 4; ++k) {
            const Index p = t.faces[face][k], last = t.face_edges[face][(k + 3) % 4];
            for (const bool forward : {true, false}) {
                Index edge = forward ? t.face_edges[face][k] : last, at = face;
                while (t.edge_is_crease[edge] == 0) {
                    at = other_boundary_face(t, edge, at);
                    if (at == face) break;
                    if (!test(at)) return false;
                    const std::size_t slot = slot_of(t.faces[at], p);
                    const Index next = t.face_edges[at][slot];
                    edge = next == edge ? t.face_edges[at][(slot + 3) % 4] : next;
                }
                if (at == face && t.edge_is_crease[edge] == 0) break;  // all around
            }
        }
        return true;
    }

    const Topology& surface_;
    std::span<const PointKind> kinds_;
    std::span<const Vec3> places_;
    HullFields fields_;
    double slack_;
};

}  // namespace

std::vector<std::uint8_t> flat_faces(const Topology& surface, std::span<const PointKind> kinds, std::span<const Vec3> places,
                                     const HullFields& fields, double bend_world) {
    return FlatFaces(surface, kinds, places, fields, bend_world).flags();
}

}  // namespace subvol::detail
