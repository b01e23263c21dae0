// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace subvol::detail {

/// The digits of base64, by their value.
inline constexpr std::string_view kBase64Digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

/// Bytes in base64, padded with =.
[[nodiscard]] std::string base64(std::string_view bytes);

/// Double: attributes stand in double quotes, so that ' needs no escape; Any: in quotes of either kind
enum class XmlQuotes { Double, Any };

/// Text to be put into XML or HTML, between tags or as the value of an attribute.
[[nodiscard]] std::string xml_escaped(std::string_view text, XmlQuotes quotes = XmlQuotes::Double);

/// SHA-256 of bytes (FIPS 180-4), 32 bytes.
[[nodiscard]] std::string sha256(std::string_view bytes);

/// The tag of a content security policy for a page in one file: it loads nothing, its images are data, and of what is between
/// script and style tags only these two texts count. So text that found its way into the page as a tag does nothing.
[[nodiscard]] std::string html_policy(std::string_view script, std::string_view style);

}  // namespace subvol::detail
