// SPDX-License-Identifier: Apache-2.0
#include "layers.h"

#include <algorithm>

#include "subvol/cell.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

/// The cells at the boundary, each with its corners as they will be: of the cells about a point those that cuts or other cells
/// part have points of their own.
class OuterCells {
public:
    OuterCells(const Topology& topology, std::span<const std::array<Index, 2>> cuts) : topology_(topology) {
        outer_.resize(topology.cells.size());
        for (Index c = 0; c < outer_.size(); ++c) {
            outer_[c] = std::ranges::any_of(topology.cell_faces[c], [&](Index f) { return topology.face_on_hull(f); }) ? 1 : 0;
        }
        parting_.assign(topology.faces.size(), 0);
        for (Index f = 0; f < parting_.size(); ++f) {
            if (topology.face_on_hull(f)) continue;
            const auto [a, b] = topology.face_cells[f];
            parting_[f] = outer_[a] != outer_[b] ? 1 : 0;
        }
        for (const auto& [a, b] : cuts) {
            for (const Index f : topology.edge_faces[*topology.find_edge(a, b)]) {
                if (!topology.face_on_hull(f)) parting_[f] = 1;
            }
        }
    }

    [[nodiscard]] bool outer(Index cell) const { return outer_[cell] != 0; }
    /// Whether there are new cells on both or one of the sides of a face.
    [[nodiscard]] bool parting(Index face) const { return parting_[face] != 0; }

    /// Gives outer cells points of their own at parting faces: appended to `points`, a part of the way to the middles of their
    /// cells.
    void part(std::vector<std::array<Index, 8>>& cells, std::vector<Vec3>& points) const {
        std::vector<std::vector<std::pair<Index, std::uint8_t>>> at(topology_.point_count);
        std::vector<std::uint8_t> parted(topology_.point_count, 0);
        for (Index f = 0; f < parting_.size(); ++f) {
            if (parting_[f] == 0) continue;
            for (const Index p : topology_.faces[f]) parted[p] = 1;
        }
        for (Index c = 0; c < outer_.size(); ++c) {
            if (outer_[c] == 0) continue;
            for (std::uint8_t k = 0; k < 8; ++k) {
                const Index p = topology_.cells[c][k];
                if (parted[p] != 0) at[p].emplace_back(c, k);
            }
        }
        for (Index p = 0; p < at.size(); ++p) {
            std::vector<std::uint8_t> done(at[p].size(), 0);
            for (std::size_t first = 0; first < done.size(); ++first) {
                if (done[first] != 0) continue;
                std::vector<std::size_t> sector{first};
                done[first] = 1;
                Vec3 middle(0.0);
                for (std::size_t i = 0; i < sector.size(); ++i) {
                    for (const Index corner : topology_.cells[at[p][sector[i]].first]) middle += points[corner] / 8.0;
                    for (std::size_t other = 0; other < done.size(); ++other) {
                        if (done[other] != 0 || !joined(at[p][sector[i]].first, at[p][other].first)) continue;
                        done[other] = 1;
                        sector.push_back(other);
                    }
                }
                constexpr double kInwards = 0.3;
                const Vec3 place = points[p] + kInwards * (middle / static_cast<double>(sector.size()) - points[p]);
                for (const std::size_t i : sector) cells[at[p][i].first][at[p][i].second] = static_cast<Index>(points.size());
                points.push_back(place);
            }
        }
    }

private:
    /// Whether two outer cells share a face that does not part them.
    [[nodiscard]] bool joined(Index a, Index b) const {
        return std::ranges::any_of(topology_.cell_faces[a], [&](Index f) {
            if (topology_.face_on_hull(f) || parting_[f] != 0) return false;
            return topology_.face_cells[f][0] == b || topology_.face_cells[f][1] == b;
        });
    }

    const Topology& topology_;
    std::vector<std::uint8_t> outer_, parting_;
};

}  // namespace

HexMesh with_layer(const HexMesh& mesh) {
    const Topology topology = build_topology(mesh);
    std::vector<Vec3> middles(mesh.points.size(), Vec3(0.0));
    std::vector<double> counts(mesh.points.size(), 0);
    for (const auto& cell : mesh.cells) {
        Vec3 middle(0.0);
        for (const Index p : cell) middle += mesh.points[p] / 8.0;
        for (const Index p : cell) {
            middles[p] += middle;
            counts[p] += 1;
        }
    }
    HexMesh made;
    made.points = mesh.points;
    made.cells = mesh.cells;
    std::vector<Index> outer(mesh.points.size(), kNone);
    constexpr double kInwards = 0.5;
    for (Index p = 0; p < mesh.points.size(); ++p) {
        if (topology.point_on_boundary[p] == 0) continue;
        outer[p] = static_cast<Index>(made.points.size());
        made.points.push_back(mesh.points[p]);
        made.points[p] += kInwards * (middles[p] / counts[p] - mesh.points[p]);
    }
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        for (std::size_t side = 0; side < 6; ++side) {
            if (!topology.face_on_hull(topology.cell_faces[c][side])) continue;
            auto& cell = made.cells.emplace_back();
            for (std::size_t k = 0; k < 4; ++k) {
                cell[k] = mesh.cells[c][kCellFaces[side][k]];
                cell[4 + k] = outer[cell[k]];
            }
        }
    }
    return made;
}

HexMesh with_layer_along(const HexMesh& mesh, std::span<const std::array<Index, 2>> along) {
    const Topology topology = build_topology(mesh);
    const OuterCells sides(topology, along);
    HexMesh made;
    made.points = mesh.points;
    made.cells = mesh.cells;
    sides.part(made.cells, made.points);
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        if (!sides.outer(c)) continue;
        for (std::size_t side = 0; side < 6; ++side) {
            if (!sides.parting(topology.cell_faces[c][side])) continue;
            std::array<Index, 8> between;
            for (std::size_t k = 0; k < 4; ++k) {
                between[k] = made.cells[c][kCellFaces[side][k]];
                between[4 + k] = mesh.cells[c][kCellFaces[side][k]];
            }
            made.cells.push_back(between);
        }
    }
    return made;
}

}  // namespace subvol::detail
