// SPDX-License-Identifier: Apache-2.0
#include "gzip.h"

#include <zlib.h>

#include <algorithm>

#include "subvol/error.h"
#include "text_scanner.h"

namespace subvol::detail {

std::optional<std::string> gunzipped(std::string_view bytes) {
    constexpr std::size_t kMost = std::size_t{1} << 30;  // of bytes that zlib is given at a time
    constexpr int kGzip = 15 + 16;
    z_stream stream{};
    if (inflateInit2(&stream, kGzip) != Z_OK) return std::nullopt;
    struct End {
        z_stream* stream;
        ~End() { inflateEnd(stream); }
    } end{&stream};
    std::string text;
    int status = Z_OK;
    while (!bytes.empty()) {
        const std::size_t given = std::min(bytes.size(), kMost);
        stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
        stream.avail_in = static_cast<uInt>(given);
        while (stream.avail_in > 0) {
            if (status == Z_STREAM_END && inflateReset(&stream) != Z_OK) return std::nullopt;
            const std::size_t before = text.size(), room = std::clamp<std::size_t>(text.size(), 1 << 16, kMost);
            text.resize(before + room);
            stream.next_out = reinterpret_cast<Bytef*>(text.data() + before);
            stream.avail_out = static_cast<uInt>(room);
            status = inflate(&stream, Z_NO_FLUSH);
            text.resize(before + room - stream.avail_out);
            if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) return std::nullopt;
        }
        bytes.remove_prefix(given);
    }
    while (status == Z_OK) {  // what the last bytes still hold
        const std::size_t before = text.size();
        text.resize(before + (1 << 16));
        stream.next_out = reinterpret_cast<Bytef*>(text.data() + before);
        stream.avail_out = 1 << 16;
        status = inflate(&stream, Z_NO_FLUSH);
        text.resize(before + (1 << 16) - stream.avail_out);
    }
    if (status != Z_STREAM_END) return std::nullopt;
    return text;
}

std::string read_maybe_gzipped(const std::filesystem::path& path) {
    std::error_code none;
    const std::filesystem::path packed = path.string() + ".gz";
    if (std::filesystem::exists(path, none) || !std::filesystem::exists(packed, none)) return read_regular(path);
    auto text = gunzipped(read_regular(packed));
    if (!text) throw Error(ErrorCode::InvalidInput, "not a whole gzip file", packed.string());
    return std::move(*text);
}

}  // namespace subvol::detail
