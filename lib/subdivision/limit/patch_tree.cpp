// SPDX-License-Identifier: Apache-2.0
// Patches of patches. A node is a patch of one level with two layers around its wanted cells, which are enough for any number
// of levels: a rule uses the cells around a point, and each refinement spends one layer of cells, which is two layers of
// children.
//
//     level 0     the control cells of the places: one patch
//     level 1     the children of those cells whose places are still open: one patch (refine_patch of sub_patch)
//     level 2 …   likewise; a place whose surroundings have a class by now goes on there
//
// A later call, or a later place, finds the children of a cell where an earlier one has made them; what is missing is refined
// as one more patch. The points of a cell have the same bits in whichever patch it is refined, so results do not depend on what
// was there before.
#include "patch_tree.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "jets.h"
#include "run_nested.h"
#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/topology_parts.h"

namespace subvol::detail {

namespace {

// Larger classes are those of cells next to the axis: their tables have a row for each cell around it, which the patch has
// anyway, and one level further down there are no such cells but those at the axis.
constexpr std::size_t kMostPointsOfClass = 600;
constexpr std::size_t kPlacesOfPart = std::size_t{1} << 17;       // whose jets are kept at a time
constexpr std::size_t kMostBytesOfTree = std::size_t{256} << 20;  // of what is kept between calls

}  // namespace

/// A patch with what its wanted cells are evaluated from.
struct PatchTree::Node {
    Node(Patch with, int at_level, std::size_t stride) : patch(std::move(with)), level(at_level), children(patch.wanted) {
        const Topology topology = build_topology(patch.mesh, InteriorCreases::Ignore);
        // The patch ends after the second layer: a colour of one round depends on the cells at the point alone.
        links = build_links(patch.mesh, topology, 1);
        rows.resize(patch.mesh.points.size() * stride);
        parallel_each(patch.mesh.points.size(),
                      [&](std::size_t p) { Channels::read(patch.mesh, static_cast<Index>(p), &rows[p * stride]); });
        grids.resize(patch.wanted);
        regular.resize(patch.wanted);
        parallel_each(patch.wanted,
                      [&](std::size_t c) { regular[c] = regular_grid(topology, static_cast<Index>(c), grids[c]) ? 1 : 0; });
    }

    [[nodiscard]] std::size_t bytes() const {
        const HexMesh& mesh = patch.mesh;
        return mesh.cells.size() * (sizeof(mesh.cells[0]) + sizeof(links.neighbors[0]) + sizeof(links.turns[0])) +
               mesh.points.size() * 2 * sizeof(Vec3) + 2 * rows.size() * sizeof(double) + grids.size() * sizeof(grids[0]);
    }

    Patch patch;
    int level;
    CellLinks links;
    std::vector<double> rows;  // the channels of the points
    std::vector<GridPoints> grids;
    std::vector<std::uint8_t> regular;  // whether a wanted cell has a grid
    std::vector<Child> children;        // of the wanted cells, as far as they have been refined
};

/// cell: the wanted cell of the node in which the place lies; left: the level at which the classes left it
struct PatchTree::Place {
    Index cell;
    int left;
    OpenPlace open;
};

/// What a call works with.
struct PatchTree::Task {
    /// Of each thread: what is at work on the places of one cell.
    struct Worker {
        explicit Worker(const Task& task)
            : descents(task.of_call),
              settling(task.of_call.options, task.of_call.scales, task.stride, task.of_call.samples),
              jets(task.of_call.options.scheme.kind, task.stride),
              jet(4 * task.stride) {}

        DescentWorker descents;
        Settling settling;
        CellJets jets;
        std::vector<double> jet;
        std::vector<OpenPlace> places{};
    };

    Task(const DescentTask& call, ClassGraph& with)
        : of_call(call), classes(with), stride(call.channels.stride()), workers([this] { return Worker(*this); }) {}

    const DescentTask& of_call;
    ClassGraph& classes;
    std::size_t stride;
    std::vector<double> lasts{};  // the jets of the places
    tbb::enumerable_thread_specific<Worker> workers;
};

PatchTree::PatchTree(const HexMesh& control, const SchemeOptions& scheme) : control_(control), scheme_(scheme) {
}
PatchTree::~PatchTree() = default;

std::vector<LeftPlace> PatchTree::run(const DescentTask& task, std::span<const LeftPlace> places, ClassGraph& classes) {
    const std::scoped_lock lock(mutex_);
    std::vector<LeftPlace> left;
    run_nested([&] {  // a thread that waits in it must not take work that waits for the lock
        if (!source_) source_ = std::make_unique<PatchSource>(control_);
        control_cells_.resize(control_.cells.size());
        Task work(task, classes);
        for (std::size_t first = 0; first < places.size(); first += kPlacesOfPart) {
            run_part(work, places.subspan(first, std::min(kPlacesOfPart, places.size() - first)));
        }
        for (Task::Worker& worker : work.workers) {
            add_report(worker.settling.report(), task.samples.report);
            add_report(worker.descents.report(), task.samples.report);
            left.insert(left.end(), worker.descents.left().begin(), worker.descents.left().end());
        }
    });
    if (bytes_ > kMostBytesOfTree) {
        nodes_.clear();
        control_cells_.clear();
        bytes_ = 0;
    }
    std::ranges::sort(left);
    return left;
}

PatchTree::Node* PatchTree::add_node(Patch patch, int level) {
    nodes_.push_back(std::make_unique<Node>(std::move(patch), level, Channels(control_).stride()));
    bytes_ += nodes_.back()->bytes();
    return nodes_.back().get();
}

namespace {

/// Calls visit(node, places) for the places of each node that they go to, in the order of the nodes' first places.
template <class Places, class NodeOf, class Visit>
void each_node(Places& places, const NodeOf& node_of, const Visit& visit) {
    while (!places.empty()) {
        const auto node = node_of(places.front());
        const auto others =
            std::stable_partition(places.begin(), places.end(), [&](const auto& place) { return node_of(place) == node; });
        Places of_node(places.begin(), others);
        places.erase(places.begin(), others);
        visit(*node, of_node);
    }
}

}  // namespace

void PatchTree::run_part(Task& task, std::span<const LeftPlace> left) {
    const DescentTask& call = task.of_call;
    task.lasts.resize(left.size() * 4 * task.stride);
    std::vector<Index> missing;
    for (const LeftPlace& one : left) {
        const Index cell = call.queries[one.query].cell;
        if (control_cells_[cell].node == nullptr) missing.push_back(cell);
    }
    std::ranges::sort(missing);
    missing.erase(std::unique(missing.begin(), missing.end()), missing.end());
    if (!missing.empty()) {
        Node* const node = add_node(source_->cut(missing, 2), 0);
        for (std::size_t i = 0; i < missing.size(); ++i) control_cells_[missing[i]] = {node, static_cast<Index>(i)};
    }
    std::vector<Place> places;
    for (std::size_t i = 0; i < left.size(); ++i) {
        const auto& [query, level] = left[i];
        const auto& [cell, uvw] = call.queries[query];
        places.push_back({cell, level, {.query = query, .uvw = uvw, .last = &task.lasts[i * 4 * task.stride]}});
    }
    each_node(
        places, [&](const Place& place) { return control_cells_[place.cell].node; },
        [&](Node& node, std::vector<Place>& inside) {
            for (Place& place : inside) place.cell = control_cells_[place.cell].first;
            visit(node, inside, task);
        });
}

/// Evaluates places in cells of a node, and in their descendants.
void PatchTree::visit(Node& node, std::vector<Place>& places, Task& task) {
    const auto key = [](const Place& place) { return std::pair(place.cell, place.left); };
    std::ranges::stable_sort(places, {}, key);
    std::vector<std::array<std::size_t, 2>> cells;  // the places of each
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (i == 0 || key(places[i]) != key(places[i - 1])) cells.push_back({i, i});
        cells.back()[1] = i + 1;
    }
    const LimitOptions& options = task.of_call.options;
    const bool spline = !interpolates(options.scheme.kind), linear = options.scheme.kind == Scheme::Linear;
    tbb::enumerable_thread_specific<NeighborhoodWalk> walks([&] { return NeighborhoodWalk(node.patch.mesh, node.links); });
    tbb::enumerable_thread_specific<Neighborhood> abouts;
    const auto run_cell = [&](std::span<Place> inside, Task::Worker& with) {
        const Index cell = inside[0].cell;
        with.settling.report().deepest_level = std::max(with.settling.report().deepest_level, node.level);
        if (node.level > 0 && node.level >= inside[0].left) {
            Neighborhood& about = abouts.local();
            if (walks.local().find(cell, 2, about) && about.points.size() <= kMostPointsOfClass) {
                with.places.clear();
                for (Place& place : inside) with.places.push_back(place.open);
                double* to = with.descents.values(node.level, about.points.size());
                for (const Index p : about.points) to = copy_row(&node.rows[p * task.stride], task.stride, to);
                with.descents.begin(task.classes.class_of(about), about.turn, node.level, with.places, task.classes);
                for (Place& place : inside) place.cell = kNone;
                return;
            }
        }
        const bool regular = !linear && node.regular[cell] != 0;
        if (regular) {
            with.jets.load_grid(node.rows.data(), node.grids[cell]);
        } else {
            std::array<Index, 8> corners;
            for (std::size_t k = 0; k < 8; ++k) corners[k] = node.patch.mesh.cells[cell][kCornerOctants[k]];
            with.jets.load_corners(node.rows.data(), corners);
        }
        for (Place& place : inside) {
            with.jets.evaluate(place.open.uvw, std::ldexp(1.0, node.level), with.jet.data());
            if (with.settling.settle(place.open, with.jet.data(), node.level, regular, linear || (regular && spline))) {
                place.cell = kNone;
            }
        }
    };
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cells.size(), 4), [&](const auto& range) {
        Task::Worker& with = task.workers.local();
        for (std::size_t i = range.begin(); i != range.end(); ++i) {
            run_cell(std::span(places).subspan(cells[i][0], cells[i][1] - cells[i][0]), with);
        }
    });
    std::erase_if(places, [](const Place& place) { return place.cell == kNone; });
    if (!places.empty()) descend(node, places, task);
}

/// From the places that are open in a node to the children of their cells.
void PatchTree::descend(Node& node, std::vector<Place>& places, Task& task) {
    std::vector<Index> missing;  // the places are sorted by cells
    for (const Place& place : places) {
        if (node.children[place.cell].node != nullptr || (!missing.empty() && missing.back() == place.cell)) continue;
        missing.push_back(place.cell);
    }
    if (!missing.empty()) {
        Node* const child = add_node(refine_patch(sub_patch(node.patch, missing, 2), scheme_, 2), node.level + 1);
        for (std::size_t i = 0; i < missing.size(); ++i) node.children[missing[i]] = {child, static_cast<Index>(8 * i)};
    }
    each_node(
        places, [&](const Place& place) { return node.children[place.cell].node; },
        [&](Node& child, std::vector<Place>& inside) {
            for (Place& place : inside) {
                place.open.step_down();
                place.cell = node.children[place.cell].first + static_cast<Index>(kCornerOctants[place.open.octant]);
            }
            visit(child, inside, task);
        });
}

}  // namespace subvol::detail
