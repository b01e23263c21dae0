// SPDX-License-Identifier: Apache-2.0
// Options as text: what is read, what is printed, and what errors say is allowed.

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "option_kinds.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"
#include "subvol/option.h"

namespace subvol {
namespace {

using detail::Content;
using detail::kIsNumber;
using detail::kLeastPositive;
using detail::kMostPositive;
using detail::kMostWhole;

constexpr double kTiny = 1e-6;                        // who gives 0 does not want to read a smaller number
constexpr double kMostBytes = 1152921504606846976.0;  // 2⁶⁰
constexpr const char* kBytesAllowed = "a number of bytes from 0 to 1024P, such as 500M or 2G";

[[noreturn]] void refuse(const std::string& given, const char* why, const std::string& where, const std::string& allowed) {
    throw Error(ErrorCode::InvalidInput, given + " " + why, where, allowed);
}

std::string quoted(const std::string& text) {
    return "'" + detail::shortened(text) + "'";
}

/// A bound as text: whole numbers in full, others with 6 digits.
std::string bound_text(double bound) {
    constexpr double kExact = 9007199254740992;  // 2⁵³
    if (bound == kMostWhole) return std::to_string(std::numeric_limits<std::uint64_t>::max());
    return bound == std::floor(bound) && std::abs(bound) <= kExact ? std::to_string(static_cast<std::int64_t>(bound))
                                                                   : detail::number_text(bound);
}

/// 1024^k of "", "K", "kB" or "KiB"; nothing for another unit.
std::optional<std::uint64_t> bytes_of_unit(std::string_view unit) {
    constexpr std::string_view kUnits = "KMGTPE";
    if (unit.empty() || unit == "B" || unit == "b") return 1;
    const std::size_t k = kUnits.find(static_cast<char>(std::toupper(static_cast<unsigned char>(unit.front()))));
    std::string rest(unit.substr(1));
    std::ranges::transform(rest, rest.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (k == std::string_view::npos || (!rest.empty() && rest != "b" && rest != "i" && rest != "ib")) return std::nullopt;
    return std::uint64_t{1} << 10 * (k + 1);
}

std::uint64_t bytes_from(const std::string& text, const std::string& where) {
    std::uint64_t number = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const auto length = static_cast<std::size_t>(stop - text.data());
    const auto unit = bytes_of_unit(std::string_view(text).substr(length));
    if (length == 0 || error == std::errc::invalid_argument || !unit) {
        refuse(quoted(text), detail::plain_number(text) ? "is out of range" : "is not a number of bytes", where, kBytesAllowed);
    }
    if (error != std::errc() || static_cast<double>(number) > kMostBytes / static_cast<double>(*unit))
        refuse(quoted(text), "is out of range", where, kBytesAllowed);
    return number * *unit;
}

/// All digits of a whole number, which may not be exact as a double; nothing if the text is something else.
std::optional<std::uint64_t> digits_from(std::string_view text) {
    if (text.starts_with('+')) text.remove_prefix(1);
    std::uint64_t number = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && stop == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

/// A value as users write it; empty: not given.
struct Text {
    std::string operator()(const bool* on) const { return *on ? "true" : ""; }
    std::string operator()(const int* number) const { return std::to_string(*number); }
    std::string operator()(const std::uint64_t* number) const { return std::to_string(*number); }
    std::string operator()(const double* number) const { return detail::exact_text(*number); }
    std::string operator()(const std::string* words) const { return *words; }
    template <class T>
    std::string operator()(const std::optional<T>* given) const {
        return *given ? (*this)(&**given) : std::string();
    }
    std::string operator()(const std::vector<std::string>* list) const {
        std::string all;
        for (const std::string& one : *list) all += (all.empty() ? "" : ",") + one;
        return all;
    }
    std::string operator()(const WordValue& word) const { return word.get(); }
    std::string operator()(const NumbersValue&) const { return {}; }
};

}  // namespace

std::string option_name(std::string_view option, OptionNames names) {
    if (names == OptionNames::Flags) return "--" + std::string(option);
    std::string key(option);
    std::ranges::replace(key, '-', '_');
    return key;
}

std::string Option::meaning(OptionNames names) const {
    if (names == OptionNames::Flags) return sentence;
    std::string told;
    bool quoted = false;  // `subvol fit --kernels` is of the command for all
    for (std::size_t at = 0; at < sentence.size();) {
        quoted = quoted != (sentence[at] == '`');
        const bool is_option = !quoted && sentence.compare(at, 2, "--") == 0;
        const std::size_t end = std::min(sentence.find_first_not_of("-abcdefghijklmnopqrstuvwxyz", at), sentence.size());
        if (is_option) {
            told += option_name(std::string_view(sentence).substr(at + 2, end - at - 2), names);
            at = end;
        } else {
            told += sentence[at++];
        }
    }
    return told;
}

std::string Option::range_text() const {
    constexpr double kMostShown = 1e9;  // a larger bound says nothing
    if (!is_number() || in_bytes) return {};
    if (range.or_zero) return "0 or more";
    if (range.least == kLeastPositive && range.most == kMostPositive) return "more than 0";
    if (range.least > 0 && range.least < kTiny) return "more than 0, at most " + bound_text(range.most);
    if (range.least < -kMostShown || range.most > kMostShown) return {};
    return allowed(1);
}

std::string Option::text() const {
    return std::visit(Text{}, value);
}

std::string Option::allowed(double number) const {
    const NumberRange any;
    if (in_bytes) return kBytesAllowed;
    if (std::isnan(number) && range.least == any.least && range.most == any.most) return "a finite number";
    if (!is_whole() && !(number > 0)) {
        if (range.or_zero) return "0 or more";
        if (range.least == kLeastPositive) return "more than 0";
        if (range.least > 0 && range.least < kTiny) return "more than 0, at most " + detail::number_text(range.most);
    }
    if (is_whole()) return bound_text(range.least) + " to " + bound_text(range.most);
    return detail::number_text(range.least) + " to " + detail::number_text(range.most);
}

void Option::check_number(double number, const std::string& given, const std::string& where) const {
    if (std::isnan(number)) refuse(given, "is not a number", where, allowed(number));
    if (!range.contains(number)) refuse(given, "is out of range", where, allowed(number));
    if (is_whole() && number != std::floor(number)) refuse(given, "is not a whole number", where, allowed(number));
}

void Option::assign(double number) const {
    std::visit(
        [&](auto given) {
            if constexpr (kIsNumber<decltype(given)>) *given = static_cast<typename Content<decltype(given)>::Type>(number);
        },
        value);
}

void Option::set(double number, const std::string& where) const {
    if (!(zero_is_none_ && number == 0)) check_number(number, detail::exact_text(number), where);
    assign(number);
}

void Option::read(const std::string& text, const std::string& where) const {
    if (const auto* word = std::get_if<WordValue>(&value)) return word->set(text, where);
    if (auto* const* words_value = std::get_if<std::string*>(&value)) {
        **words_value = text;
        return;
    }
    if (auto* const* words_value = std::get_if<std::optional<std::string>*>(&value)) {
        **words_value = text;
        return;
    }
    const bool counts_things = in_bytes || is_whole();
    const auto digits = in_bytes ? std::optional(bytes_from(text, where)) : digits_from(text);
    if (counts_things && digits) {
        const std::uint64_t whole = *digits;
        const auto number = static_cast<double>(whole);
        if (range.most != kMostWhole) check_number(number, quoted(text), where);
        // Digits of more than 53 bits are kept, which a double would round.
        if (auto* const* exact = std::get_if<std::uint64_t*>(&value)) {
            **exact = whole;
        } else {
            assign(number);
        }
        return;
    }
    const auto number = detail::plain_number(text);
    if (!number) refuse(quoted(text), "is not a number", where, allowed(NAN));
    check_number(*number, quoted(text), where);
    assign(*number);
}

void Option::check() const {
    if (!is_number() || (is_optional() && text().empty())) return;
    const double number = std::visit(
        [](auto given) {
            using Given = decltype(given);
            if constexpr (std::is_same_v<Given, int*> || std::is_same_v<Given, std::uint64_t*> ||
                          std::is_same_v<Given, double*>) {
                return static_cast<double>(*given);
            } else if constexpr (kIsNumber<Given>) {
                return static_cast<double>(**given);
            } else {
                return 0.0;
            }
        },
        value);
    if (!(zero_is_none_ && number == 0)) check_number(number, text(), key());
}

namespace detail {

std::optional<double> plain_number(std::string_view text) {
    if (text.find_first_of(" \t\r\n") != std::string_view::npos) return std::nullopt;
    const auto number = number_from(text);
    return number && !std::isnan(*number) ? number : std::nullopt;
}

}  // namespace detail

}  // namespace subvol
