// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/printable.h"

#include <algorithm>

namespace subvol::detail {

namespace {

// A printable character is copied, anything else is written as the codes of its bytes.
void append_printable(std::string& result, std::string_view character, bool valid) {
    const auto first = static_cast<unsigned char>(character[0]);
    const bool control = first < ' ' || first == 0x7F || (first == 0xC2 && static_cast<unsigned char>(character[1]) < 0xA0);
    if (valid && !control) {
        result += character;
        return;
    }
    constexpr std::string_view kDigits = "0123456789abcdef";
    for (const char c : character) {
        const auto byte = static_cast<unsigned char>(c);
        result += {'\\', 'x', kDigits[byte / 16], kDigits[byte % 16]};
    }
}

// The first `longest` characters. cut: whether there are more
std::string printable_start(std::string_view text, std::size_t longest, bool& cut) {
    std::string result;
    std::size_t i = 0;
    for (std::size_t characters = 0; i < text.size() && characters < longest; ++characters) {
        const std::size_t length = utf8_length(text.substr(i));
        append_printable(result, text.substr(i, std::max<std::size_t>(length, 1)), length > 0);
        i += std::max<std::size_t>(length, 1);
    }
    cut = i < text.size();
    return result;
}

}  // namespace

std::size_t utf8_length(std::string_view text) {
    if (text.empty()) return 0;
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const unsigned first = byte(0);
    if (first < 0x80) return 1;
    const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
    if (length == 0 || text.size() < length) return 0;
    for (std::size_t i = 1; i < length; ++i) {
        if ((byte(i) & 0xC0) != 0x80) return 0;
    }
    // Longer than needed, a half of a pair of UTF-16, or above the last code.
    const bool overlong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xF0 && byte(1) < 0x90);
    const bool no_code = (first == 0xED && byte(1) >= 0xA0) || (first == 0xF4 && byte(1) >= 0x90);
    return overlong || no_code ? 0 : length;
}

std::string printable(std::string_view text) {
    bool cut = false;
    return printable_start(text, text.size(), cut);
}

std::string shortened(std::string_view text) {
    constexpr std::size_t kLongest = 40;
    bool cut = false;
    const std::string start = printable_start(text, kLongest, cut);
    return cut ? start + "…" : start;
}

std::string in_quotes(std::string_view text) {
    return "\"" + shortened(text) + "\"";
}

std::string parser_message(std::string_view what) {
    constexpr std::string_view kQuote = "last read: '", kNext = "'; expected ";
    const std::size_t quote = what.find(kQuote);
    if (quote == std::string_view::npos) return printable(what);
    const std::size_t begin = quote + kQuote.size(), next = what.rfind(kNext);
    const bool goes_on = next != std::string_view::npos && next >= begin;
    const std::size_t end = goes_on ? next : what.size() - (what.ends_with("'") ? 1 : 0);
    return printable(what.substr(0, quote)) + "last read: " + in_quotes(what.substr(begin, end - begin)) +
           (goes_on ? printable(what.substr(end + 1)) : "");
}

}  // namespace subvol::detail
