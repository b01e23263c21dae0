// SPDX-License-Identifier: Apache-2.0
// From the class of a cell to the classes of its children, without any mesh.
//
// A neighbourhood's code is a mesh (patch_of). Refined once without positions, it shows how the cells around each child meet,
// and so which class the child belongs to:
//
//     across an edge ● at which three cells meet          the children of P
//
//            \        /                                   ┌───┬───┐     P: the class of the parent again, since the edge
//             \  P   /                                    │ o │ o │        still has three cells
//              \    /                                     ├───┼───┤     o: one or two cells away from the edge: a few other
//               ●──────                                   │ P │ o │        classes. Their children are farther away, in cells,
//               |                                         ●───┴───┘        and become regular after a level or two
//
// so the graph closes after a few classes, however many levels a walk goes down. The weights of a child's points over those of
// the parent come from the same refinement (SchemeRows).
//
// Each class is made by the thread that needs it first, from the code alone, and never changes; so it does not matter which
// thread that is. std::call_once lets the others wait. run_nested keeps a waiting thread from taking up work that would wait
// for the same class.
#include "class_graph.h"

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>

#include "run_nested.h"
#include "subvol/cell.h"
#include "subvol/detail/child_topology.h"
#include "subvol/detail/scheme_rows.h"
#include "subvol/detail/topology_parts.h"

namespace subvol::detail {

namespace {

/// One refinement of a neighbourhood, without places: the children of the cells whose rules see all that they need.
class RefinedNeighborhood {
public:
    /// cells: so many of the walk's cells are refined
    RefinedNeighborhood(const Neighborhood& about, std::size_t cells)
        : topology_(build_topology(patch_of(about).mesh, InteriorCreases::Ignore)) {
        child_.points.resize(ChildNumbering(topology_).end);
        for (std::size_t c = 0; c < cells; ++c) {
            const auto children = split_lattice(lattice_points(topology_, static_cast<Index>(c)));
            child_.cells.insert(child_.cells.end(), children.begin(), children.end());
        }
        child_.creases = child_creases(topology_);
        child_.sharp_faces = child_sharp_faces(topology_);
        links_ = build_links(child_);
        walk_.emplace(child_, links_);
    }

    /// The neighbourhood of a child of the walk's first cell. False if it has none.
    ///
    /// regular: whether `found` has the points of NeighborhoodWalk::find_regular, and nothing else
    [[nodiscard]] bool find(std::size_t octant, Neighborhood& found, bool& regular) {
        const auto cell = static_cast<Index>(kCornerOctants[octant]);
        found.points.resize(216);
        regular = walk_->find_regular(cell, std::span(found.points).first<216>());
        found.turn = kIdentityTurn;
        return regular || walk_->find(cell, 2, found);
    }

    [[nodiscard]] const Topology& parent() const { return topology_; }
    [[nodiscard]] const HexMesh& child() const { return child_; }

private:
    Topology topology_;
    HexMesh child_;
    CellLinks links_;
    std::optional<NeighborhoodWalk> walk_;
};

/// A value that is made once, by the thread that asks first.
template <class Value>
struct Made {
    std::once_flag once;
    Value value;
};

}  // namespace

struct ClassGraph::State {
    explicit State(const SchemeOptions& wanted) : scheme(wanted) {
        regular.about = regular_neighborhood();
        regular.on_grid = true;
        for (std::size_t n = 0; n < 64; ++n) {
            const std::size_t u = 1 + n % 4, v = 1 + n / 4 % 4, w = 1 + n / 16;
            regular.grid[n] = static_cast<Index>(u + 6 * (v + 6 * w));
        }
    }

    /// The place for a value. The lock is for the map alone: nodes of a std::map stay where they are, so values are made
    /// without it.
    template <class Key, class Value>
    Made<Value>& slot(std::map<Key, Made<Value>>& map, const Key& key) {
        const std::scoped_lock lock(mutex);
        return map[key];
    }

    /// The class keeps its code and its number of points; the points are numbered as the walk numbers them.
    const DescentClass* class_of(const Neighborhood& found) {
        Made<DescentClass>& made = slot(classes, key_of(found));
        std::call_once(made.once, [&] {
            DescentClass& is = made.value;
            is.about = {.turn = kIdentityTurn, .points = std::vector<Index>(found.points.size()), .code = found.code};
            std::iota(is.about.points.begin(), is.about.points.end(), Index{0});
            const Topology topology = build_topology(patch_of(is.about).mesh, InteriorCreases::Ignore);
            is.on_grid = regular_grid(topology, 0, is.grid);
            bytes += sizeof(DescentClass) + found.points.size() * sizeof(Index) + found.code.size() * sizeof(found.code[0]);
        });
        return &made.value;
    }

    /// Children of all octants share points, so the rows of all are made once, in one block, and each child's tables pick
    /// theirs: `near` the points that a place is evaluated from (64 of a grid, else its eight corners), `rest` the others.
    void make_children(const DescentClass& parent, ClassChildren& made) {
        RefinedNeighborhood refined(parent.about, parent.about.code[0]);
        const SchemeRows rows(refined.parent(), scheme);
        StencilBuilder row;
        StencilBlockWriter block;  // of all their points, each once
        block.start(0);
        std::array<std::vector<StepTable::Row>, 8> near_rows, rest_rows;
        std::vector<Index> row_of(refined.child().points.size(), kNone);
        Neighborhood found;
        for (std::size_t octant = 0; octant < 8; ++octant) {
            bool is_regular = false;
            if (!refined.find(octant, found, is_regular)) continue;
            ClassChildren::Child& child = made.children[octant];
            child.to = is_regular ? &regular : class_of(found);
            child.turn = found.turn;
            std::vector<std::uint8_t> is_near(found.points.size(), 0);
            if (child.to->on_grid) {
                for (const Index p : child.to->grid) {
                    if (p != kNone) is_near[p] = 1;
                }
            } else {
                std::fill_n(is_near.begin(), 8, std::uint8_t{1});
            }
            std::vector<StepTable::Row>& near = near_rows[octant];
            std::vector<StepTable::Row>& rest = rest_rows[octant];
            for (std::size_t p = 0; p < found.points.size(); ++p) {
                const Index point = found.points[p];
                if (row_of[point] == kNone) {
                    row_of[point] = static_cast<Index>(block.block().row_patterns.size());
                    row.clear();
                    point < rows.kept() ? row.add(point, 1) : rows.write_row(point, row);
                    block.push(row.finish());
                }
                (is_near[p] != 0 ? near : rest).push_back({row_of[point], static_cast<std::uint16_t>(p)});
            }
        }
        for (std::size_t octant = 0; octant < 8; ++octant) {
            ClassChildren::Child& child = made.children[octant];
            child.near = StepTable(block.block(), near_rows[octant]);
            child.rest = StepTable(block.block(), rest_rows[octant]);
            bytes += sizeof(child) + child.near.bytes() + child.rest.bytes();
        }
    }

    /// No weights here: the mesh has been refined twice, so the points of the children are there, as corners of cells that the
    /// walk around the parent can name.
    void make_entry(const Neighborhood& about, ClassEntry& entry) {
        RefinedNeighborhood refined(about, about.code[0]);
        entry.on_grid = regular_grid(refined.parent(), 0, entry.grid);
        std::vector<ClassEntry::Corner> corner_of(refined.child().points.size());
        for (std::size_t c = 0; c < refined.child().cells.size(); ++c) {
            for (std::size_t k = 0; k < 8; ++k) {
                corner_of[refined.child().cells[c][k]] = {static_cast<std::uint16_t>(c / 8),
                                                          static_cast<std::uint8_t>(kCornerOctants[c % 8]),
                                                          static_cast<std::uint8_t>(kCornerOctants[k])};
            }
        }
        Neighborhood found;
        std::vector<Index> row_of(refined.child().points.size(), kNone);
        for (std::size_t octant = 0; octant < 8; ++octant) {
            bool is_regular = false;
            if (!refined.find(octant, found, is_regular)) continue;
            ClassEntry::Child& child = entry.children[octant];
            child.to = is_regular ? &regular : class_of(found);
            child.turn = found.turn;
            for (const Index p : found.points) {
                if (row_of[p] == kNone) {
                    row_of[p] = static_cast<Index>(entry.points.size());
                    entry.points.push_back(corner_of[p]);
                }
                child.rows.push_back(static_cast<std::uint16_t>(row_of[p]));
            }
            bytes += sizeof(child) + child.rows.size() * sizeof(child.rows[0]);
        }
        bytes += entry.points.size() * sizeof(ClassEntry::Corner);
    }

    SchemeOptions scheme;
    DescentClass regular;
    std::mutex mutex;
    std::map<ClassKey, Made<DescentClass>> classes;
    std::map<const DescentClass*, Made<ClassChildren>> children_of;
    std::map<ClassKey, Made<ClassEntry>> entries;
    std::atomic<std::size_t> bytes{0};
};

ClassGraph::ClassGraph(const SchemeOptions& scheme) : state_(std::make_unique<State>(scheme)) {
}
ClassGraph::~ClassGraph() = default;

const DescentClass& ClassGraph::regular() const {
    return state_->regular;
}

const DescentClass& ClassGraph::class_of(const Neighborhood& about) {
    const DescentClass* found = nullptr;
    run_nested([&] { found = state_->class_of(about); });
    return *found;
}

const ClassChildren& ClassGraph::children(const DescentClass& parent) {
    if (const auto* children = parent.children.load(std::memory_order_acquire)) return *children;
    auto& made = state_->slot(state_->children_of, &parent);
    std::call_once(made.once, [&] { run_nested([&] { state_->make_children(parent, made.value); }); });
    parent.children.store(&made.value, std::memory_order_release);
    return made.value;
}

const ClassEntry& ClassGraph::entry(const Neighborhood& about) {
    auto& made = state_->slot(state_->entries, key_of(about));
    std::call_once(made.once, [&] { run_nested([&] { state_->make_entry(about, made.value); }); });
    return made.value;
}

std::size_t ClassGraph::bytes() const {
    return state_->bytes;
}

}  // namespace subvol::detail
