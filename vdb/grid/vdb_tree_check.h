// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace subvol::detail {

/// The bytes of a .vdb file, read forwards. Nothing beyond the file's end is taken, and no memory is allocated for a length
/// that the file cannot have.
class VdbBytes {
public:
    /// throws: Error(Io) if the file cannot be read
    explicit VdbBytes(const std::filesystem::path& path);

    /// A number as the file stores it: little-endian, as memory is on the machines that OpenVDB supports.
    template <class T>
    [[nodiscard]] T take() {
        static_assert(std::is_trivially_copyable_v<T>);
        T value;
        std::memcpy(&value, take(sizeof(T)), sizeof(T));
        return value;
    }
    /// The next `count` bytes, at most `kMostAtOnce`; valid until the next call.
    [[nodiscard]] const char* take(std::size_t count);
    /// A text after its length of 32 bits.
    [[nodiscard]] std::string text();
    void skip(std::uint64_t count);
    void seek(std::uint64_t position) { position_ = position; }

    [[nodiscard]] std::uint64_t position() const { return position_; }
    [[nodiscard]] std::uint64_t left() const { return position_ < size_ ? size_ - position_ : 0; }
    /// Whether that many items, of at least `bytes` bytes each, fit into the rest of the file.
    [[nodiscard]] bool has_room_for(std::uint64_t items, std::uint64_t bytes) const { return items <= left() / bytes; }

    /// throws: Error(InvalidInput) "FILE: is not a whole OpenVDB file: at byte 1234, message (allowed)"
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;

    static constexpr std::size_t kMostAtOnce = 8192;

private:
    [[noreturn]] void fail_short() const;

    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t size_ = 0;
    std::uint64_t position_ = 0;
    std::uint64_t loaded_from_ = 0;
    std::size_t loaded_ = 0;
    std::vector<char> buffer_;
};

enum class LeafLayout { Values, Booleans, Mask, Points };

/// How the trees of one type of grid are stored.
struct TreeLayout {
    std::size_t value_bytes = 0;
    std::size_t half_bytes = 0;  // of a value if floats are stored in 16 bits
    LeafLayout leaves = LeafLayout::Values;
};

/// type: as OpenVDB names it; nothing for types whose layout is not known here
[[nodiscard]] std::optional<TreeLayout> tree_layout(const std::string& type);

/// Where a block's size comes from, and how its values are packed.
struct BlockCoding {
    bool blosc = false, zip = false;
    bool masked = false;  // values of inactive voxels are left out
};

/// Goes over a compressed block for blosc, which has a size of its own that must not exceed the buffer's.
///
/// size: of the block in the file; raw: what it unpacks into
void check_blosc(VdbBytes& file, std::uint64_t size, std::uint64_t raw);

/// Goes over a grid's tree, from the count of buffers to its last value.
///
/// in_half: floats are stored in 16 bits
void check_tree(VdbBytes& file, const TreeLayout& layout, const BlockCoding& coding, bool in_half);

/// Goes over metadata: of a file, of a grid, of attributes of points.
void check_metadata(VdbBytes& file);

/// Goes over the values of a point grid's leaves, which are stored in passes over all leaves.
void check_point_leaves(VdbBytes& file, std::size_t leaves);

}  // namespace subvol::detail
