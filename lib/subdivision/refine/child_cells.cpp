// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/child_topology.h"

#include "subvol/cell.h"
#include "subvol/detail/bucket_sort.h"

namespace subvol::detail {

namespace {

template <std::size_t N>
constexpr std::size_t lattice_offset(const std::array<std::size_t, N>& corners) {
    std::array<int, 3> sum{};
    for (const std::size_t c : corners) {
        for (std::size_t a = 0; a < 3; ++a) sum[a] += 2 * kCornerParameters[c][a];
    }
    const int n = static_cast<int>(N);
    return static_cast<std::size_t>(sum[0] / n + 3 * (sum[1] / n) + 9 * (sum[2] / n));
}

constexpr std::array<LatticePlace, 27> make_lattice() {
    std::array<LatticePlace, 27> lattice{};
    for (std::uint8_t k = 0; k < 8; ++k) lattice[lattice_offset(std::array<std::size_t, 1>{k})] = {LatticePlace::Corner, k};
    for (std::uint8_t k = 0; k < 12; ++k) lattice[lattice_offset(kCellEdges[k])] = {LatticePlace::Edge, k};
    for (std::uint8_t k = 0; k < 6; ++k) lattice[lattice_offset(kCellFaces[k])] = {LatticePlace::Face, k};
    return lattice;
}

constexpr auto kLattice = make_lattice();

constexpr std::size_t lattice_index(std::size_t child, std::size_t corner) {
    const auto& o = kCornerParameters[child];
    const auto& p = kCornerParameters[corner];
    return static_cast<std::size_t>(o[0] + p[0] + 3 * (o[1] + p[1]) + 9 * (o[2] + p[2]));
}

}  // namespace

LatticePlace lattice_place(std::size_t child, std::size_t corner) {
    return kLattice[lattice_index(child, corner)];
}

std::array<Index, 27> lattice_points(const Topology& parent, Index cell) {
    const ChildNumbering first(parent);
    std::array<Index, 27> points;
    for (std::size_t i = 0; i < 27; ++i) {
        const auto [kind, k] = kLattice[i];
        switch (kind) {
            case LatticePlace::Corner:
                points[i] = parent.cells[cell][k];
                break;
            case LatticePlace::Edge:
                points[i] = static_cast<Index>(first.edges + parent.cell_edges[cell][k]);
                break;
            case LatticePlace::Face:
                points[i] = static_cast<Index>(first.faces + parent.cell_faces[cell][k]);
                break;
            case LatticePlace::Cell:
                points[i] = static_cast<Index>(first.cells + parent.cell_ordinal[cell]);
                break;
        }
    }
    return points;
}

std::array<std::array<Index, 8>, 8> split_lattice(const std::array<Index, 27>& points) {
    std::array<std::array<Index, 8>, 8> children;
    for (std::size_t child = 0; child < 8; ++child) {
        for (std::size_t k = 0; k < 8; ++k) children[child][k] = points[lattice_index(child, k)];
    }
    return children;
}

std::vector<std::array<Index, 8>> child_cells(const Topology& parent) {
    std::vector<std::array<Index, 8>> children(8 * parent.cells.size());
    parallel_each(parent.cells.size(), [&](std::size_t c) {
        const auto eight = split_lattice(lattice_points(parent, static_cast<Index>(c)));
        std::copy(eight.begin(), eight.end(), children.begin() + static_cast<std::ptrdiff_t>(8 * c));
    });
    return children;
}

std::vector<std::array<Index, 2>> child_creases(const Topology& parent) {
    std::vector<std::array<Index, 2>> creases;
    for (const auto& [a, b] : parent.creases) {
        const auto middle = static_cast<Index>(parent.point_count + *parent.find_edge(a, b));
        creases.push_back({a, middle});
        creases.push_back({b, middle});
    }
    return creases;
}

std::vector<std::array<Index, 4>> child_sharp_faces(const Topology& parent) {
    const ChildNumbering first(parent);
    std::vector<std::array<Index, 4>> quarters;
    for (std::size_t f = 0; f < parent.face_is_sharp.size(); ++f) {
        if (!parent.face_is_sharp[f]) continue;
        for (std::size_t k = 0; k < 4; ++k) {
            quarters.push_back({parent.faces[f][k], static_cast<Index>(first.edges + parent.face_edges[f][k]),
                                static_cast<Index>(first.faces + f),
                                static_cast<Index>(first.edges + parent.face_edges[f][(k + 3) % 4])});
        }
    }
    return quarters;
}

}  // namespace subvol::detail
