// SPDX-License-Identifier: Apache-2.0
// Points as .npz: numpy's archive, a zip without compression with one .npy for each array. An .npy is a line of text that says
// type and shape, padded so that the numbers after it begin at a multiple of 64 bytes, and the numbers as they lie in memory.
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "points_file.h"
#include "subvol/detail/output_file.h"
#include "subvol/error.h"
#include "subvol/points_io.h"

namespace subvol::detail {

namespace {

using Bytes = std::string_view;

template <class T>
Bytes bytes_of(const std::vector<T>& values) {
    return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

std::string shape_text(const std::vector<std::size_t>& shape) {
    std::string text = "(";
    for (const std::size_t side : shape) text += std::to_string(side) + ", ";
    if (shape.size() > 1) text.resize(text.size() - 2);
    return text + ")";
}

/// An array of the archive: its numbers are those of the parts, one after the other.
struct NpzArray {
    std::string name;
    std::string head;
    std::vector<Bytes> parts;

    /// type: numpy's letter and bytes, such as "f8", or "S12" of texts
    NpzArray(const std::string& called, const std::string& type, const std::vector<std::size_t>& shape,
             std::vector<Bytes> bytes)
        : name(called + ".npy"), parts(std::move(bytes)) {
        constexpr std::size_t kAlign = 64, kBefore = 10;  // the magic word, the version and the length
        const std::string order = type[0] == 'S' ? "|" : std::endian::native == std::endian::little ? "<" : ">";
        std::string line = "{'descr': '" + order + type + "', 'fortran_order': False, 'shape': " + shape_text(shape) + ", }";
        line.append((kAlign - (kBefore + line.size() + 1) % kAlign) % kAlign, ' ');
        line += '\n';
        head = std::string("\x93NUMPY\x01\x00", 8);
        head += static_cast<char>(line.size() & 0xff);
        head += static_cast<char>(line.size() >> 8);
        head += line;
    }

    [[nodiscard]] std::uint64_t size() const {
        std::uint64_t bytes = head.size();
        for (const Bytes part : parts) bytes += part.size();
        return bytes;
    }
    [[nodiscard]] std::uint32_t checksum() const {
        uLong sum = add(crc32(0, nullptr, 0), head);
        for (const Bytes part : parts) sum = add(sum, part);
        return static_cast<std::uint32_t>(sum);
    }

private:
    static uLong add(uLong sum, Bytes bytes) {
        if (bytes.empty()) return sum;  // zlib begins anew for a null pointer
        return crc32_z(sum, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    }
};

/// Texts one after the other, each filled with zero bytes to the length of the longest, which is returned, too.
std::pair<std::string, std::size_t> padded(const std::vector<std::string>& texts) {
    std::size_t longest = 1;
    for (const std::string& text : texts) longest = std::max(longest, text.size());
    std::string all;
    for (std::string text : texts) {
        text.resize(longest, '\0');
        all += text;
    }
    return {std::move(all), longest};
}

class ZipWriter {
public:
    explicit ZipWriter(OutputFile& out) : out_(out) {}

    void add(const NpzArray& array) {
        const auto at = static_cast<std::uint32_t>(out_.position());
        std::string entry = record(array);
        out_.write("PK\x03\x04" + entry + array.name);
        out_.write(array.head);
        for (const Bytes part : array.parts) out_.write(part);
        // Version of the maker, then the same as before the array, no comment, disk 0, no attributes, and where it is.
        directory_ += "PK\x01\x02" + number<2>(20) + entry + number<2>(0) + number<2>(0) + number<2>(0) + number<4>(0) +
                      number<4>(at) + array.name;
        ++count_;
    }

    void finish() {
        const auto at = static_cast<std::uint32_t>(out_.position());
        out_.write(directory_);
        out_.write("PK\x05\x06" + number<2>(0) + number<2>(0) + number<2>(count_) + number<2>(count_) +
                   number<4>(static_cast<std::uint32_t>(directory_.size())) + number<4>(at) + number<2>(0));
    }

private:
    template <std::size_t Bytes>
    static std::string number(std::uint32_t value) {
        std::string text;
        for (std::size_t b = 0; b < Bytes; ++b) text += static_cast<char>(value >> 8 * b & 0xff);
        return text;
    }

    /// What the record before an array and that of the directory share.
    static std::string record(const NpzArray& array) {
        constexpr std::uint32_t kVersion = 20, kFirstDay = 33;  // 1980-01-01: the same bytes each time
        const auto size = static_cast<std::uint32_t>(array.size());
        return number<2>(kVersion) + number<2>(0) + number<2>(0) + number<2>(0) + number<2>(kFirstDay) +
               number<4>(array.checksum()) + number<4>(size) + number<4>(size) +
               number<2>(static_cast<std::uint32_t>(array.name.size())) + number<2>(0);
    }

    OutputFile& out_;
    std::string directory_;
    std::uint32_t count_ = 0;
};

}  // namespace

void write_npz(const std::filesystem::path& path, const RbfVolume& volume) {
    const std::size_t points = volume.size(), channels = volume.channels.size();
    std::vector<std::string> names;
    std::vector<Bytes> values, gradients, moments, hessians;
    const std::vector<Symmetric3> zeros(points, Symmetric3{});
    bool curved = false;
    for (const RbfChannel& channel : volume.channels) {
        names.push_back(channel.name);
        values.push_back(bytes_of(channel.values));
        gradients.push_back(bytes_of(channel.gradients));
        moments.push_back(bytes_of(channel.moments));
        hessians.push_back(bytes_of(channel.hessians.empty() ? zeros : channel.hessians));
        curved = curved || !channel.hessians.empty();
    }
    const auto [name_bytes, longest_name] = padded(names);
    const std::string kernel = to_json(volume.kernel);
    const std::vector<Vec3> bounds{volume.bounds.lower, volume.bounds.upper};
    const Surface& boundary = volume.boundary;

    std::vector<NpzArray> arrays;
    arrays.emplace_back("centers", "f8", std::vector{points, std::size_t{3}}, std::vector{bytes_of(volume.centers)});
    arrays.emplace_back("frames", "f4", std::vector{points, std::size_t{6}}, std::vector{bytes_of(volume.frames)});
    arrays.emplace_back("channels", "S" + std::to_string(longest_name), std::vector{channels}, std::vector<Bytes>{name_bytes});
    arrays.emplace_back("values", "f4", std::vector{channels, points}, values);
    arrays.emplace_back("gradients", "f4", std::vector{channels, points, std::size_t{3}}, gradients);
    arrays.emplace_back("moments", "f4", std::vector{channels, points}, moments);
    if (curved) arrays.emplace_back("hessians", "f4", std::vector{channels, points, std::size_t{6}}, hessians);
    arrays.emplace_back("kernel", "S" + std::to_string(kernel.size()), std::vector<std::size_t>{}, std::vector<Bytes>{kernel});
    arrays.emplace_back("bounds", "f8", std::vector{std::size_t{2}, std::size_t{3}}, std::vector{bytes_of(bounds)});
    arrays.emplace_back("boundary_points", "f8", std::vector{boundary.points.size(), std::size_t{3}},
                        std::vector{bytes_of(boundary.points)});
    arrays.emplace_back("boundary_triangles", "u" + std::to_string(sizeof(Index)),
                        std::vector{boundary.triangles.size(), std::size_t{3}}, std::vector{bytes_of(boundary.triangles)});

    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max(), kRecords = 1 << 14;
    std::uint64_t all = kRecords;
    for (const NpzArray& array : arrays) all += array.size();
    if (all > kMost) {
        throw Error(ErrorCode::InvalidInput, "the arrays have more than 4 GiB, which a .npz of this kind cannot hold",
                    path.string(), ".ply or .svk");
    }
    OutputFile out(path);
    ZipWriter zip(out);
    for (const NpzArray& array : arrays) zip.add(array);
    zip.finish();
    out.commit();
}

}  // namespace subvol::detail
