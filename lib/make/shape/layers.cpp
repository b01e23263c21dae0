// SPDX-License-Identifier: Apache-2.0
#include "layers.h"

#include <algorithm>

#include "mesh_walls.h"
#include "subvol/cell.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

/// The cells of parts with their corners as they will be: of the cells about a point those that a layer parts from others have
/// points of their own.
class PartedCells {
public:
    PartedCells(const Topology& topology, const Layers& layers) : topology_(topology), layers_(layers) {
        parting_.assign(topology.faces.size(), 0);
        for (Index f = 0; f < parting_.size(); ++f) {
            const auto [a, b] = topology.face_cells[f];
            const bool parts = b == kNone ? layers.at_hull : layers.parts[a] != layers.parts[b];
            parting_[f] = parts ? 1 : 0;
        }
        for (const auto& [a, b] : layers.cuts) {
            for (const Index f : topology.edge_faces[*topology.find_edge(a, b)]) {
                if (wall_of(topology, layers.materials, f) == kNone) parting_[f] = 1;
            }
        }
    }

    /// Whether there is a layer on both or one of the sides of a face.
    [[nodiscard]] bool parting(Index face) const { return parting_[face] != 0; }
    [[nodiscard]] bool stays(Index cell) const { return layers_.parts[cell] == kNone; }

    /// Gives cells points of their own at parting faces: appended to `points`, a part of the way to the middles of their cells.
    void part(std::vector<std::array<Index, 8>>& cells, std::vector<Vec3>& points) const {
        std::vector<std::vector<std::pair<Index, std::uint8_t>>> at(topology_.point_count);
        std::vector<std::uint8_t> parted(topology_.point_count, 0);
        for (Index f = 0; f < parting_.size(); ++f) {
            if (parting_[f] == 0) continue;
            for (const Index p : topology_.faces[f]) parted[p] = 1;
        }
        for (Index c = 0; c < topology_.cells.size(); ++c) {
            if (stays(c)) continue;
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
                const Vec3 place = points[p] + layers_.inwards * (middle / static_cast<double>(sector.size()) - points[p]);
                for (const std::size_t i : sector) cells[at[p][i].first][at[p][i].second] = static_cast<Index>(points.size());
                points.push_back(place);
            }
        }
    }

private:
    /// Whether two cells of parts share a face that does not part them.
    [[nodiscard]] bool joined(Index a, Index b) const {
        return std::ranges::any_of(topology_.cell_faces[a], [&](Index f) {
            if (topology_.face_on_hull(f) || parting_[f] != 0) return false;
            return topology_.face_cells[f][0] == b || topology_.face_cells[f][1] == b;
        });
    }

    const Topology& topology_;
    const Layers& layers_;
    std::vector<std::uint8_t> parting_;
};

}  // namespace

LayeredMesh with_layers(const HexMesh& mesh, const Layers& layers) {
    const Topology topology = build_topology(mesh);
    const PartedCells parted(topology, layers);
    LayeredMesh made;
    made.mesh.points = mesh.points;
    made.mesh.cells = mesh.cells;
    parted.part(made.mesh.cells, made.mesh.points);
    for (Index c = 0; c < mesh.cells.size(); ++c) made.from.push_back(c);
    for (Index c = 0; c < mesh.cells.size(); ++c) {
        if (parted.stays(c)) continue;
        for (std::size_t side = 0; side < 6; ++side) {
            if (!parted.parting(topology.cell_faces[c][side])) continue;
            std::array<Index, 8> between;
            for (std::size_t k = 0; k < 4; ++k) {
                between[k] = made.mesh.cells[c][kCellFaces[side][k]];
                between[4 + k] = mesh.cells[c][kCellFaces[side][k]];
            }
            made.mesh.cells.push_back(between);
            made.from.push_back(c);
        }
    }
    return made;
}

LayeredMesh with_layer_at_walls(const HexMesh& mesh, std::span<const Index> materials) {
    constexpr double kInwards = 0.5;
    const std::vector<Index> one(materials.empty() ? mesh.cells.size() : 0, 0);
    return with_layers(
        mesh, {.parts = materials.empty() ? std::span<const Index>(one) : materials, .at_hull = true, .inwards = kInwards});
}

LayeredMesh with_layer_along(const HexMesh& mesh, std::span<const std::array<Index, 2>> along,
                             std::span<const Index> materials) {
    const Topology topology = build_topology(mesh);
    std::vector<Index> parts(mesh.cells.size(), kNone);
    for (Index c = 0; c < parts.size(); ++c) {
        const auto at_wall = [&](Index f) { return wall_of(topology, materials, f) != kNone; };
        if (std::ranges::any_of(topology.cell_faces[c], at_wall)) parts[c] = 0;
    }
    constexpr double kInwards = 0.3;
    return with_layers(mesh, {.parts = parts, .cuts = along, .materials = materials, .inwards = kInwards});
}

}  // namespace subvol::detail
