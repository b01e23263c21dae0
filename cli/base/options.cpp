// SPDX-License-Identifier: Apache-2.0
#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "numbers.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
#include "subvol/option.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr double kMostShown = 1e9;  // a larger bound says nothing
constexpr int kDigitsShown = 10;

/// Numbers and words as the parser describes them; help, the manual page and completion read it.
std::string description_of(const Option& option) {
    if (!option.words.empty()) {
        std::string set;
        for (const std::string& word : option.words) set += (set.empty() ? "" : ",") + word;
        return "{" + set + "}";
    }
    const NumberRange& range = option.range;
    if (!option.is_number() || option.in_bytes || range.least < -kMostShown || range.most > kMostShown) return {};
    return text(option.is_whole() ? "INT" : "FLOAT", " in [", detail::number_text(range.least, kDigitsShown), " - ",
                detail::number_text(range.most, kDigitsShown), "]");
}

CLI::Validator described(const std::string& description) {
    return {[](const std::string&) { return std::string(); }, description, "described"};
}

/// Rows of numbers, each in a word of its own.
CLI::Option* add_numbers(CLI::App& app, const std::string& name, const NumbersValue& rows, const Option& option) {
    const auto read = [rows, name](const std::vector<std::string>& given) {
        for (const std::string& row : given) rows.add(parse_numbers(name, row, rows.count, rows.example), name);
    };
    CLI::Option* const added = app.add_option_function<std::vector<std::string>>(name, read, option.sentence);
    added->type_name(option.about)->transform(number_list(rows.count, rows.example));
    return rows.repeatable ? added->allow_extra_args(false) : added->expected(1);
}

/// Text of an option that was given.
std::optional<std::string> given_to(const CLI::App& app, std::string_view name) {
    const CLI::Option* const option = app.get_option_no_throw("--" + std::string(name));
    return option == nullptr || option->count() == 0 ? std::nullopt : std::optional(join(option->results()));
}

/// Says the condition in the help, and checks it when the option is given.
void check_need(CLI::App& app, CLI::Option& added, Option option, const OptionNeed& need) {
    CLI::Option* const other = app.get_option_no_throw("--" + need.option);
    option.needs = {need};
    option.excludes.clear();
    const auto check = [&app, option](const std::string&) -> std::string {
        const auto usual = [&app](std::string_view name) {
            return app.get_option("--" + std::string(name))->get_default_str();
        };
        check_needs(
            option, [&app](std::string_view name) { return given_to(app, name); }, usual, OptionNames::Flags);
        return {};
    };
    const bool says = need.words.empty() && !need.excluded && need.instead.empty();
    if (says) {
        added.needs(other);  // which the help says
    } else {
        added.description(added.get_description() + "; " + need_text(need, OptionNames::Flags));
    }
    added.check(CLI::Validator(check, "", "only with"));
}

}  // namespace

GivenOptions given_options(const CLI::App& app) {
    return [&app](std::string_view name) { return given_to(app, name); };
}

CLI::Option* add_option(CLI::App& app, const Option& option) {
    const std::string first = "--" + option.name, other_name = (option.alias.size() == 1 ? "-" : "--") + option.alias;
    const std::string name = option.alias.empty() ? first : first + "," + other_name;
    CLI::Option* added = nullptr;
    if (auto* const* on = std::get_if<bool*>(&option.value)) {
        added = app.add_flag(name, **on, option.sentence);
    } else if (auto* const* list = std::get_if<std::vector<std::string>*>(&option.value)) {
        added = app.add_option(name, **list, option.sentence)->type_name(option.about)->allow_extra_args(false);
        if (option.has_commas) added->delimiter(',');
    } else if (const auto* const rows = std::get_if<NumbersValue>(&option.value)) {
        added = add_numbers(app, first, *rows, option);
    } else {
        const bool said = option.sentence.find("(default") != std::string::npos;
        const bool has_default = !said && !option.is_optional() && !option.text().empty() && option.text() != "0";
        const std::string help = option.sentence + (has_default ? " (default " + option.text() + ")" : "");
        const auto read = [option, first](const std::string& given) { option.read(given, first); };
        added = app.add_option_function<std::string>(name, read, help)->type_name(option.about)->default_str(option.text());
    }
    if (const std::string description = description_of(option); !description.empty()) added->check(described(description));
    for (const OptionNeed& need : option.needs) {
        if (app.get_option_no_throw("--" + need.option) != nullptr) check_need(app, *added, option, need);
    }
    for (const std::string& other : option.excludes) {
        if (CLI::Option* const second = app.get_option_no_throw("--" + other); second != nullptr) added->excludes(second);
    }
    return added;
}

CLI::Option* add_input(CLI::App& app, const std::string& name, std::string& value, const std::string& help) {
    return app.add_option(name, value, help);
}

CLI::Option* add_input(CLI::App& app, const std::string& name, std::vector<std::string>& value, const std::string& help) {
    return app.add_option(name, value, help);
}

void add_options(CLI::App& app, const std::vector<Option>& options) {
    for (const Option& option : options) add_option(app, option);
}

void only_with(CLI::App& app, const std::string& name, const OptionNeed& need) {
    std::string none;
    check_need(app, *app.get_option("--" + name), Option(name, none), need);
}

}  // namespace subvol::cli
