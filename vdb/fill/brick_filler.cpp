// SPDX-License-Identifier: Apache-2.0
#include "brick_filler.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>

#include "boundary_triangles.h"
#include "check_voxels.h"
#include "subvol/detail/flat_array.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kBatchNodes = 1 << 17;  // of an unrefined mesh
constexpr std::size_t kBatchRefinedNodes =
    1 << 20;  // smaller batches refine more surrounding cells, larger ones need more memory

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

}  // namespace

/// The blocks of some cells, one after the other.
///
/// first: the first node of each block, then the number of all nodes; boxes: the voxels of each block
struct BrickFiller::Batch {
    std::span<const Index> cells;
    std::vector<std::size_t> first;
    FlatArray<Vec3> points;
    FlatArray<double> values;
    FlatArray<Index> ids;  // of the nodes of unrefined cells
    std::vector<VoxelBox> boxes;
};

BrickFiller::BrickFiller(CellRequest request) : request_(std::move(request)), refined_(request_) {
    for (const Attribute* field : request_.fields) channels_ += static_cast<std::size_t>(field->channels);
    orientation_ = check_voxel_count(*request_.mesh, request_.to_voxels) < 0 ? -1 : 1;
}

VoxelBricks BrickFiller::run(const std::optional<VoxelBox>& part) {
    VoxelBricks bricks(channels_ + (request_.cell_numbers ? 1 : 0));
    const std::vector<Index> cells = cells_of(part);
    const bool first_run = boxes_.empty();
    std::vector<VoxelBox> boxes;
    Batch batch;
    for (std::size_t first = 0; first < cells.size(); first += batch.cells.size()) {
        report_progress(request_.progress, "rasterize", static_cast<double>(first) / static_cast<double>(cells.size()));
        load(std::span(cells).subspan(first), batch);
        fill(batch, part, bricks);
        if (first_run) boxes.insert(boxes.end(), batch.boxes.begin(), batch.boxes.end());
    }
    if (first_run) boxes_ = std::move(boxes);
    drop_leaks(bricks.channels());
    report_progress(request_.progress, "rasterize", 1);
    return bricks;
}

std::vector<Index> BrickFiller::cells_of(const std::optional<VoxelBox>& part) const {
    std::vector<Index> cells;
    for (std::size_t c = 0; c < request_.mesh->cells.size(); ++c) {
        if (!part || boxes_.empty() || touch(boxes_[c], *part)) cells.push_back(static_cast<Index>(c));
    }
    return cells;
}

CellBlock BrickFiller::block(const Batch& batch, std::size_t i) const {
    const std::size_t first = batch.first[i];
    return {.cell = batch.cells[i],
            .side = side(batch.cells[i]),
            .step = request_.curved && request_.levels(batch.cells[i]) > request_.refine.levels ? std::size_t{2} : 1,
            .curved = request_.curved,
            .channels = channels_,
            .cell_numbers = request_.cell_numbers,
            .orientation = orientation_,
            .points = batch.points.data() + first,
            .values = batch.values.data() + first * channels_,
            .ids = refines() ? nullptr : batch.ids.data() + first};
}

/// Loads the first of the cells, as many as make a batch.
void BrickFiller::load(std::span<const Index> cells, Batch& batch) {
    const std::size_t most = refines() ? kBatchRefinedNodes : kBatchNodes;
    batch.first.assign(1, 0);
    for (std::size_t i = 0; i < cells.size() && batch.first.back() < most; ++i) {
        const std::size_t n = side(cells[i]);
        batch.first.push_back(batch.first.back() + n * n * n);
    }
    batch.cells = cells.first(batch.first.size() - 1);
    batch.points.resize(batch.first.back());
    batch.values.resize(batch.first.back() * channels_);
    batch.boxes.resize(batch.cells.size());
    if (refines()) {
        load_refined(batch);
    } else {
        load_cells(batch);
    }
    tbb::parallel_for(std::size_t{0}, batch.cells.size(), [&](std::size_t i) { batch.boxes[i] = voxels_of(block(batch, i)); });
    check_brick_count(batch.boxes, request_.to_voxels.voxel_size);
}

void BrickFiller::load_cells(Batch& batch) const {
    batch.ids.resize(batch.first.back());
    const HexMesh& mesh = *request_.mesh;
    tbb::parallel_for(std::size_t{0}, batch.cells.size(), [&](std::size_t i) {
        for (std::size_t k = 0; k < 8; ++k) {
            const Index id = mesh.cells[batch.cells[i]][k];
            const std::size_t node = 8 * i + kCornerOctants[k];
            batch.ids[node] = id;
            batch.points[node] = request_.to_voxels(mesh.points[id]);
            double* value = batch.values.data() + node * channels_;
            for (const Attribute* field : request_.fields) {
                const auto channels = static_cast<std::size_t>(field->channels);
                value = std::copy_n(field->values.begin() + static_cast<std::ptrdiff_t>(id * channels), channels, value);
            }
        }
    });
}

void BrickFiller::load_refined(Batch& batch) const {
    std::map<int, std::vector<Index>> of_level;
    for (const Index cell : batch.cells) of_level[request_.levels(cell)].push_back(cell);
    for (const auto& [levels, cells] : of_level) {
        refined_.for_each(cells, levels, [&](const DenseCell& cell) {
            const auto slot = static_cast<std::size_t>(std::ranges::lower_bound(batch.cells, cell.cell) - batch.cells.begin());
            const std::size_t nodes = cell.points.size(), first = batch.first[slot];
            for (std::size_t n = 0; n < nodes; ++n) {
                batch.points[first + n] = request_.to_voxels(cell.points[n]);
                double* value = batch.values.data() + (first + n) * channels_;
                for (std::size_t a = 0; a < cell.values.size(); ++a) {
                    const std::size_t channels = cell.values[a].size() / nodes;
                    value = std::copy_n(cell.values[a].begin() + static_cast<std::ptrdiff_t>(n * channels), channels, value);
                }
            }
        });
    }
}

void BrickFiller::fill(const Batch& batch, const std::optional<VoxelBox>& part, VoxelBricks& bricks) {
    for (std::size_t i = 0; i < batch.cells.size(); ++i) {
        bricks.enter(static_cast<Index>(i), part ? common(batch.boxes[i], *part) : batch.boxes[i]);
    }
    const std::vector<VoxelBrick*> entered = bricks.take_entered();
    tbb::parallel_for(std::size_t{0}, entered.size(), [&](std::size_t b) {
        CellShape shape;
        for (const Index i : entered[b]->cells) {
            CellBlock cell = block(batch, i);
            fill_block(cell, shape, *entered[b]);
            // The cells of `refine.levels` bound the volume: they fill the gaps between their faces and those of finer cells.
            const std::size_t coarsest = (cell.side - 1) >> request_.refine.levels;
            if (cell.step == coarsest) continue;
            cell.step = coarsest;
            fill_block(cell, shape, *entered[b]);
        }
        entered[b]->cells.clear();
        entered[b]->cells.shrink_to_fit();
    });
    for (VoxelBrick* brick : entered) {
        if (!brick->doubtful.empty()) doubtful_.push_back(brick);
    }
}

/// Removes voxels that only folded cells filled. The signed number of tetrahedra around a centre is its winding number; where
/// that is 0, turned tetrahedra cancel the others and the centre lies outside.
void BrickFiller::drop_leaks(std::size_t leaf_channels) {
    std::ranges::sort(doubtful_);
    doubtful_.erase(std::unique(doubtful_.begin(), doubtful_.end()), doubtful_.end());
    if (!doubtful_.empty() && !columns_) columns_.emplace(boundary_triangles(request_));
    tbb::parallel_for(std::size_t{0}, doubtful_.size(), [&](std::size_t i) {
        VoxelBrick& brick = *doubtful_[i];
        for (const VoxelBox& box : brick.doubtful) drop_outside(*columns_, box, leaf_channels, brick);
        brick.doubtful = {};
    });
    doubtful_.clear();
}

}  // namespace subvol::detail
