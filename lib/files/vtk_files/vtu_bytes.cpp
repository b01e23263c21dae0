// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/vtu_bytes.h"

#include <lz4.h>
#include <lzma.h>
#include <zlib.h>
#include <algorithm>
#include <array>
#include <limits>
#include <new>

#include "subvol/detail/text_codes.h"

namespace subvol::detail {

namespace {

constexpr unsigned char kNoDigit = 64;

constexpr auto kDigitOf = [] {
    std::array<unsigned char, 256> table{};
    table.fill(kNoDigit);
    for (std::size_t d = 0; d < kBase64Digits.size(); ++d)
        table[static_cast<unsigned char>(kBase64Digits[d])] = static_cast<unsigned char>(d);
    return table;
}();

bool unzip(std::string_view bytes, std::string& into) {
    Bytef one = 0;  // zlib takes a place without bytes for one of one byte
    uLongf size = std::max<std::size_t>(into.size(), 1);
    auto* to = into.empty() ? &one : reinterpret_cast<Bytef*>(into.data());
    const auto* from = reinterpret_cast<const Bytef*>(bytes.data());
    const int done = uncompress(to, &size, from, bytes.size());
    if (done == Z_MEM_ERROR) throw std::bad_alloc();
    return done == Z_OK && size == into.size();
}

constexpr std::uint64_t kMostDictionary = std::uint64_t{128} << 20;  // twice what the strongest preset needs

bool unpack_lzma(std::string_view bytes, std::string& into) {
    std::uint64_t dictionary_limit = kMostDictionary;
    std::size_t read = 0;
    std::size_t written = 0;
    const auto result =
        lzma_stream_buffer_decode(&dictionary_limit, 0, nullptr, reinterpret_cast<const std::uint8_t*>(bytes.data()), &read,
                                  bytes.size(), reinterpret_cast<std::uint8_t*>(into.data()), &written, into.size());
    if (result == LZMA_MEM_ERROR) throw std::bad_alloc();
    return result == LZMA_OK && written == into.size() && read == bytes.size();
}

bool unpack_lz4(std::string_view bytes, std::string& into) {
    constexpr std::size_t kMost = std::numeric_limits<int>::max();
    if (bytes.size() > kMost || into.size() > kMost) return false;
    const int size = static_cast<int>(into.size());
    return LZ4_decompress_safe(bytes.data(), into.data(), static_cast<int>(bytes.size()), size) == size;
}

}  // namespace

std::optional<std::string> ByteSource::take(std::size_t count) {
    if (count > left()) return std::nullopt;
    if (!base64_) {
        std::string bytes(text_.substr(0, count));
        text_.remove_prefix(count);
        return bytes;
    }
    std::string bytes;
    bytes.reserve(count);
    while (bytes.size() < count) {
        if (decoded_.empty()) take_whole_groups(bytes, count);
        if (bytes.size() == count) break;
        if (decoded_.empty() && !decode_group()) return std::nullopt;
        const std::size_t some = std::min(count - bytes.size(), decoded_.size());
        bytes.append(decoded_, 0, some);
        decoded_.erase(0, some);
    }
    return bytes;
}

std::size_t ByteSource::left() const {
    return base64_ ? decoded_.size() + text_.size() / 4 * 3 : text_.size();
}

// The fast path for most of the text: groups without white space and padding, as long as whole groups are needed.
void ByteSource::take_whole_groups(std::string& bytes, std::size_t count) {
    const auto digit = [&](std::size_t i) { return kDigitOf[static_cast<unsigned char>(text_[i])]; };
    std::size_t next = 0;
    for (; count - bytes.size() >= 3 && text_.size() - next >= 4; next += 4) {
        const unsigned a = digit(next), b = digit(next + 1), c = digit(next + 2), d = digit(next + 3);
        if (((a | b | c | d) & kNoDigit) != 0) break;
        const unsigned bits = (a << 18) | (b << 12) | (c << 6) | d;
        for (const unsigned shift : {16u, 8u, 0u}) bytes += static_cast<char>((bits >> shift) & 0xFF);
    }
    text_.remove_prefix(next);
}

// Four characters encode three bytes; each = at the end stands for one byte less.
bool ByteSource::decode_group() {
    unsigned bits = 0;
    int digits = 0;
    int padding = 0;
    while (digits + padding < 4) {
        if (text_.empty()) return false;
        const char c = text_.front();
        text_.remove_prefix(1);
        if (c == ' ' || (c >= '\t' && c <= '\r')) continue;
        const unsigned char digit = kDigitOf[static_cast<unsigned char>(c)];
        if (c == '=') {
            ++padding;
        } else if (digit == kNoDigit || padding > 0) {
            return false;
        } else {
            ++digits;
        }
        bits = (bits << 6) | (c == '=' ? 0u : digit);
    }
    if (padding > 2) return false;
    for (int shift = 16; shift >= 8 * padding; shift -= 8) decoded_ += static_cast<char>((bits >> shift) & 0xFF);
    return true;
}

std::optional<Compressor> compressor_named(std::string_view name) {
    if (name.empty()) return Compressor::None;
    if (name == "vtkZLibDataCompressor") return Compressor::Zlib;
    if (name == "vtkLZMADataCompressor") return Compressor::Lzma;
    if (name == "vtkLZ4DataCompressor") return Compressor::Lz4;
    return std::nullopt;
}

std::size_t largest_size(Compressor compressor, std::size_t compressed) {
    // The largest expansion of a byte in each format, rounded up: deflate 258 bytes from 2 bits, LZMA 273 from about 0.3 bits,
    // LZ4 255 from a byte.
    constexpr std::array<std::size_t, 4> kMostByOne{1, 1040, 8192, 256};
    constexpr std::size_t kAtLeast = 64;
    return (compressed + kAtLeast) * kMostByOne[static_cast<std::size_t>(compressor)];
}

std::optional<std::string> decompressed(Compressor compressor, std::string_view bytes, std::size_t size) {
    if (size > largest_size(compressor, bytes.size())) return std::nullopt;
    std::string result(size, '\0');
    const bool good = compressor == Compressor::Zlib   ? unzip(bytes, result)
                      : compressor == Compressor::Lzma ? unpack_lzma(bytes, result)
                                                       : unpack_lz4(bytes, result);
    if (!good) return std::nullopt;
    return result;
}

struct LzmaReader::Stream {
    lzma_stream lzma = LZMA_STREAM_INIT;
    bool ended = false;
};

void LzmaReader::End::operator()(Stream* stream) const {
    lzma_end(&stream->lzma);
    delete stream;
}

LzmaReader::LzmaReader(std::string_view bytes) : stream_(new Stream), piece_(std::size_t{1} << 16, '\0') {
    if (lzma_stream_decoder(&stream_->lzma, kMostDictionary, 0) != LZMA_OK) throw std::bad_alloc();
    stream_->lzma.next_in = reinterpret_cast<const std::uint8_t*>(bytes.data());
    stream_->lzma.avail_in = bytes.size();
}

std::optional<std::string_view> LzmaReader::next() {
    if (stream_->ended) return std::string_view();
    lzma_stream& lzma = stream_->lzma;
    lzma.next_out = reinterpret_cast<std::uint8_t*>(piece_.data());
    lzma.avail_out = piece_.size();
    // A call may do no more than read: only the end of the stream is the end of the bytes.
    while (!stream_->ended && lzma.avail_out == piece_.size()) {
        const lzma_ret result = lzma_code(&lzma, LZMA_FINISH);
        stream_->ended = result == LZMA_STREAM_END;
        if (result == LZMA_MEM_ERROR) throw std::bad_alloc();
        if (result != LZMA_OK && !stream_->ended) return std::nullopt;
    }
    if (stream_->ended && lzma.avail_in > 0) return std::nullopt;
    return std::string_view(piece_).substr(0, piece_.size() - lzma.avail_out);
}

std::string zlib_compressed(std::string_view bytes, int level) {
    uLongf size = compressBound(bytes.size());
    std::string result(size, '\0');
    const int done = compress2(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                               bytes.size(), level);
    if (done != Z_OK) throw std::bad_alloc();  // the only way to fail with room for all of it
    result.resize(size);
    return result;
}

std::string compressed_numbers(std::string_view bytes, Effort effort) {
    lzma_options_lzma options{};
    lzma_lzma_preset(&options, effort == Effort::Most ? 9 : 0);
    options.dict_size = static_cast<std::uint32_t>(std::clamp<std::size_t>(bytes.size(), 1 << 16, 1 << 26));
    options.lc = 0;  // a number says little about the next one
    options.pb = 0;
    std::array<lzma_filter, 2> filters{{{LZMA_FILTER_LZMA2, &options}, {LZMA_VLI_UNKNOWN, nullptr}}};
    std::string result(lzma_stream_buffer_bound(bytes.size()), '\0');
    std::size_t written = 0;
    const auto done = lzma_stream_buffer_encode(filters.data(), LZMA_CHECK_CRC64, nullptr,
                                                reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(),
                                                reinterpret_cast<std::uint8_t*>(result.data()), &written, result.size());
    if (done != LZMA_OK) throw std::bad_alloc();  // the only reason with these options
    result.resize(written);
    return result;
}

}  // namespace subvol::detail
