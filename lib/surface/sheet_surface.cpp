// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "subvol/error.h"
#include "subvol/limit_sheets.h"

namespace subvol {

namespace {

constexpr std::size_t kSides = 8;  // of a tube
constexpr double kBend = 0.98;     // cosine: less bent joints need no ball, as the gap is narrower than a tenth of the radius

/// Two vectors across a direction, of unit length.
std::array<Vec3, 2> across(const Vec3& along) {
    const Vec3 a(std::abs(along.x), std::abs(along.y), std::abs(along.z));
    const Vec3 other = a.x <= a.y && a.x <= a.z ? Vec3(1, 0, 0) : a.y <= a.z ? Vec3(0, 1, 0) : Vec3(0, 0, 1);
    const Vec3 u = glm::normalize(glm::cross(along, other));
    return {u, glm::cross(along, u)};
}

class TubeMaker {
public:
    TubeMaker(SheetSurface& to, double radius) : to_(to), radius_(radius) {}

    void tube(const Sheets& sheets, Index a, Index b) {
        const Vec3 step = sheets.points[b] - sheets.points[a];
        const double length = glm::length(step);
        if (!(length > 0)) return;
        const auto [u, v] = across(step / length);
        const std::size_t first = to_.surface.points.size();
        for (std::size_t k = 0; k < kSides; ++k) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(k) / kSides;
            const Vec3 offset = radius_ * (std::cos(angle) * u + std::sin(angle) * v);
            add(sheets.points[a] + offset, a);
            add(sheets.points[b] + offset, b);
        }
        for (std::size_t k = 0; k < kSides; ++k) {
            const std::size_t here = first + 2 * k, next = first + 2 * ((k + 1) % kSides);
            triangle(here, next, here + 1);
            triangle(next, next + 1, here + 1);
        }
    }

    /// An octahedron whose faces are split once, on the sphere.
    void ball(const Sheets& sheets, Index p) {
        const std::array<Vec3, 6> tips{Vec3(1, 0, 0),  Vec3(-1, 0, 0), Vec3(0, 1, 0),
                                       Vec3(0, -1, 0), Vec3(0, 0, 1),  Vec3(0, 0, -1)};
        for (std::size_t face = 0; face < 8; ++face) {
            const Vec3 x = tips[face & 1], y = tips[2 + (face >> 1 & 1)], z = tips[4 + (face >> 2)];
            const bool turned = glm::dot(glm::cross(y - x, z - x), x) < 0;
            const Vec3 &a = x, &b = turned ? z : y, &c = turned ? y : z;
            const Vec3 ab = glm::normalize(a + b), bc = glm::normalize(b + c), ca = glm::normalize(c + a);
            for (const auto& corners :
                 {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}}) {
                const std::size_t first = to_.surface.points.size();
                for (const Vec3& corner : corners) add(sheets.points[p] + radius_ * corner, p);
                triangle(first, first + 1, first + 2);
            }
        }
    }

private:
    void add(const Vec3& point, Index source) {
        to_.surface.points.push_back(point);
        to_.sources.push_back(source);
    }
    void triangle(std::size_t a, std::size_t b, std::size_t c) {
        to_.surface.triangles.push_back({static_cast<Index>(a), static_cast<Index>(b), static_cast<Index>(c)});
    }

    SheetSurface& to_;
    double radius_;
};

/// The lines that are no edges of quads.
std::vector<std::array<Index, 2>> lines_alone(const Sheets& sheets) {
    std::vector<std::array<Index, 2>> edges, lines;
    if (sheets.lines.empty()) return lines;
    edges.reserve(4 * sheets.quads.size());
    for (const auto& quad : sheets.quads) {
        for (std::size_t k = 0; k < 4; ++k) {
            const auto [low, high] = std::minmax({quad[k], quad[(k + 1) % 4]});
            edges.push_back({low, high});
        }
    }
    std::ranges::sort(edges);
    for (const auto& line : sheets.lines) {
        if (!std::ranges::binary_search(edges, std::array{std::min(line[0], line[1]), std::max(line[0], line[1])}))
            lines.push_back(line);
    }
    return lines;
}

}  // namespace

SheetSurface sheet_surface(const Sheets& sheets, double tube_radius_world) {
    if (!(tube_radius_world >= 0) || !std::isfinite(tube_radius_world)) {
        throw Error(ErrorCode::InvalidInput, "the radius of tubes is " + std::to_string(tube_radius_world), "sheets",
                    "0 or more");
    }
    SheetSurface result;
    result.surface.points = sheets.points;
    for (Index p = 0; p < sheets.points.size(); ++p) result.sources.push_back(p);
    for (const auto& [a, b, c, d] : sheets.quads) {
        result.surface.triangles.push_back({a, b, c});
        result.surface.triangles.push_back({a, c, d});
    }
    result.sheet_triangles = result.surface.triangles.size();
    if (tube_radius_world == 0) return result;
    TubeMaker maker(result, tube_radius_world);
    const auto lines = lines_alone(sheets);
    std::vector<std::vector<Index>> others(sheets.points.size());
    for (const auto& [a, b] : lines) {
        maker.tube(sheets, a, b);
        others[a].push_back(b);
        others[b].push_back(a);
    }
    for (Index p = 0; p < others.size(); ++p) {
        if (others[p].empty()) continue;
        if (others[p].size() == 2) {
            const Vec3 before = sheets.points[p] - sheets.points[others[p][0]],
                       after = sheets.points[others[p][1]] - sheets.points[p];
            if (glm::dot(before, after) > kBend * glm::length(before) * glm::length(after)) continue;
        }
        maker.ball(sheets, p);
    }
    return result;
}

void add_sheets(LimitSurface& surface, const Sheets& sheets) {
    bool same = surface.fields.size() == sheets.attributes.size();
    for (std::size_t f = 0; same && f < surface.fields.size(); ++f) {
        same = surface.fields[f].name == sheets.attributes[f].name &&
               surface.fields[f].channels == static_cast<std::size_t>(sheets.attributes[f].channels);
    }
    if (!same) throw Error(ErrorCode::InvalidInput, "their fields are not those of the surface", "sheets");
    std::vector<Index> number(sheets.points.size(), kNone);
    const auto add = [&](Index p) {
        if (number[p] != kNone) return;
        number[p] = static_cast<Index>(surface.surface.points.size());
        surface.surface.points.push_back(sheets.points[p]);
        surface.normals.emplace_back(0.0);
        surface.places.push_back({});
        for (std::size_t f = 0; f < surface.fields.size(); ++f) {
            ProbedField& field = surface.fields[f];
            for (std::size_t c = 0; c < field.channels; ++c) {
                field.values.push_back(sheets.attributes[f].values[p * field.channels + c]);
                field.gradients.emplace_back(0.0);
            }
        }
    };
    const std::size_t first = surface.surface.points.size();
    for (const auto& [a, b, c, d] : sheets.quads) {
        for (const Index p : {a, b, c, d}) add(p);
        const Vec3 normal = glm::cross(sheets.points[c] - sheets.points[a], sheets.points[d] - sheets.points[b]);
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
