// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/printable.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace subvol::detail {

namespace {

// The code of a character that is valid UTF-8.
char32_t code_of(std::string_view character) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(character[i]); };
    constexpr std::array<unsigned, 5> kLeadBits{0, 0x7F, 0x1F, 0x0F, 0x07};
    char32_t code = byte(0) & kLeadBits[character.size()];
    for (std::size_t i = 1; i < character.size(); ++i) code = code << 6U | (byte(i) & 0x3FU);
    return code;
}

// What a terminal obeys, what changes the direction or the place of the text about it, what is not seen, and what is no
// character: XML has no way to hold some of these, and a name with others looks like another name.
bool is_hidden(char32_t code) {
    struct Codes {
        char32_t first, last;
    };
    constexpr std::array<Codes, 17> kHidden{
        {{0, 0x1F},             // controls
         {0x7F, 0x9F},          // delete, and controls again
         {0xAD, 0xAD},          // a hyphen that is seen at the end of a line only
         {0x34F, 0x34F},        // joins characters without being seen
         {0x61C, 0x61C},        // a mark of direction
         {0x115F, 0x1160},      // fillers without width
         {0x180E, 0x180E},      // a separator without width
         {0x200B, 0x200B},      // a space without width; joiners (0x200C, 0x200D) are orthography
         {0x200E, 0x200F},      // marks of direction
         {0x2028, 0x202E},      // ends of lines and paragraphs, embedded directions
         {0x2060, 0x206F},      // more joiners and directions
         {0x3164, 0x3164},      // a filler
         {0xFDD0, 0xFDEF},      // no characters
         {0xFEFF, 0xFEFF},      // the byte order mark
         {0xFFA0, 0xFFA0},      // a filler
         {0xFFF0, 0xFFFB},      // notes between lines
         {0xE0000, 0xE0FFF}}};  // tags and selectors
    const bool no_character = (code & 0xFFFEU) == 0xFFFE;
    return no_character || std::ranges::any_of(kHidden, [=](const Codes& c) { return c.first <= code && code <= c.last; });
}

// A printable character is copied, anything else is written as the codes of its bytes.
void append_printable(std::string& result, std::string_view character, bool valid) {
    if (valid && !is_hidden(code_of(character))) {
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

bool is_printable(std::string_view character) {
    const std::size_t length = utf8_length(character);
    return length > 0 && length == character.size() && !is_hidden(code_of(character));
}

std::string shortened(std::string_view text, std::size_t longest) {
    bool cut = false;
    const std::string start = printable_start(text, longest, cut);
    return cut ? start + "…" : start;
}

std::string printable_message(std::string_view text) {
    constexpr std::size_t kLongest = 80;
    const auto is_letter = [&](std::size_t i) {
        return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 || (text[i] & 0x80) != 0);
    };
    std::string result;
    std::size_t copied = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char quote = text[i];
        if ((quote != '"' && quote != '\'') || (i > 0 && is_letter(i - 1))) continue;  // an apostrophe follows a letter
        std::size_t end = text.find(quote, i + 1);
        while (end != std::string_view::npos && is_letter(end + 1)) end = text.find(quote, end + 1);
        if (end == std::string_view::npos) break;
        if (end - i > kLongest) {
            result += printable(text.substr(copied, i + 1 - copied)) + shortened(text.substr(i + 1, end - i - 1), kLongest);
            copied = end;
        }
        i = end;
    }
    return result + printable(text.substr(copied));
}

std::string in_quotes(std::string_view text) {
    return "\"" + shortened(text) + "\"";
}

std::string parser_message(std::string_view what) {
    // "[json.exception.parse_error.101] parse error at line 1, column 5: syntax error while parsing value - …; expected …"
    constexpr std::string_view kPrefix = "[json.exception.parse_error.", kWhere = "parse error at line ", kWhile = " - ";
    if (what.starts_with(kPrefix)) {
        const std::size_t where = what.find(kWhere), colon = what.find(':', where);
        if (where != std::string_view::npos && colon != std::string_view::npos) {
            const std::string place = "line " + std::string(what.substr(where + kWhere.size(), colon - where - kWhere.size()));
            what.remove_prefix(colon + 2);
            if (what.starts_with("syntax error while parsing") && what.find(kWhile) != std::string_view::npos)
                what.remove_prefix(what.find(kWhile) + kWhile.size());
            const std::size_t expected = what.rfind("; expected ");
            return place + ": " + parser_message(what.substr(0, expected));
        }
    }
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
