// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/rbf_volume.h"

namespace subvol::detail {

// A .svk file: kernels in blocks, and over them the tree of `build_kernel_hierarchy`, of which a view reads the blocks that it
// needs. docs/formats.md describes the bytes.

struct SvkChannel {
    std::string name;
    bool bent = false;       ///< has Hessians
    float min = 0, max = 0;  ///< range of the kernels' values
};

/// What the head of a file says.
struct SvkContents {
    Kernel kernel{};
    std::uint64_t kernels = 0;
    std::vector<SvkChannel> channels{};
    Box bounds{};  ///< `box_of` the volume
    std::uint64_t boundary_points = 0, boundary_triangles = 0;
};

[[nodiscard]] SvkContents svk_contents(const RbfVolume& volume);

/// Where bytes are in the file.
struct SvkExtent {
    std::uint64_t offset = 0, bytes = 0;
    std::size_t count = 0;  ///< number of kernels, nodes or numbers
};

/// The tree has 2^levels leaves of at most 8 kernels. A block is what lies below one node of the level `root_level`: some
/// 1000 kernels. The top of the tree, down to these nodes, is one extent. The rest of a block has parts, each of which is read
/// as a whole: the nodes of the first three levels below its root, those of each further level, the kernels' numbers, and the
/// kernels. So few bytes are read where a view needs few levels.
class SvkLayout {
public:
    static constexpr std::size_t kLeafSize = 8;
    static constexpr int kBlockLevels = 8, kFirstLevels = 3;

    SvkLayout() = default;
    /// data: where the head ends
    SvkLayout(const SvkContents& contents, std::uint64_t data);

    [[nodiscard]] int levels() const { return levels_; }
    [[nodiscard]] int root_level() const { return levels_ - below_; }
    /// The levels below the root of a block.
    [[nodiscard]] int below() const { return below_; }
    [[nodiscard]] std::size_t blocks() const { return std::size_t{1} << root_level(); }

    /// The part with the nodes of a level, counted from the root of the block as 0; and the place of the first of them in it.
    [[nodiscard]] static std::size_t part_of_level(int level) {
        return level <= kFirstLevels ? 0 : static_cast<std::size_t>(level - kFirstLevels);
    }
    [[nodiscard]] static std::size_t first_of_level(int level) {
        return level <= kFirstLevels ? (std::size_t{1} << level) - 2 : 0;
    }
    /// The levels of a part: first to last.
    [[nodiscard]] int first_level(std::size_t part) const { return part == 0 ? 1 : kFirstLevels + static_cast<int>(part); }
    [[nodiscard]] int last_level(std::size_t part) const {
        return part == 0 ? (below_ < kFirstLevels ? below_ : kFirstLevels) : first_level(part);
    }
    [[nodiscard]] std::size_t node_parts() const { return below_ == 0 ? 0 : part_of_level(below_) + 1; }
    [[nodiscard]] std::size_t numbers_part() const { return node_parts(); }
    [[nodiscard]] std::size_t kernels_part() const { return node_parts() + 1; }
    [[nodiscard]] std::size_t parts() const { return node_parts() + 2; }

    /// The first slot of a leaf, counted over all blocks; of a leaf behind the last: the number of kernels.
    [[nodiscard]] std::uint64_t first_slot_of_leaf(std::uint64_t leaf) const { return leaf * kernels_ >> levels_; }
    [[nodiscard]] std::uint64_t first_slot(std::size_t block) const { return std::uint64_t{block} * kernels_ >> root_level(); }

    [[nodiscard]] SvkExtent part(std::size_t block, std::size_t part) const;
    [[nodiscard]] const SvkExtent& boundary() const { return boundary_; }
    [[nodiscard]] const SvkExtent& top() const { return top_; }
    [[nodiscard]] std::uint64_t file_bytes() const { return file_bytes_; }
    /// Hashes are of the boundary, of the top, and of each part of each block.
    [[nodiscard]] std::size_t hashes() const { return 2 + blocks() * parts(); }
    [[nodiscard]] std::size_t hash_of_part(std::size_t block, std::size_t part) const { return 2 + block * parts() + part; }

private:
    std::uint64_t kernels_ = 0, kernel_bytes_ = 0, node_bytes_ = 0;
    int levels_ = 0, below_ = 0;
    SvkExtent boundary_, top_;
    std::vector<std::uint64_t> part_offsets_;  // of the same part of all blocks, which are together
    std::uint64_t file_bytes_ = 0;
};

/// The arrays of kernels or nodes in the bytes of an extent. The bytes are referred to.
class SvkArrays {
public:
    enum class Kind { Kernels, Nodes };  // nodes have widths and errors, too

    SvkArrays(const SvkContents& contents, Kind kind, std::string_view bytes, std::size_t count);

    [[nodiscard]] std::size_t size() const { return count_; }
    [[nodiscard]] float width(std::size_t i) const;
    [[nodiscard]] float error(std::size_t channel, std::size_t i) const;
    [[nodiscard]] Vec3 center(std::size_t i) const;

    /// Puts kernel i into place j of a volume of `svk_volume`. channels: as there
    void copy(std::size_t i, RbfVolume& to, std::size_t j, std::span<const std::size_t> channels) const;

    /// All of them, with all channels.
    [[nodiscard]] RbfVolume volume() const;

private:
    template <class T>
    [[nodiscard]] T load(std::size_t array, std::size_t i) const;

    const SvkContents& contents_;
    const char* bytes_;
    std::size_t count_, centers_, frames_;  // where arrays begin
    std::vector<std::size_t> channels_{};
};

/// The bytes that `SvkArrays` reads. numbers: which of the volume's kernels. Of nodes: widths, and errors for each channel
[[nodiscard]] std::string svk_bytes(const RbfVolume& volume, std::span<const Index> numbers, std::span<const float> widths = {},
                                    std::span<const std::vector<float>> errors = {});

/// A volume of the file's kernel and some of its channels, with room for so many kernels.
[[nodiscard]] RbfVolume svk_volume(const SvkContents& contents, std::size_t size, std::span<const std::size_t> channels);

}  // namespace subvol::detail
