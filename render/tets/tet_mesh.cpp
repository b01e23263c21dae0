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

/// The faces of a cell's tetrahedra, sorted, and which of them lie inside the cell, two at the same place.
///
/// cell: `tets` tetrahedra that follow each other
class CellFaces {
public:
    CellFaces(const TetMesh& mesh, std::size_t cell, std::size_t tets) : count_(4 * tets) {
        for (std::size_t k = 0; k < count_; ++k) records_[k] = record_of(mesh, static_cast<TetFace>(count_ * cell + k));
        std::sort(records_.begin(), records_.begin() + static_cast<std::ptrdiff_t>(count_));
        for (std::size_t k = 0; k + 1 < count_; ++k) {
            if (records_[k].ids == records_[k + 1].ids) inside_[k] = inside_[k + 1] = true;
        }
    }

    void link_inside(TetMesh& mesh) const {
        for (std::size_t k = 0; k + 1 < count_; ++k) {
            if (!inside_[k]) continue;
            link(mesh, records_[k].face, records_[k + 1].face);
            ++k;
        }
    }
    template <class Sink>
    void each_side(const Sink& sink) const {
        for (std::size_t k = 0; k < count_; ++k) {
            if (!inside_[k]) sink(records_[k]);
        }
    }

private:
    std::size_t count_;
    std::array<FaceRecord, 4 * kTetsPerCell> records_{};
    std::array<bool, 4 * kTetsPerCell> inside_{};
};

/// Faces inside a cell find each other there. The others, on the cells' sides, are sorted.
void connect(TetMesh& mesh, std::size_t tets_per_cell) {
    mesh.links.resize(mesh.tets.size());
    const std::size_t cells = mesh.tets.size() / tets_per_cell;
    if (tets_per_cell > 1) parallel_each(cells, [&](std::size_t c) { CellFaces(mesh, c, tets_per_cell).link_inside(mesh); });
    const auto sides = bucket_sort<FaceRecord>(
        cells, mesh.points.size(), [&](std::size_t c, const auto& sink) { CellFaces(mesh, c, tets_per_cell).each_side(sink); },
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

Shape shape_of(const std::vector<Vec3>& points, const std::array<Index, 4>& tet) {
    std::array<Vec3, 4> p;
    for (std::size_t k = 0; k < 4; ++k) p[k] = points[tet[k]];
    const Vec3 a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
    const double longest =
        std::sqrt(std::max({dot(a, a), dot(b, b), dot(c, c), dot(b - a, b - a), dot(c - a, c - a), dot(c - b, c - b)}));
    const double volume = dot(cross(a, b), c);
    if (!(std::abs(volume) > kZeroVolume * longest * longest * longest)) return Shape::Degenerate;
    return volume < 0 ? Shape::Inverted : Shape::Regular;
}

/// tets_of: gives the tetrahedra of a cell
template <class TetsOf>
TetShapes count_shapes(const std::vector<Vec3>& points, std::size_t cells, const TetsOf& tets_of) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, cells, 1024), TetShapes{},
        [&](const auto& range, TetShapes sum) {
            for (std::size_t c = range.begin(); c < range.end(); ++c) {
                for (const auto& tet : tets_of(c)) {
                    const Shape shape = shape_of(points, tet);
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

void check_count(std::size_t count, std::size_t most, const char* what) {
    if (count <= most) return;
    throw Error(ErrorCode::InvalidInput, "the mesh has " + std::to_string(count) + what, {}, "at most " + std::to_string(most));
}

TetMesh points_with(const std::vector<Vec3>& points, std::span<const double> values) {
    check_count(points.size(), TetLink::kBoundary, " points");
    TetMesh mesh;
    mesh.points.resize(points.size());
    parallel_each(points.size(), [&](std::size_t p) { mesh.points[p] = {points[p], values[p]}; });
    return mesh;
}

const Attribute& scalar_of(const MixedMesh& mesh, std::string_view field) {
    for (const Attribute& attribute : mesh.attributes) {
        if (field.empty() || attribute.name == field) {
            if (attribute.channels == 1) return attribute;
            throw Error(ErrorCode::InvalidInput, "has " + std::to_string(attribute.channels) + " channels", attribute.name,
                        "1");
        }
    }
    throw Error(ErrorCode::InvalidInput, "the mesh has no such field", std::string(field));
}

}  // namespace

Box bounds_of(const TetMesh& mesh) {
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, mesh.tets.size(), 4096), Box{},
        [&](const auto& range, Box box) {
            for (std::size_t t = range.begin(); t < range.end(); ++t) {
                for (const Index p : mesh.tets[t].corner) box.add(mesh.points[p].position);
            }
            return box;
        },
        [](Box a, const Box& b) {
            a.add(b);
            return a;
        });
}

TetShapes tet_shapes(const HexMesh& mesh) {
    return count_shapes(mesh.points, mesh.cells.size(), [&](std::size_t c) { return split_cell(mesh.cells[c]); });
}

TetMesh build_tet_mesh(const HexMesh& hexes, std::span<const double> values) {
    check_count(hexes.cells.size(), kMaxCells, " cells");
    TetMesh mesh = points_with(hexes.points, values);
    mesh.tets.resize(kTetsPerCell * hexes.cells.size());
    parallel_each(hexes.cells.size(), [&](std::size_t c) {
        const auto split = split_cell(hexes.cells[c]);
        for (std::size_t k = 0; k < kTetsPerCell; ++k) mesh.tets[kTetsPerCell * c + k] = {split[k]};
    });
    mesh.shapes = tet_shapes(hexes);
    connect(mesh, kTetsPerCell);
    return mesh;
}

TetMesh build_tet_mesh(const MixedMesh& mixed, std::string_view field) {
    validate(mixed);
    const MixedMesh cut = in_tetrahedra(mixed);
    check_count(cut.tets.size(), kTetsPerCell * kMaxCells, " tetrahedra");
    TetMesh mesh = points_with(cut.points, scalar_of(cut, field).values);
    mesh.tets.resize(cut.tets.size());
    parallel_each(cut.tets.size(), [&](std::size_t t) { mesh.tets[t] = {cut.tets[t]}; });
    mesh.shapes = count_shapes(cut.points, cut.tets.size(), [&](std::size_t t) { return std::span(&cut.tets[t], 1); });
    connect(mesh, 1);
    return mesh;
}

}  // namespace subvol::detail
