// SPDX-License-Identifier: Apache-2.0
#include "subvol/option.h"

#include <limits>
#include <utility>

#include "option_kinds.h"

namespace subvol {

bool NumberRange::contains(double number) const {
    return (number >= least && number <= most) || (or_zero && number == 0);
}

Option::Option(std::string option_name, Value member) : name(std::move(option_name)), value(std::move(member)) {
    const auto bounds = [&](auto* pointer) {
        using Pointer = decltype(pointer);
        if constexpr (detail::kIsNumber<Pointer>) {
            using Number = typename detail::Content<Pointer>::Type;
            if constexpr (std::is_same_v<Number, int>)
                range = {std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};
            if constexpr (std::is_same_v<Number, std::uint64_t>) range = {0, detail::kMostWhole};
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
    range = {detail::kLeastPositive, detail::kMostPositive};
    return *this;
}

Option& Option::or_none() {
    zero_is_none_ = true;
    return *this;
}

Option& Option::not_negative() {
    range = {detail::kLeastPositive, detail::kMostPositive, true};
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

Option& Option::with_commas() {
    has_commas = true;
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

std::string Option::key() const {
    return keyword.empty() ? option_name(name, OptionNames::Keywords) : keyword;
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

}  // namespace subvol
