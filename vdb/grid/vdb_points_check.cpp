// SPDX-License-Identifier: Apache-2.0
// The attributes of a point grid are stored in passes over all leaves: the sizes of voxels' blocks, the attributes'
// descriptions, the sizes of each attribute's pages, the voxels, the pages. See points/PointDataGrid.h and
// points/StreamCompression.cc of OpenVDB.
#include <openvdb/points/AttributeArray.h>

#include <algorithm>
#include <limits>
#include <set>

#include "subvol/detail/printable.h"
#include "vdb_tree_check.h"

namespace subvol::detail {

namespace {

using openvdb::points::AttributeArray;

constexpr std::uint64_t kPadded = 128;  // OpenVDB lengthens shorter blocks before it compresses them

/// A block for blosc that unpacks into `raw` bytes, or into 128 if those are fewer.
void check_padded_blosc(VdbBytes& file, std::uint64_t size, std::uint64_t raw) {
    constexpr std::uint64_t kRawSize = 4;  // where blosc's header has it
    const std::uint64_t begin = file.position();
    file.skip(kRawSize);
    const auto unpacked = file.take<std::uint32_t>();
    file.seek(begin);
    check_blosc(file, size, raw <= kPadded && unpacked == kPadded ? kPadded : raw);
}

/// An attribute of the points of one leaf.
struct Attribute {
    std::uint64_t stored = 0;  // bytes in the file; of a paged attribute in memory
    std::uint64_t raw = 0;     // bytes in memory
    bool uniform = false, paged = false;
};

class PointsCheck {
public:
    PointsCheck(VdbBytes& file, std::size_t leaves) : file_(file), leaves_(leaves) {}

    void run() {
        const auto passes = file_.take<std::uint16_t>();
        if (leaves_.empty()) return;
        file_.skip(leaves_.size() * sizeof(std::uint16_t));  // the sizes of the voxels' blocks, which are stored twice
        std::size_t attributes = 0;
        for (std::vector<Attribute>& leaf : leaves_) {
            describe(leaf);
            attributes = std::max(attributes, leaf.size());
        }
        constexpr std::size_t kOtherPasses = 4;
        if (passes != 2 * attributes + kOtherPasses) {
            file_.fail("points in " + std::to_string(passes) + " passes", std::to_string(2 * attributes + kOtherPasses));
        }
        pages_.resize(attributes);
        for (std::size_t a = 0; a < attributes; ++a) read_page_sizes(a);
        for (std::size_t i = 0; i < leaves_.size(); ++i) voxels();
        for (std::size_t a = 0; a < attributes; ++a) read_values(a);
    }

private:
    /// compressed: negative if the page is not compressed
    struct Page {
        std::int64_t compressed, raw;
    };

    void describe(std::vector<Attribute>& leaf) {
        if (!shared_) {
            const auto flags = file_.take<std::uint8_t>();
            if (flags > 3) file_.fail("unknown flags of points: " + std::to_string(flags), "at most 3");
            read_types();
            shared_ = (flags & 1) != 0;
            if ((flags & 2) != 0) file_.skip(file_.take<std::uint64_t>());
        }
        for (const std::size_t value_bytes : types_) leaf.push_back(attribute(value_bytes));
    }

    /// The types and names of attributes, and the groups of points.
    void read_types() {
        const auto count = count_of("attributes");
        types_.clear();
        for (std::uint64_t i = 0; i < count; ++i) {
            const std::string value = file_.text(), codec = file_.text();
            if (!AttributeArray::isRegistered({value, codec})) {
                file_.fail("an attribute of the unknown type " + in_quotes(value + " " + codec));
            }
            types_.push_back(AttributeArray::create({value, codec}, 1, 1)->storageTypeSize());
        }
        std::set<std::string> names;
        std::set<std::uint64_t> positions;
        for (std::uint64_t i = 0; i < count; ++i) {
            names.insert(file_.text());
            positions.insert(file_.take<std::uint64_t>());
        }
        if (names.size() != count || (count > 0 && (positions.size() != count || *positions.rbegin() >= count))) {
            file_.fail("the names of " + std::to_string(count) + " attributes are not one for each");
        }
        for (std::uint64_t left = count_of("groups"); left > 0; --left) {
            (void)file_.text();
            file_.skip(sizeof(std::uint64_t));
        }
        check_metadata(file_);
    }

    std::uint64_t count_of(const std::string& what) {
        constexpr std::uint64_t kLeastBytes = sizeof(std::uint32_t) + sizeof(std::uint64_t);
        const auto count = file_.take<std::uint64_t>();
        if (!file_.has_room_for(count, kLeastBytes)) file_.fail("a count of " + std::to_string(count) + " " + what);
        return count;
    }

    Attribute attribute(std::size_t value_bytes) {
        constexpr std::uint64_t kCounted = 6;                         // bytes of the description that the size includes
        constexpr std::uint8_t kConstantStride = 0x8, kFlags = 0x20;  // AttributeArray::Flag
        constexpr std::uint8_t kStrided = 1, kUniform = 2, kPaged = 8, kStorageFlags = 16;  // AttributeArray::SerializationFlag
        const auto size = file_.take<std::uint64_t>();
        const auto flags = file_.take<std::uint8_t>(), storage = file_.take<std::uint8_t>();
        const std::uint64_t points = file_.take<std::uint32_t>();
        if (flags >= kFlags || storage >= kStorageFlags) file_.fail("unknown flags of an attribute");
        const std::uint64_t stride = (storage & kStrided) != 0 ? file_.take<std::uint32_t>() : 1;
        const std::uint64_t values = (flags & kConstantStride) != 0 ? points * stride : stride;
        if (stride == 0 || values < points || values > std::numeric_limits<std::int32_t>::max()) {
            file_.fail("an attribute of " + std::to_string(points) + " points has " + std::to_string(values) + " values");
        }
        Attribute attribute{.stored = size - kCounted, .raw = values * value_bytes};
        attribute.uniform = (storage & kUniform) != 0;
        attribute.paged = (storage & kPaged) != 0;
        if (attribute.uniform) attribute.raw = value_bytes;
        const bool exact = attribute.uniform || attribute.paged;
        if (size <= kCounted || (exact && attribute.stored != attribute.raw)) {
            file_.fail("an attribute has a size of " + std::to_string(size) + " bytes",
                       std::to_string(attribute.raw + kCounted) + " are due");
        }
        return attribute;
    }

    /// OpenVDB reads a page's size when the values of the leaves before have filled the last page exactly.
    void read_page_sizes(std::size_t a) {
        std::int64_t filled = 0;
        std::vector<Page>& pages = pages_[a];
        for (const std::vector<Attribute>& leaf : leaves_) {
            if (a >= leaf.size() || !leaf[a].paged) continue;
            if (pages.empty() || filled == pages.back().raw) {
                const auto compressed = file_.take<std::int32_t>();
                const auto raw = compressed > 0 ? file_.take<std::int32_t>() : -static_cast<std::int64_t>(compressed);
                if (raw <= 0) file_.fail("a page of " + std::to_string(raw) + " bytes");
                pages.push_back({compressed, raw});
                filled = 0;
            }
            const auto more = static_cast<std::int64_t>(leaf[a].stored);
            if (more > pages.back().raw - filled) {
                file_.fail("a page has " + std::to_string(pages.back().raw) + " bytes",
                           std::to_string(filled) + " + " + std::to_string(more) + " are due");
            }
            filled += more;
        }
        if (!pages.empty() && filled != pages.back().raw) file_.fail("the last page of an attribute is not full");
    }

    void voxels() {
        constexpr std::uint64_t kMask = 512 / 8, kOffsets = 512 * sizeof(std::uint32_t);
        constexpr std::uint16_t kUncompressed = 0xFFFF;
        file_.skip(kMask);
        const auto size = file_.take<std::uint16_t>();
        if (size == kUncompressed) {
            file_.skip(kOffsets);
        } else {
            check_blosc(file_, size, kOffsets);
        }
    }

    void read_values(std::size_t a) {
        std::size_t next = 0;
        std::int64_t left = 0;
        for (const std::vector<Attribute>& leaf : leaves_) {
            if (a >= leaf.size()) continue;
            const Attribute& attribute = leaf[a];
            if (!attribute.paged) {
                unpaged(attribute);
            } else {
                if (left == 0) {
                    const Page& page = pages_[a][next++];
                    left = page.raw;
                    if (page.compressed > 0) {
                        check_padded_blosc(file_, static_cast<std::uint64_t>(page.compressed),
                                           static_cast<std::uint64_t>(page.raw));
                    } else {
                        file_.skip(static_cast<std::uint64_t>(page.raw));
                    }
                }
                left -= static_cast<std::int64_t>(attribute.stored);
            }
        }
    }

    void unpaged(const Attribute& attribute) {
        if (attribute.uniform) return file_.skip(attribute.stored);
        const auto compressed = file_.take<std::uint8_t>();
        if (compressed == 1) return check_padded_blosc(file_, attribute.stored, attribute.raw);
        if (attribute.stored != attribute.raw) {
            file_.fail("an attribute has " + std::to_string(attribute.stored) + " bytes",
                       std::to_string(attribute.raw) + " are due");
        }
        file_.skip(attribute.stored);
    }

    VdbBytes& file_;
    std::vector<std::vector<Attribute>> leaves_;
    std::vector<std::size_t> types_;  // the bytes of a value
    std::vector<std::vector<Page>> pages_;
    bool shared_ = false;  // all leaves have the same attributes
};

}  // namespace

void check_point_leaves(VdbBytes& file, std::size_t leaves) {
    PointsCheck(file, leaves).run();
}

}  // namespace subvol::detail
