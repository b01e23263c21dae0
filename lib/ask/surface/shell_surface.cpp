// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "shell_triangles.h"
#include "subvol/detail/across.h"
#include "subvol/error.h"

namespace subvol {

namespace {

constexpr std::size_t kSides = 8;  // of a tube
constexpr double kBend = 0.98;     // cosine: less bent joints need no ball, as the gap is narrower than a tenth of the radius

class TubeMaker : detail::ShellTriangles {
public:
    TubeMaker(ShellSurface& to, double radius) : ShellTriangles(to), radius_(radius) {}

    void tube(const Shells& shells, Index a, Index b) {
        const Vec3 step = shells.points[b] - shells.points[a];
        const double length = glm::length(step);
        if (!(length > 0)) return;
        const auto [u, v] = detail::across(step / length);
        const std::size_t first = next_point();
        for (std::size_t k = 0; k < kSides; ++k) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kSides;
            const Vec3 offset = radius_ * (std::cos(angle) * u + std::sin(angle) * v);
            add(shells.points[a] + offset, a);
            add(shells.points[b] + offset, b);
        }
        for (std::size_t k = 0; k < kSides; ++k) {
            const std::size_t here = first + 2 * k, next = first + 2 * ((k + 1) % kSides);
            triangle(here, next, here + 1);
            triangle(next, next + 1, here + 1);
        }
    }

    /// An octahedron whose faces are split once, on the sphere.
    void ball(const Shells& shells, Index p) {
        const std::array<Vec3, 6> tips{Vec3(1, 0, 0),  Vec3(-1, 0, 0), Vec3(0, 1, 0),
                                       Vec3(0, -1, 0), Vec3(0, 0, 1),  Vec3(0, 0, -1)};
        for (std::size_t face = 0; face < 8; ++face) {
            const Vec3 x = tips[face & 1], y = tips[2 + (face >> 1 & 1)], z = tips[4 + (face >> 2)];
            const bool turned = glm::dot(glm::cross(y - x, z - x), x) < 0;
            const Vec3 &a = x, &b = turned ? z : y, &c = turned ? y : z;
            const Vec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
            for (const auto& corners :
                 {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}}) {
                const std::size_t first = next_point();
                for (const Vec3& corner : corners) add(shells.points[p] + radius_ * corner, p);
                triangle(first, first + 1, first + 2);
            }
        }
    }

private:
    double radius_;
};

/// The lines that are not edges of quads.
std::vector<std::array<Index, 2>> lines_alone(const Shells& shells) {
    std::vector<std::array<Index, 2>> edges, lines;
    if (shells.lines.empty()) return lines;
    edges.reserve(4 * shells.quads.size());
    for (const auto& quad : shells.quads) {
        for (std::size_t k = 0; k < 4; ++k) {
            const auto [low, high] = std::minmax({quad[k], quad[(k + 1) % 4]});
            edges.push_back({low, high});
        }
    }
    std::ranges::sort(edges);
    for (const auto& line : shells.lines) {
        if (!std::ranges::binary_search(edges, std::array{std::min(line[0], line[1]), std::max(line[0], line[1])}))
            lines.push_back(line);
    }
    return lines;
}

}  // namespace

ShellSurface shell_surface(const Shells& shells, double tube_radius_world) {
    if (!(tube_radius_world >= 0) || !std::isfinite(tube_radius_world)) {
        throw Error(ErrorCode::InvalidInput, "the radius of tubes is " + std::to_string(tube_radius_world), "shells",
                    "0 or more");
    }
    ShellSurface result;
    result.surface.points = shells.points;
    for (Index p = 0; p < shells.points.size(); ++p) result.sources.push_back(p);
    for (const auto& [a, b, c, d] : shells.quads) {
        result.surface.triangles.push_back({a, b, c});
        result.surface.triangles.push_back({a, c, d});
    }
    result.shell_triangles = result.surface.triangles.size();
    if (tube_radius_world == 0) return result;
    TubeMaker maker(result, tube_radius_world);
    const auto lines = lines_alone(shells);
    std::vector<std::vector<Index>> others(shells.points.size());
    for (const auto& [a, b] : lines) {
        maker.tube(shells, a, b);
        others[a].push_back(b);
        others[b].push_back(a);
    }
    for (Index p = 0; p < others.size(); ++p) {
        if (others[p].empty()) continue;
        if (others[p].size() == 2) {
            const Vec3 before = shells.points[p] - shells.points[others[p][0]],
                       after = shells.points[others[p][1]] - shells.points[p];
            if (glm::dot(before, after) > kBend * glm::length(before) * glm::length(after)) continue;
        }
        maker.ball(shells, p);
    }
    return result;
}

void add_shells(LimitSurface& surface, const Shells& shells) {
    bool same = surface.fields.size() == shells.attributes.size();
    for (std::size_t f = 0; same && f < surface.fields.size(); ++f) {
        same = surface.fields[f].name == shells.attributes[f].name &&
               surface.fields[f].channels == static_cast<std::size_t>(shells.attributes[f].channels);
    }
    if (!same) throw Error(ErrorCode::InvalidInput, "their fields are not those of the surface", "shells");
    std::vector<Index> number(shells.points.size(), kNone);
    const auto add = [&](Index p) {
        if (number[p] != kNone) return;
        number[p] = static_cast<Index>(surface.surface.points.size());
        surface.surface.points.push_back(shells.points[p]);
        surface.normals.emplace_back(0.0);
        surface.places.push_back({});
        for (std::size_t f = 0; f < surface.fields.size(); ++f) {
            ProbedField& field = surface.fields[f];
            for (std::size_t c = 0; c < field.channels; ++c) {
                field.values.push_back(shells.attributes[f].values[p * field.channels + c]);
                field.gradients.emplace_back(0.0);
            }
        }
    };
    const std::size_t first = surface.surface.points.size();
    for (const auto& [a, b, c, d] : shells.quads) {
        for (const Index p : {a, b, c, d}) add(p);
        const Vec3 normal = glm::cross(shells.points[c] - shells.points[a], shells.points[d] - shells.points[b]);
        for (const Index p : {a, b, c, d}) surface.normals[number[p]] += normal;
        surface.surface.triangles.push_back({number[a], number[b], number[c]});
        surface.surface.triangles.push_back({number[a], number[c], number[d]});
    }
    for (std::size_t p = first; p < surface.normals.size(); ++p) {
        const double length = glm::length(surface.normals[p]);
        if (length > 0) surface.normals[p] /= length;
    }
}

}  // namespace subvol
