// SPDX-License-Identifier: Apache-2.0
#include "tet_mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "subvol/cell.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kTetsPerCell = 6;
constexpr std::size_t kMaxCells = (std::size_t{1} << 32) / (4 * kTetsPerCell) - 1;

// A volume below this part of the cube over the longest edge is only rounding of the coordinates.
constexpr double kZeroVolume = 1e-13;

struct FaceRecord {
    std::array<Index, 3> ids;  // ascending
    TetFace face;

    bool operator<(const FaceRecord& other) const { return std::tie(ids, face) < std::tie(other.ids, other.face); }
};

FaceRecord record_of(const TetMesh& mesh, TetFace face) {
    auto [a, b, c] = mesh.corners(face);
    if (a > b) std::swap(a, b);
    if (b > c) std::swap(b, c);
    if (a > b) std::swap(a, b);
    return {{a, b, c}, face};
}

TetLink& link_of(TetMesh& mesh, TetFace face) {
    return mesh.links[face / 4][mesh.rank(face / 4, face % 4)];
}

void link(TetMesh& mesh, TetFace one, TetFace other) {
    link_of(mesh, one) = {other / 4, mesh.tets[other / 4].corner[other % 4]};
    link_of(mesh, other) = {one / 4, mesh.tets[one / 4].corner[one % 4]};
}

constexpr std::size_t kFacesPerCell = 4 * kTetsPerCell;

/// The faces of a cell's tetrahedra, sorted, and which of them lie inside the cell, two at the same place.
struct CellFaces {
    CellFaces(const TetMesh& mesh, std::size_t cell) {
        for (std::size_t k = 0; k < kFacesPerCell; ++k) {
            records[k] = record_of(mesh, static_cast<TetFace>(kFacesPerCell * cell + k));
        }
        std::sort(records.begin(), records.end());
        for (std::size_t k = 0; k + 1 < kFacesPerCell; ++k) {
            if (records[k].ids == records[k + 1].ids) inside[k] = inside[k + 1] = true;
        }
    }
    std::array<FaceRecord, kFacesPerCell> records;
    std::array<bool, kFacesPerCell> inside{};
};

/// Half of the faces lie inside a cell and find each other there. The others, on the cells' sides, are sorted.
void connect(TetMesh& mesh) {
    mesh.links.resize(mesh.tets.size());
    const std::size_t cells = mesh.tets.size() / kTetsPerCell;
    parallel_each(cells, [&](std::size_t c) {
        const CellFaces faces(mesh, c);
        for (std::size_t k = 0; k + 1 < kFacesPerCell; ++k) {
            if (faces.records[k].ids != faces.records[k + 1].ids) continue;
            link(mesh, faces.records[k].face, faces.records[k + 1].face);
            ++k;
        }
    });
    const auto sides = bucket_sort<FaceRecord>(
        cells, mesh.points.size(),
        [&](std::size_t c, const auto& sink) {
            const CellFaces faces(mesh, c);
            for (std::size_t k = 0; k < kFacesPerCell; ++k) {
                if (!faces.inside[k]) sink(faces.records[k]);
            }
        },
        [](const FaceRecord& face) { return face.ids[0]; });
    tbb::enumerable_thread_specific<std::vector<TetFace>> boundaries;
    parallel_each(mesh.points.size(), [&](std::size_t p) {
        const std::size_t last = sides.offsets[p + 1];
        for (std::size_t i = sides.offsets[p], end; i < last; i = end) {
            for (end = i + 1; end < last && sides.records[end].ids == sides.records[i].ids;) ++end;
            if (end - i == 2) {
                link(mesh, sides.records[i].face, sides.records[i + 1].face);
            } else {
                for (std::size_t k = i; k < end; ++k) boundaries.local().push_back(sides.records[k].face);
            }
        }
    });
    for (const auto& boundary : boundaries) mesh.boundary.insert(mesh.boundary.end(), boundary.begin(), boundary.end());
    tbb::parallel_sort(mesh.boundary.begin(), mesh.boundary.end());  // in the order of cells: near in the list, near in space
}

enum class Shape { Regular, Degenerate, Inverted };

Shape shape_of(const HexMesh& mesh, const std::array<Index, 4>& tet) {
    std::array<Vec3, 4> p;
    for (std::size_t k = 0; k < 4; ++k) p[k] = mesh.points[tet[k]];
    const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
    const double longest =
        std::sqrt(std::max({dot(a, a), dot(b, b), dot(c, c), dot(b - a, b - a), dot(c - a, c - a), dot(c - b, c - b)}));
    const double volume = dot(cross(a, b), c);
    if (!(std::abs(volume) > kZeroVolume * longest * longest * longest)) return Shape::Degenerate;
    return volume < 0 ? Shape::Inverted : Shape::Regular;
}

}  // namespace

TetShapes tet_shapes(const HexMesh& mesh) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, mesh.cells.size(), 1024), TetShapes{},
        [&](const auto& range, TetShapes sum) {
            for (std::size_t c = range.begin(); c < range.end(); ++c) {
                for (const auto& tet : split_cell(mesh.cells[c])) {
                    const Shape shape = shape_of(mesh, tet);
                    if (shape == Shape::Degenerate) ++sum.degenerate;
                    if (shape == Shape::Inverted) ++sum.inverted;
                }
            }
            return sum;
        },
        [](const TetShapes& a, const TetShapes& b) {
            return TetShapes{a.degenerate + b.degenerate, a.inverted + b.inverted};
        });
}

TetMesh build_tet_mesh(const HexMesh& hexes, std::span<const double> values) {
    if (hexes.cells.size() > kMaxCells) {
        throw Error(ErrorCode::InvalidInput, "the mesh has " + std::to_string(hexes.cells.size()) + " cells", {},
                    "at most " + std::to_string(kMaxCells));
    }
    if (hexes.points.size() > TetLink::kBoundary) {
        throw Error(ErrorCode::InvalidInput, "the mesh has " + std::to_string(hexes.points.size()) + " points", {},
                    "at most " + std::to_string(TetLink::kBoundary));
    }
    TetMesh mesh;
    mesh.points.resize(hexes.points.size());
    parallel_each(mesh.points.size(), [&](std::size_t p) { mesh.points[p] = {hexes.points[p], values[p]}; });
    mesh.tets.resize(kTetsPerCell * hexes.cells.size());
    parallel_each(hexes.cells.size(), [&](std::size_t c) {
        const auto split = split_cell(hexes.cells[c]);
        for (std::size_t k = 0; k < kTetsPerCell; ++k) mesh.tets[kTetsPerCell * c + k] = {split[k]};
    });
    mesh.shapes = tet_shapes(hexes);
    connect(mesh);
    return mesh;
}

}  // namespace subvol::detail
