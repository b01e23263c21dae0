// SPDX-License-Identifier: Apache-2.0
#include "subvol/hex_mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>

#include "subvol/detail/error_text.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/place_function.h"
#include "subvol/error.h"

namespace subvol {

namespace {

/// The first of the numbers in [0, count) for which `wrong` is true; in parallel.
template <class Wrong>
std::optional<std::size_t> first_where(std::size_t count, const Wrong& wrong) {
    const std::size_t found = tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, count), count,
        [&](const auto& range, std::size_t first) {
            for (std::size_t i = range.begin(); i < std::min(range.end(), first); ++i) {
                if (wrong(i)) return i;
            }
            return first;
        },
        [](std::size_t a, std::size_t b) { return std::min(a, b); });
    return found == count ? std::nullopt : std::optional(found);
}

/// Whether a cell has 8 different points below the count; without branches, since nearly all cells are valid.
bool is_valid(const std::array<Index, 8>& cell, std::size_t points) {
    bool wrong = false;
    for (std::size_t k = 0; k < 8; ++k) {
        wrong |= cell[k] >= points;
        for (std::size_t j = 0; j < k; ++j) wrong |= cell[j] == cell[k];
    }
    return !wrong;
}

void validate_cells(const HexMesh& mesh) {
    const std::size_t points = mesh.points.size();
    const auto bad = first_where(mesh.cells.size(), [&](std::size_t c) { return !is_valid(mesh.cells[c], points); });
    if (!bad) return;
    const std::string where = "cell " + std::to_string(*bad);
    auto corners = mesh.cells[*bad];
    for (std::size_t k = 0; k < 8; ++k) {
        if (corners[k] < points) continue;
        throw Error(ErrorCode::InvalidInput,
                    "corner " + std::to_string(k) + " is " + std::to_string(corners[k]) + "; the mesh has " +
                        std::to_string(points) + " points",
                    where);
    }
    std::sort(corners.begin(), corners.end());
    throw Error(ErrorCode::InvalidInput,
                "point " + std::to_string(*std::adjacent_find(corners.begin(), corners.end())) + " is listed twice", where,
                "a hexahedron needs 8 different points");
}

void validate_tags(const HexMesh& mesh, const std::vector<std::uint8_t>& used) {
    const auto check = [&](const auto& points, const std::string& where) {
        for (const Index p : points) {
            if (p >= mesh.points.size()) {
                throw Error(
                    ErrorCode::InvalidInput,
                    "point " + std::to_string(p) + " does not exist; the mesh has " + std::to_string(mesh.points.size()),
                    where);
            }
            if (!used[p]) throw Error(ErrorCode::InvalidInput, "point " + std::to_string(p) + " belongs to no cell", where);
        }
    };
    for (std::size_t i = 0; i < mesh.creases.size(); ++i) check(mesh.creases[i], "crease " + std::to_string(i));
    for (std::size_t i = 0; i < mesh.sharp_faces.size(); ++i) check(mesh.sharp_faces[i], "sharp face " + std::to_string(i));
}

}  // namespace

const Attribute* HexMesh::find_attribute(std::string_view name) const {
    const auto found = std::find_if(attributes.begin(), attributes.end(), [&](const auto& a) { return a.name == name; });
    return found == attributes.end() ? nullptr : &*found;
}

const Attribute& scalar_field(const HexMesh& mesh, std::string_view name) {
    std::vector<std::string> known;
    for (const auto& attribute : mesh.attributes) {
        if (attribute.channels != 1) continue;
        if (name.empty() || attribute.name == name) return attribute;
        known.push_back(attribute.name);
    }
    throw Error(ErrorCode::InvalidInput,
                name.empty() ? "the mesh has no field of one channel"
                             : "there is no field \"" + std::string(name) + "\" of one channel",
                {}, known.empty() ? "an attribute of one channel" : "the mesh has: " + detail::listed(known));
}

std::vector<std::uint8_t> detail::used_points(const HexMesh& mesh) {
    std::vector<std::uint8_t> used(mesh.points.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.cells.size()), [&](const auto& range) {
        for (std::size_t c = range.begin(); c < range.end(); ++c) {
            for (const Index p : mesh.cells[c]) std::atomic_ref(used[p]).store(1, std::memory_order_relaxed);
        }
    });
    return used;
}

void validate(const HexMesh& mesh) {
    if (mesh.cells.empty()) throw Error(ErrorCode::InvalidInput, "the mesh has no hexahedra");
    validate_cells(mesh);
    const auto used = detail::used_points(mesh);
    validate_tags(mesh, used);
    const auto wrong_point = first_where(mesh.points.size(), [&](std::size_t p) {
        const Vec3& x = mesh.points[p];
        return used[p] && !(std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z));
    });
    if (wrong_point) {
        throw Error(ErrorCode::InvalidInput, "a coordinate is not finite", "point " + std::to_string(*wrong_point));
    }
    for (const auto& attribute : mesh.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        if (attribute.channels < 1 || attribute.values.size() != channels * mesh.points.size()) {
            throw Error(ErrorCode::InvalidInput, "has " + std::to_string(attribute.values.size()) + " values",
                        "attribute \"" + attribute.name + "\"",
                        std::to_string(mesh.points.size()) + " points of " + std::to_string(attribute.channels) + " channels");
        }
        assert(attribute.function == nullptr ||
               attribute.arguments.size() == attribute.function->arguments * mesh.points.size());
        const auto wrong_value = first_where(
            attribute.values.size(), [&](std::size_t i) { return !std::isfinite(attribute.values[i]) && used[i / channels]; });
        if (wrong_value) {
            throw Error(ErrorCode::InvalidInput,
                        "the value at point " + std::to_string(*wrong_value / channels) + " is not finite",
                        "attribute \"" + attribute.name + "\"");
        }
    }
}

HexMesh without_unused_points(HexMesh mesh) {
    const auto used = detail::used_points(mesh);
    std::vector<Index> renumbered(mesh.points.size(), kNone);
    Index count = 0;
    for (std::size_t p = 0; p < used.size(); ++p) {
        if (used[p]) renumbered[p] = count++;
    }
    if (count == mesh.points.size()) return mesh;

    HexMesh result;
    result.time = mesh.time;
    result.points.reserve(count);
    for (const auto& attribute : mesh.attributes) {
        Attribute& kept = result.attributes.emplace_back(detail::without_values(attribute));
        kept.cells = attribute.cells;
        kept.constant = attribute.constant;
        kept.walls = detail::at_kept_points(attribute.walls, attribute.channels, renumbered);
    }
    for (std::size_t p = 0; p < used.size(); ++p) {
        if (!used[p]) continue;
        result.points.push_back(mesh.points[p]);
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            detail::add_point(mesh.attributes[a], p, result.attributes[a]);
        }
    }
    result.cells = std::move(mesh.cells);
    for (auto& cell : result.cells) {
        for (auto& p : cell) p = renumbered[p];
    }
    for (const auto& [a, b] : mesh.creases) {
        if (used[a] && used[b]) result.creases.push_back({renumbered[a], renumbered[b]});
    }
    for (auto face : mesh.sharp_faces) {
        if (!std::ranges::all_of(face, [&](Index p) { return used[p]; })) continue;
        for (auto& p : face) p = renumbered[p];
        result.sharp_faces.push_back(face);
    }
    return result;
}

double cell_volume(const std::array<Vec3, 8>& c) {
    const double g = 0.5 / std::sqrt(3.0);
    double volume = 0;
    for (int point = 0; point < 8; ++point) {
        const double u = 0.5 + ((point & 1) ? g : -g), v = 0.5 + ((point & 2) ? g : -g), w = 0.5 + ((point & 4) ? g : -g);
        const auto mix = [](const Vec3& a, const Vec3& b, double t) { return (1 - t) * a + t * b; };
        const Vec3 du = mix(mix(c[1] - c[0], c[2] - c[3], v), mix(c[5] - c[4], c[6] - c[7], v), w);
        const Vec3 dv = mix(mix(c[3] - c[0], c[2] - c[1], u), mix(c[7] - c[4], c[6] - c[5], u), w);
        const Vec3 dw = mix(mix(c[4] - c[0], c[5] - c[1], u), mix(c[7] - c[3], c[6] - c[2], u), v);
        volume += glm::dot(du, glm::cross(dv, dw)) / 8;
    }
    return volume;
}

Box bounds(const HexMesh& mesh) {
    const auto used = detail::used_points(mesh);
    Box box;
    for (std::size_t p = 0; p < used.size(); ++p) {
        if (used[p]) box.add(mesh.points[p]);
    }
    return box;
}

HexMesh with_scalar_field(const HexMesh& mesh, std::string_view field) {
    return {mesh.points, mesh.cells, {scalar_field(mesh, field)}, mesh.creases, mesh.sharp_faces};
}

}  // namespace subvol
