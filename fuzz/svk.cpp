// SPDX-License-Identifier: Apache-2.0
// Files of kernels with levels of detail: as they are, and with their lengths and hashes set again, so that what is in them is
// read.

#include <cstring>

#include "input.h"
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/svk_layout.h"
#include "subvol/points_io.h"

namespace subvol::fuzz {

namespace {

constexpr std::size_t kPreamble = 48, kHeadBytes = 24, kFileBytes = 32, kHeadHash = 40;  // and places in it

std::uint64_t number_at(const std::string& bytes, std::size_t at, std::size_t width) {
    std::uint64_t number = 0;
    if (at + width <= bytes.size()) std::memcpy(&number, &bytes[at], width);
    return number;
}

void put_number(std::string& bytes, std::size_t at, std::uint64_t number) {
    if (at + sizeof number <= bytes.size()) std::memcpy(&bytes[at], &number, sizeof number);
}

void put_hash(std::string& bytes, std::size_t at, std::uint64_t from, std::uint64_t length) {
    if (from > bytes.size() || length > bytes.size() - from) return;
    detail::ByteHash hash;
    hash.add(std::string_view(bytes).substr(from, length));
    put_number(bytes, at, hash.value());
}

/// What the head says of the lengths of all else. hashes: where they begin
detail::SvkContents contents_of(const std::string& bytes, std::size_t& hashes) {
    detail::SvkContents contents;
    contents.kernels = number_at(bytes, kPreamble, 8);
    contents.boundary_points = number_at(bytes, kPreamble + 8, 8);
    contents.boundary_triangles = number_at(bytes, kPreamble + 16, 8);
    std::size_t at = kPreamble + 72;
    at += 4 + number_at(bytes, at, 4);
    const std::uint64_t channels = number_at(bytes, at, 4);
    at += 4;
    for (std::uint64_t c = 0; c < channels && at < bytes.size(); ++c) {
        at += 4 + number_at(bytes, at, 4);
        contents.channels.push_back({.name = {}, .bent = number_at(bytes, at, 1) != 0});
        at += 9;
    }
    hashes = at;
    return contents;
}

std::string with_hashes(std::string bytes) {
    constexpr std::uint64_t kMost = 1 << 14;  // of kernels, so that the layout is small
    std::size_t at = 0;
    const detail::SvkContents contents = contents_of(bytes, at);
    const std::uint64_t head = number_at(bytes, kHeadBytes, 8);
    put_number(bytes, kFileBytes, bytes.size());
    if (contents.kernels > 0 && contents.kernels < kMost && at < bytes.size() && head < bytes.size()) {
        const detail::SvkLayout layout(contents, kPreamble + head);
        put_hash(bytes, at, layout.boundary().offset, layout.boundary().bytes);
        put_hash(bytes, at + 8, layout.top().offset, layout.top().bytes);
        for (std::size_t block = 0; block < layout.blocks(); ++block) {
            for (std::size_t part = 0; part < layout.parts(); ++part) {
                const detail::SvkExtent extent = layout.part(block, part);
                put_hash(bytes, at + 8 * layout.hash_of_part(block, part), extent.offset, extent.bytes);
            }
        }
    }
    put_hash(bytes, kHeadHash, kPreamble, head);
    return bytes;
}

}  // namespace

}  // namespace subvol::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace subvol;
    fuzz::run([&] { validate(read_points(fuzz::as_file(data, size, ".svk"))); });
    const std::string whole = fuzz::with_hashes(std::string(fuzz::text_of(data, size)));
    return fuzz::run([&] {
        validate(read_points(fuzz::as_file(reinterpret_cast<const std::uint8_t*>(whole.data()), whole.size(), ".svk")));
    });
}
