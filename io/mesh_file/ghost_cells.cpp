// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <unordered_set>

#include "assemble.h"

namespace subvol::detail {

namespace {

constexpr unsigned kLeftOutCell = kDuplicateCell | kRefinedCell | kHiddenCell;

bool is_ghosts(const FileArray& array) {
    return array.name == kGhostArray && array.components == 1;
}

bool has_bit(double value, unsigned bits) {
    return value >= 1 && value < 256 && (static_cast<unsigned>(value) & bits) != 0;
}

// Removes the cells for which keeps(cells, place in the list) is false. Returns how many.
template <std::size_t N, class Keeps>
std::size_t filter(FileCells<N>& cells, const Keeps& keeps) {
    std::size_t kept = 0;
    for (std::size_t c = 0; c < cells.corners.size(); ++c) {
        if (!keeps(cells, c)) continue;
        cells.corners[kept] = cells.corners[c];
        if (!cells.numbers.empty()) cells.numbers[kept] = cells.numbers[c];
        ++kept;
    }
    const std::size_t dropped = cells.corners.size() - kept;
    cells.corners.resize(kept);
    if (!cells.numbers.empty()) cells.numbers.resize(kept);
    return dropped;
}

template <class Keeps>
std::size_t filter_all(MeshFile& found, const Keeps& keeps) {
    std::size_t dropped = 0;
    each_kind(found, [&](auto& cells) { dropped += filter(cells, keeps); });
    filter(found.quads, keeps);
    filter(found.lines, keeps);
    return dropped;
}

void drop_by_cells(MeshFile& found, const std::vector<double>& ghosts) {
    const std::size_t dropped = filter_all(found, [&](const auto& cells, std::size_t c) {
        return cells.numbers.empty() || !leaves_out_cell(ghosts[cells.numbers[c]]);
    });
    if (dropped > 0) found.warnings.push_back(ghosts_left_out(dropped));
}

void drop_by_points(MeshFile& found, const std::vector<double>& ghosts) {
    const std::size_t dropped = filter_all(found, [&](const auto& cells, std::size_t c) {
        const auto& corners = cells.corners[c];
        return std::none_of(corners.begin(), corners.end(), [&](Index p) { return hides_point(ghosts[p]); });
    });
    if (dropped > 0) found.warnings.push_back(counted(dropped, "cell", "cells") + " with hidden points left out");
}

// Leaves out the nodes of the curved hexahedra that are no longer there.
void drop_curved(MeshFile& found) {
    if (found.curved.size() == 0) return;
    std::unordered_set<Index> left(found.hexes.numbers.begin(), found.hexes.numbers.end());
    CurvedHexes kept;
    for (std::size_t k = 0; k < found.curved.size(); ++k) {
        const auto& [numbers, orders, ends, nodes] = found.curved;
        if (left.contains(numbers[k])) kept.add(numbers[k], orders[k], found.curved.nodes_of(k));
    }
    found.curved = std::move(kept);
}

}  // namespace

bool leaves_out_cell(double ghost) {
    return has_bit(ghost, kLeftOutCell);
}

bool hides_point(double ghost) {
    return has_bit(ghost, kHiddenPoint);
}

std::string ghosts_left_out(std::size_t count) {
    return counted(count, "ghost cell (duplicate or hidden)", "ghost cells (duplicate or hidden)") + " left out";
}

void take_ghost_levels(MeshFile& found) {
    const auto is_levels = [](const FileArray& array) { return array.name == "vtkGhostLevels" && array.components == 1; };
    const bool has_new_one = std::ranges::any_of(found.arrays, [](const FileArray& a) { return is_ghosts(a) && a.at_cells; });
    for (FileArray& array : found.arrays) {
        if (!is_levels(array) || !array.at_cells || has_new_one) continue;
        for (double& level : array.values) level = level > 0 ? kDuplicateCell : 0;
        array.name = std::string(kGhostArray);
    }
    std::erase_if(found.arrays, is_levels);
}

void drop_ghosts(MeshFile& found) {
    for (const FileArray& array : found.arrays) {
        if (is_ghosts(array)) array.at_cells ? drop_by_cells(found, array.values) : drop_by_points(found, array.values);
    }
    std::erase_if(found.arrays, is_ghosts);
    drop_curved(found);
}

}  // namespace subvol::detail
