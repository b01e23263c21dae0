// SPDX-License-Identifier: Apache-2.0
#include "subvol/label_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "subvol/error.h"

namespace subvol {

namespace {

constexpr std::size_t kBlockSide = LabelGrid::kSide;

std::string place_text(const std::array<std::size_t, 3>& voxel) {
    return "(" + std::to_string(voxel[0]) + ", " + std::to_string(voxel[1]) + ", " + std::to_string(voxel[2]) + ")";
}

[[noreturn]] void fail_label(std::int64_t label, const std::string& where) {
    throw Error(ErrorCode::InvalidInput, "has the label " + std::to_string(label), where,
                "0 outside, and labels from 1 to 2147483647");
}

}  // namespace

LabelGrid::LabelGrid(const Mat3& to_world, const Vec3& origin) : to_world_(to_world), origin_(origin) {
    constexpr double kLeastAngle = 1e-6;  // of the volume between edges of length 1
    double box = 1;
    bool finite = true;
    for (int axis = 0; axis < 3; ++axis) {
        finite = finite && std::isfinite(origin[axis]);
        box *= glm::length(to_world[axis]);
    }
    if (!finite || !std::isfinite(box)) {
        throw Error(ErrorCode::InvalidInput, "a number of their size, their directions or their origin is not finite",
                    "voxels");
    }
    if (!(std::abs(glm::determinant(to_world)) > kLeastAngle * box)) {
        throw Error(ErrorCode::InvalidInput, "are flat: an edge has no length, or lies in the plane of the others", "voxels",
                    "three independent directions");
    }
}

void LabelGrid::set(const At& block, const Voxels& labels) {
    for (const std::int32_t label : labels) {
        if (label < 0) fail_label(label, "a voxel");
    }
    if (std::ranges::all_of(labels, [&](std::int32_t label) { return label == labels.front(); })) {
        return set(block, labels.front());
    }
    set(block, labels.front() == 0 ? labels.back() : labels.front());
    blocks_[block].voxels = std::make_unique<const Voxels>(labels);
}

void LabelGrid::set(const At& block, std::int32_t label) {
    if (label < 0) fail_label(label, "a voxel");
    if (label == 0) {
        blocks_.erase(block);
        return;
    }
    Block& set = blocks_[block];
    if (blocks_.size() * kVoxels > kMostVoxels) {
        throw Error(ErrorCode::InvalidInput, "there are more than 2^31 voxels with labels", "voxels");
    }
    set.label = label;
    set.voxels.reset();
}

const LabelGrid::Block* LabelGrid::find(const At& block) const {
    const auto found = blocks_.find(block);
    return found == blocks_.end() ? nullptr : &found->second;
}

LabelRows::LabelRows(LabelGrid& grid, const std::array<std::size_t, 3>& size) : grid_(grid), size_(size) {
    std::uint64_t voxels = 1;
    for (const std::size_t side : size) {
        if (side < 1 || side > LabelGrid::kMostVoxels / voxels) {
            throw Error(ErrorCode::InvalidInput,
                        "are " + std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]),
                        "voxels", "1 to 2^31 in all");
        }
        voxels *= side;
    }
}

void LabelRows::take(std::span<const std::int64_t> labels) {
    const std::size_t area = size_[0] * size_[1], all = area * size_[2];
    for (const std::int64_t label : labels) {
        if (taken_ == all) {
            throw Error(ErrorCode::InvalidInput, "has more labels than its " + std::to_string(all) + " voxels", "voxels");
        }
        if (label < 0 || label > std::numeric_limits<std::int32_t>::max()) {
            fail_label(label, "voxel " + place_text({taken_ % size_[0], taken_ / size_[0] % size_[1], taken_ / area}));
        }
        layers_.push_back(static_cast<std::int32_t>(label));
        ++taken_;
        if (layers_.size() == kBlockSide * area) store();
    }
}

void LabelRows::finish() {
    const std::size_t all = size_[0] * size_[1] * size_[2];
    if (taken_ < all) {
        throw Error(ErrorCode::InvalidInput,
                    "there are " + std::to_string(taken_) + " labels for " + std::to_string(all) + " voxels", "voxels");
    }
    if (!layers_.empty()) store();
}

void LabelRows::store() {
    const std::size_t area = size_[0] * size_[1], layers = layers_.size() / area;
    const auto blocks = [](std::size_t voxels) { return static_cast<std::int32_t>((voxels + kBlockSide - 1) / kBlockSide); };
    LabelGrid::At at{0, 0, static_cast<std::int32_t>(layer_ / kBlockSide)};
    for (at[1] = 0; at[1] < blocks(size_[1]); ++at[1]) {
        for (at[0] = 0; at[0] < blocks(size_[0]); ++at[0]) {
            LabelGrid::Voxels voxels{};
            const std::size_t x = kBlockSide * static_cast<std::size_t>(at[0]),
                              y = kBlockSide * static_cast<std::size_t>(at[1]);
            const std::size_t width = std::min(kBlockSide, size_[0] - x), height = std::min(kBlockSide, size_[1] - y);
            for (std::size_t k = 0; k < layers; ++k) {
                for (std::size_t j = 0; j < height; ++j) {
                    const auto from = layers_.begin() + static_cast<std::ptrdiff_t>(x + size_[0] * (y + j) + area * k);
                    std::copy_n(from, width, voxels.begin() + static_cast<std::ptrdiff_t>(kBlockSide * (j + kBlockSide * k)));
                }
            }
            grid_.set(at, voxels);
        }
    }
    layer_ += layers;
    layers_.clear();
}

}  // namespace subvol
