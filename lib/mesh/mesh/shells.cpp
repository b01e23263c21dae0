// SPDX-License-Identifier: Apache-2.0
#include "subvol/shells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <unordered_map>

#include "subvol/cell.h"
#include "subvol/error.h"

namespace subvol {

namespace {

/// Refuses points that do not exist, and points that occur twice.
template <std::size_t N>
void check_points(const std::vector<std::array<Index, N>>& items, std::size_t points, const std::string& kind) {
    for (std::size_t i = 0; i < items.size(); ++i) {
        auto sorted = items[i];
        std::sort(sorted.begin(), sorted.end());
        const std::string which = kind + " " + std::to_string(i);
        if (sorted.back() >= points) {
            throw Error(ErrorCode::InvalidInput, which + ": there is no point " + std::to_string(sorted.back()), "shells",
                        "there are " + std::to_string(points) + " points, counted from 0");
        }
        const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
        if (twice == sorted.end()) continue;
        throw Error(ErrorCode::InvalidInput, which + " has point " + std::to_string(*twice) + " twice", "shells",
                    std::to_string(N) + " different points");
    }
}

/// Keeps the first of those with the same points.
template <std::size_t N>
std::vector<std::array<Index, N>> each_once(std::span<const std::array<Index, N>> items) {
    std::vector<std::pair<std::array<Index, N>, std::size_t>> sorted;
    for (std::size_t i = 0; i < items.size(); ++i) {
        sorted.emplace_back(items[i], i);
        std::sort(sorted.back().first.begin(), sorted.back().first.end());
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint8_t> first(items.size(), 0);
    for (std::size_t i = 0; i < sorted.size(); ++i) {
        first[sorted[i].second] = i == 0 || sorted[i].first != sorted[i - 1].first;
    }
    std::vector<std::array<Index, N>> result;
    for (std::size_t i = 0; i < items.size(); ++i) {
        if (first[i]) result.push_back(items[i]);
    }
    return result;
}

bool is_finite(const Vec3& p) {
    return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
}

}  // namespace

Shells make_shells(const HexMesh& mesh, std::span<const std::array<Index, 4>> quads,
                   std::span<const std::array<Index, 2>> lines) {
    Shells shells;
    shells.quads = each_once(quads);
    shells.lines = each_once(lines);
    check_points(shells.quads, mesh.points.size(), "quad");
    check_points(shells.lines, mesh.points.size(), "line");
    std::vector<Index> number(mesh.points.size(), kNone);
    for (const auto& quad : shells.quads) {
        for (const Index p : quad) number[p] = 0;
    }
    for (const auto& line : shells.lines) {
        for (const Index p : line) number[p] = 0;
    }
    for (const Attribute& attribute : mesh.attributes) shells.attributes.push_back({attribute.name, attribute.channels, {}});
    Index next = 0;
    for (std::size_t p = 0; p < number.size(); ++p) {
        if (number[p] == kNone) continue;
        number[p] = next++;
        shells.points.push_back(mesh.points[p]);
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(mesh.attributes[a].channels);
            for (std::size_t c = 0; c < channels; ++c) {
                shells.attributes[a].values.push_back(mesh.attributes[a].values[p * channels + c]);
            }
        }
    }
    for (auto& quad : shells.quads) {
        for (Index& p : quad) p = number[p];
    }
    for (auto& line : shells.lines) {
        for (Index& p : line) p = number[p];
    }
    shells.solid.resize(next);
    for (Index c = 0; c < mesh.cells.size() && next > 0; ++c) {
        for (std::uint8_t k = 0; k < 8; ++k) {
            const Index p = number[mesh.cells[c][k]];
            if (p != kNone && shells.solid[p].cell == kNone) shells.solid[p] = {c, k};
        }
    }
    return shells;
}

Shells patch_shells(const HexMesh& mesh, std::span<const Patch> patches) {
    HexMesh points;
    for (const Attribute& attribute : mesh.attributes) points.attributes.push_back({attribute.name, attribute.channels, {}});
    points.attributes.push_back({"patch", 1, {}});
    std::vector<std::array<Index, 4>> quads;
    std::vector<CellCorner> corners;
    for (std::size_t k = 0; k < patches.size(); ++k) {
        std::unordered_map<Index, Index> numbers;  // of this patch's points
        for (const CellSide& side : patches[k].sides) {
            if (side.cell >= mesh.cells.size() || side.side >= kCellFaces.size())
                throw Error(ErrorCode::InvalidInput, "has a side that is not of the mesh", "patch \"" + patches[k].name + "\"");
            auto& quad = quads.emplace_back();
            for (std::size_t c = 0; c < quad.size(); ++c) {
                const Index p = mesh.cells[side.cell][kCellFaces[side.side][c]];
                const auto [at, is_new] = numbers.try_emplace(p, static_cast<Index>(points.points.size()));
                quad[c] = at->second;
                if (!is_new) continue;
                points.points.push_back(mesh.points[p]);
                corners.push_back({side.cell, static_cast<std::uint8_t>(kCellFaces[side.side][c])});
                for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
                    const auto channels = static_cast<std::size_t>(mesh.attributes[a].channels);
                    const auto of_point = std::span(mesh.attributes[a].values).subspan(p * channels, channels);
                    auto& values = points.attributes[a].values;
                    values.insert(values.end(), of_point.begin(), of_point.end());
                }
                points.attributes.back().values.push_back(static_cast<double>(k + 1));
            }
        }
    }
    Shells shells = make_shells(points, quads, {});
    shells.solid = std::move(corners);  // each point is of a quad, so that all are there in their order
    return shells;
}

void validate(const Shells& shells, const HexMesh& mesh) {
    check_points(shells.quads, shells.points.size(), "quad");
    check_points(shells.lines, shells.points.size(), "line");
    for (std::size_t p = 0; p < shells.points.size(); ++p) {
        if (!is_finite(shells.points[p])) {
            throw Error(ErrorCode::InvalidInput, "point " + std::to_string(p) + " is not finite", "shells");
        }
    }
    if (shells.solid.size() != shells.points.size()) {
        throw Error(
            ErrorCode::InvalidInput,
            std::to_string(shells.solid.size()) + " corners of cells for " + std::to_string(shells.points.size()) + " points",
            "shells", "one for each point");
    }
    for (const auto& [cell, corner] : shells.solid) {
        if (cell == kNone || (cell < mesh.cells.size() && corner < 8)) continue;
        throw Error(ErrorCode::InvalidInput,
                    "there is no corner " + std::to_string(corner) + " of cell " + std::to_string(cell), "shells");
    }
    bool same = shells.attributes.size() == mesh.attributes.size();
    for (std::size_t a = 0; same && a < mesh.attributes.size(); ++a) {
        const Attribute &own = shells.attributes[a], &of_mesh = mesh.attributes[a];
        same = own.name == of_mesh.name && own.channels == of_mesh.channels &&
               own.values.size() == shells.points.size() * static_cast<std::size_t>(own.channels) &&
               std::ranges::all_of(own.values, [](double value) { return std::isfinite(value); });
    }
    if (!same) {
        throw Error(ErrorCode::InvalidInput, "their attributes are not those of the mesh", "shells",
                    "the same names in the same order, with finite values for each point");
    }
}

ShellReport inspect(const Shells& shells) {
    ShellReport report{.quads = shells.quads.size(), .lines = shells.lines.size(), .points = shells.points.size()};
    const auto attached = [&](Index p) { return shells.solid[p].cell != kNone; };
    for (Index p = 0; p < shells.points.size(); ++p) report.attached += attached(p);
    std::map<std::array<Index, 2>, std::size_t> quads_at;
    for (const auto& quad : shells.quads) {
        for (std::size_t k = 0; k < 4; ++k) {
            const Index a = quad[k], b = quad[(k + 1) % 4];
            ++quads_at[{std::min(a, b), std::max(a, b)}];
        }
    }
    for (const auto& [edge, count] : quads_at) {
        report.free_edges += count == 1 && !(attached(edge[0]) && attached(edge[1]));
        report.nonmanifold_edges += count > 2;
    }
    return report;
}

}  // namespace subvol
