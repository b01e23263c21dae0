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

}  // namespace subvol::detail
