// SPDX-License-Identifier: Apache-2.0
#include "subvol/vdb_contents.h"

#include "openvdb_grids.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <openvdb/tools/Prune.h>

#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "vdb_data.h"
#include "vdb_stream.h"

namespace subvol {

using namespace detail;

namespace {

/// The same tree with other values: an inactive background, and `value_of` of every active voxel and tile.
template <class Grid, class ValueOf>
openvdb::FloatGrid::Ptr converted(const Grid& from, const ValueOf& value_of) {
    auto to = openvdb::FloatGrid::create(0.0f);
    to->setTransform(from.transform().copy());
    to->tree().topologyUnion(from.constTree());
    auto accessor = from.getConstAccessor();
    for (auto at = to->beginValueOn(); at; ++at) at.setValue(value_of(accessor, at.getCoord()));
    return to;
}

float component_of(const openvdb::Vec3s& v, std::optional<int> component) {
    return component ? v[*component] : v.length();
}

}  // namespace

VdbContents read_vdb_contents(const std::filesystem::path& path) {
    const std::array<std::string, 5> types{openvdb::FloatGrid::gridType(), openvdb::Vec3SGrid::gridType(),
                                           openvdb::Int32Grid::gridType(), openvdb::Int64Grid::gridType(),
                                           openvdb::MaskGrid::gridType()};
    VdbContents contents;
    for (const auto& grid : read_grids(path, types, [&](const std::string&name, const std::string&type) {
             contents.others.push_back({printable(name), printable(type)});
         })) {
        contents.grids.push_back(make_vdb_grid(grid));
    }
    return contents;
}

VdbGrid scalar_of(const VdbGrid& grid, std::optional<int> component, const std::string& name) {
    const VdbData& data = VdbData::of(grid);
    const auto* vectors = dynamic_cast<const openvdb::Vec3SGrid*>(data.grid.get());
    if (component && (vectors == nullptr || *component < 0 || *component > 2))
        throw Error(ErrorCode::InvalidInput, "has no component " + std::to_string(*component), "grid " + data.report().name);
    openvdb::FloatGrid::Ptr floats;
    if (data.floats) {
        floats = openvdb::gridPtrCast<openvdb::FloatGrid>(data.grid->copyGrid());
    } else if (vectors != nullptr) {
        floats =
            converted(*vectors, [&](auto& at, const openvdb::Coord& c) { return component_of(at.getValue(c), component); });
    } else if (const auto* integers = dynamic_cast<const openvdb::Int32Grid*>(data.grid.get())) {
        floats = converted(*integers, [](auto& at, const openvdb::Coord& c) { return static_cast<float>(at.getValue(c)); });
    } else if (const auto* wide = dynamic_cast<const openvdb::Int64Grid*>(data.grid.get())) {
        floats = converted(*wide, [](auto& at, const openvdb::Coord& c) { return static_cast<float>(at.getValue(c)); });
    } else if (const auto* mask = dynamic_cast<const openvdb::MaskGrid*>(data.grid.get())) {
        floats = converted(*mask, [](auto&, const openvdb::Coord&) { return 1.0f; });
    } else {
        throw Error(ErrorCode::InvalidInput, "cannot be read as floats", "grid " + data.report().name);
    }
    floats->setName(name);
    set_frame(*floats, data.report().frame);
    return make_vdb_grid(floats);
}

namespace {

/// distance: of two values
template <class Grid, class Distance>
void deactivate_near(Grid& grid, double tolerance, const Distance& distance) {
    const auto background = grid.background();
    for (auto at = grid.beginValueOn(); at; ++at) {
        if (!(distance(*at, background) <= tolerance)) continue;
        at.setValue(background);
        at.setActiveState(false);
    }
    openvdb::tools::pruneInactive(grid.tree());
}

}  // namespace

void prune_voxels(VdbGrid& grid, double tolerance) {
    const VdbData& data = VdbData::of(grid);
    if (data.report().level_set) return;
    if (data.floats) {
        deactivate_near(*data.floats, tolerance, [](float a, float b) { return std::abs(double{a} - double{b}); });
    } else if (auto* vectors = dynamic_cast<openvdb::Vec3SGrid*>(data.grid.get())) {
        deactivate_near(*vectors, tolerance, [](const openvdb::Vec3s& a, const openvdb::Vec3s& b) {
            return (openvdb::Vec3d(a) - openvdb::Vec3d(b)).length();
        });
    } else {
        return;
    }
    grid = make_vdb_grid(data.grid);
}

void clamp_voxels(VdbGrid& grid, const FieldRange& range) {
    const VdbData& data = VdbData::of(grid);
    const auto check = [&](std::size_t components) {
        if (range.min.size() == components && range.max.size() == components) return;
        throw Error(ErrorCode::InvalidInput, "has another number of components than the range", "grid " + data.report().name);
    };
    if (data.floats) {
        check(1);
        const auto low = static_cast<float>(range.min[0]), high = static_cast<float>(range.max[0]);
        if (data.report().min >= double{low} && data.report().max <= double{high}) return;
        for (auto at = data.floats->beginValueOn(); at; ++at) at.setValue(std::min(std::max(*at, low), high));
    } else if (auto* vectors = dynamic_cast<openvdb::Vec3SGrid*>(data.grid.get())) {
        check(3);
        for (auto at = vectors->beginValueOn(); at; ++at) {
            openvdb::Vec3s v = *at;
            for (int c = 0; c < 3; ++c) {
                const auto k = static_cast<std::size_t>(c);
                v[c] = std::min(std::max(v[c], static_cast<float>(range.min[k])), static_cast<float>(range.max[k]));
            }
            at.setValue(v);
        }
    } else {
        return;
    }
    grid = make_vdb_grid(data.grid);
}

}  // namespace subvol
