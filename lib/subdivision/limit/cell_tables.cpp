// SPDX-License-Identifier: Apache-2.0
// The cells of a class, side by side in the lanes of vectors. LaneValues stores one channel
// after the other; in a channel the values of point p of the neighbourhood stand together for all sixteen cells:
//
//     channel 0                                             channel 1 …
//     point 0                point 1                point 2
//     [cell 0 … cell 15]     [cell 0 … cell 15]     …
//
// so one weight of the table is multiplied with the values of sixteen cells, and the table is read once for all of them.
// `store` takes a lane apart again. The rows are along the axes of the walk; the cell's own axes may be permuted and reversed,
// which is a permutation of the grid's strides and, for a reversed axis, a start at its other end.
#include "subvol/detail/cell_tables.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>

#include "subvol/cell.h"

namespace subvol::detail {

void CellGrid::resize(const HexMesh& mesh, std::size_t nodes) {
    points.resize(nodes);
    values.resize(mesh.attributes.size());
    for (std::size_t a = 0; a < values.size(); ++a) {
        values[a].resize(nodes * static_cast<std::size_t>(mesh.attributes[a].channels));
    }
}

void CellGrid::take(const HexMesh& mesh, std::size_t node, Index point) {
    points[node] = mesh.points[point];
    for (std::size_t a = 0; a < values.size(); ++a) {
        const auto channels = static_cast<std::size_t>(mesh.attributes[a].channels);
        std::copy_n(mesh.attributes[a].values.begin() + static_cast<std::ptrdiff_t>(point * channels), channels,
                    values[a].begin() + static_cast<std::ptrdiff_t>(node * channels));
    }
}

void CellGrid::take_child(const CellGrid& part, std::size_t child, std::size_t half) {
    // Neighbouring children share a plane of nodes. Each node is written by one child only, so children can be taken by several
    // threads.
    const std::size_t side = 2 * half + 1;
    const auto& at = kCornerParameters[child];
    std::array<std::size_t, 3> ends, start;
    for (std::size_t d = 0; d < 3; ++d) {
        // An upper child has one plane more, the cell's own upper side.
        ends[d] = half + (at[d] == 1 ? 1 : 0);
        start[d] = at[d] == 1 ? half : 0;
    }
    for (std::size_t w = 0; w < ends[2]; ++w) {
        for (std::size_t v = 0; v < ends[1]; ++v) {
            const std::size_t from = (half + 1) * (v + (half + 1) * w);
            const std::size_t to = start[0] + side * (v + start[1] + side * (w + start[2]));
            std::copy_n(part.points.begin() + static_cast<std::ptrdiff_t>(from), ends[0],
                        points.begin() + static_cast<std::ptrdiff_t>(to));
            for (std::size_t a = 0; a < part.values.size(); ++a) {
                const std::size_t channels = part.values[a].size() / part.points.size();
                std::copy_n(part.values[a].begin() + static_cast<std::ptrdiff_t>(from * channels), ends[0] * channels,
                            values[a].begin() + static_cast<std::ptrdiff_t>(to * channels));
            }
        }
    }
}

DenseCell CellGrid::dense_cell(Index cell, int levels) const {
    DenseCell dense{.cell = cell, .side = (std::size_t{1} << levels) + 1, .points = points, .values = {}};
    dense.values.assign(values.begin(), values.end());
    return dense;
}

namespace {

/// How many cells of a class make a table pay, by its level: it costs as much as the refinement of so many.
std::size_t least_members(int levels) {
    return std::size_t{32} << std::max(0, levels - 2);
}

}  // namespace

Classified classify(RefinedLevel& level, std::span<const Index> cells, int levels, int layers, const ClassKey& regular,
                    int whole) {
    constexpr std::size_t kRun = 256;  // cells that share memory for the points of their neighbourhoods
    Classified result{.members = std::vector<Member>(cells.size()),
                      .points = std::vector<std::vector<Index>>((cells.size() + kRun - 1) / kRun)};
    auto& members = result.members;
    for (std::size_t i = 0; i < cells.size(); ++i) members[i] = {kNoClass, cells[i]};
    if (levels == 0) return result;
    const std::size_t regular_points = layers == 2 ? 216 : 64;
    tbb::enumerable_thread_specific<Neighborhood> founds;
    tbb::parallel_for(std::size_t{0}, result.points.size(), [&](std::size_t r) {
        NeighborhoodWalk& walk = level.walks.local();
        Neighborhood& found = founds.local();
        std::vector<Index>& points = result.points[r];
        const std::size_t end = std::min(cells.size(), (r + 1) * kRun);
        for (std::size_t i = r * kRun; i < end; ++i) {
            const std::size_t before = points.size();
            if (before == 0) points.reserve((end - i) * regular_points);
            points.resize(before + regular_points);
            if (walk.find_regular(cells[i], std::span(points).subspan(before))) {
                members[i].key = regular;
            } else {
                points.resize(before);
                if (levels <= whole) continue;
                if (!walk.find(cells[i], layers, found)) continue;
                members[i].key = key_of(found);
                members[i].turn = found.turn;
                points.insert(points.end(), found.points.begin(), found.points.end());
            }
            members[i].point_count = static_cast<std::uint16_t>(points.size() - before);
        }
        // The addresses are known when the run is complete, because the vector may have moved until then.
        const Index* next = points.data();
        for (std::size_t i = r * kRun; i < end; ++i) {
            members[i].points = next;
            next += members[i].point_count;
        }
    });
    drop_rare(members, levels);
    return result;
}

void drop_rare(std::vector<Member>& members, int levels) {
    // A member's class is as large as the range of equal keys in the sorted list.
    std::vector<ClassKey> keys(members.size());
    std::ranges::transform(members, keys.begin(), &Member::key);
    tbb::parallel_sort(keys.begin(), keys.end());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, members.size(), 256), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            const auto [first, last] = std::equal_range(keys.begin(), keys.end(), members[i].key);
            if (static_cast<std::size_t>(last - first) < least_members(levels)) members[i].key = kNoClass;
        }
    });
}

void LaneValues::load(const HexMesh& mesh, std::span<const Member> cells, const WeightTable& table) {
    const std::size_t points = cells[0].point_count;
    channels_ = 3;
    for (const Attribute& attribute : mesh.attributes) channels_ += static_cast<std::size_t>(attribute.channels);
    stride_ = points * kTableLanes;
    if (cells.size() < kTableLanes) in_.clear();  // nothing but zeros in the lanes that have no cell
    in_.resize(channels_ * stride_, 0.0);
    for (std::size_t lane = 0; lane < cells.size(); ++lane) {
        for (const std::size_t p : table.used) {
            const Index point = cells[lane].points[p];
            double* to = &in_[p * kTableLanes + lane];
            for (int d = 0; d < 3; ++d, to += stride_) *to = mesh.points[point][d];
            for (const Attribute& attribute : mesh.attributes) {
                const auto count = static_cast<std::size_t>(attribute.channels);
                for (std::size_t c = 0; c < count; ++c, to += stride_) *to = attribute.values[point * count + c];
            }
        }
    }
}

void LaneValues::apply(const WeightTable& table) {
    rows_ = table.rows();
    out_.resize(channels_ * rows_ * kTableLanes);
    for (std::size_t c = 0; c < channels_; ++c) apply_table(table, &in_[c * stride_], &out_[c * rows_ * kTableLanes]);
}

void LaneValues::store(std::size_t lane, std::size_t side, std::uint8_t turn, CellGrid& grid) const {
    const auto& sides = cell_turns()[turn].sides;
    std::array<std::ptrdiff_t, 3> strides;  // of the cell's grid, along the axes of the rows
    std::ptrdiff_t first = 0;
    for (std::size_t a = 0; a < 3; ++a) {
        const auto axis = sides[2 * a] / 2;
        const auto stride = static_cast<std::ptrdiff_t>(axis == 0 ? 1 : axis == 1 ? side : side * side);
        const bool reversed = (sides[2 * a] & 1) != 0;
        strides[a] = reversed ? -stride : stride;
        if (reversed) first += stride * static_cast<std::ptrdiff_t>(side - 1);
    }
    const std::size_t from_stride = rows_ * kTableLanes;
    const double* row = &out_[lane];
    // Rows are read in their order and written along the turned axes.
    for (std::size_t w = 0; w < side; ++w) {
        for (std::size_t v = 0; v < side; ++v) {
            std::ptrdiff_t node =
                first + static_cast<std::ptrdiff_t>(v) * strides[1] + static_cast<std::ptrdiff_t>(w) * strides[2];
            for (std::size_t u = 0; u < side; ++u, node += strides[0], row += kTableLanes) {
                grid.points[static_cast<std::size_t>(node)] = {row[0], row[from_stride], row[2 * from_stride]};
                const double* channel = row + 3 * from_stride;
                for (auto& values : grid.values) {
                    const std::size_t count = values.size() / rows_;
                    double* to = &values[static_cast<std::size_t>(node) * count];
                    for (std::size_t c = 0; c < count; ++c, channel += from_stride) to[c] = *channel;
                }
            }
        }
    }
}

}  // namespace subvol::detail
