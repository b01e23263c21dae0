// SPDX-License-Identifier: Apache-2.0
// Grids as arrays, and arrays as grids. An array has every voxel of a box, the last axis fastest; a grid has a tree whose
// leaves are blocks of 8 x 8 x 8 voxels, each with a bit that says whether it is active. NaN stands for a voxel that is not.
//
//     grid ─► box of its active voxels ─► array filled with NaN ─► values of active voxels and tiles
//     array ─► blocks of 8^3 with something in them, layer by layer in parallel ─► leaves of a new tree
//
// In a level set every voxel has a value: those that are not active have the background with the sign of their side.
#include "subvol/vdb_grid.h"

#include "openvdb_grids.h"

#include <openvdb/tools/Dense.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

constexpr std::size_t kMostVoxels = std::size_t{1} << 31, kMostSide = std::size_t{1} << 30;
constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

// The voxels of a box, the last axis fastest, as a GridArray has them.
template <class Value>
using Block = openvdb::tools::Dense<Value, openvdb::tools::LayoutZYX>;

/// Copies the active voxels and tiles; what stands for the others stays as it is.
template <class Grid>
void copy_active(const Grid& grid, Block<typename Grid::ValueType>& to) {
    for (auto leaf = grid.constTree().cbeginLeaf(); leaf; ++leaf) {
        for (auto voxel = leaf->cbeginValueOn(); voxel; ++voxel) to.setValue(voxel.getCoord(), *voxel);
    }
    auto tile = grid.constTree().cbeginValueOn();
    tile.setMaxDepth(decltype(tile)::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        const openvdb::CoordBBox box = tile.getBoundingBox();
        for (auto c = box.begin(); c; ++c) to.setValue(*c, *tile);
    }
}

bool is_number(float value) {
    return !std::isnan(value);
}
bool is_number(const openvdb::Vec3s& value) {
    return is_number(value[0]) && is_number(value[1]) && is_number(value[2]);
}

/// A tree of the values of a block.
///
/// most: voxels are active below this magnitude, and the others have it with their sign; infinite: all but NaN are active
template <class Tree>
typename Tree::Ptr tree_of(const Block<typename Tree::ValueType>& block, float most) {
    using Leaf = typename Tree::LeafNodeType;
    using Value = typename Tree::ValueType;
    constexpr auto kSide = static_cast<openvdb::Int32>(Leaf::DIM);
    constexpr bool kScalar = std::is_same_v<Value, float>;
    const bool bounded = kScalar && std::isfinite(most);
    const Value background(bounded ? most : 0.0f);
    const openvdb::CoordBBox box = block.bbox();
    const openvdb::Coord first(box.min()[0] & -kSide, box.min()[1] & -kSide, box.min()[2] & -kSide);

    const auto leaf_at = [&](const openvdb::Coord& corner) {
        auto leaf = std::make_unique<Leaf>(corner, background);
        openvdb::CoordBBox part = leaf->getNodeBoundingBox();
        part.intersect(box);
        bool empty = true;
        for (auto c = part.begin(); c; ++c) {
            const Value& value = block.getValue(*c);
            if constexpr (kScalar) {
                if (bounded && !(std::abs(value) < most)) {
                    if (value > 0) continue;
                    leaf->setValueOnly(*c, -most);
                    empty = false;
                    continue;
                }
            }
            if (!is_number(value)) continue;
            leaf->setValueOn(*c, value);
            empty = false;
        }
        if (empty) leaf.reset();
        return leaf;
    };

    // One list of leaves for each layer of them along the first axis, so that the tree does not depend on the threads.
    const auto layers = static_cast<std::size_t>((box.max()[0] - first[0]) / kSide) + 1;
    std::vector<std::vector<std::unique_ptr<Leaf>>> leaves(layers);
    tbb::parallel_for(std::size_t{0}, layers, [&](std::size_t layer) {
        openvdb::Coord c(first[0] + kSide * static_cast<openvdb::Int32>(layer), 0, 0);
        for (c[1] = first[1]; c[1] <= box.max()[1]; c[1] += kSide) {
            for (c[2] = first[2]; c[2] <= box.max()[2]; c[2] += kSide) {
                if (auto leaf = leaf_at(c)) leaves[layer].push_back(std::move(leaf));
            }
        }
    });
    auto tree = std::make_shared<Tree>(background);
    for (auto& layer : leaves) {
        for (auto& leaf : layer) tree->addLeaf(leaf.release());
    }
    return tree;
}

std::string voxel_text(std::size_t voxel, const std::array<std::size_t, 3>& size) {
    return "[" + std::to_string(voxel / (size[1] * size[2])) + ", " + std::to_string(voxel / size[2] % size[1]) + ", " +
           std::to_string(voxel % size[2]) + "]";
}

/// Refuses sizes and values that no grid has.
void check(const GridArray& array, const GridArrayOptions& options) {
    std::size_t voxels = 1;
    for (const std::size_t side : array.size) {
        if (side < 1 || side > kMostSide || side > kMostVoxels / voxels) {
            throw Error(ErrorCode::InvalidInput,
                        "has " + std::to_string(array.size[0]) + " x " + std::to_string(array.size[1]) + " x " +
                            std::to_string(array.size[2]) + " voxels",
                        "array", "1 to 2^30 along each axis, and to 2^31 in all");
        }
        voxels *= side;
    }
    if (array.components != 1 && array.components != 3) {
        throw Error(ErrorCode::InvalidInput, "has " + std::to_string(array.components) + " components", "array",
                    "1, or 3 of vectors");
    }
    if (array.values.size() != voxels * array.components) {
        throw Error(ErrorCode::InvalidInput,
                    "has " + std::to_string(array.values.size()) + " values for " + std::to_string(voxels) + " voxels",
                    "array");
    }
    for (std::size_t i = 0; i < array.values.size(); ++i) {
        const float value = array.values[i];
        if (std::isinf(value) || (options.level_set && std::isnan(value))) {
            throw Error(ErrorCode::InvalidInput,
                        "has the value " + number_text(static_cast<double>(value)) + " at " +
                            voxel_text(i / array.components, array.size),
                        "array",
                        options.level_set ? "finite distances of a level set" : "32-bit floats, NaN where there is no value");
        }
    }
}

/// The transform of a grid, and the index of the first voxel in it.
std::pair<openvdb::math::Transform::Ptr, openvdb::Coord> transform_of(const GridArray& array, const std::string& name) {
    constexpr double kSingular = 3e-15, kMostIndex = 1 << 29;  // OpenVDB refuses smaller determinants
    check_axes(array.to_world, array.origin, name);
    if (!(std::abs(glm::determinant(array.to_world)) >= kSingular)) {
        throw Error(ErrorCode::InvalidInput, "its voxels are too small for OpenVDB", "grid " + in_quotes(name),
                    "a volume of 3e-15 or more");
    }
    const double h = array.to_world[0][0];
    if (h > 0 && array.to_world == Mat3(h)) {
        auto transform = openvdb::math::Transform::createLinearTransform(h);
        openvdb::Vec3d lower;
        bool aligned = true;
        for (int k = 0; k < 3; ++k) {
            lower[k] = std::round(array.origin[k] / h);
            aligned = aligned && std::abs(lower[k]) < kMostIndex && array.size[static_cast<std::size_t>(k)] < kMostSide / 2 &&
                      lower[k] * h == array.origin[k];
        }
        if (aligned) return {transform, openvdb::Coord::round(lower)};
        transform->postTranslate({array.origin.x, array.origin.y, array.origin.z});
        return {transform, openvdb::Coord(0)};
    }
    openvdb::Mat4d matrix = openvdb::Mat4d::identity();  // of rows: place = index · matrix
    for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < 3; ++k) matrix[axis][k] = array.to_world[axis][k];
        matrix[3][axis] = array.origin[axis];
    }
    return {openvdb::math::Transform::createLinearTransform(matrix), openvdb::Coord(0)};
}

/// The magnitude from which the voxels of a level set are not active.
float background_of(const GridArray& array, const GridArrayOptions& options) {
    const auto [least, most] = std::minmax_element(array.values.begin(), array.values.end());
    const float background =
        options.background ? static_cast<float>(*options.background) : std::max(std::abs(*least), std::abs(*most));
    if (!(background > 0) || std::isinf(background)) {
        throw Error(ErrorCode::InvalidInput, "the largest distance is " + number_text(static_cast<double>(background)),
                    "background", "above 0");
    }
    return background;
}

}  // namespace

GridArray grid_box(const VdbGrid& grid) {
    const VdbData& data = VdbData::of(grid);
    const std::string where = "grid " + in_quotes(data.grid->getName());
    const bool vectors = data.grid->isType<openvdb::Vec3SGrid>();
    if (!data.floats && !vectors) {
        throw Error(ErrorCode::InvalidInput, "its voxels are of the kind " + data.report().kind, where, "floats or vectors");
    }
    GridArray array;
    array.components = vectors ? 3 : 1;
    std::tie(array.to_world, array.origin) = axes_of(*data.grid);
    if (data.report().active_voxels == 0) return array;
    const openvdb::CoordBBox box = data.grid->evalActiveVoxelBoundingBox();
    const openvdb::Vec3d first = data.grid->indexToWorld(box.min());
    array.origin = {first[0], first[1], first[2]};
    std::size_t voxels = 1;
    for (std::size_t k = 0; k < 3; ++k) {
        const auto side = static_cast<std::size_t>(std::int64_t{box.max()[k]} - box.min()[k] + 1);
        if (side > kMostVoxels / voxels) {
            throw Error(ErrorCode::InvalidInput, "the box of its active voxels has more than 2^31 voxels", where);
        }
        array.size[k] = side;
        voxels *= side;
    }
    return array;
}

GridArray grid_array(const VdbGrid& grid) {
    GridArray array = grid_box(grid);
    const VdbData& data = VdbData::of(grid);
    if (data.report().active_voxels == 0) return array;
    const openvdb::CoordBBox box = data.grid->evalActiveVoxelBoundingBox();
    array.values.assign(box.volume() * array.components, kNothing);
    if (const auto* vectors = dynamic_cast<const openvdb::Vec3SGrid*>(data.grid.get())) {
        Block<openvdb::Vec3s> block(box, reinterpret_cast<openvdb::Vec3s*>(array.values.data()));
        copy_active(*vectors, block);
    } else {
        Block<float> block(box, array.values.data());
        if (data.is_level_set) {
            openvdb::tools::copyToDense(data.floats->constTree(), block);
        } else {
            copy_active(*data.floats, block);
        }
    }
    return array;
}

VdbGrid make_grid(const GridArray& array, const GridArrayOptions& options) {
    check(array, options);
    const auto [transform, lower] = transform_of(array, options.name);
    if (options.level_set && (array.components != 1 || !transform->hasUniformScale())) {
        throw Error(ErrorCode::InvalidInput, array.components != 1 ? "has vectors" : "has voxels that are no cubes", "array",
                    "distances in cubes for a level set");
    }
    const openvdb::CoordBBox box(
        lower, lower.offsetBy(static_cast<openvdb::Int32>(array.size[0]) - 1, static_cast<openvdb::Int32>(array.size[1]) - 1,
                              static_cast<openvdb::Int32>(array.size[2]) - 1));
    // OpenVDB reads a block of const values only through a pointer that could write to them.
    auto* values = const_cast<float*>(array.values.data());
    openvdb::GridBase::Ptr grid;
    if (array.components == 3) {
        const Block<openvdb::Vec3s> block(box, reinterpret_cast<openvdb::Vec3s*>(values));
        grid = openvdb::Vec3SGrid::create(tree_of<openvdb::Vec3STree>(block, std::numeric_limits<float>::infinity()));
    } else {
        const float most = options.level_set ? background_of(array, options) : std::numeric_limits<float>::infinity();
        grid = openvdb::FloatGrid::create(tree_of<openvdb::FloatTree>(Block<float>(box, values), most));
        grid->setGridClass(options.level_set ? openvdb::GRID_LEVEL_SET : openvdb::GRID_FOG_VOLUME);
    }
    grid->setName(options.name);
    grid->setTransform(transform);
    grid->setCreator("OpenSubVol");
    return make_vdb_grid(grid);
}

}  // namespace subvol
