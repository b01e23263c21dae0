// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace subvol::detail {

/// A hash of bytes that come in pieces of any lengths. Not against attackers: it finds damage and mistakes.
class ByteHash {
public:
    void add(std::string_view bytes);

    /// Adds a text and its end: "ab", "c" differs from "a", "bc".
    void add_text(std::string_view text);

    [[nodiscard]] std::uint64_t value() const;

private:
    void mix(std::uint64_t word);
    std::uint64_t hash_ = 0x243f6a8885a308d3ULL, length_ = 0;
    std::string rest_;  // fewer than 8 bytes
};

[[nodiscard]] inline std::uint64_t hash_of(std::string_view bytes) {
    ByteHash hash;
    hash.add(bytes);
    return hash.value();
}

/// 16 hexadecimal digits.
[[nodiscard]] std::string hex_digits(std::uint64_t number);

}  // namespace subvol::detail
