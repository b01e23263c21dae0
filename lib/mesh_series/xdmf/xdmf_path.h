// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <pugixml.hpp>
#include <string_view>
#include <vector>

namespace subvol::detail {

/// What `follow_path` follows, for messages.
inline constexpr const char* kPlainPaths =
    "a path as /Xdmf/Domain/Grid[2]/*, with tests [2], [@Name=\"a\"], [self::A or self::B] and // at its start alone";

/// The elements at a path, in the order of the file. Paths are a small part of XPath, which could take any time.
///
/// visited: is increased by the number of elements that were looked at
/// returns: nothing if it is no such path
[[nodiscard]] std::optional<std::vector<pugi::xml_node>> follow_path(const pugi::xml_node& document, std::string_view path,
                                                                     std::size_t& visited);

}  // namespace subvol::detail
