// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "subvol/vec.h"

namespace subvol::cli {

/// All parts in one string.
template <class... Part>
[[nodiscard]] std::string text(const Part&... parts) {
    std::ostringstream out;
    (out << ... << parts);
    return out.str();
}

/// "a, b, c"
[[nodiscard]] std::string join(const std::vector<std::string>& parts);

/// "1,2,3" as three numbers. option: named in the error
///
/// throws: Error(InvalidInput) if it is anything else
[[nodiscard]] Vec3 parse_vector(const std::string& option, const std::string& value);

/// "x0,y0,z0,x1,y1,z1" and the like as so many numbers. option: named in the error
///
/// throws: Error(InvalidInput) if it is anything else
[[nodiscard]] std::vector<double> parse_numbers(const std::string& option, const std::string& value, std::size_t count,
                                                const std::string& example);

/// throws: Error(InvalidInput) unless `value` is one of `supported`
void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& supported);

}  // namespace subvol::cli
