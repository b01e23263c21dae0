// SPDX-License-Identifier: Apache-2.0
// Fills voxels with cells, batch by batch. Blocks are cells, or pieces of them, in the order of their numbers:
//
//     blocks ─► batch: nodes (cells, refined grids or pieces), in voxels, and values ─► box of voxels for each block
//            ─► bricks that the boxes reach ─► one task a brick, which fills its blocks in order; the first one keeps a voxel
//
// A piece without voxels in its box is not loaded. If pieces are searched for, they are filled as they are found. Where only
// some cells of a curved mesh are filled, their neighbours beyond the cut are filled too, as neighbours place their shared side
// slightly differently and the first one has a voxel. Voxels without the number of a wanted cell are removed after that.
//
// Last, leaks are removed: where tetrahedra are turned, boxes are doubtful, and the voxels in them that have winding number 0
// about the boundary lie outside. Only the part of the boundary whose columns reach doubtful tiles is made.
#include "brick_filler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>
#include <set>

#include "boundary_triangles.h"
#include "check_voxels.h"
#include "subvol/topology.h"

namespace subvol::detail {

namespace {

constexpr int kLeafBits = std::countr_zero(unsigned{kLeafSide});
constexpr std::size_t kBatchNodes = 1 << 17;  // of an unrefined mesh
constexpr std::size_t kBatchPieceNodes = 1 << 19;
constexpr std::size_t kBatchRefinedNodes =
    1 << 22;  // smaller batches refine more surrounding cells, larger ones need more memory

bool touch(const VoxelBox& a, const VoxelBox& b) {
    return !common(a, b).empty();
}

/// Removes those voxels of a box in a brick that lie outside a surface.
void drop_outside(const SurfaceColumns& surface, const VoxelBox& box, std::size_t channels, VoxelBrick& brick) {
    for (std::size_t l = 0; l < brick.leaves.size(); ++l) {
        auto& leaf = brick.leaves[l];
        const VoxelCoord o = brick.leaf_origin(l);
        const VoxelBox part = common(box, {o, {o[0] + kLeafSide - 1, o[1] + kLeafSide - 1, o[2] + kLeafSide - 1}});
        if (!leaf || part.empty()) continue;
        for (int x = part.lower[0]; x <= part.upper[0]; ++x) {
            for (int y = part.lower[1]; y <= part.upper[1]; ++y) {
                for (int z = part.lower[2]; z <= part.upper[2]; ++z) {
                    const auto word = static_cast<std::size_t>(x - o[0]);
                    const auto place = static_cast<std::size_t>((y - o[1]) * kLeafSide + z - o[2]);
                    const std::uint64_t bit = std::uint64_t{1} << place;
                    if ((leaf->active[word] & bit) == 0 || surface.winding({x, y, z}) != 0) continue;
                    leaf->active[word] &= ~bit;
                    for (std::size_t c = 0; c < channels; ++c) leaf->values[c * kLeafVoxels + 64 * word + place] = 0;
                }
            }
        }
        if (leaf->empty()) leaf.reset();
    }
}

/// For each cell the sides that are wanted: bit i is the side i of `kCellFaces`. wanted: by the cells of a face
template <class Wanted>
std::vector<std::uint8_t> sides_of(const HexMesh& mesh, const Wanted& wanted) {
    const Topology topology = build_topology(mesh);
    std::vector<std::uint8_t> sides(mesh.cells.size());
    for (std::size_t c = 0; c < sides.size(); ++c) {
        for (std::size_t i = 0; i < 6; ++i) {
            if (wanted(topology.face_cells[topology.cell_faces[c][i]])) sides[c] |= static_cast<std::uint8_t>(1 << i);
        }
    }
    return sides;
}

/// Removes the voxels of cells without a number.
void drop_others(std::size_t channels, VoxelBrick& brick) {
    for (auto& leaf : brick.leaves) {
        if (!leaf) continue;
        const float* numbers = &leaf->values[(channels - 1) * kLeafVoxels];
        for (std::size_t i = 0; i < kLeafVoxels; ++i) {
            const std::uint64_t bit = std::uint64_t{1} << i % 64;
            if ((leaf->active[i / 64] & bit) == 0 || std::bit_cast<Index>(numbers[i]) != kNone) continue;
            leaf->active[i / 64] &= ~bit;
            for (std::size_t c = 0; c < channels; ++c) leaf->values[c * kLeafVoxels + i] = 0;
        }
        if (leaf->empty()) leaf.reset();
    }
}

}  // namespace

BrickFiller::BrickFiller(CellRequest request)
    : request_(std::move(request)), refined_(request_, request_.curved ? DenseBits::ToRounding : DenseBits::OfRefine) {
    for (const Attribute* field : request_.fields) channels_ += static_cast<std::size_t>(field->channels);
    orientation_ = check_voxel_count(*request_.mesh, request_.to_voxels, request_.numbers) < 0 ? -1 : 1;
    if (!request_.curved) return;
    if (!request_.pieces && !request_.search) {
        boundary_ = sides_of(*request_.mesh, [](const auto& cells) { return cells[1] == kNone; });
    }
    if (!request_.numbers.empty()) {
        cut_ = sides_of(*request_.mesh, [&](const auto& cells) { return cells[1] != kNone && request_.ends_at(cells); });
    }
}

VoxelBricks BrickFiller::run(const std::optional<VoxelBox>& part) {
    VoxelBricks bricks(channels_ + (has_numbers() ? 1 : 0));
    if (request_.search) {
        fill_found(part, bricks);
    } else {
        std::vector<VoxelBox> boxes = fill_blocks(blocks_in(part), part, bricks);
        if (boxes_.empty()) boxes_ = std::move(boxes);
    }
    if (!cut_.empty()) {
        const std::vector<VoxelBrick*> all = bricks.all();
        tbb::parallel_for(std::size_t{0}, all.size(), [&](std::size_t b) { drop_others(bricks.channels(), *all[b]); });
    }
    drop_leaks(bricks.channels());
    report_progress(request_.progress, "rasterize", 1);
    return bricks;
}

/// Fills pieces as they are found. Afterwards the request is one of cells whose levels are known.
void BrickFiller::fill_found(const std::optional<VoxelBox>& part, VoxelBricks& bricks) {
    found_ = visit_limit_pieces(*request_.mesh, request_.refine, *request_.search, [&](const LimitPieces& pieces) {
        request_.pieces = &pieces;
        const std::vector<VoxelBox> boxes = fill_blocks(blocks_in({}), part, bricks);
        for (std::size_t b = 0; b < boxes.size(); ++b) {
            if (pieces.hull_sides[b] == 0 && !touches_cut(static_cast<Index>(b))) continue;
            boxes_.push_back(boxes[b]);
            cells_of_boxes_.push_back(pieces.cells[b]);
        }
    });
    request_.pieces = nullptr;
    request_.search = nullptr;
    request_.refine.levels = found_.level;
}

/// Returns the boxes of the blocks.
std::vector<VoxelBox> BrickFiller::fill_blocks(std::span<const Index> blocks, const std::optional<VoxelBox>& part,
                                               VoxelBricks& bricks) {
    std::vector<VoxelBox> boxes;
    boxes.reserve(blocks.size());
    for (std::size_t first = 0; first < blocks.size(); first += batch_.numbers.size()) {
        report_progress(request_.progress, "rasterize", request_.cell_of(blocks[first]), request_.mesh->cells.size());
        load(blocks.subspan(first), batch_);
        fill(batch_, part, bricks);
        boxes.insert(boxes.end(), batch_.boxes.begin(), batch_.boxes.end());
    }
    return boxes;
}

std::vector<Index> BrickFiller::blocks_in(const std::optional<VoxelBox>& part) const {
    std::vector<Index> blocks;
    for (Index b = 0; b < request_.block_count(); ++b) {
        if (!part || boxes_.empty() || touch(boxes_[b], *part)) blocks.push_back(b);
    }
    return blocks;
}

/// The sides of a block that lie on the boundary.
std::uint8_t BrickFiller::boundary_of(Index block) const {
    if (!request_.curved) return 0;
    return request_.pieces ? request_.pieces->hull_sides[block] : boundary_[block];
}

/// Whether a block lies on one of its cell's sides where what is filled ends inside the mesh.
bool BrickFiller::touches_cut(Index block) const {
    const std::uint8_t sides = cut_.empty() ? 0 : cut_[request_.cell_of(block)];
    if (sides == 0 || !request_.pieces) return sides != 0;
    const auto& lowest = request_.pieces->lowest[block];
    const int last = (1 << request_.pieces->levels[block]) - 1;
    for (unsigned side = 0; side < 6; ++side) {
        if ((sides >> side & 1U) != 0 && lowest[side / 2] == (side % 2 == 0 ? 0 : last)) return true;
    }
    return false;
}

/// Whether the voxels of a block are filled. Neighbours that are curved have slightly different ideas of their shared side, so
/// that the first of them has a voxel: those beyond a cut are filled, too, and what they have is removed again.
bool BrickFiller::is_filled(Index block) const {
    return request_.fills(request_.cell_of(block)) || touches_cut(block);
}

CellBlock BrickFiller::block(const Batch& batch, std::size_t i) const {
    const std::size_t first = batch.first[i];
    return {.cell = request_.number_of(request_.cell_of(batch.numbers[i])),
            .side = request_.side(batch.numbers[i]),
            .step = 1,
            .curved = request_.curved,
            .channels = channels_,
            .cell_numbers = has_numbers(),
            .orientation = orientation_,
            .boundary = boundary_of(batch.numbers[i]),
            .slack = request_.curved ? request_.slack_voxels : 0,
            .points = batch.points.data() + first,
            .values = batch.values.data() + first * channels_,
            .ids = refines() ? nullptr : batch.ids.data() + first,
            .piece_boxes = request_.curved ? batch.piece_boxes.data() + batch.first_piece[i] : nullptr};
}

/// Loads the first of the blocks, as many as make a batch.
void BrickFiller::load(std::span<const Index> blocks, Batch& batch) {
    const std::size_t most = request_.pieces ? kBatchPieceNodes : refines() ? kBatchRefinedNodes : kBatchNodes;
    batch.first.assign(1, 0);
    for (std::size_t i = 0; i < blocks.size() && batch.first.back() < most; ++i) {
        const std::size_t n = request_.side(blocks[i]);
        batch.first.push_back(batch.first.back() + n * n * n);
    }
    batch.numbers = blocks.first(batch.first.size() - 1);
    batch.points.resize(batch.first.back());
    batch.values.resize(batch.first.back() * channels_);
    batch.boxes.resize(batch.numbers.size());
    if (request_.pieces) {
        load_pieces(batch);
    } else if (refines()) {
        load_refined(batch);
    } else {
        load_cells(batch);
    }
    if (!request_.pieces) set_boxes(batch);
    for (std::size_t i = 0; i < batch.numbers.size(); ++i) {
        if (!is_filled(batch.numbers[i])) batch.boxes[i] = {{0, 0, 0}, {-1, -1, -1}};  // none
    }
    check_brick_count(batch.boxes, request_.to_voxels.voxel_size);
}

/// The voxels of blocks whose nodes are loaded.
void BrickFiller::set_boxes(Batch& batch) const {
    batch.first_piece.assign(1, 0);
    if (request_.curved) {
        for (std::size_t i = 0; i < batch.numbers.size(); ++i) {
            batch.first_piece.push_back(batch.first_piece.back() + block(batch, i).pieces());
        }
        batch.piece_boxes.resize(batch.first_piece.back());
    }
    tbb::parallel_for(std::size_t{0}, batch.numbers.size(), [&](std::size_t i) {
        const CellBlock cell = block(batch, i);
        if (cell.curved) set_piece_boxes(cell, &batch.piece_boxes[batch.first_piece[i]]);
        batch.boxes[i] = voxels_of(cell);
    });
}

void BrickFiller::load_cells(Batch& batch) const {
    batch.ids.resize(batch.first.back());
    const HexMesh& mesh = *request_.mesh;
    tbb::parallel_for(std::size_t{0}, batch.numbers.size(), [&](std::size_t i) {
        for (std::size_t k = 0; k < 8; ++k) {
            const Index id = mesh.cells[batch.numbers[i]][k];
            const std::size_t node = 8 * i + kCornerOctants[k];
            batch.ids[node] = id;
            batch.points[node] = request_.to_voxels(mesh.points[id]);
            double* value = batch.values.data() + node * channels_;
            for (const Attribute* field : request_.fields) {
                const auto channels = static_cast<std::size_t>(field->channels);
                value = std::copy_n(field->values.data() + id * channels, channels, value);
            }
        }
    });
}

/// Nodes and values of a piece are loaded only if there may be voxels in it.
void BrickFiller::load_pieces(Batch& batch) const {
    const LimitPieces& pieces = *request_.pieces;
    batch.first_piece.resize(batch.numbers.size());
    std::iota(batch.first_piece.begin(), batch.first_piece.end(), std::size_t{0});
    batch.piece_boxes.resize(batch.numbers.size());
    const Mat3 linear = request_.to_voxels.linear / request_.to_voxels.voxel_size;
    tbb::parallel_for(std::size_t{0}, batch.numbers.size(), [&](std::size_t i) {
        const std::size_t piece = batch.numbers[i], first = batch.first[i];
        const Vec3 origin = request_.to_voxels(pieces.origins[piece]);
        std::array<Vec3, kCurvedNodes> points;
        for (std::size_t n = 0; n < kCurvedNodes; ++n) {
            const float* node = pieces.node(piece, n);
            points[n] = origin + linear * Vec3(node[0], node[1], node[2]);
        }
        CellBlock bare = block(batch, i);
        bare.points = points.data();
        set_piece_boxes(bare, &batch.piece_boxes[i]);
        batch.boxes[i] = batch.piece_boxes[i];
        if (batch.boxes[i].empty()) return;
        std::ranges::copy(points, batch.points.begin() + static_cast<std::ptrdiff_t>(first));
        for (std::size_t n = 0; n < kCurvedNodes; ++n) {
            double* value = batch.values.data() + (first + n) * channels_;
            for (std::size_t f = 0; f < request_.fields.size(); ++f) {
                const std::size_t channel = request_.places_in_pieces[f] - 3;
                for (std::size_t c = 0; c < static_cast<std::size_t>(request_.fields[f]->channels); ++c) {
                    *value++ = pieces.value(piece, n, channel + c);
                }
            }
        }
    });
}

void BrickFiller::load_refined(Batch& batch) const {
    std::map<int, std::vector<Index>> of_level;
    for (const Index cell : batch.numbers) of_level[request_.levels(cell)].push_back(cell);
    for (const auto& [levels, cells] : of_level) {
        refined_.for_each(cells, levels, [&](const DenseCell& cell) {
            const auto slot =
                static_cast<std::size_t>(std::ranges::lower_bound(batch.numbers, cell.cell) - batch.numbers.begin());
            const std::size_t nodes = cell.points.size(), first = batch.first[slot];
            for (std::size_t n = 0; n < nodes; ++n) {
                batch.points[first + n] = request_.to_voxels(cell.points[n]);
                double* value = batch.values.data() + (first + n) * channels_;
                for (std::size_t a = 0; a < cell.values.size(); ++a) {
                    const std::size_t channels = cell.values[a].size() / nodes;
                    value = std::copy_n(cell.values[a].data() + n * channels, channels, value);
                }
            }
        });
    }
}

void BrickFiller::fill(const Batch& batch, const std::optional<VoxelBox>& part, VoxelBricks& bricks) {
    for (Index i = 0; i < batch.numbers.size(); ++i) {
        bricks.enter(i, part ? common(batch.boxes[i], *part) : batch.boxes[i]);
    }
    const std::vector<VoxelBrick*> entered = bricks.take_entered();
    tbb::parallel_for(std::size_t{0}, entered.size(), [&](std::size_t b) {
        CellShape shape;
        for (const Index i : entered[b]->cells) {
            fill_block(block(batch, i), shape, *entered[b]);
        }
        entered[b]->cells.clear();
        entered[b]->cells.shrink_to_fit();
    });
    for (VoxelBrick* brick : entered) {
        if (!brick->doubtful.empty()) doubtful_.push_back(brick);
    }
}

/// The boundary's columns of voxels that go through the doubtful boxes of bricks.
SurfaceColumns BrickFiller::columns_through(std::span<VoxelBrick* const> bricks) const {
    std::set<std::pair<int, int>> tiles;  // of leaves' width, across the columns
    const auto each_tile = [](const VoxelBox& box, const auto& visit) {
        for (int x = box.lower[0] >> kLeafBits; x <= box.upper[0] >> kLeafBits; ++x) {
            for (int y = box.lower[1] >> kLeafBits; y <= box.upper[1] >> kLeafBits; ++y) {
                if (visit(std::pair(x, y))) return true;
            }
        }
        return false;
    };
    for (const VoxelBrick* brick : bricks) {
        for (const VoxelBox& box : brick->doubtful) each_tile(box, [&](const auto& tile) { return tiles.insert(tile), false; });
    }
    std::vector<std::uint8_t> wanted(request_.mesh->cells.size(), 0);
    for (Index b = 0; b < boxes_.size(); ++b) {
        auto& of_cell = wanted[cells_of_boxes_.empty() ? request_.cell_of(b) : cells_of_boxes_[b]];
        if (of_cell == 0 && each_tile(boxes_[b], [&](const auto& tile) { return tiles.contains(tile); })) of_cell = 1;
    }
    return SurfaceColumns(boundary_triangles(request_, [&](Index cell) { return wanted[cell] != 0; }));
}

/// Removes voxels that only folded cells filled. The signed number of tetrahedra around a centre is its winding number; where
/// that is 0, turned tetrahedra cancel the others and the centre lies outside.
void BrickFiller::drop_leaks(std::size_t leaf_channels) {
    std::ranges::sort(doubtful_);
    doubtful_.erase(std::unique(doubtful_.begin(), doubtful_.end()), doubtful_.end());
    folded_ = !doubtful_.empty();
    if (doubtful_.empty()) return;
    const SurfaceColumns columns = columns_through(doubtful_);
    tbb::parallel_for(std::size_t{0}, doubtful_.size(), [&](std::size_t i) {
        VoxelBrick& brick = *doubtful_[i];
        for (const VoxelBox& box : brick.doubtful) drop_outside(columns, box, leaf_channels, brick);
        brick.doubtful = {};
    });
    doubtful_.clear();
}

}  // namespace subvol::detail
