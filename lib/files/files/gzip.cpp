// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/gzip.h"

#include <zlib.h>
#include <algorithm>
#include <limits>
#include <new>

#include "subvol/detail/read_file.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kStart = std::size_t{1} << 20;
constexpr const char* kNotWhole = "not a whole gzip file";
constexpr std::size_t kAlways = std::size_t{64} << 20;

/// Decompresses the members of a gzip file piece by piece.
class Gunzip {
public:
    explicit Gunzip(std::string_view bytes) : bytes_(bytes) {
        constexpr int kGzip = 15 + 16;
        if (inflateInit2(&stream_, kGzip) != Z_OK) throw std::bad_alloc();
    }
    ~Gunzip() { inflateEnd(&stream_); }
    Gunzip(const Gunzip&) = delete;
    Gunzip& operator=(const Gunzip&) = delete;

    /// Appends bytes to a text. Returns whether there may be more.
    bool append_to(std::string& text) {
        constexpr std::size_t kMost = std::size_t{1} << 30;  // of bytes that zlib is given at a time
        if (stream_.avail_in == 0 && !bytes_.empty()) {
            stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes_.data()));
            stream_.avail_in = static_cast<uInt>(std::min(bytes_.size(), kMost));
            bytes_.remove_prefix(stream_.avail_in);
        }
        if (status_ == Z_STREAM_END) {
            if (stream_.avail_in == 0) return false;
            if (inflateReset(&stream_) != Z_OK) status_ = Z_DATA_ERROR;
        }
        const std::size_t before = text.size(), room = std::clamp<std::size_t>(before, std::size_t{1} << 16, kStart);
        text.resize(before + room);
        stream_.next_out = reinterpret_cast<Bytef*>(text.data() + before);
        stream_.avail_out = static_cast<uInt>(room);
        if (status_ != Z_DATA_ERROR) status_ = inflate(&stream_, Z_NO_FLUSH);
        if (status_ == Z_MEM_ERROR) throw std::bad_alloc();
        text.resize(before + room - stream_.avail_out);
        return status_ == Z_OK || status_ == Z_STREAM_END;
    }

    /// Whether the last member ended with its checksum.
    [[nodiscard]] bool whole() const { return status_ == Z_STREAM_END; }

private:
    std::string_view bytes_;
    z_stream stream_{};
    int status_ = Z_OK;
};

bool is_gzipped(const std::filesystem::path& path, std::filesystem::path& packed) {
    std::error_code none;
    packed = path.string() + ".gz";
    return !std::filesystem::exists(path, none) && std::filesystem::exists(packed, none);
}

}  // namespace

std::string read_maybe_gzipped(const std::filesystem::path& path, const MostBytes& most) {
    std::filesystem::path packed;
    if (!is_gzipped(path, packed)) return read_regular(path);
    const std::string bytes = read_regular(packed);
    Gunzip in(bytes);
    std::string text;
    std::size_t limit = 0;
    while (in.append_to(text)) {
        if (text.size() < kStart) continue;
        if (limit == 0) limit = std::max(kAlways, most(text));
        if (text.size() > limit) {
            throw Error(ErrorCode::InvalidInput,
                        "its " + std::to_string(bytes.size()) + " bytes decompress to more than what it says is in it needs",
                        packed.string(), "at most " + std::to_string(limit) + " bytes");
        }
    }
    if (!in.whole()) throw Error(ErrorCode::InvalidInput, kNotWhole, packed.string());
    return text;
}

bool each_gunzipped(std::string_view bytes, const std::function<void(std::string_view)>& take) {
    Gunzip in(bytes);
    std::string piece;
    for (bool more = true; more;) {
        piece.clear();
        more = in.append_to(piece);
        if (!piece.empty()) take(piece);
    }
    return in.whole();
}

std::string start_of_maybe_gzipped(const std::filesystem::path& path, std::size_t bytes) {
    std::filesystem::path packed;
    const bool is_packed = is_gzipped(path, packed);
    const std::filesystem::path& file = is_packed ? packed : path;
    if (const std::string wrong = not_regular(file); !wrong.empty()) throw Error(ErrorCode::InvalidInput, wrong, file.string());
    std::string text = read_range(file, 0, bytes);
    if (!is_packed) return text;
    std::string start;
    Gunzip in(text);
    while (start.size() < bytes && in.append_to(start)) {
    }
    if (start.empty() && !in.whole()) throw Error(ErrorCode::InvalidInput, kNotWhole, packed.string());
    return start.substr(0, bytes);
}

}  // namespace subvol::detail
