// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace subvol {

/// One row of an enum's table of names: what users write for an enumerator, and what it means.
template <class Enum>
struct Name {
    Enum value;
    std::string_view name;
    std::string_view help{};
};

/// The names of an enum, written once, beside it:
///
///     template <>
///     struct NameTable<Correction> {
///         static constexpr Name<Correction> rows[] = {{Correction::None, "none"}, {Correction::Gradient, "gradient"}, …};
///     };
///
/// The command, Python, studies, reports and the tables in docs read them from there.
template <class Enum>
struct NameTable;

/// The name of an enumerator; every enumerator has one.
template <class Enum>
[[nodiscard]] constexpr std::string_view name_of(Enum value) {
    for (const auto& row : NameTable<Enum>::rows) {
        if (row.value == value) return row.name;
    }
    return {};
}

/// All names, in the order of the table.
template <class Enum>
[[nodiscard]] std::vector<std::string> names_of() {
    std::vector<std::string> names;
    for (const auto& row : NameTable<Enum>::rows) names.emplace_back(row.name);
    return names;
}

namespace detail {

/// throws: Error(InvalidInput): "where: 'given' is unknown: did you mean 'near'? (supported: all names)"
[[noreturn]] void throw_unknown_name(const std::string& given, const std::string& where, const std::vector<std::string>& names);

}  // namespace detail

/// The enumerator of a name; nothing for another name.
template <class Enum>
[[nodiscard]] constexpr std::optional<Enum> find_named(std::string_view name) {
    for (const auto& row : NameTable<Enum>::rows) {
        if (row.name == name) return row.value;
    }
    return std::nullopt;
}

/// The enumerator of a name.
///
/// where:  the option or key that was given, for the error
/// throws: Error(InvalidInput) for another name; it suggests a near one
template <class Enum>
[[nodiscard]] Enum named(std::string_view name, const std::string& where) {
    if (const auto found = find_named<Enum>(name)) return *found;
    detail::throw_unknown_name(std::string(name), where, names_of<Enum>());
}

}  // namespace subvol
