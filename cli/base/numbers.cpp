// SPDX-License-Identifier: Apache-2.0
#include "numbers.h"

#include <CLI/CLI.hpp>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kLeastPositive = 1e-100, kMostPositive = 1e100;
constexpr double kMostNumber = 1e300;  // the difference of two is finite
constexpr const char* kAnyNumber = "-1e+300 to 1e+300";

/// Why a text is refused, as "'two' is not a number (0 to 10)", which `explained` takes apart again.
std::string refusal(const std::string& given, const char* why, const std::string& range) {
    return "'" + detail::shortened(given) + "' " + why + " (" + range + ")";
}

/// `number_from` lets blanks about a number pass.
std::optional<double> number_of(const std::string& text) {
    const bool blank = text.find_first_of(" \t\r\n") != std::string::npos;
    return blank ? std::nullopt : detail::number_from(text);
}

/// or_zero: 0 is in the range too; in_words: the range in words, for what is no positive number
CLI::Validator real_number(double least, double most, bool or_zero, const std::string& in_words, const std::string& in_manual) {
    const auto check = [=](std::string& text) -> std::string {
        const auto value = number_of(text);
        const bool number = value && !std::isnan(*value);
        if (number && ((*value >= least && *value <= most) || (or_zero && *value == 0))) {
            text = detail::number_text(*value, std::numeric_limits<double>::max_digits10);
            return {};
        }
        const bool plain = in_words.empty() || (number && *value > 0);
        return refusal(text, number ? "is out of range" : "is not a number",
                       plain ? detail::number_text(least) + " to " + detail::number_text(most) : in_words);
    };
    return {check, in_manual, "number"};
}

template <class Whole>
CLI::Validator integer(Whole least, Whole most, const std::string& range, const std::string& in_manual) {
    const auto check = [=](std::string& text) -> std::string {
        const std::string_view digits = std::string_view(text).substr(text.starts_with('+') ? 1 : 0);
        const char* const end = digits.data() + digits.size();
        Whole value = 0;
        const auto [stop, error] = std::from_chars(digits.data(), end, value);
        if (error == std::errc() && stop == end && !digits.starts_with('+')) {
            if (value < least || value > most) return refusal(text, "is out of range", range);
            text = std::to_string(value);
            return {};
        }
        const auto number = number_of(text);
        if (!number || std::isnan(*number)) return refusal(text, "is not a number", range);
        return refusal(text, *number == std::floor(*number) ? "is out of range" : "is not a whole number", range);
    };
    return {check, in_manual, "number"};
}

/// 1024^k of "", "K", "kB" or "KiB"; nothing of another unit.
std::optional<std::uint64_t> unit_of(std::string_view unit) {
    constexpr std::string_view kUnits = "KMGTPE";
    if (unit.empty() || unit == "B" || unit == "b") return 1;
    const std::size_t k = kUnits.find(static_cast<char>(std::toupper(static_cast<unsigned char>(unit.front()))));
    const std::string rest = CLI::detail::to_lower(std::string(unit.substr(1)));
    if (k == std::string_view::npos || (!rest.empty() && rest != "b" && rest != "i" && rest != "ib")) return std::nullopt;
    return std::uint64_t{1} << 10 * (k + 1);
}

}  // namespace

CLI::Validator whole_number(std::int64_t least, std::int64_t most) {
    return integer<std::int64_t>(least, most, text(least, " to ", most), text("INT in [", least, " - ", most, "]"));
}

CLI::Validator seed_number() {
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint64_t>::max();
    return integer<std::uint64_t>(0, kMost, text("0 to ", kMost), "");
}

CLI::Validator number_in(double least, double most) {
    constexpr double kTiny = 1e-6;  // nobody who gives 0 wants to read such a number
    const bool tiny = least > 0 && least < kTiny;
    return real_number(least, most, false, tiny ? "more than 0, at most " + detail::number_text(most) : "",
                       "FLOAT in [" + detail::number_text(least) + " - " + detail::number_text(most) + "]");
}

CLI::Validator positive_number() {
    return real_number(kLeastPositive, kMostPositive, false, "more than 0", "POSITIVE");
}

CLI::Validator not_negative_number() {
    return real_number(kLeastPositive, kMostPositive, true, "0 or more", "NONNEGATIVE");
}

CLI::Validator any_number() {
    const auto check = [](std::string& text) -> std::string {
        const auto value = number_of(text);
        if (!value) return detail::in_quotes(text) + " is not a number";
        if (std::isnan(*value)) return detail::in_quotes(text) + " is not a finite number";
        if (std::abs(*value) > kMostNumber) return refusal(text, "is out of range", kAnyNumber);
        text = detail::number_text(*value, std::numeric_limits<double>::max_digits10);
        return {};
    };
    return {check, "", "number"};
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

CLI::Validator byte_count() {
    constexpr std::uint64_t kMost = std::uint64_t{1} << 60;
    const auto check = [](std::string& text) -> std::string {
        const std::string range = "a number of bytes from 0 to 1024P, such as 500M or 2G";
        std::uint64_t number = 0;
        const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const std::size_t length = static_cast<std::size_t>(stop - text.data());
        const auto unit = unit_of(std::string_view(text).substr(length));
        const bool digits = length > 0 && error != std::errc::invalid_argument;
        if (!digits || !unit) {
            const auto other = number_of(text);
            return refusal(text, other && !std::isnan(*other) ? "is out of range" : "is not a number of bytes", range);
        }
        if (error != std::errc() || number > kMost / *unit) return refusal(text, "is out of range", range);
        text = std::to_string(number * *unit);
        return {};
    };
    return {check, "", "bytes"};
}

double parse_number(const std::string& option, const std::string& value) {
    const auto number = number_of(value);
    if (!number || std::isnan(*number)) {
        throw Error(ErrorCode::InvalidInput, "'" + detail::shortened(value) + "' is not a number", option);
    }
    if (std::abs(*number) > kMostNumber) {
        throw Error(ErrorCode::InvalidInput, "'" + detail::shortened(value) + "' is out of range", option, kAnyNumber);
    }
    return *number;
}

}  // namespace subvol::cli
