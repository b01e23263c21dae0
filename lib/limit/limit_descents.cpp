// SPDX-License-Identifier: Apache-2.0
// More than 400 lines: the walk down, the batches that lead into it and the order of both share one state.
#include "limit_descents.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "run_nested.h"
#include "space_order.h"
#include "subvol/cell.h"
#include "subvol/detail/bucket_sort.h"
#include "topology_parts.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostLevels = 24;
constexpr std::size_t kBatchCells = 4096, kBatchPlaces = 1U << 18;
constexpr std::size_t kMostBytes = std::size_t{256} << 20;  // of the classes' tables; beyond, they are made anew

/// The octant of the walk that is a cell's octant `octant`.
std::size_t walk_octant(std::uint8_t turn, std::size_t octant) {
    const auto& octants = cell_turns()[turn].octants;
    return static_cast<std::size_t>(std::find(octants.begin(), octants.end(), octant) - octants.begin());
}

constexpr std::array<Index, 8> kFirstEight{0, 1, 2, 3, 4, 5, 6, 7};

std::array<Index, 8> by_octants(const std::array<Index, 8>& cell) {
    std::array<Index, 8> corners{};
    for (std::size_t octant = 0; octant < 8; ++octant) corners[octant] = cell[kCornerOctants[octant]];
    return corners;
}

/// All channels of the points of a mesh.
std::vector<double> rows_of(const HexMesh& mesh, std::size_t stride) {
    std::vector<double> rows(mesh.points.size() * stride);
    parallel_each(mesh.points.size(), [&](std::size_t p) { Channels::read(mesh, static_cast<Index>(p), &rows[p * stride]); });
    return rows;
}

}  // namespace

struct LimitDescents::State {
    /// What a thread needs.
    struct Worker {
        Worker(const State& state, LimitSamples& samples)
            : settling(state.options, state.scales, state.channels.stride(), samples),
              jets(state.options.scheme.kind, state.channels.stride()),
              values(kMostLevels),
              rows(kMostLevels) {}
        Settling settling;
        CellJets jets;
        std::vector<std::vector<double>> values;  // of the neighbourhoods on the way down
        std::vector<StepRows> rows;               // of the children of these
        std::vector<OpenPlace> places;
        std::vector<double> lasts;
        std::vector<double> jet, turned;
        std::vector<Index> points;
        Neighborhood about;
        std::vector<std::size_t> left;
    };

    /// A cell of level 1 that has places, with the walk about it. entry: null if there is none
    struct Parent {
        const ClassEntry* entry = nullptr;
        std::uint8_t turn = kIdentityTurn;
        std::vector<Index> points{};
        std::vector<NeighborhoodWalk::Visited> visited{};
    };

    /// A batch of control cells, refined twice where places need it.
    struct Batch {
        Patch first;  // level 1
        std::vector<double> first_rows, second_rows;
        std::vector<Parent> parents;
        std::vector<Index> slots;  // of cells of level 1 among the refined ones
        HexMesh second;
    };

    State(const HexMesh& mesh, std::span<const LimitQuery> list, std::span<const std::size_t> sorted,
          const LimitOptions& wanted, std::span<const double> of_channels, LimitSamples& results)
        : control(mesh),
          queries(list),
          order(sorted),
          options(wanted),
          scales(of_channels),
          channels(mesh),
          topology(build_topology(mesh)),
          links(build_links(mesh, topology)),
          graph(std::make_shared<ClassGraph>(wanted.scheme)),
          samples(results),
          workers([this] { return Worker(*this, samples); }),
          walks([this] { return NeighborhoodWalk(control, links); }) {}

    [[nodiscard]] bool is_spline() const { return !interpolates(options.scheme.kind); }

    /// The classes so far, or none if their tables take too much memory. What is made again is the same.
    [[nodiscard]] std::shared_ptr<ClassGraph> classes() {
        const std::scoped_lock lock(mutex);
        if (graph->bytes() > kMostBytes) graph = std::make_shared<ClassGraph>(options.scheme);
        return graph;
    }

    /// The places of a cell, with memory for their jets.
    std::span<OpenPlace> open(const CellPlaces& in, Worker& to) const {
        const std::size_t size = 4 * channels.stride(), count = in.last - in.first;
        to.places.resize(count);
        to.lasts.resize(count * size);
        to.jet.resize(size);
        to.turned.resize(size);
        for (std::size_t i = 0; i < count; ++i) {
            const std::size_t query = order[in.first + i];
            to.places[i] = {.query = query, .uvw = queries[query].uvw, .last = &to.lasts[i * size]};
        }
        return to.places;
    }

    /// Evaluates places in the cell that is loaded. Those that are open are moved to the front and returned.
    ///
    /// turn: from the axes of the loaded cell to those of the control cell
    std::span<OpenPlace> evaluate(std::span<OpenPlace> places, std::uint8_t turn, int level, bool on_grid, Worker& with) const {
        with.settling.report().deepest_level = std::max(with.settling.report().deepest_level, level);
        const bool exact = options.scheme.kind == Scheme::Linear || (on_grid && is_spline());
        const double scale = std::ldexp(1.0, level);
        const std::size_t stride = channels.stride();
        std::size_t kept = 0;
        for (OpenPlace& at : places) {
            const double* jet = with.jet.data();
            if (turn == kIdentityTurn) {
                with.jets.evaluate(at.uvw, scale, with.jet.data());
            } else {
                const auto& sides = cell_turns()[turn].sides;
                Vec3 uvw;
                for (std::size_t a = 0; a < 3; ++a) {
                    const double t = at.uvw[static_cast<int>(sides[2 * a] / 2)];
                    uvw[static_cast<int>(a)] = (sides[2 * a] & 1) != 0 ? 1 - t : t;
                }
                with.jets.evaluate(uvw, scale, with.jet.data());
                std::copy_n(with.jet.data(), stride, with.turned.data());
                for (std::size_t a = 0; a < 3; ++a) {
                    const double sign = (sides[2 * a] & 1) != 0 ? -1 : 1;
                    const double* from = &with.jet[(1 + a) * stride];
                    double* to = &with.turned[(1 + static_cast<std::size_t>(sides[2 * a] / 2)) * stride];
                    for (std::size_t c = 0; c < stride; ++c) to[c] = sign * from[c];
                }
                jet = with.turned.data();
            }
            if (!with.settling.settle(at, jet, level, on_grid, exact)) places[kept++] = at;
        }
        return places.first(kept);
    }

    /// Calls visit(octant, places) for the children of a cell that have places.
    template <class Visit>
    static void each_octant(std::span<OpenPlace> places, const Visit& visit) {
        for (OpenPlace& at : places) at.octant = static_cast<std::uint8_t>(step_into_octant(at.uvw));
        if (places.size() > 1) std::ranges::sort(places, {}, &OpenPlace::octant);
        for (std::size_t first = 0; first < places.size();) {
            std::size_t last = first + 1;
            while (last < places.size() && places[last].octant == places[first].octant) ++last;
            visit(std::size_t{places[first].octant}, places.subspan(first, last - first));
            first = last;
        }
    }

    void leave(std::span<const OpenPlace> places, Worker& with) const {
        for (const OpenPlace& at : places) with.left.push_back(at.query);
    }

    /// Places in a cell of a class, the values of whose neighbourhood are there, and in its children as deep as they ask for
    /// it.
    void begin(const DescentClass& is, std::uint8_t turn, int level, std::span<OpenPlace> places, ClassGraph& classes,
               Worker& with) const {
        const double* values = with.values[static_cast<std::size_t>(level)].data();
        is.on_grid ? with.jets.load_grid(values, is.grid) : with.jets.load_corners(values, kFirstEight);
        places = evaluate(places, turn, level, is.on_grid, with);
        if (!places.empty()) descend(is, turn, level, places, classes, with);
    }

    /// Only those points are computed that a place is evaluated from; the rest of a child's neighbourhood if it goes on.
    void descend(const DescentClass& is, std::uint8_t turn, int level, std::span<OpenPlace> places, ClassGraph& classes,
                 Worker& with) const {
        const std::size_t stride = channels.stride();
        const double* values = with.values[static_cast<std::size_t>(level)].data();
        auto& below = with.values[static_cast<std::size_t>(level) + 1];
        StepRows& rows = with.rows[static_cast<std::size_t>(level)];
        const auto& [table, children] = classes.children(is);
        rows.begin(table, stride);
        each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
            const ClassChildren::Child& child = children[walk_octant(turn, octant)];
            if (child.to == nullptr) return leave(inside, with);
            apply_step(table, child.near, stride, values, rows);
            if (child.to->on_grid) {
                with.jets.load_grid(rows.values.data(), child.grid);
            } else {
                with.jets.load_corners(rows.values.data(), child.corners);
            }
            const std::uint8_t child_turn = composed(child.turn, turn);
            inside = evaluate(inside, child_turn, level + 1, child.to->on_grid, with);
            if (inside.empty()) return;
            apply_step(table, child.rows, stride, values, rows);
            below.resize(std::max(below.size(), child.rows.size() * stride));
            double* to = below.data();
            for (const std::uint16_t row : child.rows) {
                const double* from = &rows.values[row * stride];
                for (std::size_t c = 0; c < stride; ++c) *to++ = from[c];
            }
            descend(*child.to, child_turn, level + 1, inside, classes, with);
        });
    }

    /// Loads a control cell, by its regular grid if it has one. Returns whether it has.
    bool load(Index cell, Worker& with) const {
        GridPoints grid;
        const bool regular = options.scheme.kind != Scheme::Linear && regular_grid(topology, cell, grid);
        std::array<Index, 8> corners = by_octants(control.cells[cell]);
        auto& values = with.values[0];
        values.resize(std::max(values.size(), 216 * channels.stride()));
        const auto copy = [&](std::span<Index> points) {
            for (std::size_t n = 0; n < points.size(); ++n) {
                if (points[n] == kNone) continue;
                Channels::read(control, points[n], &values[n * channels.stride()]);
                points[n] = static_cast<Index>(n);
            }
        };
        if (regular) {
            copy(grid);
            with.jets.load_grid(values.data(), grid);
        } else {
            copy(corners);
            with.jets.load_corners(values.data(), corners);
        }
        return regular;
    }

    /// The places of a control cell, if no refined mesh is needed for them; false if it is.
    bool run_at_once(const CellPlaces& in, ClassGraph& classes, Worker& with) {
        if (options.scheme.kind == Scheme::Linear) {
            load(in.cell, with);
            (void)evaluate(open(in, with), kIdentityTurn, 0, false, with);
            return true;
        }
        with.points.resize(216);
        if (!is_spline() && walks.local().find_regular(in.cell, std::span(with.points).first<216>())) {
            auto& values = with.values[0];
            values.resize(std::max(values.size(), 216 * channels.stride()));
            for (std::size_t n = 0; n < 216; ++n) Channels::read(control, with.points[n], &values[n * channels.stride()]);
            begin(classes.regular(), kIdentityTurn, 0, open(in, with), classes, with);
            return true;
        }
        if (!is_spline() || !load(in.cell, with)) return false;
        (void)evaluate(open(in, with), kIdentityTurn, 0, true, with);
        return true;
    }

    /// The classes of control cells that occur so often that their tables pay, as far as a sample of the mesh shows.
    void find_common() {
        constexpr std::size_t kMost = 8192, kLeast = 4;
        const std::size_t count = control.cells.size(), seen = std::min(count, kMost);
        std::vector<ClassKey> keys(seen);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, seen, 16), [&](const auto& range) {
            Worker& with = workers.local();
            NeighborhoodWalk& walk = walks.local();
            std::array<Index, 216> points;
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const auto cell = static_cast<Index>(i * count / seen);
                if (!walk.find_regular(cell, points) && walk.find(cell, 2, with.about)) keys[i] = key_of(with.about);
            }
        });
        std::ranges::sort(keys);
        for (std::size_t first = 0, last = 0; first < seen; first = last) {
            while (last < seen && keys[last] == keys[first]) ++last;
            if (last - first >= kLeast && keys[first] != ClassKey{}) common.push_back(keys[first]);
        }
    }

    /// The places of a control cell of a common class; false if it is not of one.
    bool run_common(const CellPlaces& in, ClassGraph& classes, Worker& with) {
        NeighborhoodWalk& walk = walks.local();
        if (!walk.find(in.cell, 2, with.about) || !std::ranges::binary_search(common, key_of(with.about))) return false;
        auto& values = with.values[0];
        const auto& points = with.about.points;
        values.resize(std::max(values.size(), points.size() * channels.stride()));
        for (std::size_t n = 0; n < points.size(); ++n) Channels::read(control, points[n], &values[n * channels.stride()]);
        begin(classes.class_of(with.about), with.about.turn, 0, open(in, with), classes, with);
        return true;
    }

    /// The walk about a cell of level 1 of a batch.
    void find_parent(NeighborhoodWalk& walk, Index cell, ClassGraph& classes, Worker& with, Parent& found) const {
        if (!walk.find(cell, 1, with.about)) return;
        found.entry = &classes.entry(with.about);
        found.turn = with.about.turn;
        found.points = with.about.points;
        found.visited.assign(walk.visited().begin(), walk.visited().end());
    }

    void run_batch(std::span<const CellPlaces> cells, ClassGraph& classes) {
        Batch batch;
        std::vector<Index> numbers;
        for (const CellPlaces& in : cells) numbers.push_back(in.cell);
        const Patch first = refine_patch(source->cut(numbers, 2), options.scheme, 2);
        const Topology first_topology = build_topology(first.mesh, InteriorCreases::Ignore);
        batch.first_rows = rows_of(first.mesh, channels.stride());
        batch.parents.resize(8 * cells.size());
        std::vector<std::uint8_t> wanted(first.first_layer, 0);
        {
            // The second layer ends the patch: colours of one round see no further.
            const CellLinks first_links = build_links(first.mesh, first_topology, 1);
            tbb::enumerable_thread_specific<NeighborhoodWalk> first_walks(
                [&] { return NeighborhoodWalk(first.mesh, first_links); });
            tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 16), [&](const auto& range) {
                for (std::size_t i = range.begin(); i != range.end(); ++i) {
                    unsigned has_places = 0;
                    for (std::size_t n = cells[i].first; n < cells[i].last; ++n) {
                        Vec3 uvw = queries[order[n]].uvw;
                        has_places |= 1U << step_into_octant(uvw);
                    }
                    for (std::size_t octant = 0; octant < 8; ++octant) {
                        if ((has_places >> octant & 1) == 0) continue;
                        const std::size_t cell = 8 * i + kCornerOctants[octant];
                        Parent& parent = batch.parents[cell];
                        find_parent(first_walks.local(), static_cast<Index>(cell), classes, workers.local(), parent);
                        if (parent.entry == nullptr || (is_spline() && parent.entry->on_grid)) continue;
                        for (const auto& visited : parent.visited) {
                            std::atomic_ref(wanted[visited.cell]).store(1, std::memory_order_relaxed);
                        }
                    }
                }
            });
        }
        std::vector<Index> refined;
        batch.slots.assign(wanted.size(), kNone);
        for (std::size_t c = 0; c < wanted.size(); ++c) {
            if (wanted[c] == 0) continue;
            batch.slots[c] = static_cast<Index>(refined.size());
            refined.push_back(static_cast<Index>(c));
        }
        if (!refined.empty()) batch.second = refine_cells(first, first_topology, options.scheme, refined);
        batch.second_rows = rows_of(batch.second, channels.stride());
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 4), [&](const auto& range) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) run_cell(cells[i], i, batch, classes, workers.local());
        });
    }

    /// The places of a control cell whose refinement is in a batch.
    void run_cell(const CellPlaces& in, std::size_t number, const Batch& batch, ClassGraph& classes, Worker& with) const {
        const bool regular = load(in.cell, with);
        const auto places = evaluate(open(in, with), kIdentityTurn, 0, regular, with);
        each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
            const Parent& parent = batch.parents[8 * number + kCornerOctants[octant]];
            if (parent.entry == nullptr) return leave(inside, with);
            if (parent.entry->on_grid) {
                GridPoints grid = parent.entry->grid;
                for (Index& p : grid) p = p == kNone ? kNone : parent.points[p];
                with.jets.load_grid(batch.first_rows.data(), grid);
            } else {
                with.jets.load_corners(batch.first_rows.data(), std::span(parent.points).first<8>());
            }
            inside = evaluate(inside, parent.turn, 1, parent.entry->on_grid, with);
            if (!inside.empty()) enter(parent, inside, batch, classes, with);
        });
    }

    /// From a cell of level 1 to the classes of its children.
    void enter(const Parent& parent, std::span<OpenPlace> places, const Batch& batch, ClassGraph& classes, Worker& with) const {
        const std::size_t stride = channels.stride();
        each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
            const ClassEntry::Child& child = parent.entry->children[walk_octant(parent.turn, octant)];
            if (child.to == nullptr) return leave(inside, with);
            auto& values = with.values[2];
            values.resize(std::max(values.size(), child.points.size() * stride));
            double* to = values.data();
            for (const auto& [number, of, corner] : child.points) {
                const auto& [from, from_turn] = parent.visited[number];
                const auto& octants = cell_turns()[from_turn].octants;
                const auto& corners = batch.second.cells[8 * batch.slots[from] + kCornerOctants[octants[of]]];
                const double* row = &batch.second_rows[corners[kCornerOctants[octants[corner]]] * stride];
                for (std::size_t c = 0; c < stride; ++c) *to++ = row[c];
            }
            begin(*child.to, composed(child.turn, parent.turn), 2, inside, classes, with);
        });
    }

    const HexMesh& control;
    std::span<const LimitQuery> queries;
    std::span<const std::size_t> order;
    const LimitOptions& options;
    std::span<const double> scales;
    Channels channels;
    Topology topology;
    CellLinks links;
    std::optional<PatchSource> source;
    std::vector<ClassKey> common;  // sorted
    std::mutex mutex;
    std::shared_ptr<ClassGraph> graph;
    LimitSamples& samples;
    mutable tbb::enumerable_thread_specific<Worker> workers;
    mutable tbb::enumerable_thread_specific<NeighborhoodWalk> walks;
};

LimitDescents::LimitDescents(const HexMesh& control, std::span<const LimitQuery> queries, std::span<const std::size_t> order,
                             const LimitOptions& options, std::span<const double> scales, LimitSamples& samples)
    : state_(std::make_unique<State>(control, queries, order, options, scales, samples)) {
}
LimitDescents::~LimitDescents() = default;

std::vector<std::size_t> LimitDescents::run(std::span<const CellPlaces> cells) {
    State& state = *state_;
    Progress* progress = state.options.progress;
    std::vector<std::uint8_t> done(cells.size());
    const auto run_each = [&](double from, const auto& run_one) {
        const auto classes = state.classes();
        constexpr std::size_t kTurn = 1U << 16;  // cells between two reports of progress
        for (std::size_t turn = 0; turn < cells.size(); turn += kTurn) {
            report_progress(progress, "limit", from + 0.3 * static_cast<double>(turn) / static_cast<double>(cells.size()));
            const tbb::blocked_range<std::size_t> range(turn, std::min(cells.size(), turn + kTurn), 4);
            tbb::parallel_for(range, [&](const auto& part) {
                for (std::size_t i = part.begin(); i != part.end(); ++i) {
                    if (done[i] == 0) done[i] = run_one(cells[i], *classes, state.workers.local()) ? 1 : 0;
                }
            });
        }
    };
    run_each(0, [&](const CellPlaces& in, ClassGraph& classes, auto& with) { return state.run_at_once(in, classes, with); });
    if (std::ranges::find(done, 0) != done.end()) state.find_common();
    if (!state.common.empty()) {
        run_each(0.3,
                 [&](const CellPlaces& in, ClassGraph& classes, auto& with) { return state.run_common(in, classes, with); });
    }
    std::vector<CellPlaces> rest;
    std::vector<Vec3> centers;
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (done[i] != 0) continue;
        const auto& corners = state.control.cells[cells[i].cell];
        // A cell with very many places is shared by several batches.
        for (std::size_t first = cells[i].first; first < cells[i].last; first += kBatchPlaces) {
            rest.push_back({cells[i].cell, first, std::min(cells[i].last, first + kBatchPlaces)});
            centers.push_back(0.5 * (state.control.points[corners[0]] + state.control.points[corners[6]]));
        }
    }
    if (!rest.empty()) {
        state.source.emplace(state.control);
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
            report_progress(progress, "limit", 0.6 + 0.4 * part);
            run_nested([&] {
                const auto classes = state.classes();
                state.run_batch(std::span(ordered).subspan(starts[b], starts[b + 1] - starts[b]), *classes);
            });
            ++finished;
        });
    }
    report_progress(progress, "limit", 1);
    std::vector<std::size_t> left;
    for (auto& worker : state.workers) {
        add_report(worker.settling.report(), state.samples.report);
        left.insert(left.end(), worker.left.begin(), worker.left.end());
    }
    std::ranges::sort(left);
    return left;
}

}  // namespace subvol::detail
