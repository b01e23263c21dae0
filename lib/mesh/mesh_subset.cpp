// SPDX-License-Identifier: Apache-2.0
#include "mesh_subset.h"

#include <algorithm>
#include <set>

#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

template <class Entity>
Entity in_order(Entity entity) {
    std::ranges::sort(entity);
    return entity;
}

}  // namespace

void grow(const HexMesh& mesh, std::vector<std::uint8_t>& cells, int layers) {
    std::vector<std::uint8_t> points(mesh.points.size(), 0);
    for (int layer = 0; layer < layers; ++layer) {
        for (std::size_t c = 0; c < cells.size(); ++c) {
            if (!cells[c]) continue;
            for (const Index p : mesh.cells[c]) points[p] = 1;
        }
        parallel_each(cells.size(), [&](std::size_t c) {
            if (!cells[c]) cells[c] = std::ranges::any_of(mesh.cells[c], [&](Index p) { return points[p] != 0; });
        });
    }
}

MeshSubset subset(const HexMesh& mesh, std::span<const std::uint8_t> cells) {
    std::vector<Index> places(mesh.points.size(), kNone);
    MeshSubset result;
    result.mesh.time = mesh.time;
    for (Index c = 0; c < cells.size(); ++c) {
        if (!cells[c]) continue;
        result.mesh.cells.push_back(mesh.cells[c]);
        result.cells.push_back(c);
        for (const Index p : mesh.cells[c]) places[p] = 0;
    }
    for (const Attribute& field : mesh.attributes)
        result.mesh.attributes.push_back({field.name, field.channels, {}, field.bounds});
    for (Index p = 0; p < places.size(); ++p) {
        if (places[p] == kNone) continue;
        places[p] = static_cast<Index>(result.mesh.points.size());
        result.mesh.points.push_back(mesh.points[p]);
        result.points.push_back(p);
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            const Attribute& from = mesh.attributes[a];
            const auto first = from.values.begin() + static_cast<std::ptrdiff_t>(p) * from.channels;
            auto& to = result.mesh.attributes[a].values;
            to.insert(to.end(), first, first + from.channels);
        }
    }
    const auto renumber = [&](auto& entity) {
        for (Index& p : entity) p = places[p];
    };
    for (auto& cell : result.mesh.cells) renumber(cell);
    const auto take = [&](const auto& tags, auto& taken) {
        for (auto tag : tags) {
            if (std::ranges::any_of(tag, [&](Index p) { return places[p] == kNone; })) continue;
            renumber(tag);
            taken.push_back(tag);
        }
    };
    take(mesh.creases, result.mesh.creases);
    take(mesh.sharp_faces, result.mesh.sharp_faces);
    keep_own_tags(result.mesh);
    return result;
}

void keep_own_tags(HexMesh& mesh) {
    if (!mesh.creases.empty()) {
        std::set<std::array<Index, 2>> wanted, found;
        for (const auto& crease : mesh.creases) wanted.insert(in_order(crease));
        for (const auto& cell : mesh.cells) {
            for (const auto& edge : kCellEdges) {
                const auto key = in_order(std::array{cell[edge[0]], cell[edge[1]]});
                if (wanted.contains(key)) found.insert(key);
            }
        }
        mesh.creases.assign(found.begin(), found.end());
    }
    if (mesh.sharp_faces.empty()) return;
    std::set<std::array<Index, 4>> wanted, found;
    for (const auto& face : mesh.sharp_faces) wanted.insert(in_order(face));
    for (const auto& cell : mesh.cells) {
        for (const auto& side : kCellFaces) {
            std::array<Index, 4> key;
            for (std::size_t k = 0; k < 4; ++k) key[k] = cell[side[k]];
            if (wanted.contains(in_order(key))) found.insert(in_order(key));
        }
    }
    std::erase_if(mesh.sharp_faces, [&](const auto& face) { return !found.contains(in_order(face)); });
}

}  // namespace subvol::detail
