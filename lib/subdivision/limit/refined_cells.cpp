// SPDX-License-Identifier: Apache-2.0
// Control cells whose neighbourhoods have no common class, refined twice.
//
//     level 0   the cells, with two layers around them: one patch for a batch of cells (PatchSource::cut)
//     level 1   their children (RefinedOctant). A place is evaluated there from the walk around the child, of one layer
//     level 2   the cells of that walk, refined once more. Their points are the neighbourhoods of the child's children, which
//               have classes: ClassEntry lists them as corners of children of the cells that the walk visits
//     below     DescentWorker, from class to class
//
// Level 2 is refined only around the octants that have places. What has been refined is kept for the next call (RefinedStore),
// because callers that move places by Newton's method ask again for places in the same cells.
#include "refined_cells.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <atomic>
#include <bit>
#include <mutex>

#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/space_order.h"
#include "subvol/detail/topology_parts.h"

namespace subvol::detail {

namespace {

/// All channels of the points of a mesh.
std::vector<double> rows_of(const HexMesh& mesh, std::size_t stride) {
    std::vector<double> rows(mesh.points.size() * stride);
    parallel_each(mesh.points.size(), [&](std::size_t p) { Channels::read(mesh, static_cast<Index>(p), &rows[p * stride]); });
    return rows;
}

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.capacity() * sizeof(T);
}

}  // namespace

DescentMesh::DescentMesh(const HexMesh& mesh, const SchemeOptions& with, int color_rounds)
    : control(mesh),
      scheme(with),
      stride(Channels(mesh).stride()),
      topology(build_topology(mesh)),
      links(build_links(mesh, topology, color_rounds)),
      rows(rows_of(mesh, stride)) {
}

bool DescentMesh::load(Index cell, CellJets& jets) const {
    GridPoints grid;
    if (scheme.kind != Scheme::Linear && regular_grid(topology, cell, grid)) {
        jets.load_grid(rows.data(), grid);
        return true;
    }
    std::array<Index, 8> corners;
    for (std::size_t octant = 0; octant < 8; ++octant) corners[octant] = control.cells[cell][kCornerOctants[octant]];
    jets.load_corners(rows.data(), corners);
    return false;
}

RefinedCells::RefinedCells(const DescentMesh& mesh, const PatchSource& source, std::shared_ptr<ClassGraph> classes,
                           std::span<const Index> cells, std::span<const std::uint8_t> octants)
    : mesh_(mesh), classes_(std::move(classes)) {
    const Patch first = refine_patch(source.cut(cells, 2), mesh.scheme, 2);
    const Topology first_topology = build_topology(first.mesh, InteriorCreases::Ignore);
    first_rows_ = rows_of(first.mesh, mesh.stride);
    const std::vector<Index> refined = find_octants(first, first_topology, octants);
    if (refined.empty()) return;
    HexMesh second = refine_cells(first, first_topology, mesh.scheme, refined);
    second_rows_ = rows_of(second, mesh.stride);
    second_cells_ = std::move(second.cells);
}

/// The walks around the cells of level 1 that are wanted. Returns the cells that are to be refined for them, in the order of
/// slots_.
std::vector<Index> RefinedCells::find_octants(const Patch& first, const Topology& topology,
                                              std::span<const std::uint8_t> octants) {
    octants_.resize(8 * octants.size());
    std::vector<std::uint8_t> wanted(first.first_layer, 0);
    // The patch ends after the second layer, so one colouring round is all that it can decide: a colour of one round depends on
    // the cells at the point alone.
    const CellLinks links = build_links(first.mesh, topology, 1);
    tbb::enumerable_thread_specific<NeighborhoodWalk> walks([&] { return NeighborhoodWalk(first.mesh, links); });
    tbb::enumerable_thread_specific<Neighborhood> abouts;
    const bool is_spline = !interpolates(mesh_.scheme.kind);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, octants.size(), 16), [&](const auto& range) {
        NeighborhoodWalk& walk = walks.local();
        Neighborhood& about = abouts.local();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            for (std::size_t octant = 0; octant < 8; ++octant) {
                if ((octants[i] >> octant & 1) == 0) continue;
                const std::size_t cell = 8 * i + kCornerOctants[octant];
                octants_[cell].cells = this;
                if (!walk.find(static_cast<Index>(cell), 1, about)) continue;
                const ClassEntry& entry = classes_->entry(about);
                const auto points = about.points.begin();
                octants_[cell] = {this, &entry, about.turn, {points, entry.on_grid ? about.points.end() : points + 8}};
                if (is_spline && entry.on_grid) continue;
                octants_[cell].visited.assign(walk.visited().begin(), walk.visited().end());
                for (const auto& visited : walk.visited()) {
                    // Walks of different octants visit the same cells; all threads write the same 1, so no order between them
                    // is needed.
                    std::atomic_ref(wanted[visited.cell]).store(1, std::memory_order_relaxed);
                }
            }
        }
    });
    std::vector<Index> refined;
    // Maps a cell of level 1 to its place among the cells that are refined again.
    slots_.assign(wanted.size(), kNone);
    for (Index c = 0; c < wanted.size(); ++c) {
        if (wanted[c] == 0) continue;
        slots_[c] = static_cast<Index>(refined.size());
        refined.push_back(c);
    }
    return refined;
}

const RefinedOctant& RefinedCells::octant(std::size_t number, std::size_t octant) const {
    return octants_[8 * number + kCornerOctants[octant]];
}

void RefinedCells::run(const RefinedOctant& in, std::span<OpenPlace> places, DescentWorker& with) const {
    if (in.entry == nullptr) return with.leave(places, 1);
    if (in.entry->on_grid) {
        GridPoints grid = in.entry->grid;
        for (Index& p : grid) p = p == kNone ? kNone : in.points[p];
        with.jets().load_grid(first_rows_.data(), grid);
    } else {
        with.jets().load_corners(first_rows_.data(), std::span(in.points).first<8>());
    }
    places = with.evaluate(places, in.turn, 1, in.entry->on_grid);
    if (!places.empty()) enter(in, places, with);
}

/// From a cell of level 1 to the classes of its children.
void RefinedCells::enter(const RefinedOctant& parent, std::span<OpenPlace> places, DescentWorker& with) const {
    const std::size_t stride = mesh_.stride;
    const auto row_of = [&](const ClassEntry::Corner& at) {
        const auto& [from, from_turn] = parent.visited[at.cell];
        const auto& octants = cell_turns()[from_turn].octants;
        const auto& corners = second_cells_[8 * slots_[from] + kCornerOctants[octants[at.child]]];
        return &second_rows_[corners[kCornerOctants[octants[at.corner]]] * stride];
    };
    const auto& points = parent.entry->points;
    // The neighbourhoods of several places share points, which are far apart in memory.
    const bool many = places.size() > 2;
    double* const all = with.values(1, many ? points.size() : 0);
    if (many) {
        double* to = all;
        for (const ClassEntry::Corner& point : points) to = copy_row(row_of(point), stride, to);
    }
    each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
        const ClassEntry::Child& child = parent.entry->children[walk_octant(parent.turn, octant)];
        if (child.to == nullptr) return with.leave(inside, 2);
        double* to = with.values(2, child.rows.size());
        for (const std::uint16_t row : child.rows) to = copy_row(many ? all + row * stride : row_of(points[row]), stride, to);
        with.begin(*child.to, composed(child.turn, parent.turn), 2, inside, *classes_);
    });
}

std::size_t RefinedCells::bytes() const {
    std::size_t bytes =
        bytes_of(octants_) + bytes_of(slots_) + bytes_of(second_cells_) + bytes_of(first_rows_) + bytes_of(second_rows_);
    for (const RefinedOctant& octant : octants_) bytes += bytes_of(octant.points) + bytes_of(octant.visited);
    return bytes;
}

namespace {

constexpr std::size_t kBatchCells = 8192, kBatchPlaces = 1U << 19;
constexpr std::size_t kMostBytesOfStore = std::size_t{256} << 20;  // of what is kept
constexpr int kMany = 5;                                           // of the octants of a cell: then all are refined

/// The octants of a cell that have places, bit by bit.
std::uint8_t octants_of(const DescentTask& task, const CellPlaces& in) {
    unsigned octants = 0;
    for (std::size_t n = in.first; n < in.last; ++n) {
        Vec3 uvw = task.queries[task.order[n]].uvw;
        octants |= 1U << step_into_octant(uvw);
    }
    return static_cast<std::uint8_t>(std::popcount(octants) >= kMany ? 0xFFU : octants);
}

}  // namespace

RefinedStore::RefinedStore(const DescentMesh& mesh) : mesh_(mesh), source_(mesh.control), kept_(mesh.control.cells.size()) {
}

std::vector<RefinedStore::Batch> RefinedStore::batches(std::span<const CellPlaces> cells) const {
    std::vector<Vec3> centers;
    for (const CellPlaces& in : cells) {
        const auto& corners = mesh_.control.cells[in.cell];
        centers.push_back(0.5 * (mesh_.control.points[corners[0]] + mesh_.control.points[corners[6]]));
    }
    std::vector<Batch> batches;
    std::size_t places = 0;
    for (const Index i : space_order(centers)) {
        const CellPlaces& in = cells[i];
        // A cell with very many places is divided between several batches.
        for (std::size_t first = in.first; first < in.last; first += kBatchPlaces) {
            const std::size_t last = std::min(in.last, first + kBatchPlaces);
            if (batches.empty() || first > in.first || batches.back().size() == kBatchCells ||
                places + (last - first) > kBatchPlaces) {
                batches.emplace_back();
                places = 0;
            }
            batches.back().push_back({in.cell, first, last});
            places += last - first;
        }
    }
    return batches;
}

void RefinedStore::run(const Batch& batch, const DescentTask& task, const std::shared_ptr<ClassGraph>& classes, bool keep,
                       DescentWorkers& workers) {
    std::vector<Octants> octants(batch.size(), Octants{});
    std::vector<std::uint8_t> missing(batch.size());
    parallel_each(batch.size(), [&](std::size_t i) { missing[i] = octants_of(task, batch[i]); });
    // What earlier calls have kept is not refined again.
    {
        const std::shared_lock lock(mutex_);
        for (std::size_t i = 0; i < batch.size(); ++i) {
            if (!kept_[batch[i].cell]) continue;
            octants[i] = *kept_[batch[i].cell];
            for (std::size_t o = 0; o < 8; ++o) {
                if (octants[i][o] != nullptr) missing[i] &= static_cast<std::uint8_t>(~(1U << o));
            }
        }
    }
    std::shared_ptr<const RefinedCells> refined;
    refine(batch, missing, classes, keep, refined, octants);
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, batch.size(), 4), [&](const auto& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            DescentWorker& with = workers.local();
            const bool regular = mesh_.load(batch[i].cell, with.jets());
            const auto places = with.evaluate(with.open(batch[i]), kIdentityTurn, 0, regular);
            each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
                const RefinedOctant& in = *octants[i][octant];
                in.cells->run(in, inside, with);
            });
        }
    });
}

/// Refines the octants that are missing as one piece, and keeps the piece if it is to be kept and there is room. Pieces are
/// never changed, so those who read them need no lock; the lock is for the lists.
void RefinedStore::refine(const Batch& batch, std::span<const std::uint8_t> missing, const std::shared_ptr<ClassGraph>& classes,
                          bool keep, std::shared_ptr<const RefinedCells>& refined, std::span<Octants> octants) {
    std::vector<std::size_t> numbers;  // in the batch
    std::vector<Index> cells;
    std::vector<std::uint8_t> wanted;
    for (std::size_t i = 0; i < batch.size(); ++i) {
        if (missing[i] == 0) continue;
        numbers.push_back(i);
        cells.push_back(batch[i].cell);
        wanted.push_back(missing[i]);
    }
    if (cells.empty()) return;
    refined = std::make_shared<const RefinedCells>(mesh_, source_, classes, cells, wanted);
    const auto add = [&](std::size_t n, Octants& to) {
        for (std::size_t o = 0; o < 8; ++o) {
            if ((wanted[n] >> o & 1) != 0) to[o] = &refined->octant(n, o);
        }
    };
    for (std::size_t n = 0; n < cells.size(); ++n) add(n, octants[numbers[n]]);
    if (!keep) return;
    const std::size_t bytes = refined->bytes();
    const std::scoped_lock lock(mutex_);
    if (bytes_ + bytes > kMostBytesOfStore) return;
    bytes_ += bytes;
    pieces_.push_back(refined);
    for (std::size_t n = 0; n < cells.size(); ++n) {
        auto& kept = kept_[cells[n]];
        if (!kept) kept = std::make_unique<Octants>();
        add(n, *kept);
    }
}

}  // namespace subvol::detail
