// SPDX-License-Identifier: Apache-2.0
#include "text.h"

#include <algorithm>
#include <cmath>

#include "subvol/error.h"

namespace subvol::cli {

std::string join(const std::vector<std::string>& parts) {
    std::string all;
    for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
    return all;
}

Vec3 parse_vector(const std::string& option, const std::string& value) {
    std::istringstream in(value);
    Vec3 v(0.0);
    char first = 0, second = 0;
    in >> v.x >> first >> v.y >> second >> v.z;
    const bool finite = std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
    if (in.fail() || !(in >> std::ws).eof() || first != ',' || second != ',' || !finite) {
        throw Error(ErrorCode::InvalidInput, "'" + value + "' is not three numbers", option, "write it as 1,2,3");
    }
    return v;
}

double parse_number(const std::string& option, const std::string& value) {
    std::istringstream in(value);
    double number = 0;
    in >> number;
    if (in.fail() || !(in >> std::ws).eof() || !std::isfinite(number)) {
        throw Error(ErrorCode::InvalidInput, "'" + value + "' is not a number", option);
    }
    return number;
}

void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& supported) {
    if (std::ranges::find(supported, value) != supported.end()) return;
    throw Error(ErrorCode::InvalidInput, "'" + value + "' is unknown", option, "supported: " + join(supported));
}

}  // namespace subvol::cli
