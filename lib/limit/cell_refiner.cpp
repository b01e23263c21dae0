// SPDX-License-Identifier: Apache-2.0
#include "cell_refiner.h"

#include <tbb/cache_aligned_allocator.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <numeric>

#include "class_tables.h"
#include "dense_block.h"
#include "run_nested.h"
#include "space_order.h"
#include "subvol/cell.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/limit.h"

namespace subvol::detail {

namespace {

/// How many cells of a class make a table pay, by its level: it costs as much as the refinement of so many.
std::size_t least_members(int levels) {
    return std::size_t{32} << std::max(0, levels - 2);
}

constexpr std::size_t kClassified = 1U << 16;   // cells whose classes are looked for together: 1 kB each
constexpr int kMostTableLevels = 3;             // a table of one more level has 5,000 rows: children's tables serve instead
constexpr int kWhole = 2;                       // so many levels are refined as they are, without classes of children
constexpr std::size_t kGroupBytes = 32U << 20;  // of the grids that wait for the last of their parts

/// The vertices of one cell's refinement, with the values of all attributes.
struct Grid {
    std::vector<Vec3> points;
    std::vector<std::vector<double>> values;

    void resize(const HexMesh& mesh, std::size_t nodes) {
        points.resize(nodes);
        values.resize(mesh.attributes.size());
        for (std::size_t a = 0; a < values.size(); ++a) {
            values[a].resize(nodes * static_cast<std::size_t>(mesh.attributes[a].channels));
        }
    }

    /// Node `node` from a point of a mesh.
    void take(const HexMesh& mesh, std::size_t node, Index point) {
        points[node] = mesh.points[point];
        for (std::size_t a = 0; a < values.size(); ++a) {
            const auto channels = static_cast<std::size_t>(mesh.attributes[a].channels);
            std::copy_n(mesh.attributes[a].values.begin() + static_cast<std::ptrdiff_t>(point * channels), channels,
                        values[a].begin() + static_cast<std::ptrdiff_t>(node * channels));
        }
    }
};

using Sink = std::function<void(Index cell, const Grid& grid)>;

/// A cell with the class of its neighbourhood, whose points are points[0 .. point_count).
struct Member {
    ClassKey key;
    Index cell = 0;
    std::uint16_t point_count = 0;
    std::uint8_t turn = kIdentityTurn;
    const Index* points = nullptr;
};

/// Values of kTableLanes cells: channel by channel, point by point, cell by cell.
class LaneValues {
public:
    void load(const HexMesh& mesh, std::span<const Member> cells) {
        const std::size_t points = cells[0].point_count;
        channels_ = 3;
        for (const Attribute& attribute : mesh.attributes) channels_ += static_cast<std::size_t>(attribute.channels);
        in_.assign(channels_ * points * kTableLanes, 0.0);
        stride_ = points * kTableLanes;
        for (std::size_t lane = 0; lane < cells.size(); ++lane) {
            for (std::size_t p = 0; p < points; ++p) {
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

    void apply(const WeightTable& table) {
        rows_ = table.rows();
        out_.resize(channels_ * rows_ * kTableLanes);
        for (std::size_t c = 0; c < channels_; ++c) apply_table(table, &in_[c * stride_], &out_[c * rows_ * kTableLanes]);
    }

    /// The rows of one cell as its grid. turn: from the axes of the rows to those of the cell
    void store(std::size_t lane, std::size_t side, std::uint8_t turn, Grid& grid) const {
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

private:
    template <class T>
    using Aligned = std::vector<T, tbb::cache_aligned_allocator<T>>;
    std::size_t channels_ = 0, stride_ = 0, rows_ = 0;
    Aligned<double> in_, out_;
};

struct Scratch {
    Neighborhood found;
    LaneValues lanes;
    Grid grid;
};

/// Cells with their classes, and the memory of their points.
struct Classified {
    std::vector<Member> members;
    std::vector<std::vector<Index>> points;
};

constexpr ClassKey kNoClass{~std::uint64_t{0}, ~std::uint64_t{0}};

}  // namespace

struct CellRefiner::State {
    State(const HexMesh& mesh, const SchemeOptions& wanted, bool on_limit)
        : control(mesh),
          scheme(wanted),
          moves(on_limit && !interpolates(wanted.kind)),
          regular(regular_neighborhood()),
          regular_key(key_of(regular)),
          tables(wanted, moves ? [kind = wanted.kind](HexMesh m) { return subvol::on_limit(std::move(m), kind); }
                               : std::function<HexMesh(HexMesh)>()),
          top(control) {}

    /// One mesh whose cells are refined: the control mesh, or a patch of a level of it.
    struct Level {
        explicit Level(const HexMesh& of)
            : mesh(of), links(build_links(of)), walks([this] { return NeighborhoodWalk(mesh, links); }) {}
        const HexMesh& mesh;
        CellLinks links;
        tbb::enumerable_thread_specific<NeighborhoodWalk> walks;
    };
    /// Cuts a patch for some cells of a level.
    using Cut = std::function<Patch(std::span<const Index> cells, int layers)>;

    [[nodiscard]] int last_layers() const { return moves ? 1 : 0; }
    /// How many layers about a cell its refinement depends on.
    [[nodiscard]] int layers(int levels) const { return std::min(levels + last_layers(), 2); }

    /// The cells in their order with their classes, kNoClass where a class has too few members for a table.
    ///
    /// whole: up to so many levels only regular cells have a class
    [[nodiscard]] Classified classify(Level& level, std::span<const Index> cells, int levels, int whole = kWhole) const {
        constexpr std::size_t kRun = 256;
        Classified result{.members = std::vector<Member>(cells.size()),
                          .points = std::vector<std::vector<Index>>((cells.size() + kRun - 1) / kRun)};
        auto& members = result.members;
        for (std::size_t i = 0; i < cells.size(); ++i) members[i] = {kNoClass, cells[i]};
        if (levels == 0) return result;
        tbb::enumerable_thread_specific<Neighborhood> founds;
        tbb::parallel_for(std::size_t{0}, result.points.size(), [&](std::size_t r) {
            NeighborhoodWalk& walk = level.walks.local();
            Neighborhood& found = founds.local();
            std::vector<Index>& points = result.points[r];
            const std::size_t end = std::min(cells.size(), (r + 1) * kRun);
            for (std::size_t i = r * kRun; i < end; ++i) {
                const std::size_t before = points.size();
                points.resize(before + 216);
                if (layers(levels) == 2 && walk.find_regular(cells[i], std::span(points).subspan(before).first<216>())) {
                    members[i].key = regular_key;
                } else {
                    points.resize(before);
                    if (levels <= whole) continue;
                    if (!walk.find(cells[i], layers(levels), found)) continue;
                    members[i].key = key_of(found);
                    members[i].turn = found.turn;
                    points.insert(points.end(), found.points.begin(), found.points.end());
                }
                members[i].point_count = static_cast<std::uint16_t>(points.size() - before);
            }
            const Index* next = points.data();
            for (std::size_t i = r * kRun; i < end; ++i) {
                members[i].points = next;
                next += members[i].point_count;
            }
        });
        drop_rare(members, levels);
        return result;
    }

    /// Takes the class from members that are too few of a kind for a table.
    static void drop_rare(std::vector<Member>& members, int levels) {
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

    /// Up to kTableLanes cells of one class.
    void apply(Level& level, std::span<const Member> members, int levels, const DenseBlock& block, Scratch& to,
               const Sink& sink) {
        const auto table = tables.table(members[0].key, levels, [&]() -> const Neighborhood& {
            if (members[0].key == regular_key) return regular;
            (void)level.walks.local().find(members[0].cell, layers(levels), to.found);
            return to.found;
        });
        to.lanes.load(level.mesh, members);
        to.lanes.apply(*table);
        to.grid.resize(level.mesh, block.node_count());
        for (std::size_t lane = 0; lane < members.size(); ++lane) {
            to.lanes.store(lane, block.side(), members[lane].turn, to.grid);
            sink(members[lane].cell, to.grid);
        }
    }

    /// The last level: the vertices are read off.
    void read_off(Patch patch, std::span<const Index> cells, int levels, const Sink& sink) {
        for (int level = levels; level > 0; --level) patch = refine_patch(patch, scheme, layers(level - 1));
        if (moves) patch.mesh = on_limit(std::move(patch.mesh), scheme.kind);
        const DenseBlock block(levels);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 64), [&](const auto& range) {
            Grid grid;
            grid.resize(patch.mesh, block.node_count());
            std::vector<Index> nodes;
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                block.nodes(patch.mesh, i << (3 * levels), nodes);
                for (std::size_t n = 0; n < nodes.size(); ++n) grid.take(patch.mesh, n, nodes[n]);
                sink(cells[i], grid);
            }
        });
    }

    /// A batch of cells without a table: one level of refinement, and their children in their place.
    void refine_batch(const Cut& cut, std::span<const Index> cells, int levels, const Sink& sink) {
        Patch patch = cut(cells, layers(levels));
        if (levels <= 1) return read_off(std::move(patch), cells, levels, sink);
        patch = refine_patch(patch, scheme, 2);
        Level level(patch.mesh);
        const Cut cut_patch = [&](std::span<const Index> wanted, int layers) { return sub_patch(patch, wanted, layers); };
        std::vector<Index> children(8 * cells.size());
        for (std::size_t i = 0; i < children.size(); ++i) children[i] = static_cast<Index>(i);
        const Classified classified = classify(level, children, levels - 1, 0);

        const std::size_t half = std::size_t{1} << (levels - 1), nodes = (2 * half + 1) * (2 * half + 1) * (2 * half + 1);
        std::size_t channels = 3;
        for (const Attribute& attribute : patch.mesh.attributes) channels += static_cast<std::size_t>(attribute.channels);
        const std::size_t group = std::clamp<std::size_t>(kGroupBytes / (nodes * channels * sizeof(double)), 1, cells.size());
        for (std::size_t first = 0; first < cells.size(); first += group) {
            const std::size_t count = std::min(group, cells.size() - first);
            std::vector<Grid> grids(count);
            for (Grid& one : grids) one.resize(patch.mesh, nodes);
            const auto members = std::span(classified.members).subspan(8 * first, 8 * count);
            evaluate(level, cut_patch, {members.begin(), members.end()}, levels - 1,
                     [&](Index child, const Grid& part) { put(part, child % 8, half, grids[child / 8 - first]); });
            parallel_each(count, [&](std::size_t i) { sink(cells[first + i], grids[i]); });
        }
    }

    /// Writes the grid of a child into that of its parent. Children share nodes on the planes between them: a child writes
    /// those of its lower sides, and at the parent's own upper sides the upper ones too.
    static void put(const Grid& part, std::size_t child, std::size_t half, Grid& whole) {
        const std::size_t side = 2 * half + 1;
        const auto& at = kCornerParameters[child];
        std::array<std::size_t, 3> ends, start;
        for (std::size_t d = 0; d < 3; ++d) {
            ends[d] = half + (at[d] == 1 ? 1 : 0);
            start[d] = at[d] == 1 ? half : 0;
        }
        for (std::size_t w = 0; w < ends[2]; ++w) {
            for (std::size_t v = 0; v < ends[1]; ++v) {
                const std::size_t from = (half + 1) * (v + (half + 1) * w);
                const std::size_t to = start[0] + side * (v + start[1] + side * (w + start[2]));
                std::copy_n(part.points.begin() + static_cast<std::ptrdiff_t>(from), ends[0],
                            whole.points.begin() + static_cast<std::ptrdiff_t>(to));
                for (std::size_t a = 0; a < part.values.size(); ++a) {
                    const std::size_t channels = part.values[a].size() / part.points.size();
                    std::copy_n(part.values[a].begin() + static_cast<std::ptrdiff_t>(from * channels), ends[0] * channels,
                                whole.values[a].begin() + static_cast<std::ptrdiff_t>(to * channels));
                }
            }
        }
    }

    /// Evaluates cells by their classes' tables; those without a class are refined, in batches of neighbours.
    void evaluate(Level& level, const Cut& cut, const Classified& classified, int levels, const Sink& sink) {
        evaluate(level, cut, classified.members, levels, sink);
    }
    void evaluate(Level& level, const Cut& cut, std::vector<Member> members, int levels, const Sink& sink) {
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
        // Larger batches have fewer cells around them that are refined too, smaller ones need less memory.
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

    /// Some cells, and those of their children that the visitor asks for.
    ///
    /// is_open: flags of cells that the visitor has seen at level 1 already, and wants finer
    void descend_batch(const Cut& cut, std::span<const Index> cells, const std::vector<std::uint8_t>& is_open, int most_levels,
                       const Descent& visitor) {
        Patch patch = refine_patch(cut(cells, 2), scheme, 2);
        const std::vector<Index> open = visit_first_level(patch, cells, is_open, visitor);
        if (open.empty() || most_levels < 2) return;
        std::vector<Index> children;
        for (const Index cell : open) {
            for (Index k = 0; k < 8; ++k) children.push_back(8 * cell + k);
        }
        if (open.size() < cells.size()) patch = sub_patch(patch, children, 2);
        for (std::size_t i = 0; i < children.size(); ++i) children[i] = static_cast<Index>(i);
        Level level(patch.mesh);
        const Cut cut_patch = [&](std::span<const Index> wanted, int layers) { return sub_patch(patch, wanted, layers); };
        const auto parent = [&](Index child) { return cells[open[child / 8]]; };

        std::vector<Grid> grids(open.size());
        parallel_each(grids.size(), [&](std::size_t i) { grids[i].resize(patch.mesh, 125); });
        evaluate(level, cut_patch, classify(level, children, 1, 0), 1,
                 [&](Index child, const Grid& part) { put(part, child % 8, 2, grids[child / 8]); });
        std::vector<std::uint8_t> goes_on(children.size());
        parallel_each(open.size(), [&](std::size_t i) {
            const std::uint8_t wanted = visitor.whole(dense_cell(cells[open[i]], 2, grids[i]));
            for (std::size_t k = 0; k < 8; ++k) goes_on[8 * i + k] = wanted >> k & 1;
        });
        grids.clear();

        Classified classified;
        for (int levels = 2; levels < most_levels; ++levels) {
            std::erase_if(children, [&](Index child) { return goes_on[child] == 0; });
            if (children.empty()) return;
            if (levels == 2) {
                classified = classify(level, children, levels, 0);
            } else {
                std::erase_if(classified.members, [&](const Member& member) { return goes_on[member.cell] == 0; });
                if (levels > kMostTableLevels) {
                    for (Member& member : classified.members) member.key = kNoClass;
                }
                drop_rare(classified.members, levels);
            }
            evaluate(level, cut_patch, classified, levels, [&](Index child, const Grid& part) {
                goes_on[child] = visitor.part(dense_cell(parent(child), levels, part), child % 8, levels) ? 1 : 0;
            });
        }
    }

    /// Shows the visitor the cells of a patch of their children that it has not seen yet. Returns places in `cells` of those
    /// that it wants finer, and of those that are open already.
    [[nodiscard]] std::vector<Index> visit_first_level(const Patch& patch, std::span<const Index> cells,
                                                       const std::vector<std::uint8_t>& is_open, const Descent& visitor) const {
        std::vector<std::uint8_t> wanted(cells.size());
        HexMesh moved;
        if (moves) moved = on_limit(patch.mesh, scheme.kind);
        const HexMesh& mesh = moves ? moved : patch.mesh;
        const DenseBlock block(1);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 64), [&](const auto& range) {
            Grid grid;
            grid.resize(mesh, block.node_count());
            std::vector<Index> nodes;
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                if (is_open[cells[i]] != 0) {
                    wanted[i] = 1;
                    continue;
                }
                block.nodes(mesh, 8 * i, nodes);
                for (std::size_t n = 0; n < nodes.size(); ++n) grid.take(mesh, n, nodes[n]);
                wanted[i] = visitor.cell(dense_cell(cells[i], 1, grid)) ? 1 : 0;
            }
        });
        std::vector<Index> open;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            if (wanted[i] != 0) open.push_back(static_cast<Index>(i));
        }
        return open;
    }

    /// Regular cells have one table for all; the others are refined in batches of neighbours.
    void descend(int most_levels, Progress* progress, const Descent& visitor) {
        std::vector<Index> cells(control.cells.size());
        std::iota(cells.begin(), cells.end(), Index{0});
        std::vector<std::uint8_t> is_open(cells.size(), 0), is_done(cells.size(), 0);
        for (std::size_t first = 0; first < cells.size(); first += kClassified) {
            const auto run = std::span(cells).subspan(first, std::min(kClassified, cells.size() - first));
            Classified classified = classify(top, run, 2);
            std::erase_if(classified.members, [](const Member& member) { return member.key == kNoClass; });
            evaluate(top, {}, classified, 1, [&](Index cell, const Grid& grid) {
                (visitor.cell(dense_cell(cell, 1, grid)) ? is_open : is_done)[cell] = 1;
            });
        }
        std::erase_if(cells, [&](Index cell) { return is_done[cell] != 0; });
        cells = in_space_order(control, cells);
        const Cut cut = cut_of_control();
        constexpr std::size_t kMost = 8192;
        const std::size_t batches = (cells.size() + kMost - 1) / kMost;
        std::atomic<std::size_t> done{0};
        tbb::parallel_for(std::size_t{0}, batches, [&](std::size_t b) {
            report_progress(progress, "limit", static_cast<double>(done) / static_cast<double>(batches));
            const std::size_t first = b * cells.size() / batches, last = (b + 1) * cells.size() / batches;
            run_nested(
                [&] { descend_batch(cut, std::span(cells).subspan(first, last - first), is_open, most_levels, visitor); });
            ++done;
        });
        report_progress(progress, "limit", 1);
    }

    [[nodiscard]] Cut cut_of_control() {
        return [this](std::span<const Index> wanted, int layers) {
            std::call_once(patches_made, [&] { run_nested([&] { patches = std::make_unique<PatchSource>(control); }); });
            return patches->cut(wanted, layers);
        };
    }

    static DenseCell dense_cell(Index cell, int levels, const Grid& grid) {
        DenseCell dense{.cell = cell, .side = (std::size_t{1} << levels) + 1, .points = grid.points, .values = {}};
        dense.values.assign(grid.values.begin(), grid.values.end());
        return dense;
    }

    static std::vector<Index> in_space_order(const HexMesh& mesh, std::span<const Index> cells) {
        std::vector<Vec3> centers(cells.size());
        parallel_each(cells.size(), [&](std::size_t i) {
            const auto& corners = mesh.cells[cells[i]];
            centers[i] = 0.5 * (mesh.points[corners[0]] + mesh.points[corners[6]]);
        });
        std::vector<Index> ordered = space_order(centers);
        for (Index& i : ordered) i = cells[i];
        return ordered;
    }

    const HexMesh& control;
    SchemeOptions scheme;
    bool moves;
    Neighborhood regular;
    ClassKey regular_key;
    ClassTables tables;
    Level top;
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
                           const std::function<void(const DenseCell&)>& visit) const {
    State& state = *state_;
    const State::Cut cut = state.cut_of_control();
    const Sink sink = [&](Index cell, const Grid& grid) { visit(State::dense_cell(cell, levels, grid)); };
    std::vector<Index> ordered;
    if (cells.size() > kClassified) {
        ordered = State::in_space_order(state.control, cells);
        cells = ordered;
    }
    for (std::size_t first = 0; first < cells.size(); first += kClassified) {
        report_progress(progress, "dense cells", static_cast<double>(first) / static_cast<double>(cells.size()));
        const auto batch = cells.subspan(first, std::min(kClassified, cells.size() - first));
        const Classified classified = state.classify(state.top, batch, levels);
        state.evaluate(state.top, cut, classified.members, levels, sink);
    }
    report_progress(progress, "dense cells", 1);
}

void CellRefiner::descend(int most_levels, Progress* progress, const Descent& visitor) const {
    report_progress(progress, "limit", 0);
    state_->descend(most_levels, progress, visitor);
}

}  // namespace subvol::detail
