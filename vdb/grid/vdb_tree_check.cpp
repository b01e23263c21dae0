// SPDX-License-Identifier: Apache-2.0
#include "vdb_tree_check.h"

#include <openvdb/io/Compression.h>
#include <algorithm>
#include <array>
#include <bit>
#include <bitset>
#include <set>
#include <utility>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kBuffer = 1 << 16;
constexpr const char* kNotWhole = "is not a whole OpenVDB file: ";

}  // namespace

VdbBytes::VdbBytes(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary), buffer_(kBuffer) {
    std::error_code no_size;
    size_ = std::filesystem::file_size(path, no_size);
    if (!file_ || no_size || !std::filesystem::is_regular_file(path))
        throw Error(ErrorCode::Io, "cannot be read", path.string());
}

const char* VdbBytes::take(std::size_t count) {
    if (count > left()) fail_short();
    if (position_ < loaded_from_ || position_ + count > loaded_from_ + loaded_) {
        const std::size_t size = std::min<std::uint64_t>(buffer_.size(), left());
        file_.seekg(static_cast<std::streamoff>(position_));
        if (!file_.read(buffer_.data(), static_cast<std::streamsize>(size))) fail_short();
        loaded_from_ = position_;
        loaded_ = size;
    }
    const char* const bytes = buffer_.data() + (position_ - loaded_from_);
    position_ += count;
    return bytes;
}

std::string VdbBytes::text() {
    const auto size = take<std::uint32_t>();
    if (size > left()) fail("a text of " + std::to_string(size) + " bytes", std::to_string(left()) + " bytes are left");
    std::string text;
    while (text.size() < size) {
        const std::size_t part = std::min<std::size_t>(size - text.size(), kMostAtOnce);
        text.append(take(part), part);
    }
    return text;
}

void VdbBytes::skip(std::uint64_t count) {
    if (count > left()) fail_short();
    position_ += count;
}

void VdbBytes::fail(const std::string& message, const std::string& allowed) const {
    throw Error(ErrorCode::InvalidInput, kNotWhole + ("at byte " + std::to_string(position_)) + ", " + message, path_.string(),
                allowed);
}

void VdbBytes::fail_short() const {
    throw Error(ErrorCode::InvalidInput, std::string(kNotWhole) + "it ends too early", path_.string());
}

namespace {

constexpr unsigned kUpper = 5, kLower = 4, kLeaf = 3;  // nodes have 2^(3·this) entries
constexpr std::size_t kLeafMask = 512 / 8;
constexpr std::size_t kOrigin = 3 * sizeof(std::int32_t);

class TreeCheck {
public:
    TreeCheck(VdbBytes& file, const TreeLayout& layout, const BlockCoding& coding, bool in_half)
        : file_(file), layout_(layout), coding_(coding), stored_bytes_(in_half ? layout.half_bytes : layout.value_bytes) {}

    void run() {
        const auto buffers = file_.take<std::int32_t>();
        if (buffers != 1) file_.fail("a tree has " + std::to_string(buffers) + " buffers", "1");
        root();
        if (layout_.leaves == LeafLayout::Points) return check_point_leaves(file_, leaves_);
        for (std::size_t i = 0; i < leaves_; ++i) leaf();
    }

private:
    using Origin = std::array<std::int32_t, 3>;

    void root() {
        background();
        const auto tiles = file_.take<std::uint32_t>();
        const auto children = file_.take<std::uint32_t>();
        for (std::uint32_t i = 0; i < tiles; ++i) {
            origin();
            file_.skip(layout_.value_bytes);
            if (file_.take<std::uint8_t>() > 1) file_.fail("a tile is neither active nor inactive");
        }
        for (std::uint32_t i = 0; i < children; ++i) {
            origin();
            inner(kUpper);
        }
    }

    /// OpenVDB makes leaves of points with the background as their values, and aborts if that is not 0.
    void background() {
        if (layout_.leaves != LeafLayout::Points) return file_.skip(layout_.value_bytes);
        const auto value = file_.take<std::uint32_t>();
        if (value != 0) file_.fail("a grid of points has the background " + std::to_string(value), "0");
    }

    /// OpenVDB keeps one entry for each origin, so that a second one would change the number of leaves whose values follow.
    void origin() {
        constexpr std::int32_t kSize = 1 << (kUpper + kLower + kLeaf);
        const auto origin = file_.take<Origin>();
        for (const std::int32_t x : origin) {
            if (x % kSize != 0) file_.fail("a node begins at the index " + std::to_string(x), "a multiple of 4096");
        }
        if (!origins_.insert(origin).second) file_.fail("a second node begins where another one does");
    }

    void inner(unsigned log2) {
        const std::size_t size = std::size_t{1} << (3 * log2);
        std::vector<std::uint64_t> children(size / 64), active(size / 64);
        for (auto* mask : {&children, &active}) {
            for (std::uint64_t& word : *mask) word = file_.take<std::uint64_t>();
        }
        std::size_t nodes = 0, active_tiles = 0;
        for (std::size_t i = 0; i < children.size(); ++i) {
            if ((children[i] & active[i]) != 0) file_.fail("an entry of a node is both a node and an active value");
            nodes += static_cast<std::size_t>(std::popcount(children[i]));
            active_tiles += static_cast<std::size_t>(std::popcount(active[i]));
        }
        values(size, active_tiles);
        if (log2 == kUpper) {
            for (std::size_t i = 0; i < nodes; ++i) inner(kLower);
        } else {
            file_.skip(nodes * kLeafMask);
            leaves_ += nodes;
        }
    }

    void leaf() {
        switch (layout_.leaves) {
            case LeafLayout::Mask:
                return file_.skip(kLeafMask + kOrigin);
            case LeafLayout::Booleans:
                return file_.skip(kLeafMask + kOrigin + kLeafMask);
            default:
                break;
        }
        std::size_t active = 0;
        for (std::size_t i = 0; i < kLeafMask; i += sizeof(std::uint64_t)) {
            active += static_cast<std::size_t>(std::popcount(file_.take<std::uint64_t>()));
        }
        values(8 * kLeafMask, active);
    }

    /// The values of a node: a byte that says which are left out, the one or two values of those, and a block with the others.
    void values(std::size_t size, std::size_t active) {
        using namespace openvdb;
        const auto packing = file_.take<std::int8_t>();
        if (packing < io::NO_MASK_OR_INACTIVE_VALS || packing > io::NO_MASK_AND_ALL_VALS) {
            file_.fail("an unknown packing of values: " + std::to_string(packing));
        }
        const bool two = packing == io::MASK_AND_TWO_INACTIVE_VALS;
        const bool one = packing == io::NO_MASK_AND_ONE_INACTIVE_VAL || packing == io::MASK_AND_ONE_INACTIVE_VAL;
        file_.skip((two ? 2 : one ? 1 : 0) * layout_.value_bytes);
        if (two || packing == io::MASK_AND_NO_INACTIVE_VALS || packing == io::MASK_AND_ONE_INACTIVE_VAL) file_.skip(size / 8);
        const std::size_t stored = coding_.masked && packing != io::NO_MASK_AND_ALL_VALS ? active : size;
        if (stored == 0 && stored_bytes_ != layout_.value_bytes) return;
        block(stored * stored_bytes_);
    }

    /// raw: the size of OpenVDB's buffer for it
    void block(std::uint64_t raw) {
        if (!coding_.blosc && !coding_.zip) return file_.skip(raw);
        const auto size = file_.take<std::int64_t>();
        if (size <= 0) {  // not compressed: the negative size
            if (size != -static_cast<std::int64_t>(raw)) {
                file_.fail("a block of " + std::to_string(size).substr(size < 0) + " bytes", std::to_string(raw) + " are due");
            }
            return file_.skip(raw);
        }
        if (static_cast<std::uint64_t>(size) > file_.left()) {
            file_.fail("a block of " + std::to_string(size) + " bytes", std::to_string(file_.left()) + " are left");
        }
        if (coding_.blosc) return check_blosc(file_, static_cast<std::uint64_t>(size), raw);
        file_.skip(static_cast<std::uint64_t>(size));
    }

    VdbBytes& file_;
    const TreeLayout layout_;
    const BlockCoding coding_;
    const std::size_t stored_bytes_;
    std::set<Origin> origins_;
    std::size_t leaves_ = 0;
};

}  // namespace

std::optional<TreeLayout> tree_layout(const std::string& type) {
    static constexpr std::pair<const char*, TreeLayout> kLayouts[] = {
        {"float", {4, 2, LeafLayout::Values}},   {"double", {8, 2, LeafLayout::Values}},
        {"vec3s", {12, 6, LeafLayout::Values}},  {"vec3d", {24, 6, LeafLayout::Values}},
        {"vec3i", {12, 12, LeafLayout::Values}}, {"int32", {4, 4, LeafLayout::Values}},
        {"int64", {8, 8, LeafLayout::Values}},   {"bool", {1, 1, LeafLayout::Booleans}},
        {"mask", {1, 1, LeafLayout::Mask}},      {"ptdataidx32", {4, 4, LeafLayout::Points}},
    };
    for (const auto& [value, layout] : kLayouts) {
        if (type == std::string("Tree_") + value + "_5_4_3") return layout;
    }
    return std::nullopt;
}

void check_blosc(VdbBytes& file, std::uint64_t size, std::uint64_t raw) {
    struct Header {
        std::uint8_t version, codec_version, flags, type_size;
        std::uint32_t raw, part, size;
    };
    if (size < sizeof(Header)) file.fail("a block of " + std::to_string(size) + " bytes is too short for blosc");
    const std::uint64_t end = file.position() + size;
    if (size > file.left()) file.skip(size);  // fails
    const auto header = file.take<Header>();
    if (header.raw != raw || header.size != size) {
        file.fail(
            "a block for blosc of " + std::to_string(header.size) + " bytes that unpack into " + std::to_string(header.raw),
            std::to_string(size) + " and " + std::to_string(raw) + " are due");
    }
    constexpr std::uint64_t kBestRatio = 256;  // of LZ4, the codec that OpenVDB chooses: a byte cannot repeat more than 255
    if (raw / kBestRatio > size) file.fail("a block of " + std::to_string(size) + " bytes cannot hold " + std::to_string(raw));
    file.seek(end);
}

void check_tree(VdbBytes& file, const TreeLayout& layout, const BlockCoding& coding, bool in_half) {
    TreeCheck(file, layout, coding, in_half).run();
}

}  // namespace subvol::detail
