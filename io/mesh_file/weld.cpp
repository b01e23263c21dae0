// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "assemble.h"
#include "subvol/detail/point_welder.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

template <class Call>
void for_each_cell(MeshFile& found, const Call& call) {
    each_kind(found, [&](auto& cells) { std::ranges::for_each(cells.corners, call); });
}

/// The arrays at points that have gaps, while points are welded. A point that has no value gets that of one that is welded to
/// it. If cells that lacked an array then seem to have it, as those between two layers that do, it is left out.
class GapsOfWelded {
public:
    explicit GapsOfWelded(MeshFile& found) : found_(found) {
        for (const FileArray& array : found.arrays) {
            const bool gaps = !array.at_cells && std::ranges::any_of(array.values, [](double v) { return !std::isfinite(v); });
            if (gaps) whole_before_[array.name] = whole_cells(array);
        }
    }

    /// After the cells have the points that are left. joined: for each point the one that it became, or kNone
    void fill(std::span<const Index> joined) {
        std::erase_if(found_.arrays, [&](FileArray& array) {
            const auto before = whole_before_.find(array.name);
            if (array.at_cells || before == whole_before_.end()) return false;
            const auto components = static_cast<std::size_t>(array.components);
            for (std::size_t p = 0; p < joined.size(); ++p) {
                const std::size_t q = joined[p];
                if (q == kNone || q == p || is_there(array, q) || !is_there(array, p)) continue;
                std::copy_n(&array.values[p * components], components, &array.values[q * components]);
            }
            const std::vector<std::uint8_t> after = whole_cells(array);
            if (std::ranges::equal(after, before->second, std::ranges::less_equal())) return false;
            found_.ignore(
                {"array", array.name, 1, "cells without it lie between those that have it, and their points are welded"});
            return true;
        });
    }

private:
    [[nodiscard]] static bool is_there(const FileArray& array, std::size_t p) {
        const auto components = static_cast<std::size_t>(array.components);
        return std::ranges::all_of(std::span(array.values).subspan(p * components, components),
                                   [](double value) { return std::isfinite(value); });
    }

    /// A flag for each cell: all of its corners have a value.
    [[nodiscard]] std::vector<std::uint8_t> whole_cells(const FileArray& array) const {
        std::vector<std::uint8_t> whole;
        for_each_cell(found_, [&](const auto& cell) {
            whole.push_back(std::ranges::all_of(cell, [&](Index p) { return is_there(array, p); }) ? 1 : 0);
        });
        return whole;
    }

    MeshFile& found_;
    std::map<std::string, std::vector<std::uint8_t>> whole_before_;
};

}  // namespace

void weld_points(MeshFile& found, double tolerance, std::string_view file, const EntityNames& names) {
    std::vector<Index> joined(found.points.size(), kNone);
    for_each_cell(found, [&](const auto& cell) {
        for (const Index p : cell) joined[p] = p;
    });
    for (const Index p : found.curved.nodes) joined[p] = p;
    GapsOfWelded gaps(found);
    PointWelder welder(found.points, tolerance);
    std::size_t welded = 0;
    for (Index p = 0; p < joined.size(); ++p) {
        if (joined[p] == kNone) continue;
        joined[p] = welder.join(p);
        welded += joined[p] != p;
    }
    for_each_cell(found, [&](auto& cell) {
        for (std::size_t k = 0; k < cell.size(); ++k) {
            for (std::size_t j = 0; j < k; ++j) {
                if (tolerance == 0 || cell[j] != joined[cell[k]]) continue;
                throw Error(ErrorCode::InvalidInput,
                            "a cell has " + names.point(cell[j]) + " and " + names.point(cell[k]) + ", which would be welded",
                            std::string(file), "a smaller tolerance, or no welding");
            }
            cell[k] = joined[cell[k]];
        }
    });
    gaps.fill(joined);
    for (Index& p : found.curved.nodes) p = joined[p];
    // The points of shells come last, so that the cells have the points that they have without shells.
    const auto join_shell = [&](auto& corners) {
        for (Index& p : corners) {
            if (joined[p] == kNone) {
                joined[p] = welder.join(p);
                welded += joined[p] != p;
            }
            p = joined[p];
        }
    };
    std::ranges::for_each(found.quads.corners, join_shell);
    std::ranges::for_each(found.lines.corners, join_shell);
    const auto join_tag = [&](auto& tag) {
        for (Index& p : tag) p = joined[p] == kNone ? p : joined[p];
    };
    std::ranges::for_each(found.sharp.faces, join_tag);
    std::ranges::for_each(found.sharp.edges, join_tag);
    for (FilePatch& patch : found.patches) join_tag(patch.corners);
    for (FileSet& set : found.node_sets) join_tag(set.numbers);
    found.warnings.push_back(counted(welded, "point", "points") + " welded to others " +
                             (tolerance > 0 ? "nearby" : "at the same place") + "; the values of the first point are kept");
}

void say_points_of_their_own(MeshFile& found) {
    std::size_t cells = 0;
    each_kind(found, [&](const auto& of_kind) { cells += of_kind.corners.size(); });
    // Meshes of more than a few cells have about as many points as hexahedra, and fewer than other cells.
    constexpr std::size_t kMostOfPatch = 64, kFewCells = 8;
    if (cells < kFewCells || 3 * cells > 2 * found.points.size()) return;
    // Groups of cells that share points, by the least point of each.
    std::vector<Index> group(found.points.size());
    std::iota(group.begin(), group.end(), Index{0});
    const auto root = [&](Index p) {
        while (group[p] != p) p = group[p] = group[group[p]];
        return p;
    };
    each_kind(found, [&](const auto& of_kind) {
        for (const auto& cell : of_kind.corners) {
            for (const Index p : cell) {
                const Index a = root(cell[0]), b = root(p);
                group[std::max(a, b)] = std::min(a, b);
            }
        }
    });
    const std::vector<std::uint8_t> used = used_points(found);
    std::size_t groups = 0, points = 0, joined = 0;
    PointWelder welder(found.points, 0);
    for (std::size_t p = 0; p < found.points.size(); ++p) {
        if (!used[p]) continue;
        ++points;
        groups += group[p] == p;
    }
    if (groups < 2 || cells > kMostOfPatch * groups) return;
    for (std::size_t p = 0; p < found.points.size(); ++p) {
        if (used[p]) joined += welder.join(static_cast<Index>(p)) != p;
    }
    if (4 * joined < points) return;
    found.warnings.push_back(counted(groups, "group", "groups") + " of cells share no points, though " +
                             std::to_string(joined) + " of " + std::to_string(points) +
                             " points lie at the places of others: --weld joins these");
}

}  // namespace subvol::detail
