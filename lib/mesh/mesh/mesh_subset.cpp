// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/mesh_subset.h"

#include <algorithm>
#include <set>

#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/place_function.h"

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
    for (const Attribute& field : mesh.attributes) {
        result.mesh.attributes.push_back(without_values(field));
        if (!is_at_cells(mesh, field)) continue;
        result.mesh.attributes.back().cells = of_cells(field.cells, field.channels, result.cells);
        result.mesh.attributes.back().constant = field.constant;
    }
    for (Index p = 0; p < places.size(); ++p) {
        if (places[p] == kNone) continue;
        places[p] = static_cast<Index>(result.mesh.points.size());
        result.mesh.points.push_back(mesh.points[p]);
        result.points.push_back(p);
        for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
            add_point(mesh.attributes[a], p, result.mesh.attributes[a]);
        }
    }
    for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
        const Attribute& from = mesh.attributes[a];
        result.mesh.attributes[a].walls = at_kept_points(from.walls, from.channels, places);
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

std::vector<double> of_cells(std::span<const double> cells, int channels, std::span<const Index> numbers) {
    std::vector<double> some;
    if (cells.empty()) return some;
    const auto width = static_cast<std::size_t>(channels);
    some.reserve(numbers.size() * width);
    for (const Index c : numbers) {
        const std::span<const double> of_cell = cells.subspan(c * width, width);
        some.insert(some.end(), of_cell.begin(), of_cell.end());
    }
    return some;
}

GradientsAtPoints at_kept_points(const GradientsAtPoints& gradients, int channels, std::span<const Index> places) {
    GradientsAtPoints kept;
    const auto width = static_cast<std::size_t>(channels);
    for (std::size_t i = 0; i < gradients.points.size(); ++i) {
        const Index place = places[gradients.points[i]];
        if (place == kNone) continue;
        kept.points.push_back(place);
        for (std::size_t c = 0; c < width; ++c) kept.gradients.push_back(gradients.gradients[i * width + c]);
    }
    return kept;
}

bool is_at_cells(const HexMesh& mesh, const Attribute& field) {
    return !field.cells.empty() && field.cells.size() == static_cast<std::size_t>(field.channels) * mesh.cells.size();
}

bool is_constant_in_cells(const HexMesh& mesh, const Attribute& field) {
    return field.constant && is_at_cells(mesh, field);
}

void set_means_at_points(const HexMesh& mesh, Attribute& field) {
    const auto width = static_cast<std::size_t>(field.channels);
    std::vector<double> sums(field.values.size(), 0);
    std::vector<Index> counts(mesh.points.size(), 0);
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (const Index p : mesh.cells[c]) {
            ++counts[p];
            for (std::size_t k = 0; k < width; ++k) sums[p * width + k] += field.cells[c * width + k];
        }
    }
    for (std::size_t i = 0; i < sums.size(); ++i) {
        if (counts[i / width] > 0) field.values[i] = sums[i] / counts[i / width];
    }
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
