// SPDX-License-Identifier: Apache-2.0
#include "limit_descents.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <optional>

#include "descent_batch.h"
#include "run_nested.h"
#include "space_order.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kBatchCells = 8192, kBatchPlaces = 1U << 19;
constexpr std::size_t kMostBytes = std::size_t{256} << 20;  // of the classes' tables; beyond, they are made anew

}  // namespace

struct LimitDescents::State {
    State(const HexMesh& mesh, const SchemeOptions& with)
        : control(mesh),
          scheme(with),
          stride(Channels(mesh).stride()),
          topology(build_topology(control)),
          links(build_links(control, topology)),
          rows(rows_of(control, stride)),
          graph(std::make_shared<ClassGraph>(scheme)),
          walks([this] { return NeighborhoodWalk(control, links); }) {}

    /// The classes so far, or none if their tables take too much memory. What is made again is the same.
    [[nodiscard]] std::shared_ptr<ClassGraph> classes() {
        const std::scoped_lock lock(mutex);
        if (graph->bytes() > kMostBytes) graph = std::make_shared<ClassGraph>(scheme);
        return graph;
    }

    /// The neighbourhood of a control cell.
    void gather(std::span<const Index> points, DescentWorker& with) const {
        double* to = with.values(0, points.size());
        for (const Index p : points) to = copy_row(&rows[p * stride], stride, to);
    }

    /// The places of a control cell, if no refined mesh is needed for them; false if it is.
    bool run_at_once(const DescentTask& task, const CellPlaces& in, ClassGraph& classes, DescentWorker& with) {
        if (!task.is_spline() && scheme.kind != Scheme::Linear) {
            std::array<Index, 216> points;
            if (!walks.local().find_regular(in.cell, points)) return false;
            gather(points, with);
            with.begin(classes.regular(), kIdentityTurn, 0, with.open(in), classes);
            return true;
        }
        const bool regular = load_control_cell(task, topology, rows, in.cell, with.jets());
        if (task.is_spline() && !regular) return false;
        (void)with.evaluate(with.open(in), kIdentityTurn, 0, regular);
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
        constexpr std::size_t kMost = 4096, kLeast = 3, kLeastPart = 5;
        const std::size_t count = control.cells.size(), seen = std::min(count, kMost);
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

    /// The places of a control cell of a common class; false if it is not of one.
    bool run_common(const CellPlaces& in, ClassGraph& classes, DescentWorker& with) {
        Neighborhood& about = abouts.local();
        if (!walks.local().find(in.cell, 2, about) || !std::ranges::binary_search(common, key_of(about))) return false;
        gather(about.points, with);
        with.begin(classes.class_of(about), about.turn, 0, with.open(in), classes);
        return true;
    }

    const HexMesh& control;
    SchemeOptions scheme;
    std::size_t stride;  // of rows
    Topology topology;
    CellLinks links;
    std::vector<double> rows;  // the channels of the control points
    std::mutex common_mutex;
    bool has_common = false;
    std::vector<ClassKey> common;  // sorted; filled once
    std::mutex mutex;
    std::shared_ptr<ClassGraph> graph;
    tbb::enumerable_thread_specific<NeighborhoodWalk> walks;
    tbb::enumerable_thread_specific<Neighborhood> abouts;
};

/// One call: its task, with a worker for each thread.
struct LimitDescents::Run {
    Run(State& with, const DescentTask& wanted) : state(with), task(wanted), workers([this] { return DescentWorker(task); }) {}

    void run_batches(std::span<const CellPlaces> cells);

    State& state;
    const DescentTask& task;
    DescentWorkers workers;
};

/// Cells that have no class of their own.
void LimitDescents::Run::run_batches(std::span<const CellPlaces> cells) {
    std::vector<CellPlaces> rest;
    std::vector<Vec3> centers;
    for (const CellPlaces& in : cells) {
        const auto& corners = task.control.cells[in.cell];
        // A cell with very many places is shared by several batches.
        for (std::size_t first = in.first; first < in.last; first += kBatchPlaces) {
            rest.push_back({in.cell, first, std::min(in.last, first + kBatchPlaces)});
            centers.push_back(0.5 * (task.control.points[corners[0]] + task.control.points[corners[6]]));
        }
    }
    const PatchSource source(task.control);
    std::vector<CellPlaces> ordered;
    for (const Index i : space_order(centers)) ordered.push_back(rest[i]);
    std::vector<std::size_t> starts{0};
    std::size_t places = 0;
    for (std::size_t i = 0; i < ordered.size(); ++i) {
        const std::size_t more = ordered[i].last - ordered[i].first;
        const bool again = i > starts.back() && ordered[i].cell == ordered[i - 1].cell;
        if (i > starts.back() && (again || i - starts.back() >= kBatchCells || places + more > kBatchPlaces)) {
            starts.push_back(i);
            places = 0;
        }
        places += more;
    }
    starts.push_back(ordered.size());
    std::atomic<std::size_t> finished{0};
    tbb::parallel_for(std::size_t{0}, starts.size() - 1, [&](std::size_t b) {
        const double part = static_cast<double>(finished) / static_cast<double>(starts.size());
        report_progress(task.options.progress, "limit", 0.6 + 0.4 * part);
        run_nested([&] {
            const auto classes_now = state.classes();
            DescentBatch(task, state.topology, state.rows, *classes_now, workers)
                .run(source, std::span(ordered).subspan(starts[b], starts[b + 1] - starts[b]));
        });
        ++finished;
    });
}

LimitDescents::LimitDescents(const HexMesh& control, const SchemeOptions& scheme)
    : state_(std::make_unique<State>(control, scheme)) {
}
LimitDescents::~LimitDescents() = default;

std::vector<std::size_t> LimitDescents::run(const DescentTask& task, std::span<const CellPlaces> cells) const {
    State& state = *state_;
    Run call(state, task);
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
                    if (done[i] == 0) done[i] = run_one(cells[i], *classes, call.workers.local()) ? 1 : 0;
                }
            });
        }
    };
    run_each(0,
             [&](const CellPlaces& in, ClassGraph& classes, auto& with) { return state.run_at_once(task, in, classes, with); });
    if (std::ranges::find(done, 0) != done.end()) state.find_common();
    if (!state.common.empty()) {
        run_each(0.3,
                 [&](const CellPlaces& in, ClassGraph& classes, auto& with) { return state.run_common(in, classes, with); });
    }
    std::vector<CellPlaces> rest;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (done[i] == 0) rest.push_back(cells[i]);
    }
    if (!rest.empty()) call.run_batches(rest);
    report_progress(progress, "limit", 1);
    std::vector<std::size_t> left;
    for (DescentWorker& worker : call.workers) {
        add_report(worker.report(), task.samples.report);
        left.insert(left.end(), worker.left().begin(), worker.left().end());
    }
    std::ranges::sort(left);
    return left;
}

}  // namespace subvol::detail
