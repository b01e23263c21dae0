// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>
#include <vector>

#include "session_state.h"

namespace subvol::detail {

/// Reads the arguments of actions. All throw Error(InvalidInput) that says what would be right.

[[nodiscard]] double number(const Json& value, double least, double most);
[[nodiscard]] int whole_number(const Json& value, int least, int most);
/// count: exactly so many
[[nodiscard]] std::vector<double> numbers(const Json& value, std::size_t count);
[[nodiscard]] Vec3 vector(const Json& value);
[[nodiscard]] bool flag(const Json& value);
[[nodiscard]] std::string word(const Json& value);
/// The name of a file to read, or of anything else: not that of a pipe or device, which may have no end.
[[nodiscard]] std::string readable_word(const Json& value);
[[nodiscard]] std::string word_of(const Json& value, const std::vector<std::string>& words);

/// The value of a key of an object, or `fallback` if the object does not have it.
[[nodiscard]] const Json& member(const Json& object, const char* key);

/// throws: unless `value` is an object that has no other keys than these
void check_keys(const Json& value, std::initializer_list<const char*> keys);

}  // namespace subvol::detail
