// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/mixed_mesh.h"

namespace subvol::detail {

/// A face of a tetrahedron: 4 · tetrahedron + the corner opposite to it.
using TetFace = Index;

/// What lies across a face: the tetrahedron and its corner that is not on the face, in one number, so that a walk loads both at
/// once.
class TetLink {
public:
    TetLink() = default;
    TetLink(Index tet, Index apex) : bits_(static_cast<std::uint64_t>(tet) | static_cast<std::uint64_t>(apex) << 32) {}

    [[nodiscard]] std::uint64_t bits() const { return bits_; }  // the tetrahedron in the lower half
    [[nodiscard]] bool is_boundary() const { return static_cast<std::uint32_t>(bits_) == kBoundary; }
    [[nodiscard]] Index tet() const { return is_boundary() ? kNone : static_cast<std::uint32_t>(bits_); }

    static constexpr std::uint32_t kBoundary = ~std::uint32_t{0};

private:
    std::uint64_t bits_ = ~std::uint64_t{0};
};

/// How many tetrahedra have zero volume, and how many are inverted.
struct TetShapes {
    std::size_t degenerate = 0, inverted = 0;
};

/// A mesh of tetrahedra with their neighbours.
struct TetMesh {
    struct Tet {
        std::array<Index, 4> corner;
    };
    struct Point {
        Vec3 position;
        double value;
    };
    std::vector<Point> points;
    std::vector<Tet> tets;
    /// For each tetrahedron one link for each face, half a cache line in all, by the rank of the opposite corner's id among the
    /// four. A walk knows the ids from the face by which it came, so it reads nothing else.
    std::vector<std::array<TetLink, 4>> links;
    std::vector<TetFace> boundary;
    TetShapes shapes{};

    [[nodiscard]] std::array<Index, 3> corners(TetFace face) const {
        const auto& corner = tets[face / 4].corner;
        const std::size_t k = face % 4;
        return {corner[k == 0 ? 1 : 0], corner[k <= 1 ? 2 : 1], corner[k <= 2 ? 3 : 2]};
    }

    [[nodiscard]] std::size_t rank(Index tet, Index k) const {
        const auto& c = tets[tet].corner;
        return std::size_t{c[0] < c[k]} + std::size_t{c[1] < c[k]} + std::size_t{c[2] < c[k]} + std::size_t{c[3] < c[k]};
    }

    // What `walk` needs of a mesh.
    [[nodiscard]] std::size_t tet_count() const { return tets.size(); }
    [[nodiscard]] const std::array<Index, 4>& corners_of_tet(Index tet) const { return tets[tet].corner; }
    [[nodiscard]] Index neighbor(Index tet, Index k) const { return links[tet][rank(tet, k)].tet(); }
    [[nodiscard]] const Point& point(Index id) const { return points[id]; }
};

/// The box of the points that tetrahedra use.
[[nodiscard]] Box bounds_of(const TetMesh& mesh);

/// The shapes of the tetrahedra into which `build_tet_mesh` splits the cells.
[[nodiscard]] TetShapes tet_shapes(const HexMesh& mesh);

/// Splits every cell into 6 and finds the neighbours by sorting the faces on the sides of cells. A face of more than two
/// tetrahedra is a boundary face of each of them.
///
/// mesh:   a valid one
/// values: one for each point
/// throws: Error(InvalidInput) if the mesh has more cells than 32-bit faces can number, or more points than 32 bits can
/// cost:   O(n), parallel; about 90 bytes for each tetrahedron while it sorts, 55 afterwards
[[nodiscard]] TetMesh build_tet_mesh(const HexMesh& mesh, std::span<const double> values);

/// The same of tetrahedra as they are; all other cells are cut into tetrahedra (`in_tetrahedra`).
///
/// field:  the attribute whose values are taken, of one channel; empty: the first
/// throws: as above, and Error(InvalidInput) as validate(mesh), or if there is no such attribute
[[nodiscard]] TetMesh build_tet_mesh(const MixedMesh& mesh, std::string_view field);

}  // namespace subvol::detail
