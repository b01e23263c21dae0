// SPDX-License-Identifier: Apache-2.0
#include "subvol/grid_error.h"

#include <openvdb/tree/LeafManager.h>
#include "openvdb_grids.h"

#include <algorithm>
#include <cmath>

#include "subvol/error.h"
#include "subvol/field_range.h"
#include "subvol/probe.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

constexpr std::size_t kLeavesCompared = 1 << 14;  // leaves whose voxels are compared at once: up to 8 million
constexpr double kHalfRounding = 1.0 / 2048;      // of a value of 11 bits
constexpr double kReach_voxels = 1;
// A multiple of the tolerance: where the limit has little smoothness, two levels agree although the limit is this many times
// farther away.
constexpr double kTrust = 10;

}  // namespace

GridError grid_error(const VdbGrid& grid, const HexMesh& mesh, std::string_view field, const GridErrorOptions& options) {
    const auto& floats = VdbData::of(grid).floats;
    if (!floats) throw Error(ErrorCode::InvalidInput, "its voxels are not floats", "grid \"" + grid.report().name + "\"");
    HexMesh chosen = with_scalar_field(mesh, field);
    const FieldRange of_field = range_of(chosen.attributes.front());
    const double range = of_field.max.front() - of_field.min.front(), diagonal = bounds(chosen).diagonal();
    const LimitOptions limit{.scheme = options.scheme, .progress = options.progress};
    const LimitProbe probe(std::move(chosen), {.limit = limit, .reach_world = kReach_voxels * grid.report().voxel_size_world});

    auto made = floats->deepCopy();
    made->setName(grid.report().name + "_error");
    made->setGridClass(openvdb::GRID_UNKNOWN);
    made->insertMeta(
        "error",
        openvdb::StringMetadata(
            "an upper bound of |value - limit| at each voxel's centre, with an estimate of 1e-5 for the limit itself"));
    made->tree().voxelizeActiveTiles();
    openvdb::tree::LeafManager<openvdb::FloatTree> leaves(made->tree());
    double most = 0, squares = 0;
    std::size_t count = 0, outside = 0;
    std::vector<Vec3> places;
    for (std::size_t first = 0; first < leaves.leafCount(); first += kLeavesCompared) {
        report_progress(options.progress, "error", first, leaves.leafCount());
        const std::size_t end = std::min(first + kLeavesCompared, leaves.leafCount());
        places.clear();
        for (std::size_t l = first; l < end; ++l) {
            for (auto at = leaves.leaf(l).cbeginValueOn(); at; ++at) {
                const auto x = made->indexToWorld(at.getCoord());
                places.emplace_back(x[0], x[1], x[2]);
            }
        }
        const ProbeResult found = probe.at(places);
        std::size_t p = 0;
        for (std::size_t l = first; l < end; ++l) {
            for (auto at = leaves.leaf(l).beginValueOn(); at; ++at, ++p) {
                const auto value = static_cast<double>(*at);
                double bound = std::abs(range) + std::abs(value);
                if (found.inside(p)) {
                    bound = std::abs(value - found.fields[0].values[p]) +
                            kTrust * limit.tolerance * (range + diagonal * glm::length(found.fields[0].gradients[p]));
                }
                if (!found.inside(p) || found.distances[p] > 0) ++outside;
                if (options.half) bound += kHalfRounding * std::abs(value);
                // A bound is rounded upwards.
                const float rounded = std::nextafter(static_cast<float>(bound), std::numeric_limits<float>::infinity());
                at.setValue(rounded);
                most = std::max(most, static_cast<double>(rounded));
                squares += bound * bound;
                ++count;
            }
        }
    }
    return {make_vdb_grid(made), most, count > 0 ? std::sqrt(squares / static_cast<double>(count)) : 0, outside};
}

}  // namespace subvol
