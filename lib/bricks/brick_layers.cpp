// SPDX-License-Identifier: Apache-2.0
#include "brick_layers.h"

#include <algorithm>
#include <set>

#include "subvol/cell.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"
#include "topology_parts.h"

namespace subvol::detail {

namespace {

constexpr double kWiden = 0.25;

}  // namespace

void check_halo_of_limit(const Bricks& bricks) {
    if (bricks.halo_layers >= kHaloOfLimit) return;
    throw Error(ErrorCode::InvalidInput,
                "its bricks have " + std::to_string(bricks.halo_layers) + " layers of halo, values of the limit need " +
                    std::to_string(kHaloOfLimit),
                bricks.path.string(), "split with --halo " + std::to_string(kHaloOfLimit));
}

CellReaches::CellReaches(const HexMesh& mesh) : mesh_(mesh), about_(mesh.points.size()) {
    for (const auto& cell : mesh.cells) {
        Box box;
        for (const Index p : cell) box.add(mesh.points[p]);
        for (const Index p : cell) about_[p].add(box);
    }
}

Box CellReaches::operator()(std::size_t cell) const {
    Box box;
    for (const Index p : mesh_.cells[cell]) box.add(about_[p]);
    const Vec3 more = kWiden * box.size();
    return {box.lower - more, box.upper + more};
}

bool touch(const Box& a, const Box& b) {
    for (int d = 0; d < 3; ++d) {
        if (!(a.lower[d] <= b.upper[d] && b.lower[d] <= a.upper[d])) return false;
    }
    return true;
}

BrickMesh subset(const BrickMesh& part, std::span<const std::uint8_t> cells) {
    MeshSubset some = subset(part.mesh, cells);
    BrickMesh result;
    result.mesh = std::move(some.mesh);
    for (const Index c : some.cells) {
        result.cell_numbers.push_back(part.cell_numbers[c]);
        result.owned_cells.push_back(part.owned_cells[c]);
    }
    for (const Index p : some.points) {
        result.point_numbers.push_back(part.point_numbers[p]);
        result.owned_points.push_back(part.owned_points[p]);
    }
    return result;
}

BrickMesh merged(std::vector<BrickMesh> parts) {
    BrickMesh all;
    if (parts.empty()) return all;
    if (parts.size() == 1) return std::move(parts.front());
    for (const BrickMesh& part : parts) {
        all.point_numbers.insert(all.point_numbers.end(), part.point_numbers.begin(), part.point_numbers.end());
        all.cell_numbers.insert(all.cell_numbers.end(), part.cell_numbers.begin(), part.cell_numbers.end());
    }
    for (auto* numbers : {&all.point_numbers, &all.cell_numbers}) {
        std::ranges::sort(*numbers);
        numbers->erase(std::unique(numbers->begin(), numbers->end()), numbers->end());
    }
    const std::size_t points = all.point_numbers.size(), cells = all.cell_numbers.size();
    all.mesh.points.resize(points);
    all.mesh.cells.resize(cells);
    all.owned_points.assign(points, 0);
    all.owned_cells.assign(cells, 0);
    for (const Attribute& field : parts.front().mesh.attributes) {
        all.mesh.attributes.push_back(
            {field.name, field.channels, std::vector<double>(points * static_cast<std::size_t>(field.channels))});
    }
    std::set<std::array<Index, 2>> creases;
    std::set<std::array<Index, 4>> faces;
    for (BrickMesh& part_left : parts) {
        const BrickMesh part = std::move(part_left);  // frees each part after its turn
        std::vector<Index> places(part.point_numbers.size());
        std::size_t at = 0;
        for (std::size_t p = 0; p < places.size(); ++p) {
            while (all.point_numbers[at] != part.point_numbers[p]) ++at;
            places[p] = static_cast<Index>(at);
            all.mesh.points[at] = part.mesh.points[p];
            all.owned_points[at] |= part.owned_points[p];
            for (std::size_t a = 0; a < all.mesh.attributes.size(); ++a) {
                Attribute& to = all.mesh.attributes[a];
                std::copy_n(part.mesh.attributes[a].values.begin() + static_cast<std::ptrdiff_t>(p) * to.channels, to.channels,
                            to.values.begin() + static_cast<std::ptrdiff_t>(at) * to.channels);
            }
        }
        at = 0;
        for (std::size_t c = 0; c < part.cell_numbers.size(); ++c) {
            while (all.cell_numbers[at] != part.cell_numbers[c]) ++at;
            for (std::size_t k = 0; k < 8; ++k) all.mesh.cells[at][k] = places[part.mesh.cells[c][k]];
            all.owned_cells[at] |= part.owned_cells[c];
        }
        for (auto crease : part.mesh.creases) {
            for (Index& p : crease) p = places[p];
            creases.insert(crease);
        }
        for (auto face : part.mesh.sharp_faces) {
            for (Index& p : face) p = places[p];
            faces.insert(face);
        }
    }
    all.mesh.creases.assign(creases.begin(), creases.end());
    all.mesh.sharp_faces.assign(faces.begin(), faces.end());
    return all;
}

std::vector<std::uint8_t> hull_points_of_owned(const BrickMesh& part) {
    std::vector<std::uint8_t> of_owned(part.mesh.points.size(), 0), on_hull(part.mesh.points.size(), 0);
    for (std::size_t c = 0; c < part.mesh.cells.size(); ++c) {
        if (!part.owned_cells[c]) continue;
        for (const Index p : part.mesh.cells[c]) of_owned[p] = 1;
    }
    // All cells at a point of an owned cell are here, so a face with such a point that has one cell here has no other.
    const auto at_owned = [&](const auto& face) {
        return std::ranges::any_of(face, [&](Index p) { return of_owned[p] != 0; });
    };
    for (const auto& quad : hull_quads(part.mesh, at_owned)) {
        for (const Index p : quad) on_hull[p] = 1;
    }
    return on_hull;
}

}  // namespace subvol::detail
