// SPDX-License-Identifier: Apache-2.0
#include "html_text.h"

#include <cstdint>
#include <fstream>
#include <sstream>

#include "subvol/error.h"

namespace subvol::detail {

std::string escaped(std::string_view text) {
    std::string html;
    for (const char c : text) {
        switch (c) {
            case '&':
                html += "&amp;";
                break;
            case '<':
                html += "&lt;";
                break;
            case '>':
                html += "&gt;";
                break;
            case '"':
                html += "&quot;";
                break;
            case '\'':
                html += "&#39;";
                break;
            default:
                html += c;
        }
    }
    return html;
}

std::string base64(std::string_view bytes) {
    static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    text.reserve((bytes.size() + 2) / 3 * 4);
    for (std::size_t i = 0; i < bytes.size(); i += 3) {
        std::uint32_t three = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            three = three << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0U);
        }
        for (std::size_t k = 0; k < 4; ++k) {
            const bool padding = i + k > bytes.size();
            text += padding ? '=' : kDigits[three >> (18 - 6 * k) & 63];
        }
    }
    return text;
}

std::string png_uri(const std::filesystem::path& file) {
    constexpr std::uintmax_t kMaxBytes = 16 << 20;
    std::error_code error;
    const auto bytes = std::filesystem::file_size(file, error);
    if (error) throw Error(ErrorCode::Io, "cannot be read: " + error.message(), file.string());
    if (bytes > kMaxBytes) throw Error(ErrorCode::InvalidInput, "is too large for a report (16 MiB)", file.string());
    std::ifstream in(file, std::ios::binary);
    std::ostringstream content;
    content << in.rdbuf();
    if (!in) throw Error(ErrorCode::Io, "cannot be read", file.string());
    return "data:image/png;base64," + base64(content.str());
}

}  // namespace subvol::detail
