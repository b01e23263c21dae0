// SPDX-License-Identifier: Apache-2.0
#include "subvol/sheets.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <string>

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
            throw Error(ErrorCode::InvalidInput, which + ": there is no point " + std::to_string(sorted.back()), "sheets",
                        "there are " + std::to_string(points) + " points, counted from 0");
        }
        const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
        if (twice == sorted.end()) continue;
        throw Error(ErrorCode::InvalidInput, which + " has point " + std::to_string(*twice) + " twice", "sheets",
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

Sheets make_sheets(const HexMesh& mesh, std::span<const std::array<Index, 4>> quads,
                   std::span<const std::array<Index, 2>> lines) {
    Sheets sheets;
    sheets.quads = each_once(quads);
    sheets.lines = each_once(lines);
    check_points(sheets.quads, mesh.points.size(), "quad");
    check_points(sheets.lines, mesh.points.size(), "line");
    std::vector<Index> number(mesh.points.size(), kNone);
    for (const auto& quad : sheets.quads) {
        for (const Index p : quad) number[p] = 0;
    }
    for (const auto& line : sheets.lines) {
        for (const Index p : line) number[p] = 0;
    }
    for (const Attribute& attribute : mesh.attributes) sheets.attributes.push_back({attribute.name, attribute.channels, {}});
    Index next = 0;
    for (std::size_t p = 0; p < number.size(); ++p) {
        if (number[p] == kNone) continue;
        number[p] = next++;
        sheets.points.push_back(mesh.points[p]);
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(mesh.attributes[a].channels);
            for (std::size_t c = 0; c < channels; ++c) {
                sheets.attributes[a].values.push_back(mesh.attributes[a].values[p * channels + c]);
            }
        }
    }
    for (auto& quad : sheets.quads) {
        for (Index& p : quad) p = number[p];
    }
    for (auto& line : sheets.lines) {
        for (Index& p : line) p = number[p];
    }
    sheets.solid.resize(next);
    for (std::size_t c = 0; c < mesh.cells.size() && next > 0; ++c) {
        for (std::uint8_t k = 0; k < 8; ++k) {
            const Index p = number[mesh.cells[c][k]];
            if (p != kNone && sheets.solid[p].cell == kNone) sheets.solid[p] = {static_cast<Index>(c), k};
        }
    }
    return sheets;
}

void validate(const Sheets& sheets, const HexMesh& mesh) {
    check_points(sheets.quads, sheets.points.size(), "quad");
    check_points(sheets.lines, sheets.points.size(), "line");
    for (std::size_t p = 0; p < sheets.points.size(); ++p) {
        if (!is_finite(sheets.points[p])) {
            throw Error(ErrorCode::InvalidInput, "point " + std::to_string(p) + " is not finite", "sheets");
        }
    }
    if (sheets.solid.size() != sheets.points.size()) {
        throw Error(
            ErrorCode::InvalidInput,
            std::to_string(sheets.solid.size()) + " corners of cells for " + std::to_string(sheets.points.size()) + " points",
            "sheets", "one for each point");
    }
    for (const auto& [cell, corner] : sheets.solid) {
        if (cell == kNone || (cell < mesh.cells.size() && corner < 8)) continue;
        throw Error(ErrorCode::InvalidInput,
                    "there is no corner " + std::to_string(corner) + " of cell " + std::to_string(cell), "sheets");
    }
    bool same = sheets.attributes.size() == mesh.attributes.size();
    for (std::size_t a = 0; same && a < mesh.attributes.size(); ++a) {
        const Attribute &own = sheets.attributes[a], &of_mesh = mesh.attributes[a];
        same = own.name == of_mesh.name && own.channels == of_mesh.channels &&
               own.values.size() == sheets.points.size() * static_cast<std::size_t>(own.channels) &&
               std::ranges::all_of(own.values, [](double value) { return std::isfinite(value); });
    }
    if (!same) {
        throw Error(ErrorCode::InvalidInput, "their attributes are not those of the mesh", "sheets",
                    "the same names in the same order, with finite values for each point");
    }
}

SheetReport inspect(const Sheets& sheets) {
    SheetReport report{.quads = sheets.quads.size(), .lines = sheets.lines.size(), .points = sheets.points.size()};
    const auto attached = [&](Index p) { return sheets.solid[p].cell != kNone; };
    for (Index p = 0; p < sheets.points.size(); ++p) report.attached += attached(p);
    std::map<std::array<Index, 2>, std::size_t> quads_at;
    for (const auto& quad : sheets.quads) {
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
