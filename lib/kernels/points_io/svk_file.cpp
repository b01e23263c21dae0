// SPDX-License-Identifier: Apache-2.0
// Reads and writes files of kernels in blocks, extent by extent:
//
//     preamble, 48 bytes │ head │ boundary │ top of the tree │ nodes, part by part │ kernels' numbers │ kernels
//
// In each of the last three, the extents of all blocks follow each other. The head has counts, the kernel, the channels, and a
// hash for every extent; the preamble has the hash of the head. All places follow from the head.
//
// Opening a file checks its beginning, byte order, version, length and head, and that the counts need exactly that length. An
// extent is checked against its hash when it is read, and the numbers in it against the counts. A file that is written gets its
// extents in any order, then the preamble and the head, whose hashes are known last, and then its name. Reading all of it takes
// the numbers of all blocks, makes sure that none occurs twice, and puts each kernel at its number: the order of the volume
// that was written.
#include "svk_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <tbb/parallel_for.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <system_error>
#include <utility>

#include "points_file.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::string_view kMagic{"subvol-kernels\n", 16};  // with the null
constexpr std::uint32_t kByteOrder = 0x01020304, kVersion = 1;
constexpr std::uint64_t kMostCount = std::uint64_t{1} << 32;  // of kernels, and of the boundary's points and triangles
constexpr std::uint32_t kMostChannels = 1 << 16;

/// What a file begins with. The hash is of the head, which follows.
struct Preamble {
    std::array<char, 16> magic{};
    std::uint32_t byte_order = kByteOrder, version = kVersion;
    std::uint64_t head_bytes = 0, file_bytes = 0, head_hash = 0;
};
static_assert(sizeof(Preamble) == 48);

template <class T>
void put(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void put_text(std::string& bytes, std::string_view text) {
    put(bytes, static_cast<std::uint32_t>(text.size()));
    bytes += text;
}

/// Takes one number or text after the other from the head.
class HeadReader {
public:
    HeadReader(const SvkFile& file, std::string_view bytes) : file_(file), rest_(bytes) {}

    template <class T>
    T number() {
        T value{};
        std::memcpy(&value, take(sizeof value).data(), sizeof value);
        return value;
    }
    std::string text() { return std::string(take(number<std::uint32_t>())); }
    [[nodiscard]] std::size_t left() const { return rest_.size(); }

private:
    std::string_view take(std::size_t bytes) {
        if (bytes > rest_.size()) file_.fail("the head ends too early");
        const std::string_view taken = rest_.substr(0, bytes);
        rest_.remove_prefix(bytes);
        return taken;
    }

    const SvkFile& file_;
    std::string_view rest_;
};

std::string block_name(std::size_t block) {
    return "block " + std::to_string(block);
}

}  // namespace

SvkFile::SvkFile(std::filesystem::path path) : path_(std::move(path)), file_(::open(path_.c_str(), O_RDONLY | O_CLOEXEC)) {
    if (file_ < 0) throw Error(ErrorCode::Io, "cannot be read: " + std::generic_category().message(errno), path_.string());
    try {
        read_head();
    } catch (...) {
        (void)::close(file_);
        throw;
    }
}

SvkFile::~SvkFile() {
    (void)::close(file_);
}

void SvkFile::fail(const std::string& what, const std::string& allowed) const {
    throw Error(ErrorCode::InvalidInput, what, path_.string(), allowed);
}

std::string SvkFile::read(std::uint64_t offset, std::uint64_t bytes) const {
    std::string result(bytes, '\0');
    for (std::size_t done = 0; done < bytes;) {
        const ssize_t count = ::pread(file_, &result[done], bytes - done, static_cast<off_t>(offset + done));
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw Error(ErrorCode::Io, "cannot be read: " + std::generic_category().message(errno), path_.string());
        if (count == 0) fail("ends too early");  // it was longer when it was opened
        done += static_cast<std::size_t>(count);
    }
    bytes_read_ += bytes;
    return result;
}

std::string SvkFile::read(const SvkExtent& extent, std::size_t hash, const std::string& name) const {
    std::string bytes = read(extent.offset, extent.bytes);
    if (hash_of(bytes) != hashes_[hash]) fail(name + " is damaged: its bytes are not those that were written");
    return bytes;
}

void SvkFile::read_head() {
    struct stat about {};
    if (::fstat(file_, &about) != 0 || !S_ISREG(about.st_mode)) {
        throw Error(ErrorCode::Io, "cannot be read: it is not a file with a size", path_.string());
    }
    const auto size = static_cast<std::uint64_t>(about.st_size);
    Preamble preamble;
    std::string begin = read(0, std::min<std::uint64_t>(size, sizeof preamble));
    if (!begin.starts_with(kMagic)) fail("is not a file of kernels with levels of detail", "it begins with subvol-kernels");
    if (size < sizeof preamble) fail("is cut off within its first 48 bytes");
    std::memcpy(&preamble, begin.data(), sizeof preamble);
    if (preamble.byte_order != kByteOrder) fail("was written by a machine with the other order of bytes", "write it again");
    if (preamble.version != kVersion) {
        fail("has version " + std::to_string(preamble.version) + " of the format",
             "this program reads version " + std::to_string(kVersion) + "; write it again");
    }
    if (preamble.file_bytes != size) {
        fail("has " + std::to_string(size) + " bytes, of " + std::to_string(preamble.file_bytes) + " that were written");
    }
    if (preamble.head_bytes > size - sizeof preamble) fail("its head is longer than the file");
    const std::string head = read(sizeof preamble, preamble.head_bytes);
    if (hash_of(head) != preamble.head_hash) fail("its head is damaged: its bytes are not those that were written");

    HeadReader in(*this, head);
    contents_.kernels = in.number<std::uint64_t>();
    contents_.boundary_points = in.number<std::uint64_t>();
    contents_.boundary_triangles = in.number<std::uint64_t>();
    for (Vec3* corner : {&contents_.bounds.lower, &contents_.bounds.upper}) {
        for (int k = 0; k < 3; ++k) (*corner)[k] = in.number<double>();
    }
    if (contents_.kernels == 0) fail("there are no kernels in it");
    if (std::max({contents_.kernels, contents_.boundary_points, contents_.boundary_triangles}) >= kMostCount) {
        fail("its head has a count of 2³² or more");
    }
    try {
        contents_.kernel = kernel_from_json(in.text());
        validate(contents_.kernel);
    } catch (const Error& error) {
        if (error.where() == path_.string()) throw;
        fail(std::string("its kernel: ") + error.what());
    }
    const auto channels = in.number<std::uint32_t>();
    if (channels == 0 || channels > kMostChannels) fail("has " + std::to_string(channels) + " channels", "1 to 65536");
    for (std::uint32_t c = 0; c < channels; ++c) {
        SvkChannel channel{.name = printable(in.text())};
        channel.bent = in.number<std::uint8_t>() != 0;
        channel.min = in.number<float>();
        channel.max = in.number<float>();
        if (!(channel.min <= channel.max)) fail("the range of channel \"" + channel.name + "\" is empty");
        contents_.channels.push_back(std::move(channel));
    }
    layout_ = SvkLayout(contents_, sizeof preamble + preamble.head_bytes);
    if (layout_.file_bytes() != size) {
        fail("its counts do not fit its size: they need " + std::to_string(layout_.file_bytes()) + " bytes, it has " +
             std::to_string(size));
    }
    if (in.left() != layout_.hashes() * sizeof(std::uint64_t)) fail("its head has another number of hashes than of blocks");
    hashes_.resize(layout_.hashes());
    for (std::uint64_t& hash : hashes_) hash = in.number<std::uint64_t>();
}

void SvkFile::check_kernels(const SvkArrays& arrays, const std::string& name) const {
    try {
        validate(arrays.volume());
    } catch (const Error& error) {
        fail(name + ": " + error.what());
    }
}

std::string SvkFile::part(std::size_t block, std::size_t part) const {
    const SvkExtent extent = layout_.part(block, part);
    std::string bytes = read(extent, layout_.hash_of_part(block, part), block_name(block));
    if (part == layout_.numbers_part()) return bytes;
    const bool nodes = part < layout_.node_parts();
    const SvkArrays arrays(contents_, nodes ? SvkArrays::Kind::Nodes : SvkArrays::Kind::Kernels, bytes, extent.count);
    check_kernels(arrays, block_name(block));
    return bytes;
}

std::string SvkFile::top() const {
    std::string bytes = read(layout_.top(), 1, "the top of the tree");
    check_kernels({contents_, SvkArrays::Kind::Nodes, bytes, layout_.top().count}, "the top of the tree");
    return bytes;
}

Surface SvkFile::boundary() const {
    const std::string bytes = read(layout_.boundary(), 0, "the boundary");
    Surface surface;
    surface.points.resize(contents_.boundary_points);
    surface.triangles.resize(contents_.boundary_triangles);
    for (std::size_t i = 0; i < surface.points.size(); ++i) {
        Vec3& p = surface.points[i];
        std::memcpy(&p, &bytes[i * sizeof p], sizeof p);
        if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
            fail("a coordinate of the boundary is not finite");
        }
    }
    const std::size_t first = surface.points.size() * sizeof(Vec3);
    for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
        std::array<std::uint32_t, 3> corners;
        std::memcpy(&corners, &bytes[first + i * sizeof corners], sizeof corners);
        for (std::size_t k = 0; k < 3; ++k) {
            if (corners[k] >= surface.points.size()) {
                fail("the boundary has no point " + std::to_string(corners[k]),
                     "it has " + std::to_string(surface.points.size()) + ", counted from 0");
            }
            surface.triangles[i][k] = corners[k];
        }
    }
    return surface;
}

std::vector<std::uint32_t> SvkFile::numbers_in(std::size_t block, std::string_view part) const {
    std::vector<std::uint32_t> numbers(part.size() / sizeof(std::uint32_t));
    if (!numbers.empty()) std::memcpy(numbers.data(), part.data(), part.size());
    for (const std::uint32_t number : numbers) {
        if (number < contents_.kernels) continue;
        fail(block_name(block) + " has a kernel with the number " + std::to_string(number),
             "there are " + std::to_string(contents_.kernels));
    }
    return numbers;
}

SvkWriter::SvkWriter(const std::filesystem::path& path, SvkContents contents)
    : contents_(std::move(contents)), out_(path), layout_(contents_, 0) {
    hashes_.resize(layout_.hashes());
    layout_ = SvkLayout(contents_, sizeof(Preamble) + head().size());
}

std::string SvkWriter::head() const {
    std::string bytes;
    put(bytes, contents_.kernels);
    put(bytes, contents_.boundary_points);
    put(bytes, contents_.boundary_triangles);
    for (const Vec3& corner : {contents_.bounds.lower, contents_.bounds.upper}) {
        for (int k = 0; k < 3; ++k) put(bytes, corner[k]);
    }
    put_text(bytes, to_json(contents_.kernel));
    put(bytes, static_cast<std::uint32_t>(contents_.channels.size()));
    for (const SvkChannel& channel : contents_.channels) {
        put_text(bytes, channel.name);
        put(bytes, static_cast<std::uint8_t>(channel.bent ? 1 : 0));
        put(bytes, channel.min);
        put(bytes, channel.max);
    }
    for (const std::uint64_t hash : hashes_) put(bytes, hash);
    return bytes;
}

void SvkWriter::write(const SvkExtent& extent, std::size_t hash, std::string_view bytes) {
    assert(bytes.size() == extent.bytes);
    hashes_[hash] = hash_of(bytes);
    if (extent.offset == position_) {
        out_.write(bytes);
    } else {
        out_.write_at(extent.offset, bytes);
    }
    position_ = extent.offset + extent.bytes;
}

void SvkWriter::write_boundary(const Surface& boundary) {
    std::string bytes;
    bytes.reserve(layout_.boundary().bytes);
    for (const Vec3& p : boundary.points) put(bytes, p);
    for (const auto& triangle : boundary.triangles) {
        for (const Index corner : triangle) put(bytes, static_cast<std::uint32_t>(corner));
    }
    write(layout_.boundary(), 0, bytes);
}

void SvkWriter::write_top(std::string_view bytes) {
    write(layout_.top(), 1, bytes);
}

void SvkWriter::write_part(std::size_t block, std::size_t part, std::string_view bytes) {
    write(layout_.part(block, part), layout_.hash_of_part(block, part), bytes);
}

void SvkWriter::finish() {
    const std::string head = this->head();
    Preamble preamble{.head_bytes = head.size(), .file_bytes = layout_.file_bytes(), .head_hash = hash_of(head)};
    kMagic.copy(preamble.magic.data(), kMagic.size());
    std::string bytes;
    put(bytes, preamble);
    out_.write_at(0, bytes + head);
    out_.commit();
}

/// The kernels in the order of the volume that was written.
RbfVolume read_svk(const std::filesystem::path& path) {
    const SvkFile file(path);
    const SvkContents& contents = file.contents();
    const SvkLayout& layout = file.layout();
    std::vector<std::size_t> channels(contents.channels.size());
    for (std::size_t c = 0; c < channels.size(); ++c) channels[c] = c;
    std::vector<char> found(contents.kernels);
    std::vector<std::vector<std::uint32_t>> numbers;
    for (std::size_t block = 0; block < layout.blocks(); ++block) {
        numbers.push_back(file.numbers_in(block, file.part(block, layout.numbers_part())));
        for (const std::uint32_t number : numbers.back()) {
            if (std::exchange(found[number], char{1}) != 0) file.fail("kernel " + std::to_string(number) + " is in it twice");
        }
    }
    RbfVolume volume = svk_volume(contents, contents.kernels, channels);
    volume.boundary = file.boundary();
    tbb::parallel_for(std::size_t{0}, layout.blocks(), [&](std::size_t block) {
        const std::string bytes = file.part(block, layout.kernels_part());
        const SvkArrays kernels(contents, SvkArrays::Kind::Kernels, bytes, numbers[block].size());
        for (std::size_t i = 0; i < kernels.size(); ++i) kernels.copy(i, volume, numbers[block][i], channels);
    });
    return volume;
}

}  // namespace subvol::detail
