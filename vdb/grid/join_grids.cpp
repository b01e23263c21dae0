// SPDX-License-Identifier: Apache-2.0
// Shares of a grid are slabs of whole leaves, so joining moves leaves and repeats tiles; no voxel is touched. What depends on
// more than one leaf is done again for the whole: tiles of one value that fill an inner node are merged, and in level sets the
// inactive voxels between the bands get their signs.
#include "subvol/join_grids.h"

#include <openvdb/io/Stream.h>
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>
#include "openvdb_grids.h"

#include <sstream>
#include <string_view>
#include <type_traits>

#include "subvol/detail/byte_hash.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

[[noreturn]] void refuse(const openvdb::GridBase& grid, const std::string& what) {
    throw Error(ErrorCode::InvalidInput, what, "grid " + in_quotes(grid.getName()));
}

/// Moves the leaves and tiles of a part into the whole.
template <class Grid>
void take(Grid& whole, Grid& part) {
    using Tree = typename Grid::TreeType;
    using Leaf = typename Tree::LeafNodeType;
    auto& tree = whole.tree();
    auto tile = part.tree().cbeginValueOn();
    tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        openvdb::CoordBBox box;
        tile.getBoundingBox(box);
        tree.addTile(static_cast<openvdb::Index>(tile.getLevel()), box.min(), tile.getValue(), true);
    }
    std::vector<Leaf*> leaves;
    part.tree().stealNodes(leaves);
    for (Leaf* leaf : leaves) {
        if (tree.probeConstLeaf(leaf->origin()) != nullptr) {
            delete leaf;
            refuse(whole, "two parts have voxels in the same place");
        }
        tree.addLeaf(leaf);
    }
}

void check_alike(const openvdb::GridBase& whole, const openvdb::GridBase& part) {
    if (part.type() != whole.type() || part.getName() != whole.getName()) {
        refuse(part, "is another grid than " + in_quotes(whole.getName()) + " of the first part");
    }
    if (part.transform() != whole.transform()) refuse(part, "has other voxels than that of the first part");
}

/// Whether the grid is of this type; if so, it is joined.
template <class Grid>
bool join_as(std::vector<VdbGrid>& parts, openvdb::GridBase::Ptr& result) {
    const auto first = openvdb::gridPtrCast<Grid>(VdbData::of(parts.front()).grid);
    if (!first) return false;
    const auto whole = openvdb::gridPtrCast<Grid>(first->copyGridWithNewTree());
    for (VdbGrid& one : parts) {
        const auto part = openvdb::gridPtrCast<Grid>(VdbData::of(one).grid);
        check_alike(*whole, *VdbData::of(one).grid);
        take(*whole, *part);
    }
    if constexpr (std::is_same_v<Grid, openvdb::FloatGrid>) {
        if (whole->getGridClass() == openvdb::GRID_LEVEL_SET) {
            openvdb::tools::signedFloodFill(whole->tree());
            openvdb::tools::pruneLevelSet(whole->tree());
        } else {
            openvdb::tools::pruneTiles(whole->tree());
        }
    } else {
        openvdb::tools::pruneTiles(whole->tree());
    }
    result = whole;
    return true;
}

template <class Value>
std::string_view bytes_of(const Value& value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

/// Tiles and leaves come in the order of their places, as OpenVDB's nodes are sorted.
template <class Grid>
void add_tree(const Grid& grid, ByteHash& hash) {
    using Tree = typename Grid::TreeType;
    auto tile = grid.tree().cbeginValueOn();
    tile.setMaxDepth(Tree::ValueOnCIter::LEAF_DEPTH - 1);
    for (; tile; ++tile) {
        openvdb::CoordBBox box;
        tile.getBoundingBox(box);
        const auto value = tile.getValue();
        const auto level = tile.getLevel();
        hash.add(bytes_of(level));
        hash.add(bytes_of(box));
        hash.add(bytes_of(value));
    }
    for (auto leaf = grid.tree().cbeginLeaf(); leaf; ++leaf) {
        const openvdb::Coord origin = leaf->origin();
        hash.add(bytes_of(origin));
        const auto& mask = leaf->getValueMask();
        for (openvdb::Index w = 0; w < 8; ++w) {
            const auto word = mask.template getWord<std::uint64_t>(w);
            hash.add(bytes_of(word));
        }
        if constexpr (!std::is_same_v<Grid, openvdb::MaskGrid>) {
            hash.add({reinterpret_cast<const char*>(leaf->buffer().data()), 512 * sizeof(typename Grid::ValueType)});
        }
    }
}

}  // namespace

VdbGrid join_grids(std::vector<VdbGrid> parts) {
    if (parts.empty()) throw Error(ErrorCode::InvalidInput, "there is no grid to be joined");
    openvdb::GridBase::Ptr whole;
    const bool known = join_as<openvdb::FloatGrid>(parts, whole) || join_as<openvdb::Vec3SGrid>(parts, whole) ||
                       join_as<openvdb::Int32Grid>(parts, whole) || join_as<openvdb::MaskGrid>(parts, whole);
    if (!known) refuse(*VdbData::of(parts.front()).grid, "is of a type that is not joined");
    return make_vdb_grid(whole);
}

std::optional<std::string> text_of_grid(const VdbGrid& grid, const std::string& name) {
    const auto text = VdbData::of(grid).grid->getMetadata<openvdb::StringMetadata>(name);
    return text ? std::optional(text->value()) : std::nullopt;
}

void set_text_of_grid(VdbGrid& grid, const std::string& name, const std::optional<std::string>& text) {
    openvdb::GridBase& changed = *VdbData::of(grid).grid;
    if (changed[name]) changed.removeMeta(name);
    if (text) changed.insertMeta(name, openvdb::StringMetadata(*text));
}

void store_in_half(VdbGrid& grid, bool half) {
    VdbData::of(grid).grid->setSaveFloatAsHalf(half);
}

std::uint64_t hash_of_grid(const VdbGrid& grid) {
    const openvdb::GridBase& base = *VdbData::of(grid).grid;
    ByteHash hash;
    hash.add_text(base.type());
    hash.add_text(base.getName());
    std::ostringstream transform(std::ios::binary);
    base.transform().write(transform);
    hash.add_text(transform.str());
    if (const auto* floats = dynamic_cast<const openvdb::FloatGrid*>(&base)) add_tree(*floats, hash);
    if (const auto* vectors = dynamic_cast<const openvdb::Vec3SGrid*>(&base)) add_tree(*vectors, hash);
    if (const auto* integers = dynamic_cast<const openvdb::Int32Grid*>(&base)) add_tree(*integers, hash);
    if (const auto* mask = dynamic_cast<const openvdb::MaskGrid*>(&base)) add_tree(*mask, hash);
    return hash.value();
}

std::string detail::bytes_of_grids(std::span<const VdbGrid> grids) {
    openvdb::initialize();
    openvdb::GridCPtrVec list;
    for (const VdbGrid& grid : grids) list.push_back(VdbData::of(grid).grid);
    std::ostringstream out(std::ios::binary);
    openvdb::io::Stream stream(out);
    stream.setCompression(openvdb::io::COMPRESS_ACTIVE_MASK);
    stream.write(list);
    return std::move(out).str();
}

std::vector<VdbGrid> detail::grids_from_bytes(const std::string& bytes) {
    openvdb::initialize();
    try {
        std::istringstream in(bytes, std::ios::binary);
        openvdb::io::Stream stream(in, /*delayLoad=*/false);
        std::vector<VdbGrid> grids;
        for (const auto& grid : *stream.getGrids()) grids.push_back(make_vdb_grid(grid));
        return grids;
    } catch (const std::exception& error) {
        throw Error(ErrorCode::InvalidInput, "these bytes do not hold grids: " + printable(error.what()));
    }
}

}  // namespace subvol
