// SPDX-License-Identifier: Apache-2.0
// The layout of .vdb files is documented nowhere but in OpenVDB's sources: io/Archive.cc, io/Compression.h, tree/*Node.h.
// What is read here in one order, OpenVDB will read in the same order.
#include "vdb_check.h"

#include <openvdb/io/Compression.h>
#include <openvdb/io/DelayedLoadMetadata.h>
#include <openvdb/math/Maps.h>
#include "openvdb_grids.h"

#include <algorithm>
#include <cctype>

#include "subvol/detail/printable.h"
#include "vdb_tree_check.h"

namespace subvol::detail {

namespace {

constexpr std::uint32_t kOldest = openvdb::OPENVDB_FILE_VERSION_NODE_MASK_COMPRESSION;  // of 2013; older ones differ in much
constexpr const char* kHalf = "_HalfFloat";

/// Where a grid lies in the file; all 0 if the file was written as a stream.
struct GridOffsets {
    std::int64_t grid, blocks, end;
};

/// Reads what comes before the grids.
class FileCheck {
public:
    explicit FileCheck(const std::filesystem::path& path) : file_(path) {}

    std::vector<GridEntry> run(std::span<const std::string> types) {
        header();
        check_metadata(file_);
        const auto grids = file_.take<std::int32_t>();
        constexpr std::uint64_t kLeastBytes = 3 * 4 + sizeof(GridOffsets);
        if (grids < 0 || !file_.has_room_for(static_cast<std::uint64_t>(grids), kLeastBytes)) {
            file_.fail("a count of " + std::to_string(grids) + " grids");
        }
        for (std::int32_t i = 0; i < grids; ++i) grid(types);
        check_parents(types);
        return std::move(entries_);
    }

private:
    void header() {
        if (file_.take<std::int64_t>() != openvdb::OPENVDB_MAGIC) {
            file_.seek(0);
            file_.fail("its first bytes are not those of a .vdb file");
        }
        version_ = file_.take<std::uint32_t>();
        if (version_ < kOldest || version_ > openvdb::OPENVDB_FILE_VERSION) {
            file_.fail("the file's version is " + std::to_string(version_),
                       std::to_string(kOldest) + " to " + std::to_string(openvdb::OPENVDB_FILE_VERSION) + " can be read");
        }
        file_.skip(2 * sizeof(std::uint32_t));  // the version of the library that wrote it
        const auto has_offsets = file_.take<std::uint8_t>();
        if (has_offsets > 1) file_.fail("a flag is " + std::to_string(has_offsets), "0 or 1");
        has_offsets_ = has_offsets == 1;
        constexpr std::string_view kUuid = "xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx";
        for (const char expected : kUuid) {
            const auto found = file_.take<char>();
            const bool right = expected == '-' ? found == '-' : std::isxdigit(static_cast<unsigned char>(found)) != 0;
            if (!right) file_.fail("the file's identifier has " + in_quotes({&found, 1}), "32 hexadecimal digits");
        }
    }

    void grid(std::span<const std::string> types) {
        GridEntry entry;
        entry.begin = file_.position();
        entry.name = file_.text();
        entry.type = file_.text();
        if (entry.type.ends_with(kHalf)) {
            entry.half = true;
            entry.type.resize(entry.type.size() - std::string_view(kHalf).size());
        }
        entry.parent = file_.text();
        const auto offsets = file_.take<GridOffsets>();
        if (has_offsets_ && !lies_ahead(offsets.end)) {
            file_.fail("a grid ends at byte " + std::to_string(offsets.end), std::to_string(file_.left()) + " bytes are left");
        }
        const bool wanted = std::ranges::find(types, entry.type) != types.end();
        if (wanted || !has_offsets_) {
            content(entry);
            if (has_offsets_ && file_.position() != static_cast<std::uint64_t>(offsets.end)) {
                file_.fail("a grid ends", "at byte " + std::to_string(offsets.end) + " by its description");
            }
        } else {
            file_.seek(static_cast<std::uint64_t>(offsets.end));
        }
        entries_.push_back(std::move(entry));
    }

    [[nodiscard]] bool lies_ahead(std::int64_t end) const {
        return end > 0 && static_cast<std::uint64_t>(end) > file_.position() &&
               static_cast<std::uint64_t>(end) <= file_.position() + file_.left();
    }

    void content(const GridEntry& entry) {
        const auto layout = tree_layout(entry.type);
        if (!layout || (layout->leaves == LeafLayout::Points && version_ < openvdb::OPENVDB_FILE_VERSION_MULTIPASS_IO)) {
            file_.fail("a grid is of the type " + in_quotes(entry.type), "it cannot be checked");
        }
        using namespace openvdb;
        const auto flags = file_.take<std::uint32_t>();
        if (flags > (io::COMPRESS_ZIP | io::COMPRESS_ACTIVE_MASK | io::COMPRESS_BLOSC)) {
            file_.fail("an unknown compression: " + std::to_string(flags));
        }
        check_metadata(file_);
        transform(/*may_be_frustum=*/true);
        if (!entry.parent.empty()) return;  // it has no tree of its own
        const BlockCoding coding{.blosc = (flags & io::COMPRESS_BLOSC) != 0,
                                 .zip = (flags & io::COMPRESS_ZIP) != 0,
                                 .masked = (flags & io::COMPRESS_ACTIVE_MASK) != 0};
        check_tree(file_, *layout, coding, entry.half);
    }

    void transform(bool may_be_frustum) {
        using namespace openvdb::math;
        constexpr std::size_t kVector = 3 * sizeof(double);
        const std::string type = file_.text();
        if (type == AffineMap::mapType() || type == UnitaryMap::mapType()) {
            file_.skip(16 * sizeof(double));
        } else if (type == TranslationMap::mapType()) {
            file_.skip(kVector);
        } else if (type == ScaleMap::mapType() || type == UniformScaleMap::mapType()) {
            file_.skip(5 * kVector);
        } else if (type == ScaleTranslateMap::mapType() || type == UniformScaleTranslateMap::mapType()) {
            file_.skip(6 * kVector);
        } else if (type == NonlinearFrustumMap::mapType() && may_be_frustum) {
            file_.skip(2 * kVector + 2 * sizeof(double));
            transform(/*may_be_frustum=*/false);
        } else {
            file_.fail("an unknown transform " + in_quotes(type));
        }
    }

    /// A grid that shares a tree needs one of its own type.
    void check_parents(std::span<const std::string> types) const {
        for (const GridEntry& entry : entries_) {
            if (entry.parent.empty() || std::ranges::find(types, entry.type) == types.end()) continue;
            const auto parent = std::ranges::find(entries_, entry.parent, &GridEntry::name);
            if (parent == entries_.end() || parent->type != entry.type || !parent->parent.empty()) {
                file_.fail("the grid " + in_quotes(entry.name) + " shares a tree with " + in_quotes(entry.parent),
                           "the name of a grid of the same type");
            }
        }
    }

    VdbBytes file_;
    std::uint32_t version_ = 0;
    bool has_offsets_ = false;
    std::vector<GridEntry> entries_;
};

/// The sizes of the leaves' blocks, which OpenVDB writes for readers that load them later: a count of leaves, a byte for each,
/// and 64 bits for each.
void check_block_sizes(VdbBytes& file, std::uint32_t size) {
    if (size == 0) return;
    const std::uint64_t end = file.position() + size;
    constexpr std::uint32_t kNone = 0xFFFFFFFF;
    const auto leaves = file.take<std::uint32_t>();
    for (const std::uint64_t item : {1, 8}) {
        const auto packed = file.take<std::uint32_t>();
        if (packed == kNone && item == 8) break;
        const std::uint64_t raw = leaves * item;
        if (packed == 0) {
            file.skip(raw);
        } else {
            constexpr std::uint64_t kPadded = 128;  // OpenVDB lengthens shorter ones
            check_blosc(file, packed, std::max(raw, kPadded));
        }
    }
    if (file.position() != end) file.fail("the sizes of blocks end", "at byte " + std::to_string(end));
}

}  // namespace

void check_metadata(VdbBytes& file) {
    const auto items = file.take<std::uint32_t>();
    if (!file.has_room_for(items, 3 * sizeof(std::uint32_t))) file.fail("a count of " + std::to_string(items) + " metadata");
    for (std::uint32_t i = 0; i < items; ++i) {
        (void)file.text();  // the name
        const std::string type = file.text();
        const auto size = file.take<std::uint32_t>();
        if (size > file.left())
            file.fail("metadata of " + std::to_string(size) + " bytes", std::to_string(file.left()) + " are left");
        if (type == openvdb::io::DelayedLoadMetadata::staticTypeName()) {
            check_block_sizes(file, size);
            continue;
        }
        // OpenVDB reads values of a type that it knows by the type's size, whatever the file says.
        if (type != openvdb::StringMetadata::staticTypeName() && openvdb::Metadata::isRegisteredType(type)) {
            const std::uint32_t expected = openvdb::Metadata::createMetadata(type)->size();
            if (size != expected) {
                file.fail("metadata of the type " + in_quotes(type) + " have " + std::to_string(size) + " bytes",
                          std::to_string(expected) + " are due");
            }
        }
        file.skip(size);
    }
}

std::vector<GridEntry> checked_grids(const std::filesystem::path& path, std::span<const std::string> types) {
    openvdb::initialize();
    return FileCheck(path).run(types);
}

}  // namespace subvol::detail
