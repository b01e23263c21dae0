// SPDX-License-Identifier: Apache-2.0
// Which cells are left-handed. The sign of a cell's volume alone does not tell: a right-handed cell has a negative one if a
// point was moved through it. Two right-handed cells see the face that they share from two sides, so their corners there run
// in opposite directions. Cells that are connected by faces thus know their hands relative to the first of them, and the sum
// of their volumes with these signs gives its hand.
#include <algorithm>
#include <array>
#include <vector>

#include "subvol/detail/handed_face.h"
#include "subvol/hex_mesh.h"

namespace subvol {

using detail::HandedFace;

namespace {

std::vector<HandedFace> handed_faces(const HexMesh& mesh) {
    std::vector<HandedFace> faces;
    faces.reserve(kCellFaces.size() * mesh.cells.size());
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (std::size_t side = 0; side < kCellFaces.size(); ++side) {
            faces.emplace_back(mesh.cells[c], static_cast<Index>(c), side);
        }
    }
    std::ranges::sort(faces);
    return faces;
}

/// The cells beyond the faces of each cell, and whether they are of the other hand.
struct Neighbours {
    struct One {
        Index cell;
        bool other_hand;
    };
    std::vector<std::array<One, 6>> of_cells;
    std::vector<std::uint8_t> counts;

    explicit Neighbours(const HexMesh& mesh) : of_cells(mesh.cells.size()), counts(mesh.cells.size(), 0) {
        const std::vector<HandedFace> faces = handed_faces(mesh);
        for (std::size_t i = 0; i + 1 < faces.size(); ++i) {
            const HandedFace &a = faces[i], &b = faces[i + 1];
            if (a.points != b.points || a.cell == b.cell) continue;
            const bool other_hand = a.reversed == b.reversed;
            if (counts[a.cell] < 6) of_cells[a.cell][counts[a.cell]++] = {b.cell, other_hand};
            if (counts[b.cell] < 6) of_cells[b.cell][counts[b.cell]++] = {a.cell, other_hand};
        }
    }
};

double volume_of(const HexMesh& mesh, std::size_t cell) {
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[cell][k]];
    return cell_volume(corners);
}

/// A flag for each left-handed cell.
std::vector<std::uint8_t> left_handed(const HexMesh& mesh) {
    enum Hand : std::uint8_t { Right, Left, Unknown };
    const Neighbours neighbours(mesh);
    std::vector<std::uint8_t> hands(mesh.cells.size(), Unknown);
    std::vector<Index> part;
    for (std::size_t first = 0; first < hands.size(); ++first) {
        if (hands[first] != Unknown) continue;
        part.assign(1, static_cast<Index>(first));
        hands[first] = Right;
        double volume = 0;
        for (std::size_t i = 0; i < part.size(); ++i) {
            const Index c = part[i];
            volume += hands[c] == Right ? volume_of(mesh, c) : -volume_of(mesh, c);
            for (std::size_t k = 0; k < neighbours.counts[c]; ++k) {
                const auto& [next, other_hand] = neighbours.of_cells[c][k];
                if (hands[next] != Unknown) continue;
                hands[next] = other_hand ? static_cast<std::uint8_t>(1 - hands[c]) : hands[c];
                part.push_back(next);
            }
        }
        if (volume >= 0) continue;
        for (const Index c : part) hands[c] = static_cast<std::uint8_t>(1 - hands[c]);
    }
    return hands;
}

}  // namespace

std::size_t orient_cells(HexMesh& mesh) {
    std::size_t negative = 0;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) negative += volume_of(mesh, c) < 0 ? 1 : 0;
    if (negative == 0) return 0;
    const bool all = negative == mesh.cells.size();
    const std::vector<std::uint8_t> turned = all ? std::vector<std::uint8_t>(negative, 1) : left_handed(mesh);
    std::size_t count = 0;
    for (std::size_t c = 0; c < turned.size(); ++c) {
        if (turned[c] == 0) continue;
        std::swap_ranges(mesh.cells[c].begin(), mesh.cells[c].begin() + 4, mesh.cells[c].begin() + 4);
        ++count;
    }
    return count;
}

}  // namespace subvol
