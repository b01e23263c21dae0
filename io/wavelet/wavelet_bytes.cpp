// SPDX-License-Identifier: Apache-2.0
#include "wavelet_bytes.h"

#include <algorithm>

namespace subvol::detail {

void put_mesh(const HexMesh& mesh, Bytes& out) {
    out.number(mesh.points.size());
    out.number(mesh.cells.size());
    std::array<Index, 8> before{};
    for (const auto& cell : mesh.cells) {
        for (std::size_t k = 0; k < 8; ++k) {
            out.number(folded(static_cast<std::int64_t>(cell[k]) - static_cast<std::int64_t>(before[k])));
        }
        before = cell;
    }
    out.number(mesh.creases.size());
    for (const auto& crease : mesh.creases) {
        for (const Index p : crease) out.number(p);
    }
    out.number(mesh.sharp_faces.size());
    for (const auto& face : mesh.sharp_faces) {
        for (const Index p : face) out.number(p);
    }
}

namespace {

/// Refuses a last cell that no mesh has: few bytes of a compressed file can stand for millions of them.
void check_cell(const HexMesh& mesh, const Contents& in) {
    const auto& cell = mesh.cells.back();
    std::array<Index, 8> sorted = cell;
    std::ranges::sort(sorted);
    const bool twice = std::ranges::adjacent_find(sorted) != sorted.end();
    if (!twice && (mesh.cells.size() < 2 || cell != mesh.cells[mesh.cells.size() - 2])) return;
    in.fail("cell " + std::to_string(mesh.cells.size() - 1) + (twice ? " has a corner twice" : " is there twice"));
}

}  // namespace

HexMesh read_cells(Contents& in, std::size_t bytes_of_point) {
    HexMesh mesh;
    const std::size_t points = in.count("points", bytes_of_point);
    const std::size_t cells = in.count("cells", 8);
    if (points > 8 * cells) in.fail(std::to_string(points) + " points are more than the corners of the cells");
    std::array<std::int64_t, 8> corners{};
    for (std::size_t c = 0; c < cells; ++c) {
        auto& cell = mesh.cells.emplace_back();
        for (std::size_t k = 0; k < 8; ++k) {
            const std::int64_t change = in.signed_number();
            const auto most = static_cast<std::int64_t>(points);
            if (change < -corners[k] || change >= most - corners[k]) {
                in.fail("a corner of cell " + std::to_string(c) + " is not a point", "there are " + std::to_string(points));
            }
            corners[k] += change;
            cell[k] = static_cast<Index>(corners[k]);
        }
        check_cell(mesh, in);
    }
    mesh.points.assign(points, Vec3(0));
    mesh.creases.resize(in.count("creases", 2));
    for (auto& crease : mesh.creases) {
        for (Index& p : crease) p = in.point(points);
    }
    mesh.sharp_faces.resize(in.count("sharp faces", 4));
    for (auto& face : mesh.sharp_faces) {
        for (Index& p : face) p = in.point(points);
    }
    return mesh;
}

}  // namespace subvol::detail
