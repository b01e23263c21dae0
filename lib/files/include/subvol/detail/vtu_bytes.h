// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace subvol::detail {

/// Reads bytes from a text that has them raw or in base64.
///
/// Base64 may consist of several pieces, each with padding, with white space between them.
class ByteSource {
public:
    ByteSource(std::string_view text, bool base64) : text_(text), base64_(base64) {}

    /// The next `count` bytes; nothing if there are fewer, or if a character is not base64.
    [[nodiscard]] std::optional<std::string> take(std::size_t count);

    /// An upper bound for the number of bytes left.
    [[nodiscard]] std::size_t left() const;

private:
    bool decode_group();
    void take_whole_groups(std::string& bytes, std::size_t count);

    std::string_view text_;
    bool base64_;
    std::string decoded_;  // bytes of the last group of four characters that have not been taken
};

/// VTK's names for compressors.
enum class Compressor { None, Zlib, Lzma, Lz4 };

/// The compressor of that name; nothing if it is unknown or not supported. name: as in the file, empty for none
[[nodiscard]] std::optional<Compressor> compressor_named(std::string_view name);

/// The largest size that so many compressed bytes can decompress to.
[[nodiscard]] std::size_t largest_size(Compressor compressor, std::size_t compressed);

/// Decompresses a block. Nothing if the bytes are damaged or if their decompressed size is not `size`.
///
/// throws: std::bad_alloc if memory is short: the bytes may be sound
[[nodiscard]] std::optional<std::string> decompressed(Compressor compressor, std::string_view bytes, std::size_t size);

/// Compresses bytes as `decompressed` with Compressor::Zlib expects them. level: from 1, the fastest, to 9
///
/// throws: std::bad_alloc
[[nodiscard]] std::string zlib_compressed(std::string_view bytes, int level);

/// Decompresses what `compressed_numbers` has made piece by piece, so that no more is in memory than what has been asked for.
class LzmaReader {
public:
    explicit LzmaReader(std::string_view bytes);

    /// The next bytes, which are valid until the next call; empty at the end, after the checksum has been compared. Nothing if
    /// the bytes are damaged. throws: std::bad_alloc
    [[nodiscard]] std::optional<std::string_view> next();

private:
    struct Stream;
    struct End {
        void operator()(Stream* stream) const;
    };
    std::unique_ptr<Stream, End> stream_;
    std::string piece_;
};

/// Least: some ten times as fast, for some percent more bytes.
enum class Effort { Least, Most };

/// Bytes that `decompressed` with Compressor::Lzma turns back, with a checksum: small numbers, most of them 0, become smallest.
///
/// throws: std::bad_alloc
[[nodiscard]] std::string compressed_numbers(std::string_view bytes, Effort effort = Effort::Most);

}  // namespace subvol::detail
