// SPDX-License-Identifier: Apache-2.0
// Two walks over the cells of a mesh, from coarse to fine.
//
// for_each refines every cell by the same number of levels:
//
//     cells ──► classes ──► members of a class, sixteen at a time: one table, one grid for each cell      (apply)
//                 └─► cells without a class, in batches of neighbours: refined once, and their children
//                     take their place with one level less                                               (refine_batch)
//
// The children of a cell at an extraordinary edge are mostly regular, so with each level more cells have a table. Their grids
// are put together in the grid of their parent (CellGrid::take_child); the grids of many parents wait at the same time, so they
// are bounded in bytes (kGroupBytes).
//
// descend asks a visitor how far each cell and each child needs to go. Regular cells need no patch: they are shown to the
// visitor at levels 1 and 2 by their table, and cells of common classes at level 1. The others, and those of the latter that go
// on, are shown level 1 as it is refined, level 2 as the grids of their
// children, and from there on each child goes on by itself, one level at a time, as long as the visitor asks for more.
#include "subvol/detail/cell_refiner.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <numeric>
#include <optional>

#include "constant_fields.h"
#include "dense_block.h"
#include "run_nested.h"
#include "subvol/cell.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/cell_tables.h"
#include "subvol/detail/class_tables.h"
#include "subvol/detail/place_function.h"
#include "subvol/detail/space_order.h"
#include "subvol/limit.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kClassified = CellRefiner::kRun;  // cells whose classes are looked for together: 1 kB each
constexpr int kMostTableLevels = 3;            // a table of one more level has 5,000 rows: children's tables serve instead
constexpr std::size_t kGroupBytes = 8U << 20;  // of the grids that wait for the last of their parts

using Sink = std::function<void(Index cell, const CellGrid& grid)>;

/// A grid as visitors get it: with the values of the fields.
class ShownGrid {
public:
    ShownGrid(const CellGrid& grid, Index cell, int levels, std::span<const Attribute> fields)
        : cell_(grid.dense_cell(cell, levels)), memory_(fields.size()) {
        for (std::size_t a = 0; a < fields.size(); ++a) {
            cell_.values[a] = values_at_places(fields[a], cell_.values[a], memory_[a]);
        }
    }
    [[nodiscard]] const DenseCell& get() const { return cell_; }

private:
    DenseCell cell_;
    std::vector<std::vector<double>> memory_;
};

struct Scratch {
    Neighborhood found;
    LaneValues lanes;
    CellGrid grid;
};

}  // namespace

struct CellRefiner::State {
    State(const HexMesh& mesh, const SchemeOptions& wanted, bool on_limit)
        : fields(mesh.attributes),
          arguments(has_functions(mesh) ? std::make_unique<const HexMesh>(with_arguments(HexMesh(mesh))) : nullptr),
          control(arguments ? *arguments : mesh),
          scheme(wanted),
          moves(on_limit && !interpolates(wanted.kind)),
          regular{regular_neighborhood(1), regular_neighborhood(2)},
          regular_keys{key_of(regular[0]), key_of(regular[1])},
          tables(wanted, moves ? [kind = wanted.kind](HexMesh m) { return subvol::on_limit(std::move(m), kind); }
                               : std::function<HexMesh(HexMesh)>()),
          top(control) {}

    [[nodiscard]] ShownGrid shown(const CellGrid& grid, Index cell, int levels) const { return {grid, cell, levels, fields}; }

    /// Cuts a patch for some cells of a level.
    using Cut = std::function<Patch(std::span<const Index> cells, int layers)>;

    [[nodiscard]] int last_layers() const { return moves ? 1 : 0; }
    /// How many layers around a cell its refinement depends on.
    [[nodiscard]] int layers(int levels) const { return std::min(levels + last_layers(), 2); }

    [[nodiscard]] Classified classes_of(RefinedLevel& level, std::span<const Index> cells, int levels,
                                        int whole = kWhole) const {
        return classify(level, cells, levels, layers(levels), regular_key(levels), whole);
    }

    /// The class of regular cells, refined by some levels.
    [[nodiscard]] const ClassKey& regular_key(int levels) const { return regular_keys[layers(levels) > 1 ? 1 : 0]; }

    /// Evaluates up to kTableLanes cells of one class. All members have the same code, so the neighbourhood of any of them
    /// makes the table if it is not there yet.
    void apply(RefinedLevel& level, std::span<const Member> members, int levels, const DenseBlock& block, Scratch& to,
               const Sink& sink) {
        const auto table = tables.table(members[0].key, levels, [&]() -> const Neighborhood& {
            for (std::size_t layer = 0; layer < 2; ++layer) {
                if (members[0].key == regular_keys[layer]) return regular[layer];
            }
            (void)level.walks.local().find(members[0].cell, layers(levels), to.found);
            return to.found;
        });
        to.lanes.load(level.mesh, members, *table);
        to.lanes.apply(*table);
        to.grid.resize(level.mesh, block.node_count());
        for (std::size_t lane = 0; lane < members.size(); ++lane) {
            to.lanes.store(lane, block.side(), members[lane].turn, to.grid);
            sink(members[lane].cell, to.grid);
        }
    }

    /// Refines the patch by all levels that are left, and reads the vertices off.
    void read_off(Patch patch, std::span<const Index> cells, int levels, const Sink& sink) {
        for (int level = levels; level > 0; --level) patch = refine_patch(patch, scheme, layers(level - 1));
        if (moves) patch.mesh = on_limit(std::move(patch.mesh), scheme.kind);
        const DenseBlock block(levels);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 64), [&](const auto& range) {
            CellGrid grid;
            grid.resize(patch.mesh, block.node_count());
            std::vector<Index> nodes;
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                block.nodes(patch.mesh, i << (3 * levels), nodes);
                for (std::size_t n = 0; n < nodes.size(); ++n) grid.take(patch.mesh, n, nodes[n]);
                sink(cells[i], grid);
            }
        });
    }

    /// Refines a batch of cells without a table once, and evaluates their children in their place. Child k of cell i is cell 8i
    /// + k of the refined patch, as refine_patch numbers it.
    void refine_batch(const Cut& cut, std::span<const Index> cells, int levels, const Sink& sink) {
        Patch patch = cut(cells, layers(levels));
        if (levels <= 1) return read_off(std::move(patch), cells, levels, sink);
        patch = refine_patch(patch, scheme, 2);
        RefinedLevel level(patch.mesh);
        const Cut cut_patch = [&](std::span<const Index> wanted, int layers) { return sub_patch(patch, wanted, layers); };
        std::vector<Index> children(8 * cells.size());
        for (Index i = 0; i < children.size(); ++i) children[i] = i;
        const Classified classified = classes_of(level, children, levels - 1, 0);

        const std::size_t half = std::size_t{1} << (levels - 1), nodes = (2 * half + 1) * (2 * half + 1) * (2 * half + 1);
        std::size_t channels = 3;
        for (const Attribute& attribute : patch.mesh.attributes) channels += static_cast<std::size_t>(attribute.channels);
        const std::size_t group = std::clamp<std::size_t>(kGroupBytes / (nodes * channels * sizeof(double)), 1, cells.size());
        for (std::size_t first = 0; first < cells.size(); first += group) {
            const std::size_t count = std::min(group, cells.size() - first);
            std::vector<CellGrid> grids(count);
            for (CellGrid& one : grids) one.resize(patch.mesh, nodes);
            const auto members = std::span(classified.members).subspan(8 * first, 8 * count);
            evaluate(level, cut_patch, {members.begin(), members.end()}, levels - 1,
                     [&](Index child, const CellGrid& part) { grids[child / 8 - first].take_child(part, child % 8, half); });
            parallel_each(count, [&](std::size_t i) { sink(cells[first + i], grids[i]); });
        }
    }

    /// Evaluates cells by the tables of their classes; cells without a class are refined, in batches of neighbours. The members
    /// are sorted by class and cell, so that the result does not depend on how the list was made.
    void evaluate(RefinedLevel& level, const Cut& cut, const Classified& classified, int levels, const Sink& sink) {
        evaluate(level, cut, classified.members, levels, sink);
    }
    void evaluate(RefinedLevel& level, const Cut& cut, std::vector<Member> members, int levels, const Sink& sink) {
        tbb::parallel_sort(members.begin(), members.end(), [](const Member& a, const Member& b) {
            return std::pair(a.key, a.cell) < std::pair(b.key, b.cell);
        });
        std::vector<std::span<const Member>> chunks;
        std::vector<Index> rare;
        for (std::size_t first = 0; first < members.size();) {
            std::size_t last = first;
            while (last < members.size() && members[last].key == members[first].key) ++last;
            if (members[first].key == kNoClass) {
                for (std::size_t i = first; i < last; ++i) rare.push_back(members[i].cell);
            } else {
                for (std::size_t i = first; i < last; i += kTableLanes) {
                    chunks.emplace_back(&members[i], std::min(kTableLanes, last - i));
                }
            }
            first = last;
        }
        const DenseBlock block(levels);
        tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
            run_nested([&] { apply(level, chunks[i], levels, block, scratch.local(), sink); });
        });
        // Larger batches have fewer cells around them that are refined in addition, smaller ones need less memory.
        const std::size_t most = levels <= kWhole ? 16384 : 4096;
        if (rare.size() > most) rare = in_space_order(level.mesh, rare);
        const std::size_t batches = (rare.size() + most - 1) / most,
                          batch = batches > 0 ? (rare.size() + batches - 1) / batches : 0;
        tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t b) {
            run_nested([&] {
                refine_batch(cut, std::span(rare).subspan(b * batch, std::min(batch, rare.size() - b * batch)), levels, sink);
            });
        });
    }

    /// Removes the cells without a class, and returns them.
    [[nodiscard]] static std::vector<Index> take_rare(Classified& classified) {
        std::vector<Index> rare;
        for (const Member& member : classified.members) {
            if (member.key == kNoClass) rare.push_back(member.cell);
        }
        std::erase_if(classified.members, [](const Member& member) { return member.key == kNoClass; });
        return rare;
    }

    /// Control cells by tables as far as there are classes of them: regular ones are found without a walk, so they come first.
    void evaluate_common(const Cut& cut, std::span<const Index> cells, int levels, const Sink& sink) {
        Classified regulars = classes_of(top, cells, levels, std::max(levels, kWhole));
        const std::vector<Index> rest = take_rare(regulars);
        evaluate(top, cut, regulars, levels, sink);
        evaluate(top, cut, classes_of(top, rest, levels, 0), levels, sink);
    }

    /// Some cells, and those of their children that the visitor asks for.
    ///
    /// seen: for each cell of the control mesh the children that the visitor wants finer, if it has seen the cell at levels 1
    ///       and 2 already
    void descend_batch(const Cut& cut, std::span<const Index> cells, const std::vector<std::uint8_t>& seen, int most_levels,
                       const Descent& visitor) {
        Patch patch = refine_patch(cut(cells, 2), scheme, 2);
        const std::vector<Index> open = visit_first_level(patch, cells, seen, visitor);
        if (open.empty() || most_levels < 2) return;
        std::vector<Index> children;
        for (const Index cell : open) {
            for (Index k = 0; k < 8; ++k) children.push_back(8 * cell + k);
        }
        if (open.size() < cells.size()) patch = sub_patch(patch, children, 2);
        for (Index i = 0; i < children.size(); ++i) children[i] = i;
        RefinedLevel level(patch.mesh);
        const Cut cut_patch = [&](std::span<const Index> wanted, int layers) { return sub_patch(patch, wanted, layers); };
        const auto parent = [&](Index child) { return cells[open[child / 8]]; };

        const auto wanted_of = [&](std::size_t i) { return seen[cells[open[i]]]; };
        std::vector<CellGrid> grids(open.size());
        parallel_each(grids.size(), [&](std::size_t i) {
            if (wanted_of(i) == 0) grids[i].resize(patch.mesh, 125);
        });
        // Level 2 of a cell is level 1 of its eight children.
        std::vector<Index> unseen;
        std::ranges::copy_if(children, std::back_inserter(unseen), [&](Index child) { return wanted_of(child / 8) == 0; });
        evaluate(level, cut_patch, classes_of(level, unseen, 1, 0), 1,
                 [&](Index child, const CellGrid& part) { grids[child / 8].take_child(part, child % 8, 2); });
        std::vector<std::uint8_t> goes_on(children.size());
        parallel_each(open.size(), [&](std::size_t i) {
            const std::uint8_t wanted =
                wanted_of(i) != 0 ? wanted_of(i) : visitor.whole(shown(grids[i], cells[open[i]], 2).get());
            for (std::size_t k = 0; k < 8; ++k) goes_on[8 * i + k] = wanted >> k & 1;
        });
        grids.clear();

        Classified classified;
        for (int levels = 2; levels < most_levels; ++levels) {
            std::erase_if(children, [&](Index child) { return goes_on[child] == 0; });
            if (children.empty()) return;
            // The neighbourhoods stay those of the children: only the number of levels of their tables grows, and with it the
            // number of members that a table needs to pay for itself.
            if (levels == 2) {
                classified = classes_of(level, children, levels, 0);
            } else {
                std::erase_if(classified.members, [&](const Member& member) { return goes_on[member.cell] == 0; });
                if (levels > kMostTableLevels) {
                    for (Member& member : classified.members) member.key = kNoClass;
                }
                drop_rare(classified.members, levels);
            }
            evaluate(level, cut_patch, classified, levels, [&](Index child, const CellGrid& part) {
                goes_on[child] = visitor.part(shown(part, parent(child), levels).get(), child % 8, levels) ? 1 : 0;
            });
        }
    }

    /// Shows the visitor the cells of a patch of their children that it has not seen yet. Returns places in `cells` of those
    /// that it wants finer, and of those that are open already.
    [[nodiscard]] std::vector<Index> visit_first_level(const Patch& patch, std::span<const Index> cells,
                                                       const std::vector<std::uint8_t>& seen, const Descent& visitor) const {
        std::vector<std::uint8_t> wanted(cells.size());
        HexMesh moved;
        if (moves) moved = on_limit(patch.mesh, scheme.kind);
        const HexMesh& mesh = moves ? moved : patch.mesh;
        const DenseBlock block(1);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 64), [&](const auto& range) {
            CellGrid grid;
            grid.resize(mesh, block.node_count());
            std::vector<Index> nodes;
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                if (seen[cells[i]] != 0) {
                    wanted[i] = 1;
                    continue;
                }
                block.nodes(mesh, 8 * i, nodes);
                for (std::size_t n = 0; n < nodes.size(); ++n) grid.take(mesh, n, nodes[n]);
                wanted[i] = visitor.cell(shown(grid, cells[i], 1).get()) ? 1 : 0;
            }
        });
        std::vector<Index> open;
        for (Index i = 0; i < cells.size(); ++i) {
            if (wanted[i] != 0) open.push_back(i);
        }
        return open;
    }

    /// Regular cells have one table for all; the others are refined in batches of neighbours.
    void descend(std::vector<Index> cells, int most_levels, Progress* progress, const Descent& visitor) {
        std::vector<std::uint8_t> is_done(control.cells.size(), 0), seen(control.cells.size(), 0);
        for (std::size_t first = 0; first < cells.size(); first += kClassified) {
            const auto run = std::span(cells).subspan(first, std::min(kClassified, cells.size() - first));
            Classified regulars = classes_of(top, run, 1);
            const std::vector<Index> rest = take_rare(regulars);
            const Sink show_first = [&](Index cell, const CellGrid& grid) {
                if (!visitor.cell(shown(grid, cell, 1).get())) is_done[cell] = 1;
            };
            evaluate(top, {}, regulars, 1, show_first);
            // Level 1 depends on fewer cells than level 2: there cells near the boundary are of a few classes only. To find
            // those pays where there are many.
            if (control.cells.size() > kClassified) {
                Classified near = classes_of(top, rest, 1, 0);
                (void)take_rare(near);
                evaluate(top, {}, near, 1, show_first);
            }
            if (most_levels < 2) continue;
            std::vector<Index> open;
            for (const Member& member : regulars.members) {
                if (is_done[member.cell] == 0) open.push_back(member.cell);
            }
            regulars = classes_of(top, open, 2);
            (void)take_rare(regulars);
            evaluate(top, {}, regulars, 2, [&](Index cell, const CellGrid& grid) {
                seen[cell] = visitor.whole(shown(grid, cell, 2).get());
                if (seen[cell] == 0) is_done[cell] = 1;
            });
        }
        std::erase_if(cells, [&](Index cell) { return is_done[cell] != 0; });
        cells = in_space_order(control, cells);
        const Cut cut = cut_of_control();
        constexpr std::size_t kMost = 36864;  // the fewer batches, the fewer cells around them that are refined too
        const std::size_t batches = (cells.size() + kMost - 1) / kMost;
        std::atomic<std::size_t> done{0};
        tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t b) {
            report_progress(progress, "limit", done, batches);
            const std::size_t first = b * cells.size() / batches, last = (b + 1) * cells.size() / batches;
            run_nested([&] { descend_batch(cut, std::span(cells).subspan(first, last - first), seen, most_levels, visitor); });
            ++done;
        });
        report_progress(progress, "limit", 1);
    }

    /// A few cells of a large mesh with two layers around them, sorted. None if the walks do not find them all.
    [[nodiscard]] std::optional<std::vector<Index>> surroundings_of(std::span<const Index> cells) {
        constexpr std::size_t kFew = 256;  // of so many cells one
        if (cells.size() > control.cells.size() / kFew) return {};
        tbb::enumerable_thread_specific<std::vector<Index>> found;
        std::atomic<bool> is_complete{true};
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 16), [&](const auto& range) {
            NeighborhoodWalk& walk = top.walks.local();
            for (std::size_t i = range.begin(); i != range.end() && is_complete; ++i) {
                if (!walk.find(cells[i], 2, scratch.local().found)) is_complete = false;
                for (const auto& visited : walk.visited()) found.local().push_back(visited.cell);
            }
        });
        if (!is_complete) return {};
        std::vector<Index> all;
        for (const std::vector<Index>& part : found) all.insert(all.end(), part.begin(), part.end());
        tbb::parallel_sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
        return all;
    }

    [[nodiscard]] Cut cut_of_control() {
        return [this](std::span<const Index> wanted, int layers) {
            if (const auto around = surroundings_of(wanted)) return PatchSource(control, *around).cut(wanted, layers);
            std::call_once(patches_made, [&] {
                run_nested([&] { patches = std::make_unique<PatchSource>(control, PatchSource::Faces::Known); });
            });
            return patches->cut(wanted, layers);
        };
    }

    std::span<const Attribute> fields;         // of the mesh that was given
    std::unique_ptr<const HexMesh> arguments;  // that mesh as it is refined, if it differs
    const HexMesh& control;
    ConstantFields constants{control};
    SchemeOptions scheme;
    bool moves;
    std::array<Neighborhood, 2> regular;  // of one layer and of two
    std::array<ClassKey, 2> regular_keys;
    ClassTables tables;
    RefinedLevel top;
    std::once_flag patches_made;
    std::unique_ptr<PatchSource> patches;
    tbb::enumerable_thread_specific<Scratch> scratch;
};

CellRefiner::CellRefiner(const HexMesh& control, const SchemeOptions& scheme, bool on_limit)
    : state_(std::make_unique<State>(control, scheme, on_limit)) {
}
CellRefiner::~CellRefiner() = default;
CellRefiner::CellRefiner(CellRefiner&&) noexcept = default;
CellRefiner& CellRefiner::operator=(CellRefiner&&) noexcept = default;

void CellRefiner::for_each(std::span<const Index> cells, int levels, Progress* progress,
                           const std::function<void(const DenseCell&)>& visit, Tables tables) const {
    State& state = *state_;
    const State::Cut cut = state.cut_of_control();
    const Sink sink = [&](Index cell, const CellGrid& grid) {
        state.constants.with_own_values(state.shown(grid, cell, levels).get(), visit);
    };
    std::vector<Index> ordered;
    if (cells.size() > kClassified) {
        ordered = in_space_order(state.control, cells);
        cells = ordered;
    }
    for (std::size_t first = 0; first < cells.size(); first += kClassified) {
        report_progress(progress, "dense cells", first, cells.size());
        const auto batch = cells.subspan(first, std::min(kClassified, cells.size() - first));
        if (tables == Tables::Regular) {
            state.evaluate(state.top, cut, state.classes_of(state.top, batch, levels), levels, sink);
        } else {
            state.evaluate_common(cut, batch, levels, sink);
        }
    }
    report_progress(progress, "dense cells", 1);
}

const CellLinks& CellRefiner::links() const {
    return state_->top.links;
}

void CellRefiner::descend(std::span<const Index> cells, int most_levels, Progress* progress, const Descent& visitor) const {
    report_progress(progress, "limit", 0);
    const ConstantFields& constants = state_->constants;
    if (constants.fields().empty()) return state_->descend({cells.begin(), cells.end()}, most_levels, progress, visitor);
    const Descent own{.cell = [&](const DenseCell& grid) { return constants.with_own_values(grid, visitor.cell); },
                      .whole = [&](const DenseCell& grid) { return constants.with_own_values(grid, visitor.whole); },
                      .part =
                          [&](const DenseCell& grid, std::size_t child, int levels) {
                              return constants.with_own_values(
                                  grid, [&](const DenseCell& of_cell) { return visitor.part(of_cell, child, levels); });
                          }};
    state_->descend({cells.begin(), cells.end()}, most_levels, progress, own);
}

}  // namespace subvol::detail
