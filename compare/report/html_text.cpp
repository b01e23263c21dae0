// SPDX-License-Identifier: Apache-2.0
#include "html_text.h"

#include <cstdint>
#include <fstream>
#include <sstream>

#include "subvol/detail/text_codes.h"
#include "subvol/error.h"

namespace subvol::detail {

std::string escaped(std::string_view text) {
    return xml_escaped(text, XmlQuotes::Any);
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
