// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace subvol::detail {

// Numbers as text, the same in every locale: printf, std::to_string and streams write a decimal comma where the locale has one.

/// As printf's %.*g: `digits` significant digits, without zeros at the end.
[[nodiscard]] std::string number_text(double value, int digits = 6);

/// As printf's %.*f: `decimals` digits after the point.
[[nodiscard]] std::string fixed_text(double value, int decimals);

/// The fewest digits that give the same number when read again.
[[nodiscard]] std::string exact_text(double value);

/// The number that a text consists of, with or without a leading plus and blanks about it. A number that is too small for
/// double is 0, one that is too large is infinite. Nothing if the text is anything else.
[[nodiscard]] std::optional<double> number_from(std::string_view text);

}  // namespace subvol::detail
