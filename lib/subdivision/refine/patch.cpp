// SPDX-License-Identifier: Apache-2.0
// A patch is a part of a mesh that is refined with the same bits as the whole mesh. The rule of a new point uses no cell beyond
// those that share a point with its cell, face or edge, so two layers around the wanted cells W are enough for any number of
// levels: the children of the first layer are right too, and they are the two layers of the next patch.
//
//    │ 2  │ 1  │ W  │ W  │ 1  │ 2  │     a patch with its layers, along one axis
//         │2│1 │W│W │W│W │1│2 │          its child: the children of W and of layer 1
//
// Layer 2 is only looked at: its children would lack their own surroundings. A patch that is refined once more needs one layer,
// one that is not refined needs none. Creases and sharp faces are kept where they lie on the patch's cells.
#include "subvol/detail/patch.h"

#include <algorithm>
#include <atomic>
#include <cassert>

#include "subvol/detail/child_topology.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/scheme_rows.h"
#include "subvol/detail/topology_parts.h"

namespace subvol::detail {

namespace {

template <std::size_t N>
std::array<Index, N> sorted(std::array<Index, N> points) {
    std::sort(points.begin(), points.end());
    return points;
}

/// The tags that lie on the cells. tags: sorted, each with its points sorted; parts: the edges or the sides of a cell
template <std::size_t N, std::size_t M>
std::vector<std::array<Index, N>> tags_of(const std::vector<std::array<Index, N>>& tags,
                                          std::span<const std::array<Index, 8>> cells,
                                          const std::array<std::array<std::size_t, N>, M>& parts) {
    std::vector<std::array<Index, N>> found;
    if (tags.empty()) return found;
    for (const auto& cell : cells) {
        for (const auto& part : parts) {
            std::array<Index, N> points;
            for (std::size_t i = 0; i < N; ++i) points[i] = cell[part[i]];
            if (std::binary_search(tags.begin(), tags.end(), sorted(points))) found.push_back(points);
        }
    }
    if constexpr (N == 2) {
        for (auto& points : found) points = sorted(points);
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
    }
    return found;
}

template <std::size_t N>
std::vector<std::array<Index, N>> sorted_tags(std::vector<std::array<Index, N>> tags) {
    for (auto& points : tags) points = sorted(points);
    std::sort(tags.begin(), tags.end());
    return tags;
}

/// Some points of a mesh, in its order.
class PointSelection {
public:
    /// The points of some cells of a mesh of `point_count` points.
    PointSelection(std::span<const std::array<Index, 8>> cells, std::size_t point_count) {
        if (point_count > 64 * cells.size()) {
            sort_points(cells);
        } else {
            mark_points(cells, point_count);
        }
    }

    [[nodiscard]] std::span<const Index> points() const { return points_; }

    template <std::size_t N>
    void renumber(std::vector<std::array<Index, N>>& lists) const {
        for (auto& list : lists) {
            for (Index& p : list) p = number_of(p);
        }
    }

    /// Copies positions and attributes of the selected points.
    void copy_data(const HexMesh& from, HexMesh& to) const {
        to.points.reserve(points_.size());
        for (const Index p : points_) to.points.push_back(from.points[p]);
        for (const auto& attribute : from.attributes) {
            const auto channels = static_cast<std::size_t>(attribute.channels);
            auto& values = to.attributes.emplace_back(Attribute{attribute.name, attribute.channels, {}}).values;
            values.reserve(points_.size() * channels);
            for (const Index p : points_) {
                const auto first = attribute.values.data() + p * channels;
                values.insert(values.end(), first, first + channels);
            }
        }
    }

private:
    /// For a few cells of a large mesh.
    void sort_points(std::span<const std::array<Index, 8>> cells) {
        points_.reserve(8 * cells.size());
        for (const auto& cell : cells) points_.insert(points_.end(), cell.begin(), cell.end());
        std::sort(points_.begin(), points_.end());
        points_.erase(std::unique(points_.begin(), points_.end()), points_.end());
    }

    /// For most of the mesh.
    void mark_points(std::span<const std::array<Index, 8>> cells, std::size_t point_count) {
        numbers_.assign(point_count, 0);
        for (const auto& cell : cells) {
            for (const Index p : cell) numbers_[p] = 1;
        }
        for (std::size_t p = 0; p < point_count; ++p) {
            if (numbers_[p] == 0) continue;
            numbers_[p] = static_cast<Index>(points_.size());
            points_.push_back(static_cast<Index>(p));
        }
    }

    [[nodiscard]] Index number_of(Index point) const {
        if (!numbers_.empty()) return numbers_[point];
        return static_cast<Index>(std::lower_bound(points_.begin(), points_.end(), point) - points_.begin());
    }

    std::vector<Index> points_;
    std::vector<Index> numbers_;  // in `points_`; empty if they are looked up
};

/// Orders cells by layers about the first `wanted` of them and drops those beyond the last layer.
Patch arrange(std::vector<std::array<Index, 8>>&& cells, std::size_t point_count, std::size_t wanted, int layers) {
    std::vector<std::uint8_t> near(point_count, 0);
    const auto mark = [&](const auto& cell) {
        for (const Index p : cell) near[p] = 1;
    };
    for (std::size_t c = 0; c < wanted; ++c) mark(cells[c]);
    Patch patch{.mesh = {}, .wanted = wanted, .first_layer = wanted};
    auto begin = cells.begin() + static_cast<std::ptrdiff_t>(wanted);
    for (int layer = 1; layer <= layers; ++layer) {
        const auto touches = [&](const auto& cell) {
            return std::any_of(cell.begin(), cell.end(), [&](Index p) { return near[p]; });
        };
        const auto end = std::stable_partition(begin, cells.end(), touches);
        std::for_each(begin, end, mark);
        begin = end;
        if (layer == 1) patch.first_layer = static_cast<std::size_t>(end - cells.begin());
    }
    cells.erase(begin, cells.end());
    patch.mesh.cells = std::move(cells);
    return patch;
}

/// Positions and attributes of some child points.
void refine_data(const HexMesh& parent, const SchemeRows& rows, std::span<const Index> points, HexMesh& child) {
    child.points.resize(points.size());
    for (const auto& attribute : parent.attributes) {
        const auto channels = static_cast<std::size_t>(attribute.channels);
        child.attributes.push_back({attribute.name, attribute.channels, std::vector<double>(points.size() * channels)});
    }
    constexpr std::size_t kRows = 512;
    const RowInput input(rows, parent);
    tbb::parallel_for(std::size_t{0}, (points.size() + kRows - 1) / kRows, [&](std::size_t b) {
        const std::size_t begin = b * kRows, end = std::min(points.size(), begin + kRows);
        StencilBuilder row;
        StencilBlockWriter block;
        block.start(begin);
        for (std::size_t i = begin; i < end; ++i) {
            row.clear();
            points[i] < rows.kept() ? row.add(points[i], 1) : rows.write_row(points[i], row);
            block.push(row.finish());
        }
        apply_block(block.block(), input.points(), 3, &child.points[begin].x);
        for (std::size_t a = 0; a < parent.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(parent.attributes[a].channels);
            apply_block(block.block(), input.values(a), channels, child.attributes[a].values.data() + begin * channels);
        }
    });
}

}  // namespace

PatchSource::PatchSource(const HexMesh& mesh, Faces faces)
    : mesh_(mesh), creases_(sorted_tags(mesh.creases)), sharp_faces_(sorted_tags(mesh.sharp_faces)) {
    if (faces == Faces::Check) {
        Topology checked;
        checked.point_count = mesh.points.size();
        checked.cells = mesh.cells;
        build_faces(checked);
    }
    offsets_.assign(mesh.points.size() + 1, 0);
    parallel_each(mesh.cells.size(), [&](std::size_t c) {
        for (const Index p : mesh.cells[c]) std::atomic_ref(offsets_[p + 1]).fetch_add(1, std::memory_order_relaxed);
    });
    for (std::size_t p = 0; p < mesh.points.size(); ++p) offsets_[p + 1] += offsets_[p];
    cells_.resize(offsets_.back());
    auto next = offsets_;
    parallel_each(mesh.cells.size(), [&](std::size_t c) {
        for (const Index p : mesh.cells[c]) {
            cells_[std::atomic_ref(next[p]).fetch_add(1, std::memory_order_relaxed)] = static_cast<Index>(c);
        }
    });
    // The threads have entered the cells in any order.
    parallel_each(mesh.points.size(),
                  [&](std::size_t p) { std::sort(cells_.data() + offsets_[p], cells_.data() + offsets_[p + 1]); });
}

PatchSource::PatchSource(const HexMesh& mesh, std::span<const Index> cells)
    : mesh_(mesh), creases_(sorted_tags(mesh.creases)), sharp_faces_(sorted_tags(mesh.sharp_faces)) {
    std::vector<std::pair<Index, Index>> corners;  // point and cell
    corners.reserve(8 * cells.size());
    for (const Index c : cells) {
        for (const Index p : mesh.cells[c]) corners.emplace_back(p, c);
    }
    std::sort(corners.begin(), corners.end());
    for (const auto& [point, cell] : corners) {
        if (points_.empty() || points_.back() != point) {
            points_.push_back(point);
            offsets_.push_back(cells_.size());
        }
        cells_.push_back(cell);
    }
    offsets_.push_back(cells_.size());
}

std::span<const Index> PatchSource::cells_at(Index point) const {
    std::size_t i = point;
    if (!points_.empty()) {
        const auto found = std::lower_bound(points_.begin(), points_.end(), point);
        assert(found != points_.end() && *found == point);
        i = static_cast<std::size_t>(found - points_.begin());
    }
    return std::span(cells_).subspan(offsets_[i], offsets_[i + 1] - offsets_[i]);
}

std::vector<Index> PatchSource::cells_about(std::span<const Index> cells) const {
    // Each point once, since very many cells may share an axis.
    std::vector<std::array<Index, 8>> corners;
    for (const Index c : cells) corners.push_back(mesh_.cells[c]);
    const PointSelection selection(corners, mesh_.points.size());
    std::vector<Index> found;
    const auto for_each_found = [&](const auto& take) {
        for (const Index p : selection.points()) {
            for (const Index c : cells_at(p)) take(c);
        }
    };
    if (mesh_.cells.size() > 64 * cells.size()) {  // a few cells of a large mesh
        for_each_found([&](Index c) { found.push_back(c); });
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
        return found;
    }
    std::vector<std::uint8_t> marks(mesh_.cells.size(), 0);
    for_each_found([&](Index c) { marks[c] = 1; });
    for (Index c = 0; c < marks.size(); ++c) {
        if (marks[c] != 0) found.push_back(c);
    }
    return found;
}

Patch PatchSource::cut(std::span<const Index> cells, int layers) const {
    std::vector<Index> chosen(cells.begin(), cells.end());
    std::vector<Index> known(chosen);  // sorted
    std::sort(known.begin(), known.end());
    Patch patch{.mesh = {}, .wanted = cells.size(), .first_layer = cells.size()};
    std::size_t begin = 0;
    for (int layer = 1; layer <= layers; ++layer) {
        const std::vector<Index> next = cells_about(std::span(chosen).subspan(begin));
        begin = chosen.size();
        std::set_difference(next.begin(), next.end(), known.begin(), known.end(), std::back_inserter(chosen));
        known.assign(chosen.begin(), chosen.end());
        std::sort(known.begin(), known.end());
        if (layer == 1) patch.first_layer = chosen.size();
    }
    patch.mesh.cells.reserve(chosen.size());
    for (const Index c : chosen) patch.mesh.cells.push_back(mesh_.cells[c]);
    patch.mesh.creases = tags_of(creases_, patch.mesh.cells, kCellEdges);
    patch.mesh.sharp_faces = tags_of(sharp_faces_, patch.mesh.cells, kCellFaces);
    const PointSelection selection(patch.mesh.cells, mesh_.points.size());
    selection.copy_data(mesh_, patch.mesh);
    selection.renumber(patch.mesh.cells);
    selection.renumber(patch.mesh.creases);
    selection.renumber(patch.mesh.sharp_faces);
    return patch;
}

Patch refine_patch(const Patch& patch, const SchemeOptions& scheme, int layers) {
    return refine_patch(patch, build_topology(patch.mesh, InteriorCreases::Ignore), scheme, layers);
}

HexMesh refine_cells(const Patch& patch, const Topology& topology, const SchemeOptions& scheme, std::span<const Index> cells) {
    const SchemeRows rows(topology, scheme, SchemeRows::Columns::WithSums);
    HexMesh child;
    child.cells.reserve(8 * cells.size());
    for (const Index c : cells) {
        const auto children = split_lattice(lattice_points(topology, c));
        child.cells.insert(child.cells.end(), children.begin(), children.end());
    }
    const PointSelection selection(child.cells, rows.rows());
    refine_data(patch.mesh, rows, selection.points(), child);
    selection.renumber(child.cells);
    return child;
}

Patch refine_patch(const Patch& patch, const Topology& topology, const SchemeOptions& scheme, int layers) {
    const SchemeRows rows(topology, scheme, SchemeRows::Columns::WithSums);
    const std::size_t parents = layers == 0 ? patch.wanted : patch.first_layer;
    std::vector<std::array<Index, 8>> cells;
    cells.reserve(8 * parents);
    for (std::size_t c = 0; c < parents; ++c) {
        const auto children = split_lattice(lattice_points(topology, static_cast<Index>(c)));
        cells.insert(cells.end(), children.begin(), children.end());
    }
    Patch child = arrange(std::move(cells), rows.rows(), 8 * patch.wanted, layers);
    child.mesh.creases = tags_of(sorted_tags(child_creases(topology)), child.mesh.cells, kCellEdges);
    child.mesh.sharp_faces = tags_of(sorted_tags(child_sharp_faces(topology)), child.mesh.cells, kCellFaces);
    const PointSelection selection(child.mesh.cells, rows.rows());
    refine_data(patch.mesh, rows, selection.points(), child.mesh);
    selection.renumber(child.mesh.cells);
    selection.renumber(child.mesh.creases);
    selection.renumber(child.mesh.sharp_faces);
    return child;
}

Patch refine_patch(const PatchSource& source, std::span<const Index> cells, const SchemeOptions& scheme, int levels,
                   int layers) {
    Patch patch = source.cut(cells, std::min(levels + layers, 2));
    for (int level = 1; level <= levels; ++level) patch = refine_patch(patch, scheme, std::min(levels - level + layers, 2));
    return patch;
}

Patch sub_patch(const Patch& patch, std::span<const Index> wanted, int layers) {
    std::vector<std::array<Index, 8>> cells;
    std::vector<std::uint8_t> taken(patch.mesh.cells.size(), 0);
    for (const Index c : wanted) {
        cells.push_back(patch.mesh.cells[c]);
        taken[c] = 1;
    }
    for (std::size_t c = 0; c < taken.size(); ++c) {
        if (!taken[c]) cells.push_back(patch.mesh.cells[c]);
    }
    Patch part = arrange(std::move(cells), patch.mesh.points.size(), wanted.size(), layers);
    part.mesh.creases = tags_of(sorted_tags(patch.mesh.creases), part.mesh.cells, kCellEdges);
    part.mesh.sharp_faces = tags_of(sorted_tags(patch.mesh.sharp_faces), part.mesh.cells, kCellFaces);
    const PointSelection selection(part.mesh.cells, patch.mesh.points.size());
    selection.copy_data(patch.mesh, part.mesh);
    selection.renumber(part.mesh.cells);
    selection.renumber(part.mesh.creases);
    selection.renumber(part.mesh.sharp_faces);
    return part;
}

}  // namespace subvol::detail
