// SPDX-License-Identifier: Apache-2.0
// A mixed mesh is made in this order: the cells of a file are checked, turned until all are right-handed, and the points that
// no cell uses are left out. Last, the corners of each tetrahedron are put in the order a c b d or a c d b of their numbers a <
// b < c < d, whichever is right-handed. The diagonal of its octahedron, between the middles of ac and bd, then depends on the
// numbers alone.
//
// Prisms, pyramids and hexahedra are cut into tetrahedra along diagonals of their quads, octahedra along the shortest diagonal:
//
//     octahedron +x −x +y −y +z −z  ──axis of the shortest diagonal──►  4 tetrahedra around it, one for each edge of the ring
//
// The shape of a cell is 6 V / e³ times a factor that makes it 1 for a regular cell. V is its volume, or the least of its parts
// or corner tetrahedra, and e the root mean square of its edges. A negative shape marks an inverted cell. The volume of prisms
// and pyramids is that of the tetrahedra into which they are cut, so that cells with a common quad add up.
#include "subvol/mixed_mesh.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "subvol/detail/cell_splits.h"
#include "subvol/detail/mixed_shapes.h"
#include "subvol/detail/place_function.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

template <class Cell>
void check_corners(const Cell& cell, std::size_t points, const std::string& where) {
    auto sorted = cell;
    std::sort(sorted.begin(), sorted.end());
    if (sorted.back() >= points) {
        throw Error(ErrorCode::InvalidInput, "there is no point " + std::to_string(sorted.back()), where,
                    "the mesh has " + std::to_string(points) + " points");
    }
    const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
    if (twice != sorted.end()) {
        throw Error(ErrorCode::InvalidInput, "point " + std::to_string(*twice) + " is a corner twice", where);
    }
}

std::vector<std::uint8_t> used_points(const MixedMesh& mesh) {
    std::vector<std::uint8_t> used(mesh.points.size());
    each_kind_of(mesh, [&](CellKind, const auto& cells) {
        for (const auto& cell : cells) {
            for (const Index p : cell) used[p] = 1;
        }
    });
    return used;
}

/// A sixth of the triple product; negative if the tetrahedron is left-handed.
double tet_volume(const MixedMesh& mesh, Index a, Index b, Index c, Index d) {
    const auto& x = mesh.points;
    return glm::dot(x[b] - x[a], glm::cross(x[c] - x[a], x[d] - x[a])) / 6;
}

/// Leaves out the points that no cell uses; the others keep their order. In place, as a point never moves to a higher number.
void drop_unused(MixedMesh& mesh) {
    const auto used = used_points(mesh);
    std::vector<Index> number(used.size());
    Index count = 0;
    for (std::size_t p = 0; p < used.size(); ++p) {
        number[p] = count;
        if (!used[p]) continue;
        mesh.points[count] = mesh.points[p];
        for (Attribute& attribute : mesh.attributes) {
            const auto n = static_cast<std::size_t>(attribute.channels);
            for (std::size_t k = 0; k < n; ++k) attribute.values[count * n + k] = attribute.values[p * n + k];
        }
        ++count;
    }
    if (count == used.size()) return;
    mesh.points.resize(count);
    for (Attribute& attribute : mesh.attributes) attribute.values.resize(count * static_cast<std::size_t>(attribute.channels));
    each_kind_of(mesh, [&](CellKind, auto& cells) {
        for (auto& cell : cells) {
            for (Index& p : cell) p = number[p];
        }
    });
    std::erase_if(mesh.creases, [&](const auto& crease) { return !used[crease[0]] || !used[crease[1]]; });
    for (auto& crease : mesh.creases) crease = {number[crease[0]], number[crease[1]]};
}

/// The tetrahedron with the corners in the order a c b d or a c d b of their numbers, whichever is right-handed. Its octahedron
/// then has the diagonal between the middles of ac and bd [bey1995], which depends on the numbers alone and not on the shape,
/// so that the box spline commutes with affine maps.
std::array<Index, 4> by_numbers(const std::array<Index, 4>& tet) {
    auto sorted = tet;
    std::sort(sorted.begin(), sorted.end());
    // The order a c b d of the sorted corners; swapping the last two turns the cell over.
    std::array<Index, 4> result{sorted[0], sorted[2], sorted[1], sorted[3]};
    // The sign of the permutation from the given order.
    int inversions = 0;
    std::array<std::size_t, 4> place{};
    for (std::size_t k = 0; k < 4; ++k) {
        place[k] = static_cast<std::size_t>(std::find(tet.begin(), tet.end(), result[k]) - tet.begin());
        for (std::size_t j = 0; j < k; ++j) inversions += place[j] > place[k] ? 1 : 0;
    }
    if (inversions % 2 != 0) std::swap(result[2], result[3]);
    return result;
}

}  // namespace

void detail::cut_octahedron(const MixedMesh& mesh, const std::array<Index, 6>& q, std::vector<std::array<Index, 4>>& tets) {
    std::size_t best = 0;
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double length = glm::length(mesh.points[q[2 * axis]] - mesh.points[q[2 * axis + 1]]);
        // The tolerance makes equal diagonals equal in spite of roundings, so that the first of them is taken on every
        // computer.
        if (length < shortest * (1 - 1e-12)) {
            shortest = length;
            best = axis;
        }
    }
    // The pairs of opposite corners are rotated so that the best axis comes first; a cyclic rotation keeps the cell
    // right-handed.
    const auto corner = [&](std::size_t k) { return q[(2 * best + k) % 6]; };
    // The ring around the axis from corner 1 to corner 0 is +y, +z, −y, −z, right-handed about +x.
    const std::array<std::size_t, 4> ring{2, 4, 3, 5};
    for (std::size_t k = 0; k < 4; ++k) tets.push_back({corner(1), corner(0), corner(ring[k]), corner(ring[(k + 1) % 4])});
}

void validate(const MixedMesh& mesh) {
    if (mesh.cells() == 0) throw Error(ErrorCode::InvalidInput, "the mesh has no cells");
    each_kind_of(mesh, [&](CellKind kind, const auto& cells) {
        for (std::size_t c = 0; c < cells.size(); ++c) {
            check_corners(cells[c], mesh.points.size(), std::string(table_of(kind).name) + " " + std::to_string(c));
        }
    });
    for (const auto& crease : mesh.creases) check_corners(crease, mesh.points.size(), "a crease");
    const auto used = used_points(mesh);
    for (std::size_t p = 0; p < used.size(); ++p) {
        const Vec3& x = mesh.points[p];
        if (used[p] && !(std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z))) {
            throw Error(ErrorCode::InvalidInput, "a coordinate is not finite", "point " + std::to_string(p));
        }
    }
    for (const Attribute& attribute : mesh.attributes) {
        const std::string where = "attribute \"" + attribute.name + "\"";
        const auto channels = static_cast<std::size_t>(std::max(attribute.channels, 0));
        if (channels == 0 || attribute.values.size() != channels * mesh.points.size()) {
            throw Error(ErrorCode::InvalidInput, "its length is not that of the points", where);
        }
        for (std::size_t i = 0; i < attribute.values.size(); ++i) {
            if (!used[i / channels] || std::isfinite(attribute.values[i])) continue;
            throw Error(ErrorCode::InvalidInput, "the value at point " + std::to_string(i / channels) + " is not finite",
                        where);
        }
    }
}

MixedMesh make_mixed_mesh(const HexMesh& hexes, const MixedCells& others) {
    if (!hexes.sharp_faces.empty()) {
        throw Error(ErrorCode::InvalidInput, "sharp faces inside the mesh are not supported by the schemes of tetrahedra", {},
                    "read it without --sharp, or use another scheme");
    }
    MixedMesh mesh{
        hexes.points, others.tets, {}, others.prisms, others.pyramids, hexes.cells, detail::without_functions(hexes.attributes),
        hexes.creases};
    validate(mesh);
    MixedCells oriented{std::move(mesh.tets), std::move(mesh.prisms), std::move(mesh.pyramids)};
    orient_mixed(mesh.points, mesh.hexes, oriented);
    mesh.tets = std::move(oriented.tets);
    mesh.prisms = std::move(oriented.prisms);
    mesh.pyramids = std::move(oriented.pyramids);
    drop_unused(mesh);
    for (auto& tet : mesh.tets) tet = by_numbers(tet);
    return mesh;
}

MixedMesh in_tetrahedra(MixedMesh mesh) {
    if (mesh.cells() == mesh.tets.size()) return mesh;
    std::vector<std::array<Index, 4>> tets = std::move(mesh.tets);
    for (const auto& octahedron : mesh.octahedra) cut_octahedron(mesh, octahedron, tets);
    MixedCells others;
    others.prisms = std::move(mesh.prisms);
    others.pyramids = std::move(mesh.pyramids);
    for (const auto& tet : cut_to_tets(mesh.hexes, others).tets) tets.push_back(by_numbers(tet));
    mesh.octahedra.clear();
    mesh.prisms.clear();
    mesh.pyramids.clear();
    mesh.hexes.clear();
    mesh.tets = std::move(tets);
    return mesh;
}

HexMesh in_hexahedra(const MixedMesh& mesh) {
    return hexahedra_of(mesh).mesh;
}

/// The shape of a cell is its volume, or that of its worst corner, over the cube of its edge (root mean square), scaled so that
/// a regular cell has 1.
MixedShape measure_cells(const MixedMesh& mesh) {
    MixedShape shape;
    const auto quality = [&](CellKind kind, const auto& cell, double volume) {
        double squares = 0;
        const auto& edges = table_of(kind).edges;
        for (const auto& [a, b] : edges) {
            const Vec3 d = mesh.points[at(cell, a)] - mesh.points[at(cell, b)];
            squares += glm::dot(d, d);
        }
        const double edge = std::sqrt(squares / static_cast<double>(edges.size()));
        return edge > 0 ? 6 * volume / (edge * edge * edge) : 0.0;
    };
    const auto count = [&](double worst) {
        shape.inverted += worst < 0 ? 1 : 0;
        shape.worst = std::min(shape.worst, worst);
    };
    for (const auto& t : mesh.tets) {
        const double volume = tet_volume(mesh, t[0], t[1], t[2], t[3]);
        shape.volume += volume;
        count(quality(CellKind::Tet, t, volume) * std::sqrt(2.0));
    }
    for (const auto& q : mesh.octahedra) {
        Vec3 middle(0);
        for (const Index p : q) middle += mesh.points[p] / 6.0;
        double least = std::numeric_limits<double>::infinity(), sum = 0;
        for (const auto& face : table_of(CellKind::Octahedron).faces) {
            const Vec3 a = mesh.points[at(q, face[0])] - middle, b = mesh.points[at(q, face[1])] - middle;
            const double part = glm::dot(a, glm::cross(b, mesh.points[at(q, face[2])] - middle)) / 6;
            least = std::min(least, part);
            sum += part;
        }
        shape.volume += sum;
        count(quality(CellKind::Octahedron, q, least) * 2 * std::sqrt(2.0));
    }
    const auto at_corners = [&](CellKind kind, const auto& cell, std::span<const std::array<int, 4>> corners, double scale) {
        double least = std::numeric_limits<double>::infinity();
        for (const auto& t : corners) {
            least = std::min(least, tet_volume(mesh, at(cell, t[0]), at(cell, t[1]), at(cell, t[2]), at(cell, t[3])));
        }
        count(quality(kind, cell, least) * scale);
    };
    // The corner tetrahedra of the other kinds: a corner with its three neighbours, right-handed if the cell is. For the
    // pyramid only those of the base, because four edges meet at its apex.
    static constexpr std::array<std::array<int, 4>, 6> kPrism{
        {{0, 1, 2, 3}, {1, 2, 0, 4}, {2, 0, 1, 5}, {3, 5, 4, 0}, {4, 3, 5, 1}, {5, 4, 3, 2}}};
    static constexpr std::array<std::array<int, 4>, 4> kPyramid{{{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}}};
    static constexpr std::array<std::array<int, 4>, 8> kHex{
        {{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7}, {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}}};
    for (const auto& p : mesh.prisms) at_corners(CellKind::Prism, p, kPrism, 2 / std::sqrt(3.0));
    for (const auto& p : mesh.pyramids) at_corners(CellKind::Pyramid, p, kPyramid, std::sqrt(2.0));
    for (const auto& h : mesh.hexes) at_corners(CellKind::Hex, h, kHex, 1);
    for (const auto& h : mesh.hexes) {
        std::array<Vec3, 8> corners;
        for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[h[k]];
        shape.volume += cell_volume(corners);
    }
    MixedCells others;
    others.prisms = mesh.prisms;
    others.pyramids = mesh.pyramids;
    // Prisms and pyramids are measured as the tetrahedra into which they are cut everywhere else, so that the volumes of cells
    // with a common quad add up.
    if (!others.empty()) {
        for (const auto& t : cut_to_tets({}, others).tets) shape.volume += tet_volume(mesh, t[0], t[1], t[2], t[3]);
    }
    return shape;
}

}  // namespace subvol
