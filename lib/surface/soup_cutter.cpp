// SPDX-License-Identifier: Apache-2.0
#include "soup_cutter.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "grid_numbers.h"
#include "subvol/dense_cells.h"

namespace subvol::detail {

namespace {

/// One list of points for all cells: those that several cells have, once.
SurfaceSoup join(const std::vector<Index>& cells, const std::vector<CellTriangles>& parts, const std::vector<Index>& slots) {
    struct Named {
        VertexNumber a, b;
        std::uint64_t at;  // in the order of cells and their points
        auto operator<=>(const Named&) const = default;
    };
    std::vector<Named> named;
    std::vector<std::size_t> starts;
    for (const Index cell : cells) {
        starts.push_back(named.size());
        for (const SurfacePoint& point : parts[slots[cell]].points) named.push_back({point.a, point.b, named.size()});
    }
    std::vector<const SurfacePoint*> given;
    for (const Index cell : cells) {
        for (const SurfacePoint& point : parts[slots[cell]].points) given.push_back(&point);
    }
    tbb::parallel_sort(named.begin(), named.end());
    SurfaceSoup soup;
    soup.cells = cells;
    std::vector<Index> numbers(named.size());
    for (std::size_t i = 0; i < named.size(); ++i) {
        const bool again = i > 0 && named[i].a == named[i - 1].a && named[i].b == named[i - 1].b;
        if (!again) soup.points.push_back(*given[named[i].at]);
        // A point of the hull has a face of it in some of its cells only.
        if (again && soup.points.back().side == 6 && given[named[i].at]->side != 6) soup.points.back() = *given[named[i].at];
        numbers[named[i].at] = static_cast<Index>(soup.points.size() - 1);
    }
    for (std::size_t c = 0; c < cells.size(); ++c) {
        const CellTriangles& part = parts[slots[cells[c]]];
        for (const auto& t : part.triangles) {
            soup.triangles.push_back({numbers[starts[c] + t[0]], numbers[starts[c] + t[1]], numbers[starts[c] + t[2]]});
        }
        soup.hull.insert(soup.hull.end(), part.hull.begin(), part.hull.end());
        soup.ends.push_back(soup.triangles.size());
    }
    return soup;
}

}  // namespace

std::vector<Index> SoupCutter::candidates(const Cut& cut) const {
    std::vector<std::uint8_t> wanted(mesh_.cells.size(), 0);
    if (cut.iso) {
        std::vector<Index> all;
        all.reserve(mesh_.cells.size());
        for (Index c = 0; c < mesh_.cells.size(); ++c) {
            if (may_cut(c)) all.push_back(c);
        }
        const DenseCells cells(mesh_, {.scheme = scheme_, .levels = 1, .progress = progress_}, true, DenseBits::ToRounding);
        cells.for_each(all, [&](const DenseCell& cell) {
            const auto [low, high] = std::ranges::minmax(cell.values[0]);
            // Between the vertices of level 1 values go beyond theirs by less than this part of their range.
            const double slack = 0.3 * (high - low);
            const bool crossed = low - slack < *cut.iso && high + slack >= *cut.iso;
            const bool on_hull = cut.hull && has_hull(cell.cell) && high + slack >= *cut.iso;
            wanted[cell.cell] = crossed || on_hull ? 1 : 0;
        });
    } else {
        for (Index c = 0; c < wanted.size(); ++c) wanted[c] = may_cut(c) && has_hull(c) ? 1 : 0;
    }
    std::vector<Index> found;
    for (Index c = 0; c < wanted.size(); ++c) {
        if (wanted[c] != 0) found.push_back(c);
    }
    return found;
}

bool SoupCutter::has_hull(Index cell) const {
    return std::ranges::any_of(topology_.cell_faces[cell], [&](Index f) { return topology_.face_on_hull(f); });
}

/// Cuts the cells, and neighbours into which the surface leads from them, until no more are found.
SurfaceSoup SoupCutter::cut(const Cut& cut, int level, std::vector<Index> todo, const SurfaceReach& reach) const {
    const GridNumbers numbers(topology_, level);
    // Cells that share a vertex must agree on which side of the isovalue it is. On the hull only its number counts.
    const DenseCells dense(mesh_, {.scheme = scheme_, .levels = level, .progress = progress_}, true,
                           cut.iso ? DenseBits::OfRefine : DenseBits::ToRounding);
    std::vector<Index> slots(mesh_.cells.size(), kNone);
    for (const Index cell : reach.not_into) slots[cell] = 0;  // as if it had been cut
    std::vector<CellTriangles> parts;
    std::vector<Index> cells;
    bool leads_out = false;
    while (!todo.empty()) {
        for (const Index cell : todo) {
            slots[cell] = static_cast<Index>(cells.size());
            cells.push_back(cell);
        }
        parts.resize(cells.size());
        dense.for_each(todo, [&](const DenseCell& cell) {
            const std::span<const double> values =
                !mesh_.attributes.empty() && cut.iso ? cell.values[0] : std::span<const double>();
            parts[slots[cell.cell]] = cut_cell(cell, values, cut, topology_, numbers);
        });
        if (!reach.follow) break;
        todo = reached(cells, parts, todo.size(), slots, level);
        const std::size_t before = todo.size();
        std::erase_if(todo, [&](Index cell) { return !may_cut(cell); });
        leads_out = leads_out || todo.size() < before;
    }
    std::erase_if(cells, [&](Index cell) { return parts[slots[cell]].triangles.empty(); });
    std::ranges::sort(cells);
    SurfaceSoup soup = join(cells, parts, slots);
    soup.leads_out = leads_out;
    return soup;
}

/// Cells that have not been cut, but share a face with a point on it.
std::vector<Index> SoupCutter::reached(const std::vector<Index>& cells, const std::vector<CellTriangles>& parts,
                                       std::size_t last, const std::vector<Index>& slots, int level) const {
    const auto end = static_cast<std::uint16_t>(1U << level);
    std::vector<Index> found;
    for (std::size_t i = cells.size() - last; i < cells.size(); ++i) {
        for (const SurfacePoint& point : parts[i].points) {
            if (point.a == point.b) continue;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                if (point.at[0][axis] != point.at[1][axis]) continue;
                if (point.at[0][axis] == 0) add_neighbors(cells[i], 2 * axis, slots, found);
                if (point.at[0][axis] == end) add_neighbors(cells[i], 2 * axis + 1, slots, found);
            }
        }
    }
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

void SoupCutter::add_neighbors(Index cell, std::size_t side, const std::vector<Index>& slots, std::vector<Index>& found) const {
    for (const Index other : topology_.face_cells[topology_.cell_faces[cell][side]]) {
        if (other != kNone && slots[other] == kNone) found.push_back(other);
    }
}

}  // namespace subvol::detail
