// SPDX-License-Identifier: Apache-2.0
#include <openvdb/tree/LeafManager.h>
#include "openvdb_grids.h"

#include <algorithm>
#include <cmath>

#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

const openvdb::FloatGrid& floats_of(const VdbGrid& grid) {
    if (const auto& floats = VdbData::of(grid).floats) return *floats;
    throw Error(ErrorCode::InvalidInput, "its voxels are not floats", "grid \"" + grid.report().name + "\"");
}

constexpr std::size_t kLeavesAtOnce = 512;  // leaves whose points are evaluated at once

}  // namespace

VdbGrid sample_at_voxels(const VdbGrid& where, const std::string& name,
                         const std::function<std::vector<double>(std::span<const Vec3>)>& field) {
    auto grid = floats_of(where).deepCopy();
    grid->setName(name);
    grid->tree().voxelizeActiveTiles();
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(grid->tree());
    std::vector<Vec3> points;
    for (std::size_t first = 0; first < leaves.leafCount(); first += kLeavesAtOnce) {
        const std::size_t end = std::min(first + kLeavesAtOnce, leaves.leafCount());
        points.clear();
        for (std::size_t l = first; l < end; ++l) {
            for (auto at = leaves.leaf(l).cbeginValueOn(); at; ++at) {
                const auto x = grid->indexToWorld(at.getCoord());
                points.emplace_back(x[0], x[1], x[2]);
            }
        }
        const std::vector<double> values = field(points);
        std::size_t next = 0;
        for (std::size_t l = first; l < end; ++l) {
            for (auto at = leaves.leaf(l).beginValueOn(); at; ++at, ++next) {
                at.setValue(std::isnan(values[next]) ? 0.0f : static_cast<float>(values[next]));
            }
        }
    }
    return make_vdb_grid(grid);
}

GridDifference compare_voxels(const VdbGrid& a, const VdbGrid& b) {
    if (floats_of(a).transform() != floats_of(b).transform()) {
        throw Error(ErrorCode::InvalidInput, "the two have other voxels: their sizes, or their places, differ",
                    "grid \"" + a.report().name + "\"", "grids of one transform");
    }
    const openvdb::FloatGrid::ConstAccessor other(floats_of(b).constTree());
    GridDifference result;
    double squares = 0;
    for (auto at = floats_of(a).cbeginValueOn(); at; ++at) {
        const auto box = at.getBoundingBox();  // a voxel, or a tile
        for (auto c = box.begin(); c != box.end(); ++c) {
            float value = 0;
            if (!other.probeValue(*c, value)) continue;
            const double off = std::abs(static_cast<double>(*at) - static_cast<double>(value));
            result.max = std::max(result.max, off);
            squares += off * off;
            ++result.voxels;
        }
    }
    if (result.voxels == 0) return {.rms = NAN, .max = NAN};
    result.rms = std::sqrt(squares / static_cast<double>(result.voxels));
    return result;
}

}  // namespace subvol
