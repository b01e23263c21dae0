// SPDX-License-Identifier: Apache-2.0
#include "text.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/near_name.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"

namespace subvol::cli {

std::string join(const std::vector<std::string>& parts) {
    std::string all;
    for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
    return all;
}

Vec3 parse_vector(const std::string& option, const std::string& value) {
    std::vector<double> numbers;
    for (std::string_view rest = value; numbers.size() < 4;) {
        const std::size_t comma = rest.find(',');
        numbers.push_back(detail::number_from(rest.substr(0, comma)).value_or(NAN));
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    if (numbers.size() != 3 || !std::ranges::all_of(numbers, [](double x) { return std::isfinite(x); })) {
        throw Error(ErrorCode::InvalidInput, "'" + value + "' is not three numbers", option, "write it as 1,2,3");
    }
    return {numbers[0], numbers[1], numbers[2]};
}

std::vector<double> parse_numbers(const std::string& option, const std::string& value, std::size_t count,
                                  const std::string& example) {
    std::vector<double> numbers;
    for (std::string_view rest = value; numbers.size() <= count;) {
        const std::size_t comma = rest.find(',');
        numbers.push_back(detail::number_from(rest.substr(0, comma)).value_or(NAN));
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    bool sound = numbers.size() == count;
    for (const double number : numbers) sound = sound && std::isfinite(number);
    if (!sound) {
        throw Error(ErrorCode::InvalidInput, text("'", value, "' is not ", count, " numbers"), option,
                    "write it as " + example);
    }
    return numbers;
}

void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& supported) {
    if (std::ranges::find(supported, value) != supported.end()) return;
    throw Error(ErrorCode::InvalidInput, "'" + value + "' is unknown" + detail::did_you_mean(value, supported), option,
                "supported: " + join(supported));
}

}  // namespace subvol::cli
