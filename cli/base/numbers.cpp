// SPDX-License-Identifier: Apache-2.0
#include "numbers.h"

#include <CLI/CLI.hpp>
#include <charconv>
#include <memory>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "text.h"

namespace subvol::cli {
namespace {

/// Why our own check refuses a text, without the option's name, which the parser of the command line adds.
template <class Check>
std::string refusal_of(const Check& check) {
    try {
        check();
        return {};
    } catch (const Error& error) {
        return error.what();
    }
}

/// The check of a description, for an option that has none of its own.
template <class Number, class Describe>
CLI::Validator as_described(const Describe& describe, const std::string& in_manual) {
    const auto value = std::make_shared<Number>();
    Option option("", value.get());
    describe(option);
    const auto check = [value, option](std::string& text) {
        const std::string refusal = refusal_of([&] { option.read(text, {}); });
        if (refusal.empty()) text = option.text();
        return refusal;
    };
    return {check, in_manual, "number"};
}

}  // namespace

CLI::Validator whole_number(std::int64_t least, std::int64_t most) {
    return as_described<std::uint64_t>(
        [&](Option& option) { option.between(static_cast<double>(least), static_cast<double>(most)); },
        text("INT in [", least, " - ", most, "]"));
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

CLI::Validator number_or_percent() {
    const auto check = [number = any_number()](std::string& text) {
        const bool percent = text.ends_with('%');
        std::string digits = text.substr(0, text.size() - (percent ? 1 : 0));
        std::string wrong = number(digits);
        if (wrong.empty()) text = digits + (percent ? "%" : "");
        return wrong;
    };
    return {check, "", "number"};
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
    const auto check = [=](std::string& text) { return refusal_of([&] { (void)parse_numbers({}, text, count, example); }); };
    return {check, "", "numbers"};
}

FrameRange parse_frames(const std::string& text) {
    constexpr int kMostFrames = 1'000'000;
    const auto number_in = [](std::string_view digits) {
        int number = -1;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        return error == std::errc() && end == digits.data() + digits.size() ? number : -1;
    };
    const std::string_view all = text;
    const std::size_t dash = all.find('-');
    const int first = dash == std::string::npos ? 1 : number_in(all.substr(0, dash));
    const int last = number_in(dash == std::string::npos ? all : all.substr(dash + 1));
    const std::string given = "'" + detail::shortened(text) + "'";
    if (first < 0 || last < first)
        throw Error(ErrorCode::InvalidInput, given + " is not a range of frames", "--frames", "1-10, or 10 for the same");
    if (last - first >= kMostFrames)
        throw Error(ErrorCode::InvalidInput, given + " has too many frames", "--frames", "at most a million");
    return {first, last};
}

CLI::Validator frame_range() {
    const auto check = [](const std::string& text) -> std::string {
        (void)parse_frames(text);
        return {};
    };
    return {check, "", "frames"};
}

double parse_number(const std::string& option, const std::string& value) {
    double number = 0;
    Option("", number).read(value, option);
    return number;
}

}  // namespace subvol::cli
