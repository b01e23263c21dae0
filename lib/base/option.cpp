// SPDX-License-Identifier: Apache-2.0
#include "subvol/option.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "subvol/detail/number_text.h"
#include "subvol/detail/printable.h"
#include "subvol/error.h"

namespace subvol {
namespace {

constexpr double kLeastPositive = 1e-100, kMostPositive = 1e100;
constexpr double kTiny = 1e-6;                         // who gives 0 does not want to read a smaller number
constexpr double kMostBytes = 1152921504606846976.0;   // 2⁶⁰
constexpr double kMostWhole = 18446744073709549568.0;  // the largest double below 2⁶⁴
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

template <class>
struct Content;
template <class T>
struct Content<T*> {
    using Type = T;
};
template <class T>
struct Content<std::optional<T>*> {
    using Type = T;
};

template <class Pointer>
constexpr bool kIsNumber =
    std::is_same_v<Pointer, int*> || std::is_same_v<Pointer, std::uint64_t*> || std::is_same_v<Pointer, double*> ||
    std::is_same_v<Pointer, std::optional<int>*> || std::is_same_v<Pointer, std::optional<std::uint64_t>*> ||
    std::is_same_v<Pointer, std::optional<double>*>;

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

/// "--order havs", "order='havs' or 'lists'"
std::string shown(const OptionNeed& need, const std::vector<std::string>& words, OptionNames names) {
    std::string all = option_name(need.option, names);
    const bool flags = names == OptionNames::Flags;
    for (const std::string& word : words) {
        all += &word == &words.front() ? (flags ? " " : "=") : " or ";
        all += flags ? word : "'" + word + "'";
    }
    return all;
}

}  // namespace

bool NumberRange::contains(double number) const {
    return (number >= least && number <= most) || (or_zero && number == 0);
}

Option::Option(std::string option_name, Value member) : name(std::move(option_name)), value(std::move(member)) {
    const auto bounds = [&](auto* pointer) {
        using Pointer = decltype(pointer);
        if constexpr (kIsNumber<Pointer>) {
            using Number = typename Content<Pointer>::Type;
            if constexpr (std::is_same_v<Number, int>)
                range = {std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};
            if constexpr (std::is_same_v<Number, std::uint64_t>) range = {0, kMostWhole};
        }
    };
    std::visit(
        [&](auto& given) {
            if constexpr (std::is_pointer_v<std::remove_reference_t<decltype(given)>>) bounds(given);
        },
        value);
}

Option& Option::between(double least, double most) {
    range = {least, most};
    return *this;
}

Option& Option::positive() {
    range = {kLeastPositive, kMostPositive};
    return *this;
}

Option& Option::or_none() {
    zero_is_none_ = true;
    return *this;
}

Option& Option::not_negative() {
    range = {kLeastPositive, kMostPositive, true};
    return *this;
}

Option& Option::bytes() {
    in_bytes = true;
    return *this;
}

Option& Option::help(std::string placeholder, std::string words_of_help) {
    about = std::move(placeholder);
    sentence = std::move(words_of_help);
    return *this;
}

Option& Option::offer(std::vector<std::string> proposed) {
    words = std::move(proposed);
    return *this;
}

Option& Option::only_with(std::string option, std::vector<std::string> values) {
    needs.push_back({std::move(option), std::move(values)});
    return *this;
}

Option& Option::called(std::string other) {
    keyword = std::move(other);
    return *this;
}

Option& Option::also(std::string flag) {
    alias = std::move(flag);
    return *this;
}

Option& Option::or_with(std::string option) {
    needs.back().instead = std::move(option);
    return *this;
}

Option& Option::not_with(std::string option, std::vector<std::string> values) {
    needs.push_back({std::move(option), std::move(values), true});
    return *this;
}

Option& Option::instead_of(std::vector<std::string> others) {
    excludes.insert(excludes.end(), others.begin(), others.end());
    return *this;
}

std::string option_name(std::string_view option, OptionNames names) {
    if (names == OptionNames::Flags) return "--" + std::string(option);
    std::string key(option);
    std::ranges::replace(key, '-', '_');
    return key;
}

std::string Option::key() const {
    return keyword.empty() ? option_name(name, OptionNames::Keywords) : keyword;
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

bool Option::is_whole() const {
    return std::holds_alternative<int*>(value) || std::holds_alternative<std::uint64_t*>(value) ||
           std::holds_alternative<std::optional<int>*>(value) || std::holds_alternative<std::optional<std::uint64_t>*>(value);
}

bool Option::is_number() const {
    return is_whole() || std::holds_alternative<double*>(value) || std::holds_alternative<std::optional<double>*>(value);
}

bool Option::is_optional() const {
    return std::visit(
        [](const auto& given) {
            using Given = std::remove_cvref_t<decltype(given)>;
            return std::is_same_v<Given, std::optional<int>*> || std::is_same_v<Given, std::optional<std::uint64_t>*> ||
                   std::is_same_v<Given, std::optional<double>*> || std::is_same_v<Given, std::optional<std::string>*>;
        },
        value);
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

void check_needs(const Option& option, const GivenOptions& given, const GivenOptions& usual, OptionNames names) {
    const std::string where = names == OptionNames::Flags ? option_name(option.name, names) : option.key();
    for (const OptionNeed& need : option.needs) {
        if (!need.instead.empty() && given(need.instead)) continue;
        std::optional<std::string> other = given(need.option);
        if (!other && !need.words.empty()) other = usual(need.option);
        const bool matches = other && (need.words.empty() || std::ranges::find(need.words, *other) != need.words.end());
        if (matches && need.excluded) {
            const std::vector<std::string> word = need.words.empty() ? need.words : std::vector{*other};
            throw Error(ErrorCode::InvalidInput, "has no effect with " + shown(need, word, names), where,
                        "leave one of them out");
        }
        if (!matches && !need.excluded)
            throw Error(ErrorCode::InvalidInput, "has no effect without " + shown(need, need.words, names), where);
    }
    for (const std::string& other : option.excludes) {
        if (given(other))
            throw Error(ErrorCode::InvalidInput, "cannot be given together with " + where, option_name(other, names));
    }
}

void check_needs(const std::vector<Option>& options, const GivenOptions& given, OptionNames names) {
    const GivenOptions usual = [&](std::string_view name) -> std::optional<std::string> {
        const auto option = std::ranges::find(options, name, &Option::name);
        return option == options.end() ? std::nullopt : std::optional(option->text());
    };
    for (const Option& option : options) {
        if (given(option.name)) check_needs(option, given, usual, names);
    }
}

std::string need_text(const OptionNeed& need, OptionNames names) {
    return (need.excluded ? "not with " : "with ") + shown(need, need.words, names);
}

namespace detail {

std::optional<double> plain_number(std::string_view text) {
    if (text.find_first_of(" \t\r\n") != std::string_view::npos) return std::nullopt;
    const auto number = number_from(text);
    return number && !std::isnan(*number) ? number : std::nullopt;
}

}  // namespace detail

}  // namespace subvol
