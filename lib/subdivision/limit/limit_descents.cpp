// SPDX-License-Identifier: Apache-2.0
// Which way the places of a control cell take. Each way costs more than the one before, so a cell takes the first that it can:
//
//     1. run_at_once   a linear scheme, or a spline in a grid: the cell itself is exact. MCQ in a grid: the regular class
//     2. run_common    the class of the cell's neighbourhood occurs often in the mesh: its tables pay for themselves
//     3. RefinedStore  any other cell: refined twice together with others near it. Two levels down, extraordinary edges and
//                      points lie so far apart that there are few classes: 1,068 for 26,000 cells that nearly all differ
//
// Classes cannot serve all cells from level 0 on, because nearly every irregular cell of a control mesh has a neighbourhood of
// its own; a table that is used once costs more than a refinement.
#include "limit_descents.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <mutex>
#include <optional>

#include "refined_cells.h"
#include "run_nested.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostBytes = std::size_t{256} << 20;  // of the classes' tables; beyond, they are made anew

}  // namespace

struct LimitDescents::State {
    State(const HexMesh& given, const SchemeOptions& with, bool wanted)
        : mesh(given, with, wanted ? 3 : 2),
          by_frequency(wanted),
          has_common(!wanted),
          graph(std::make_shared<ClassGraph>(with)),
          walks([this] { return NeighborhoodWalk(mesh.control, mesh.links); }) {}

    /// The classes so far, or none if their tables take too much memory. What is made again is the same.
    [[nodiscard]] std::shared_ptr<ClassGraph> classes() {
        const std::scoped_lock lock(mutex);
        if (graph->bytes() > kMostBytes) graph = std::make_shared<ClassGraph>(mesh.scheme);
        return graph;
    }

    /// The neighbourhood of a control cell.
    void gather(std::span<const Index> points, DescentWorker& with) const {
        double* to = with.values(0, points.size());
        for (const Index p : points) to = copy_row(&mesh.rows[p * mesh.stride], mesh.stride, to);
    }

    /// Whether the places of a cell need no refined mesh and no class but the regular one. points: then of its regular
    /// neighbourhood, if it is not exact at once
    bool is_regular(Index cell, std::span<Index, 216> points) {
        if (mesh.scheme.kind == Scheme::Linear) return true;
        GridPoints grid;
        return interpolates(mesh.scheme.kind) ? walks.local().find_regular(cell, points)
                                              : regular_grid(mesh.topology, cell, grid);
    }

    /// The places of a control cell, if no refined mesh is needed for them; false if it is.
    bool run_at_once(const CellPlaces& in, ClassGraph& classes, DescentWorker& with) {
        std::array<Index, 216> points;
        if (!is_regular(in.cell, points)) return false;
        if (interpolates(mesh.scheme.kind) && mesh.scheme.kind != Scheme::Linear) {
            gather(points, with);
            with.begin(classes.regular(), kIdentityTurn, 0, with.open(in), classes);
        } else {
            const bool on_grid = mesh.load(in.cell, with.jets());
            const auto places = with.open(in);
            with.approach(places, kIdentityTurn, 0);
            (void)with.evaluate(places, kIdentityTurn, 0, on_grid);
        }
        return true;
    }

    /// The classes of control cells that occur so often that their tables pay, as far as a sample of the mesh shows.
    void find_common() {
        const std::scoped_lock lock(common_mutex);
        if (has_common) return;
        run_nested([&] { seek_common(); });  // a thread that waits in it must not take work that waits for the lock
        has_common = true;
    }

    void seek_common() {
        // A sample of the cells, evenly spread, tells which classes are common: three members among 4096 cells.
        constexpr std::size_t kMost = 4096, kLeast = 3, kLeastPart = 5;
        const std::size_t count = mesh.control.cells.size(), seen = std::min(count, kMost);
        std::vector<ClassKey> keys(seen);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, seen, 16), [&](const auto& range) {
            NeighborhoodWalk& walk = walks.local();
            Neighborhood& about = abouts.local();
            std::array<Index, 216> points;
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const auto cell = static_cast<Index>(i * count / seen);
                if (!walk.find_regular(cell, points) && walk.find(cell, 2, about)) keys[i] = key_of(about);
            }
        });
        std::ranges::sort(keys);
        std::size_t without = 0, of_common = 0;  // cells
        for (std::size_t first = 0, last = 0; first < seen; first = last) {
            while (last < seen && keys[last] == keys[first]) ++last;
            if (keys[first] == ClassKey{}) {
                without = last - first;
            } else if (last - first >= kLeast) {
                common.push_back(keys[first]);
                of_common += last - first;
            }
        }
        // To look for the class of each cell costs about as much as to refine some of them with the others.
        if (kLeastPart * of_common < seen - without) common.clear();
    }

    /// Whether a cell may be in a box of a grid: then 1, 2, 4 or 8 cells meet at each of its corners.
    [[nodiscard]] bool may_be_in_box(Index cell) const {
        return std::ranges::all_of(mesh.control.cells[cell],
                                   [&](Index p) { return std::has_single_bit(mesh.links.cells_at[p]); });
    }

    /// Whether there are as many cells and points around a cell as in a box of a grid: such classes are few, and those at the
    /// hull of most meshes.
    [[nodiscard]] static bool fills_box(std::size_t cells, std::size_t points) {
        constexpr std::size_t kMostAcross = 5;
        for (std::size_t a = 1; a <= kMostAcross; ++a) {
            for (std::size_t b = a; b <= kMostAcross; ++b) {
                for (std::size_t c = b; c <= kMostAcross; ++c) {
                    if (cells == a * b * c && points == (a + 1) * (b + 1) * (c + 1)) return true;
                }
            }
        }
        return false;
    }

    /// The places of a control cell of a common class; false if it is not of one.
    bool run_common(const CellPlaces& in, ClassGraph& classes, DescentWorker& with) {
        if (!by_frequency && !may_be_in_box(in.cell)) return false;
        Neighborhood& about = abouts.local();
        NeighborhoodWalk& walk = walks.local();
        if (!walk.find(in.cell, 2, about)) return false;
        const bool is_common = by_frequency ? std::ranges::binary_search(common, key_of(about))
                                            : fills_box(walk.visited().size(), about.points.size());
        if (!is_common) return false;
        gather(about.points, with);
        with.begin(classes.class_of(about), about.turn, 0, with.open(in), classes);
        return true;
    }

    /// The store of cells that have no class of their own; made when it is needed first.
    RefinedStore& refined() {
        const std::scoped_lock lock(common_mutex);
        if (!store) {
            run_nested([&] { store.emplace(mesh); });
        }
        return *store;
    }

    DescentMesh mesh;
    bool by_frequency;
    std::mutex common_mutex;
    bool has_common;               // they have been looked for, or are not wanted
    std::vector<ClassKey> common;  // sorted; filled once
    std::optional<RefinedStore> store;
    std::mutex mutex;
    std::shared_ptr<ClassGraph> graph;
    tbb::enumerable_thread_specific<NeighborhoodWalk> walks;
    tbb::enumerable_thread_specific<Neighborhood> abouts;
};

LimitDescents::LimitDescents(const HexMesh& control, const SchemeOptions& scheme, bool by_frequency)
    : state_(std::make_unique<State>(control, scheme, by_frequency)) {
}
LimitDescents::~LimitDescents() = default;

std::shared_ptr<ClassGraph> LimitDescents::classes() const {
    return state_->classes();
}

std::vector<LeftPlace> LimitDescents::run(const DescentTask& task, std::span<const CellPlaces> cells, bool keep) const {
    State& state = *state_;
    DescentWorkers workers([&] { return DescentWorker(task); });
    Progress* progress = task.options.progress;
    std::vector<std::uint8_t> done(cells.size());
    const auto run_each = [&](double from, const auto& run_one) {
        const auto classes = state.classes();
        constexpr std::size_t kTurn = 1U << 16;  // cells between two reports of progress
        for (std::size_t turn = 0; turn < cells.size(); turn += kTurn) {
            report_progress(progress, "limit", from + 0.3 * static_cast<double>(turn) / static_cast<double>(cells.size()));
            const tbb::blocked_range<std::size_t> range(turn, std::min(cells.size(), turn + kTurn), 4);
            tbb::parallel_for(range, [&](const auto& part) {
                for (std::size_t i = part.begin(); i != part.end(); ++i) {
                    if (done[i] == 0) done[i] = run_one(cells[i], *classes, workers.local()) ? 1 : 0;
                }
            });
        }
    };
    // Cell by cell, the cheap ways first; `done` keeps which cells are finished.
    run_each(0, [&](const CellPlaces& in, ClassGraph& classes, auto& with) { return state.run_at_once(in, classes, with); });
    if (std::ranges::find(done, 0) != done.end()) state.find_common();
    if (!state.common.empty() || !state.by_frequency) {
        run_each(0.3,
                 [&](const CellPlaces& in, ClassGraph& classes, auto& with) { return state.run_common(in, classes, with); });
    }
    std::vector<CellPlaces> rest;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (done[i] == 0) rest.push_back(cells[i]);
    }
    // The rest in batches of neighbours in space: their patches overlap, and each point of a patch is computed once.
    if (!rest.empty()) {
        RefinedStore& store = state.refined();
        const auto batches = store.batches(rest);
        std::atomic<std::size_t> finished{0};
        tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) {
            const double part = static_cast<double>(finished) / static_cast<double>(batches.size());
            report_progress(progress, "limit", 0.6 + 0.4 * part);
            run_nested([&] { store.run(batches[b], task, state.classes(), keep, workers); });
            ++finished;
        });
    }
    report_progress(progress, "limit", 1);
    std::vector<LeftPlace> left;
    for (DescentWorker& worker : workers) {
        add_report(worker.report(), task.samples.report);
        left.insert(left.end(), worker.left().begin(), worker.left().end());
    }
    std::ranges::sort(left);
    return left;
}

}  // namespace subvol::detail
