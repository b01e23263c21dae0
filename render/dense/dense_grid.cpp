// SPDX-License-Identifier: Apache-2.0
// The grid of one control cell, 2^L micro-cells along each axis, as a mesh of tetrahedra that stores no neighbours. First the
// points are ranked by (x, y, z), and a rank is a point's id. Then each micro-cell chooses its split by these ids: 8 apexes
// times 2³ diagonals of the faces away from the apex, the smallest id of a face deciding. Two grids with a common side have the
// same points there in the same order, so they split it alike.
//
//     tetrahedron t = 8 · micro-cell + 0..5      face f = 4 · t + the corner opposite to it
//     neighbour across a face: within the micro-cell by the table of its split; beyond it, in the next micro-cell, the owner of
//     the triangle that leaves out the same corner of the shared quad
//
// Each of the six sides has a quadtree of boxes, from one box down to a box for each quad. A ray descends it and tests the
// triangles of the quads that its boxes admit. Boxes are floats relative to the first point, and tested with a margin for
// rounding.
#include "dense_grid.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <tuple>

#include "subvol/topology.h"

namespace subvol::detail {

namespace {

std::size_t corner_of_face(std::size_t face, std::size_t k) {
    return kCellFaces[face][k % 4];
}

unsigned mask_of_face(std::size_t face) {
    unsigned mask = 0;
    for (std::size_t k = 0; k < 4; ++k) mask |= 1u << corner_of_face(face, k);
    return mask;
}

unsigned mask_of_triangle(const CellSplit& split, std::size_t tet, std::size_t opposite) {
    unsigned mask = 0;
    for (std::size_t k = 0; k < 4; ++k) {
        if (k != opposite) mask |= 1u << split.corners[tet][k];
    }
    return mask;
}

std::uint8_t lowest_bit(unsigned mask) {
    std::uint8_t bit = 0;
    while ((mask >> bit & 1u) == 0) ++bit;
    return bit;
}

void connect(CellSplit& split, std::size_t tet, std::size_t opposite) {
    const unsigned triangle = mask_of_triangle(split, tet, opposite);
    for (std::size_t other = 0; other < 6; ++other) {
        for (std::size_t k = 0; k < 4; ++k) {
            if (other == tet || mask_of_triangle(split, other, k) != triangle) continue;
            split.neighbors[tet][opposite] = static_cast<std::uint8_t>(other);
            return;
        }
    }
    for (std::size_t face = 0; face < 6; ++face) {
        if ((mask_of_face(face) & triangle) != triangle) continue;
        const std::uint8_t missing = lowest_bit(mask_of_face(face) & ~triangle);
        split.neighbors[tet][opposite] = static_cast<std::uint8_t>(8 + face);
        split.missing[tet][opposite] = missing;
        split.owners[face][missing] = static_cast<std::uint8_t>(4 * tet + opposite);
        return;
    }
}

CellSplit make_split(std::size_t apex, unsigned diagonals) {
    CellSplit split;
    for (auto& owners : split.owners) owners.fill(CellSplit::kNoOwner);
    std::size_t count = 0;
    for (std::size_t face = 0; face < 6; ++face) {
        if (mask_of_face(face) >> apex & 1u) continue;
        const std::size_t first = diagonals >> (count / 2) & 1u;
        const auto corner = [&](std::size_t k) { return static_cast<std::uint8_t>(corner_of_face(face, first + k)); };
        const auto top = static_cast<std::uint8_t>(apex);
        split.corners[count++] = {corner(0), corner(2), corner(1), top};
        split.corners[count++] = {corner(0), corner(3), corner(2), top};
    }
    for (std::size_t tet = 0; tet < 6; ++tet) {
        for (std::size_t k = 0; k < 4; ++k) connect(split, tet, k);
    }
    return split;
}

}  // namespace

const std::array<CellSplit, 64>& cell_splits() {
    static const auto kSplits = [] {
        std::array<CellSplit, 64> all;
        for (std::size_t s = 0; s < all.size(); ++s) all[s] = make_split(s % 8, static_cast<unsigned>(s / 8));
        return all;
    }();
    return kSplits;
}

std::uint8_t cell_split_of(const std::array<Index, 8>& cell) {
    const auto apex = static_cast<std::size_t>(std::min_element(cell.begin(), cell.end()) - cell.begin());
    unsigned diagonals = 0, count = 0;
    for (std::size_t face = 0; face < 6; ++face) {
        if (mask_of_face(face) >> apex & 1u) continue;
        const auto id = [&](std::size_t k) { return cell[corner_of_face(face, k)]; };
        if (std::min(id(1), id(3)) < std::min(id(0), id(2))) diagonals |= 1u << count;
        ++count;
    }
    return static_cast<std::uint8_t>(apex + std::size_t{8} * diagonals);
}

namespace {

/// The number of boxes of a quadtree above level l: 1 + 4 + … + 4^(l−1).
std::size_t boxes_above(int level) {
    return ((std::size_t{1} << (2 * level)) - 1) / 3;
}

}  // namespace

DenseGrid::DenseGrid(const DenseCell& cell, std::size_t attribute)
    : cell_splits_(cell_splits().data()),
      cell_(cell.cell),
      side_(cell.side),
      levels_(std::countr_zero(cell.side - 1)),
      origin_(cell.points[0]) {
    for (std::size_t k = 0; k < 8; ++k) {
        const auto& [u, v, w] = kCellCorners[k];
        step_[k] = static_cast<std::size_t>(u) + side_ * (static_cast<std::size_t>(v) + side_ * static_cast<std::size_t>(w));
    }
    rank_points(cell, attribute);
    split_cells();
    build_sides();
}

void DenseGrid::rank_points(const DenseCell& cell, std::size_t attribute) {
    const std::size_t channels = cell.values[attribute].size() / cell.points.size();
    const auto key = [&](Index n) {
        const Vec3& p = cell.points[n];
        return std::tuple(p.x, p.y, p.z, n);
    };
    std::vector<Index> order(cell.points.size());
    std::iota(order.begin(), order.end(), Index{0});
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return key(a) < key(b); });
    points_.resize(order.size());
    ranks_.resize(order.size());
    range_ = {cell.values[attribute][0], cell.values[attribute][0]};
    for (Index rank = 0; rank < order.size(); ++rank) {
        const Index n = order[rank];
        const double value = cell.values[attribute][n * channels];
        ranks_[n] = rank;
        points_[rank] = {cell.points[n], value};
        box_.add(cell.points[n]);
        range_ = {std::min(range_.min, value), std::max(range_.max, value)};
    }
}

void DenseGrid::split_cells() {
    splits_.resize(std::size_t{1} << (3 * levels_));
    for (std::size_t c = 0; c < splits_.size(); ++c) {
        std::array<Index, 8> ids;
        for (std::size_t k = 0; k < 8; ++k) ids[k] = ranks_[lowest_node(c) + step_[k]];
        splits_[c] = cell_split_of(ids);
    }
}

std::array<Index, 3> DenseGrid::cell_at(std::size_t face, Index i, Index j) const {
    const CellSide side = cell_side(face);
    std::array<Index, 3> at{};
    at[static_cast<std::size_t>(side.axis)] = side.end ? (Index{1} << levels_) - 1 : 0;
    at[static_cast<std::size_t>((side.axis + 1) % 3)] = i;
    at[static_cast<std::size_t>((side.axis + 2) % 3)] = j;
    return at;
}

DenseGrid::SmallBox DenseGrid::small_box(const Box& box) const {
    SmallBox small;
    for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        small.center[at] = static_cast<float>(0.5 * (box.lower[k] + box.upper[k]) - origin_[k]);
        small.half[at] = static_cast<float>(0.5 * (box.upper[k] - box.lower[k]));
    }
    return small;
}

void DenseGrid::build_sides() {
    sides_.resize(6 * boxes_above(levels_ + 1));
    std::vector<Box> boxes;
    for (std::size_t face = 0; face < 6; ++face) {
        SmallBox* const tree = sides_.data() + face * boxes_above(levels_ + 1);
        const CellSide side = cell_side(face);
        const Index n = Index{1} << levels_;
        boxes.assign(std::size_t{n} * n, {});
        for (Index j = 0; j < n; ++j) {
            for (Index i = 0; i < n; ++i) {
                const std::size_t lowest = lowest_node(cell_number(cell_at(face, i, j)));
                for (std::size_t k = 0; k < 8; ++k) {
                    if (kCellCorners[k][static_cast<std::size_t>(side.axis)] != side.end) continue;
                    boxes[i + std::size_t{n} * j].add(points_[ranks_[lowest + step_[k]]].position);
                }
            }
        }
        for (int level = levels_; level >= 0; --level) {
            const std::size_t width = std::size_t{1} << level;
            for (std::size_t b = 0; b < width * width; ++b) tree[boxes_above(level) + b] = small_box(boxes[b]);
            if (level == 0) break;
            std::vector<Box> above(width * width / 4);
            for (std::size_t j = 0; j < width; ++j) {
                for (std::size_t i = 0; i < width; ++i) {
                    Box& parent = above[i / 2 + width / 2 * (j / 2)];
                    parent.add(boxes[i + width * j].lower);
                    parent.add(boxes[i + width * j].upper);
                }
            }
            boxes = std::move(above);
        }
    }
}

std::size_t DenseGrid::bytes() const {
    return sizeof(*this) + points_.size() * sizeof(Point) + ranks_.size() * sizeof(Index) + splits_.size() +
           sides_.size() * sizeof(SmallBox);
}

Index DenseGrid::neighbor(Index tet, Index k) const {
    const CellSplit& split = cell_splits_[splits_[tet / 8]];
    const std::uint8_t next = split.neighbors[tet % 8][k];
    if (next < 8) return (tet & ~Index{7}) + next;
    const std::size_t face = next - 8u;
    const CellSide side = cell_side(face);
    const std::size_t cell = tet / 8, stride = std::size_t{1} << (side.axis * levels_);
    const std::size_t at = cell / stride % (std::size_t{1} << levels_);
    if (at == (side.end ? (std::size_t{1} << levels_) - 1 : 0)) return kNone;
    const std::size_t beyond = side.end ? cell + stride : cell - stride;
    const std::size_t missing = corner_across(split.missing[tet % 8][k], side.axis);
    const std::size_t opposite = opposite_face(face);
    return static_cast<Index>(8 * beyond + cell_splits_[splits_[beyond]].owners[opposite][missing] / 4u);
}

const DenseGrid::SmallBox& DenseGrid::small_box(const SidePart& part) const {
    return sides_[part.side * boxes_above(levels_ + 1) + boxes_above(part.level) + part.i +
                  (std::size_t{part.j} << part.level)];
}

Box DenseGrid::box_of(const SidePart& part) const {
    const SmallBox& small = small_box(part);
    const Vec3 center = origin_ + Vec3(small.center[0], small.center[1], small.center[2]);
    const Vec3 half(small.half[0], small.half[1], small.half[2]);
    Box box;
    box.add(center - half);
    box.add(center + half);
    return box;
}

void DenseGrid::descend(const RayPlane& plane, double margin, const SidePart& part, std::vector<TetFace>& faces) const {
    const SmallBox& box = small_box(part);
    const Vec3 center = origin_ + Vec3(box.center[0], box.center[1], box.center[2]);
    if (!plane.may_meet(center, Vec3(box.half[0], box.half[1], box.half[2]), margin)) return;
    if (part.level < levels_) {
        for (Index k = 0; k < 4; ++k) {
            descend(plane, margin, {part.side, part.level + 1, 2 * part.i + k % 2, 2 * part.j + k / 2}, faces);
        }
        return;
    }
    const std::size_t cell = cell_number(cell_at(part.side, part.i, part.j));
    for (const std::uint8_t owner : cell_splits_[splits_[cell]].owners[part.side]) {
        if (owner == CellSplit::kNoOwner) continue;
        const auto triangle = static_cast<TetFace>(32 * cell + owner);
        if (cross_face(*this, plane, triangle)) faces.push_back(triangle);
    }
}

DenseGrid::SideTriangle DenseGrid::on_side(TetFace face) const {
    const std::size_t tet = face / 4, cell = tet / 8;
    const CellSplit& split = cell_splits_[splits_[cell]];
    const std::size_t side = split.neighbors[tet % 8][face % 4] - 8u;
    const auto& missing = kCellCorners[split.missing[tet % 8][face % 4]];
    SideTriangle triangle{side, {}, {}};
    for (std::size_t k = 0; k < 2; ++k) {
        const std::size_t axis = (side / 2 + 1 + k) % 3;
        triangle.quad[k] = static_cast<Index>(cell >> (axis * static_cast<std::size_t>(levels_)) & ((Index{1} << levels_) - 1));
        triangle.missing[k] = static_cast<Index>(missing[axis]);
    }
    return triangle;
}

std::optional<TetFace> DenseGrid::face_of(const SideTriangle& triangle) const {
    const std::size_t cell = cell_number(cell_at(triangle.side, triangle.quad[0], triangle.quad[1]));
    const CellSide side = cell_side(triangle.side);
    for (std::size_t k = 0; k < 8; ++k) {
        const auto at = [&](int axis) { return kCellCorners[k][static_cast<std::size_t>(axis % 3)]; };
        if (at(side.axis) != side.end || at(side.axis + 1) != static_cast<int>(triangle.missing[0]) ||
            at(side.axis + 2) != static_cast<int>(triangle.missing[1])) {
            continue;
        }
        const std::uint8_t owner = cell_splits_[splits_[cell]].owners[triangle.side][k];
        if (owner == CellSplit::kNoOwner) return std::nullopt;
        return static_cast<TetFace>(32 * cell + owner);
    }
    return std::nullopt;
}

void DenseGrid::find_crossed(const RayPlane& plane, const SidePart& part, std::vector<TetFace>& faces) const {
    // For rounding: of the boxes in single precision about the origin, of the points in double precision about the eye.
    const Vec3 away = glm::abs(origin_ - plane.origin()), place = glm::abs(origin_);
    const double margin =
        1e-6 * box_.diagonal() + 1e-14 * (std::max({away.x, away.y, away.z}) + std::max({place.x, place.y, place.z}));
    descend(plane, margin, part, faces);
}

}  // namespace subvol::detail
