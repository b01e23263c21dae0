// SPDX-License-Identifier: Apache-2.0
#include "numbers.h"

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <memory>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kMostNumber = 1e300;  // the difference of two is finite
constexpr const char* kAnyNumber = "-1e+300 to 1e+300";

std::string refusal(const std::string& given, const std::string& why, const std::string& range) {
    return "'" + detail::shortened(given) + "' " + why + " (" + range + ")";
}

/// The check of a description, for an option that has none of its own.
template <class Number, class Describe>
CLI::Validator as_described(const Describe& describe, const std::string& in_manual) {
    const auto value = std::make_shared<Number>();
    Option option("", value.get());
    describe(option);
    const auto check = [value, option](std::string& text) -> std::string {
        try {
            option.read(text, {});
        } catch (const Error& error) {
            return error.what();
        }
        text = option.text();
        return {};
    };
    return {check, in_manual, "number"};
}

}  // namespace

CLI::Validator whole_number(std::int64_t least, std::int64_t most) {
    return as_described<std::uint64_t>(
        [&](Option& option) { option.between(static_cast<double>(least), static_cast<double>(most)); },
        text("INT in [", least, " - ", most, "]"));
}

CLI::Validator seed_number() {
    return as_described<std::uint64_t>([](Option&) {}, "");
}

CLI::Validator number_in(double least, double most) {
    return as_described<double>([&](Option& option) { option.between(least, most); },
                                "FLOAT in [" + detail::number_text(least) + " - " + detail::number_text(most) + "]");
}

CLI::Validator positive_number() {
    return as_described<double>([](Option& option) { option.positive(); }, "POSITIVE");
}

CLI::Validator not_negative_number() {
    return as_described<double>([](Option& option) { option.not_negative(); }, "NONNEGATIVE");
}

CLI::Validator any_number() {
    return as_described<double>([](Option&) {}, "");
}

CLI::Validator byte_count() {
    return as_described<std::uint64_t>([](Option& option) { option.bytes(); }, "");
}

CLI::Validator number_or(const std::string& word, const CLI::Validator& number) {
    const auto check = [=](std::string& text) -> std::string {
        if (text == word) return {};
        const std::string wrong = number(text);
        return wrong.ends_with(')') ? wrong.substr(0, wrong.size() - 1) + ", or " + word + ")" : wrong;
    };
    return {check, number.get_description(), "number"};
}

CLI::Validator number_list(std::size_t count, const std::string& example) {
    const auto check = [=](std::string& text) -> std::string {
        std::size_t numbers = 0;
        bool sound = true;
        for (std::string_view rest = text; sound; ++numbers) {
            const std::size_t comma = rest.find(',');
            const auto number = detail::number_from(rest.substr(0, comma));
            sound = number && std::abs(*number) <= kMostNumber;  // not if it is NaN
            if (comma == std::string_view::npos) {
                ++numbers;
                break;
            }
            rest.remove_prefix(comma + 1);
        }
        if (sound && numbers == count) return {};
        return refusal(text, count == 3 ? "is not three numbers" : ("is not " + std::to_string(count) + " numbers").c_str(),
                       "write it as " + example);
    };
    return {check, "", "numbers"};
}

CLI::Validator frame_range() {
    const auto check = [](std::string& text) -> std::string {
        constexpr int kMostFrames = 1'000'000;
        const auto number_in = [](std::string_view digits) {
            int number = -1;
            const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
            return error == std::errc() && end == digits.data() + digits.size() ? number : -1;
        };
        const std::size_t dash = text.find('-');
        const std::string_view all = text;
        const int first = dash == std::string::npos ? 1 : number_in(all.substr(0, dash));
        const int last = number_in(dash == std::string::npos ? all : all.substr(dash + 1));
        if (first < 0 || last < first) return refusal(text, "is not a range of frames", "1-10, or 10 for the same");
        return last - first < kMostFrames ? "" : refusal(text, "has too many frames", "at most a million");
    };
    return {check, "", "frames"};
}

double parse_number(const std::string& option, const std::string& value) {
    const auto number = detail::plain_number(value);
    if (!number) {
        throw Error(ErrorCode::InvalidInput, "'" + detail::shortened(value) + "' is not a number", option);
    }
    if (std::abs(*number) > kMostNumber) {
        throw Error(ErrorCode::InvalidInput, "'" + detail::shortened(value) + "' is out of range", option, kAnyNumber);
    }
    return *number;
}

}  // namespace subvol::cli
