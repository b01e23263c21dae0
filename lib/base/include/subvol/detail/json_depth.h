// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace subvol::detail {

/// A text of JSON from outside of this program, before it is parsed. JSON libraries copy and write values by recursion, so that
/// a deep one would overflow the stack.
///
/// where:   for the message
/// returns: the text
/// throws:  Error(InvalidInput) if its arrays and objects are nested more than 100 deep
/// cost:    one pass over the text
[[nodiscard]] std::string_view of_limited_depth(std::string_view json, const std::string& where = {});

}  // namespace subvol::detail
