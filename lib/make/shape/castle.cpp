// SPDX-License-Identifier: Apache-2.0
#include "castle.h"

#include <algorithm>
#include <span>

#include "subvol/topology.h"

namespace subvol::detail {

namespace {

/// Chosen cells and those around them.
class Castle {
public:
    Castle(const HexMesh& mesh, const std::vector<float>& likeness, std::vector<std::uint8_t>& chosen,
           std::span<const std::uint8_t> fixed)
        : topology_(build_topology(mesh)),
          likeness_(likeness),
          chosen_(chosen),
          fixed_(fixed.begin(), fixed.end()),
          cells_at_(mesh.points.size()) {
        fixed_.resize(chosen.size(), 0);
        for (Index c = 0; c < chosen.size(); ++c) {
            for (const Index p : mesh.cells[c]) {
                cells_at_[p].push_back(c);
                if (topology_.point_on_boundary[p] != 0) fixed_[c] = 1;
            }
        }
    }

    [[nodiscard]] std::size_t points() const { return cells_at_.size(); }
    [[nodiscard]] bool mixed(Index point) const {
        return std::ranges::any_of(cells_at_[point], [&](Index c) { return chosen_[c] != chosen_[cells_at_[point].front()]; });
    }

    /// The cell that is added next for the boundary to be a surface at a point and its edges; kNone if none is needed, or can
    /// be.
    Index added_at(Index point) {
        for (const Index e : topology_.point_edges[point]) {
            std::size_t sides = 0;
            for (const Index f : topology_.edge_faces[e]) sides += parting(f) ? 1 : 0;
            if (sides > 2) return added_among(topology_.edge_cells[e]);
        }
        if (joined_at(point, 1) && joined_at(point, 0)) return kNone;
        return added_among(cells_at_[point]);
    }

    [[nodiscard]] std::span<const Index> points_of(Index cell) const { return topology_.cells[cell]; }

private:
    [[nodiscard]] bool parting(Index face) const {
        const auto [a, b] = topology_.face_cells[face];
        return b != kNone && chosen_[a] != chosen_[b];
    }

    /// Whether the cells about a point that are chosen, or those that are not, are joined by their faces there.
    [[nodiscard]] bool joined_at(Index point, std::uint8_t chosen) const {
        std::vector<Index> cells;
        for (const Index c : cells_at_[point]) {
            if (chosen_[c] == chosen) cells.push_back(c);
        }
        if (cells.empty()) return true;
        std::vector<Index> reached{cells.front()};
        for (std::size_t k = 0; k < reached.size(); ++k) {
            for (const Index f : topology_.cell_faces[reached[k]]) {
                for (const Index next : topology_.face_cells[f]) {
                    const bool here = next != kNone && std::ranges::count(cells, next) > 0 &&
                                      std::ranges::count(topology_.faces[f], point) > 0;
                    if (here && std::ranges::count(reached, next) == 0) reached.push_back(next);
                }
            }
        }
        return reached.size() == cells.size();
    }

    Index added_among(std::span<const Index> cells) {
        Index best = kNone;
        for (const Index c : cells) {
            if (chosen_[c] != 0 || fixed_[c] != 0) continue;
            if (best == kNone || likeness_[c] > likeness_[best]) best = c;
        }
        if (best != kNone) chosen_[best] = 1;
        return best;
    }

    Topology topology_;
    const std::vector<float>& likeness_;
    std::vector<std::uint8_t>& chosen_;
    std::vector<std::uint8_t> fixed_;
    std::vector<std::vector<Index>> cells_at_;
};

}  // namespace

std::size_t make_manifold(const HexMesh& mesh, const std::vector<float>& likeness, std::vector<std::uint8_t>& chosen,
                          std::span<const std::uint8_t> fixed) {
    Castle castle(mesh, likeness, chosen, fixed);
    std::vector<Index> left;
    for (auto p = static_cast<Index>(castle.points()); p-- > 0;) {
        if (castle.mixed(p)) left.push_back(p);
    }
    // Cells are only ever added, so this ends.
    std::size_t added = 0;
    while (!left.empty()) {
        const Index p = left.back();
        left.pop_back();
        const Index cell = castle.added_at(p);
        if (cell == kNone) continue;
        ++added;
        left.push_back(p);
        for (const Index next : castle.points_of(cell)) left.push_back(next);
    }
    return added;
}

}  // namespace subvol::detail
