// SPDX-License-Identifier: Apache-2.0
#include "descent_batch.h"

#include <tbb/parallel_for.h>

#include <atomic>

#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "topology_parts.h"

namespace subvol::detail {

std::vector<double> rows_of(const HexMesh& mesh, std::size_t stride) {
    std::vector<double> rows(mesh.points.size() * stride);
    parallel_each(mesh.points.size(), [&](std::size_t p) { Channels::read(mesh, static_cast<Index>(p), &rows[p * stride]); });
    return rows;
}

bool load_control_cell(const DescentTask& task, const Topology& topology, std::span<const double> rows, Index cell,
                       CellJets& jets) {
    GridPoints grid;
    if (task.options.scheme.kind != Scheme::Linear && regular_grid(topology, cell, grid)) {
        jets.load_grid(rows.data(), grid);
        return true;
    }
    std::array<Index, 8> corners;
    for (std::size_t octant = 0; octant < 8; ++octant) corners[octant] = task.control.cells[cell][kCornerOctants[octant]];
    jets.load_corners(rows.data(), corners);
    return false;
}

DescentBatch::DescentBatch(const DescentTask& task, const Topology& topology, std::span<const double> control_rows,
                           ClassGraph& classes, DescentWorkers& workers)
    : task_(task), topology_(topology), control_rows_(control_rows), classes_(classes), workers_(workers) {
}

void DescentBatch::run(const PatchSource& source, std::span<const CellPlaces> cells) {
    std::vector<Index> numbers;
    for (const CellPlaces& in : cells) numbers.push_back(in.cell);
    const Patch first = refine_patch(source.cut(numbers, 2), task_.options.scheme, 2);
    const Topology first_topology = build_topology(first.mesh, InteriorCreases::Ignore);
    first_rows_ = rows_of(first.mesh, task_.channels.stride());
    const std::vector<Index> refined = find_parents(first, first_topology, cells);
    if (!refined.empty()) second_ = refine_cells(first, first_topology, task_.options.scheme, refined);
    second_rows_ = rows_of(second_, task_.channels.stride());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 4), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) run_cell(cells[i], i, workers_.local());
    });
}

/// The walks about the cells of level 1 that have places. Returns the cells that are to be refined for them, in the order of
/// slots_.
std::vector<Index> DescentBatch::find_parents(const Patch& first, const Topology& topology, std::span<const CellPlaces> cells) {
    parents_.resize(8 * cells.size());
    std::vector<std::uint8_t> wanted(first.first_layer, 0);
    // The second layer ends the patch: colours of one round see no further.
    const CellLinks links = build_links(first.mesh, topology, 1);
    tbb::enumerable_thread_specific<NeighborhoodWalk> walks([&] { return NeighborhoodWalk(first.mesh, links); });
    tbb::enumerable_thread_specific<Neighborhood> abouts;
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 16), [&](const auto& range) {
        NeighborhoodWalk& walk = walks.local();
        Neighborhood& about = abouts.local();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            unsigned has_places = 0;
            for (std::size_t n = cells[i].first; n < cells[i].last; ++n) {
                Vec3 uvw = task_.queries[task_.order[n]].uvw;
                has_places |= 1U << step_into_octant(uvw);
            }
            for (std::size_t octant = 0; octant < 8; ++octant) {
                if ((has_places >> octant & 1) == 0) continue;
                const std::size_t cell = 8 * i + kCornerOctants[octant];
                if (!walk.find(static_cast<Index>(cell), 1, about)) continue;
                const ClassEntry& entry = classes_.entry(about);
                parents_[cell] = {&entry, about.turn, about.points, {walk.visited().begin(), walk.visited().end()}};
                if (task_.is_spline() && entry.on_grid) continue;
                for (const auto& visited : walk.visited()) {
                    std::atomic_ref(wanted[visited.cell]).store(1, std::memory_order_relaxed);
                }
            }
        }
    });
    std::vector<Index> refined;
    slots_.assign(wanted.size(), kNone);
    for (std::size_t c = 0; c < wanted.size(); ++c) {
        if (wanted[c] == 0) continue;
        slots_[c] = static_cast<Index>(refined.size());
        refined.push_back(static_cast<Index>(c));
    }
    return refined;
}

/// The places of a control cell.
void DescentBatch::run_cell(const CellPlaces& in, std::size_t number, DescentWorker& with) const {
    const bool regular = load_control_cell(task_, topology_, control_rows_, in.cell, with.jets());
    const auto places = with.evaluate(with.open(in), kIdentityTurn, 0, regular);
    each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
        const Parent& parent = parents_[8 * number + kCornerOctants[octant]];
        if (parent.entry == nullptr) return with.leave(inside);
        if (parent.entry->on_grid) {
            GridPoints grid = parent.entry->grid;
            for (Index& p : grid) p = p == kNone ? kNone : parent.points[p];
            with.jets().load_grid(first_rows_.data(), grid);
        } else {
            with.jets().load_corners(first_rows_.data(), std::span(parent.points).first<8>());
        }
        inside = with.evaluate(inside, parent.turn, 1, parent.entry->on_grid);
        if (!inside.empty()) enter(parent, inside, with);
    });
}

/// From a cell of level 1 to the classes of its children.
void DescentBatch::enter(const Parent& parent, std::span<OpenPlace> places, DescentWorker& with) const {
    const std::size_t stride = task_.channels.stride();
    const double* gathered = with.values(1, parent.entry->points.size());
    double* next = with.values(1, 0);
    for (const auto& [number, of, corner] : parent.entry->points) {
        const auto& [from, from_turn] = parent.visited[number];
        const auto& octants = cell_turns()[from_turn].octants;
        const auto& corners = second_.cells[8 * slots_[from] + kCornerOctants[octants[of]]];
        next = copy_row(&second_rows_[corners[kCornerOctants[octants[corner]]] * stride], stride, next);
    }
    each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
        const ClassEntry::Child& child = parent.entry->children[walk_octant(parent.turn, octant)];
        if (child.to == nullptr) return with.leave(inside);
        double* to = with.values(2, child.rows.size());
        for (const std::uint16_t row : child.rows) to = copy_row(gathered + row * stride, stride, to);
        with.begin(*child.to, composed(child.turn, parent.turn), 2, inside, classes_);
    });
}

}  // namespace subvol::detail
