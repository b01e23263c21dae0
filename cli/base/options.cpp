// SPDX-License-Identifier: Apache-2.0
#include "options.h"

#include <CLI/CLI.hpp>
#include <algorithm>

#include "numbers.h"
#include "subvol/detail/number_text.h"
#include "subvol/error.h"
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

/// "--values paper", "--scheme mcq or cc"
std::string words_of(const OptionNeed& need) {
    std::string all = need.option;
    for (const std::string& word : need.words) all += (&word == &need.words.front() ? " " : " or ") + word;
    return all;
}

}  // namespace

CLI::Option* add_option(CLI::App& app, const Option& option) {
    const std::string name = "--" + option.name;
    CLI::Option* added = nullptr;
    if (auto* const* on = std::get_if<bool*>(&option.value)) {
        added = app.add_flag(name, **on, option.sentence);
    } else if (auto* const* list = std::get_if<std::vector<std::string>*>(&option.value)) {
        added = app.add_option(name, **list, option.sentence)->type_name(option.about);
    } else {
        const bool said = option.sentence.find("(default") != std::string::npos;
        const bool has_default = !said && !option.is_optional() && !option.text().empty() && option.text() != "0";
        const std::string help = option.sentence + (has_default ? " (default " + option.text() + ")" : "");
        const auto read = [option, name](const std::string& given) { option.read(given, name); };
        added = app.add_option_function<std::string>(name, read, help)->type_name(option.about)->default_str(option.text());
    }
    if (const std::string description = description_of(option); !description.empty()) added->check(described(description));
    for (const OptionNeed& need : option.needs) {
        if (app.get_option_no_throw("--" + need.option) != nullptr) only_with(app, name, {"--" + need.option, need.words});
    }
    for (const std::string& other : option.excludes) {
        if (CLI::Option* const second = app.get_option_no_throw("--" + other); second != nullptr) added->excludes(second);
    }
    return added;
}

void add_options(CLI::App& app, const std::vector<Option>& options) {
    for (const Option& option : options) add_option(app, option);
}

void only_with(CLI::App& app, const std::string& name, const OptionNeed& need) {
    CLI::Option* const other = app.get_option(need.option);
    const std::string words = words_of(need);
    const auto check = [=](const std::string&) -> std::string {
        const std::string value = other->count() > 0 ? other->results().back() : other->get_default_str();
        const bool met = need.words.empty() ? other->count() > 0 : std::ranges::find(need.words, value) != need.words.end();
        if (!met) throw Error(ErrorCode::InvalidInput, "has no effect without " + words, name);
        return {};
    };
    CLI::Option* const option = app.get_option(name);
    if (need.words.empty()) {
        option->needs(other);  // which the help says
    } else {
        option->description(option->get_description() + "; with " + words);
    }
    option->check(CLI::Validator(check, "", "only with"));
}

}  // namespace subvol::cli
