// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
#include <vector>

#include "subvol/names.h"
#include "subvol/option_names.h"
#include "subvol/option_needs.h"

namespace subvol {

/// The numbers that an option may have: from `least` to `most`, and 0 besides if `or_zero`. Differences of two numbers of the
/// widest range are finite.
struct NumberRange {
    double least = -1e300, most = 1e300;
    bool or_zero = false;

    /// NaN is in no range.
    [[nodiscard]] bool contains(double number) const;
};

/// A value that is written as a word, or as a text with a meaning.
struct WordValue {
    std::function<std::string()> get;
    std::function<void(const std::string& word, const std::string& where)> set;  ///< `where` is named in its error
    bool numbers = false;                                                        ///< the value is a number or a word
};

/// Rows of numbers, as of planes and boxes.
struct NumbersValue {
    std::size_t count = 0;    ///< count of numbers in a row
    std::string example{};    ///< example of a row, for errors: "0,0,0,0,0,1: a point of the plane and its normal"
    bool repeatable = false;  ///< there may be several rows
    /// Takes a row; `where` is named in its error
    std::function<void(std::span<const double> row, const std::string& where)> add{};
};

/// One member of an options struct, as users know it: its name, what it may be, and a sentence about it. Each options struct
/// has a function beside it that describes all its members that users set:
///
///     std::vector<Option> options_of(FitOptions& options) {
///         return {Option("extent", options.extent).between(1e-3, 3).help("R", "the distance at which bc and cardinal end"),
///                 Option("terms", options.terms).between(1, 6).help("N", "number of gaussians in a sum"),
///                 Option("sign-slip", options.sign_slip).help("…")};
///     }
///
/// The command makes its options of it, Python its keywords, studies their keys; the call itself checks the values by
/// `check_options`. The description refers to the struct, which must live as long.
class Option {
public:
    using Value =
        std::variant<bool*, int*, std::uint64_t*, double*, std::string*, std::optional<int>*, std::optional<std::uint64_t>*,
                     std::optional<double>*, std::optional<std::string>*, std::vector<std::string>*, WordValue, NumbersValue>;

    /// name: as the command has it, without dashes before it: "per-edge"
    Option(std::string option, Value member);
    template <class Member>
    requires(std::is_constructible_v<Value, Member*>) Option(std::string option, Member& member)
        : Option(std::move(option), Value(&member)) {}
    /// A choice: the words are those of the enum's table.
    template <class Enum>
    requires(std::is_enum_v<Enum>) Option(std::string option, Enum& member)
        : Option(std::move(option), WordValue{[&member] { return std::string(name_of(member)); },
                                              [&member](const std::string& word, const std::string& where) {
                                                  member = named<Enum>(word, where);
                                              }}) {
        words = names_of<Enum>();
    }

    Option& between(double least, double most);
    /// More than 0. A length, an error or a factor whose square or cube is 0 or infinite is none.
    Option& positive();
    /// Code may leave it at 0: not given.
    Option& or_none();
    Option& not_negative();
    /// Memory, which the command also takes as "500M" or "2G".
    Option& bytes();
    /// placeholder: what stands for the value in a list of options, as "N"; empty for switches
    Option& help(std::string placeholder, std::string help_text);
    Option& help(std::string help_text) { return help({}, std::move(help_text)); }
    /// Words that are proposed; others are allowed too.
    Option& offer(std::vector<std::string> proposed);
    /// A list of which several entries may stand in one value, with commas between them. Others take one each time they are
    /// given.
    Option& with_commas();
    /// The option has an effect only with another one, or only if that one has one of these values.
    Option& only_with(std::string option, std::vector<std::string> values = {});
    /// The name in Python and studies, if it is another word.
    Option& called(std::string keyword);
    /// Another name, which the command takes too.
    Option& also(std::string flag);
    /// The last condition is also met if this option is given.
    Option& or_with(std::string option);
    /// The option has no effect with another one, or with one of these values of it.
    Option& not_with(std::string option, std::vector<std::string> values = {});
    /// The option replaces others, so both cannot be given.
    Option& instead_of(std::vector<std::string> others);

    /// The name where dashes are not possible: in Python and in studies.
    [[nodiscard]] std::string key() const;
    /// The sentence, for users who have these names.
    [[nodiscard]] std::string meaning(OptionNames names) const;
    /// The numbers that are allowed, in words; empty: all, or the value is not a number.
    [[nodiscard]] std::string range_text() const;
    [[nodiscard]] bool is_whole() const;
    [[nodiscard]] bool is_number() const;
    [[nodiscard]] bool is_optional() const;
    /// The value as users write it; empty: not given.
    [[nodiscard]] std::string text() const;

    /// The option's value is read from a text, as the command and environments have it.
    ///
    /// where:  the option as it was given, for the error
    /// throws: Error(InvalidInput) for text that is not such a number or word
    void read(const std::string& text, const std::string& where) const;
    /// The value is set to a number.
    ///
    /// throws: Error(InvalidInput) for a number out of range, or one that is not whole where it must be
    void set(double number, const std::string& where) const;
    /// throws: Error(InvalidInput) if the value, which code has set, is not allowed
    void check() const;

    std::string name, alias{}, keyword{};
    Value value;
    NumberRange range{};
    bool in_bytes = false, has_commas = false;
    std::string about{}, sentence{};
    std::vector<std::string> words{};
    std::vector<OptionNeed> needs{};
    std::vector<std::string> excludes{};

private:
    void assign(double number) const;
    void check_number(double number, const std::string& given, const std::string& where) const;
    [[nodiscard]] std::string allowed(double number) const;

    bool zero_is_none_ = false;
};

/// Checks all members of options that are described by an `options_of` beside their struct.
///
/// throws: Error(InvalidInput): "per_edge: 65 is out of range (1 to 64)"
template <class Options>
void check_options(Options options) {
    for (const Option& option : options_of(options)) option.check();
}

namespace detail {

/// As `number_from`, without blanks around the number; nothing for NaN.
[[nodiscard]] std::optional<double> plain_number(std::string_view text);

}  // namespace detail

}  // namespace subvol
