// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace subvol::detail {

/// Takes bytes one after the other from a text that holds them raw or in base64.
///
/// Base64 may be several pieces, each padded by itself, with white space between.
class ByteSource {
public:
    ByteSource(std::string_view text, bool base64) : text_(text), base64_(base64) {}

    /// Exactly so many bytes; nothing if there are fewer, or if a character is not of base64.
    [[nodiscard]] std::optional<std::string> take(std::size_t count);

    /// How many bytes are left at most.
    [[nodiscard]] std::size_t left() const;

private:
    bool decode_group();
    void take_whole_groups(std::string& bytes, std::size_t count);

    std::string_view text_;
    bool base64_;
    std::string decoded_;  // of the last group of four characters, what has not been taken
};

/// VTK's names for compressors.
enum class Compressor { None, Zlib, Lzma, Lz4 };

/// nothing: VTK has no compressor of that name, or it is not supported. name: as in the file, empty for none
[[nodiscard]] std::optional<Compressor> compressor_named(std::string_view name);

/// The most that so many compressed bytes can become.
[[nodiscard]] std::size_t largest_size(Compressor compressor, std::size_t compressed);

/// size: that of the result
/// returns: nothing if the bytes are damaged or become more or less than `size`
[[nodiscard]] std::optional<std::string> decompressed(Compressor compressor, std::string_view bytes, std::size_t size);

}  // namespace subvol::detail
