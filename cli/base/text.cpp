// SPDX-License-Identifier: Apache-2.0
#include "text.h"

#include <algorithm>
#include <cmath>

#include "subvol/detail/near_name.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol::cli {

std::string join(const std::vector<std::string>& parts) {
    std::string all;
    for (const std::string& part : parts) all += (all.empty() ? "" : ", ") + part;
    return all;
}

Vec3 parse_vector(const std::string& option, const std::string& value) {
    const std::vector<double> numbers = parse_numbers(option, value, 3, "1,2,3");
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
    constexpr double kMostNumber = 1e300;                                                 // the difference of two is finite
    const auto is_sound = [](double number) { return std::abs(number) <= kMostNumber; };  // not if it is NaN
    if (numbers.size() != count || !std::ranges::all_of(numbers, is_sound)) {
        throw Error(ErrorCode::InvalidInput,
                    text("'", detail::shortened(value), "' is not ", count == 3 ? "three" : std::to_string(count), " numbers"),
                    option, "write it as " + example);
    }
    return numbers;
}

void check_choice(const std::string& option, const std::string& value, const std::vector<std::string>& supported) {
    if (std::ranges::find(supported, value) != supported.end()) return;
    throw Error(ErrorCode::InvalidInput, "'" + value + "' is unknown" + detail::did_you_mean(value, supported), option,
                "supported: " + join(supported));
}

}  // namespace subvol::cli
