// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/byte_hash.h"
#include "subvol/detail/word_hash.h"

#include <algorithm>
#include <cstdio>
#include <cstring>

namespace subvol::detail {

void ByteHash::mix(std::uint64_t word) {
    hash_ = hash_with(hash_, word);
    hash_ ^= hash_ >> 29;
}

void ByteHash::add(std::string_view bytes) {
    length_ += bytes.size();
    std::uint64_t word = 0;
    if (!rest_.empty()) {
        const std::size_t more = std::min(sizeof word - rest_.size(), bytes.size());
        rest_ += bytes.substr(0, more);
        bytes.remove_prefix(more);
        if (rest_.size() < sizeof word) return;
        std::memcpy(&word, rest_.data(), sizeof word);
        mix(word);
        rest_.clear();
    }
    for (; bytes.size() >= sizeof word; bytes.remove_prefix(sizeof word)) {
        std::memcpy(&word, bytes.data(), sizeof word);
        mix(word);
    }
    rest_ = bytes;
}

void ByteHash::add_text(std::string_view text) {
    add(text);
    add("\xff");
}

std::uint64_t ByteHash::value() const {
    ByteHash last = *this;
    std::uint64_t word = 0;
    std::memcpy(&word, rest_.data(), rest_.size());
    last.mix(word);
    last.mix(length_);
    return last.hash_;
}

std::string hex_digits(std::uint64_t number) {
    char digits[17];
    std::snprintf(digits, sizeof digits, "%016llx", static_cast<unsigned long long>(number));
    return digits;
}

}  // namespace subvol::detail
