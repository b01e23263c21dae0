// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/text_codes.h"

#include <algorithm>

#include "subvol/detail/printable.h"

namespace subvol::detail {

std::string base64(std::string_view bytes) {
    const std::size_t whole = bytes.size() / 3 * 3;
    std::string text((bytes.size() + 2) / 3 * 4, '=');
    const auto byte = [&](std::size_t i) { return i < bytes.size() ? static_cast<unsigned char>(bytes[i]) : 0u; };
    const auto put = [&](std::size_t i, unsigned characters) {
        const unsigned bits = (byte(i) << 16) | (byte(i + 1) << 8) | byte(i + 2);
        for (unsigned k = 0; k < characters; ++k) text[i / 3 * 4 + k] = kBase64Digits[(bits >> (18 - 6 * k)) & 63];
    };
    for (std::size_t i = 0; i < whole; i += 3) put(i, 4);
    if (whole < bytes.size()) put(whole, static_cast<unsigned>(bytes.size() - whole) + 1);
    return text;
}

std::string xml_escaped(std::string_view text, XmlQuotes quotes) {
    std::string result;
    while (!text.empty()) {
        const std::size_t length = std::max<std::size_t>(utf8_length(text), 1);
        const std::string_view character = text.substr(0, length);
        text.remove_prefix(length);
        const char c = character.front();
        if (c == '&') {
            result += "&amp;";
        } else if (c == '<') {
            result += "&lt;";
        } else if (c == '>') {
            result += "&gt;";
        } else if (c == '"') {
            result += "&quot;";
        } else if (c == '\'' && quotes == XmlQuotes::Any) {
            result += "&#39;";
        } else if (c == '\n' || c == '\t' || c == '\r') {
            result += c;
        } else {
            result += printable(character);  // XML cannot hold most controls, even as the numbers of characters
        }
    }
    return result;
}

}  // namespace subvol::detail
