// SPDX-License-Identifier: Apache-2.0
#include "mistakes.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <optional>

#include "manual.h"
#include "subvol/detail/error_text.h"
#include "subvol/detail/near_name.h"
#include "subvol/detail/printable.h"
#include "text.h"

namespace subvol::cli {
namespace {

const CLI::App* parsed_verb(const CLI::App& program) {
    for (const CLI::App* verb : verbs_of(program)) {
        if (verb->parsed()) return verb;
    }
    return nullptr;
}

std::vector<std::string> option_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const Argument& argument : arguments_of(app)) {
        if (argument.positional) continue;
        names.insert(names.end(), argument.names.begin(), argument.names.end());
    }
    return names;
}

std::string help_hint(const CLI::App* verb) {
    return verb ? "see subvol " + verb->get_name() + " --help" : "see subvol --help";
}

/// The verbs that have the option; else near names; else the options that begin as the given one does.
std::string proposal(const CLI::App& program, const CLI::App& verb, const std::string& given) {
    constexpr std::size_t kMostOffered = 4;
    const std::vector<std::string> names = option_names(verb);
    std::vector<std::string> longer, elsewhere;
    for (const CLI::App* other : verbs_of(program)) {
        const std::vector<std::string> its = option_names(*other);
        if (std::ranges::find(its, given) != its.end()) elsewhere.push_back(other->get_name());
    }
    if (!elsewhere.empty()) return "; it is one of " + join(elsewhere);
    if (const std::string near = detail::did_you_mean(given, names); !near.empty()) return near;
    std::ranges::copy_if(names, std::back_inserter(longer), [&](const auto& name) { return name.starts_with(given); });
    if (given.size() > 3 && !longer.empty() && longer.size() <= kMostOffered) return ": did you mean " + join(longer) + "?";
    return {};
}

/// What the parser could not place: an unknown option, or a word too many. That says more than what is missing because of it.
void check_extras(const CLI::App& program, const CLI::App& verb) {
    const std::vector<std::string> extras = verb.remaining();
    const auto option = std::ranges::find_if(extras, [](const std::string& word) { return word.size() > 1 && word[0] == '-'; });
    if (option != extras.end()) {
        const std::string name = option->substr(0, option->find('='));
        throw Error(ErrorCode::InvalidInput, verb.get_name() + " has no such option" + proposal(program, verb, name), name,
                    help_hint(&verb));
    }
    if (!extras.empty()) {
        throw Error(ErrorCode::InvalidInput, "'" + extras.front() + "' is one argument too many", verb.get_name(),
                    help_hint(&verb));
    }
}

/// "-o IMAGE" of "--output"; "FILE" of a positional argument.
std::string usage_name(const CLI::App& verb, const std::string& name) {
    for (const Argument& argument : arguments_of(verb)) {
        if (std::ranges::find(argument.names, name) == argument.names.end()) continue;
        return argument.positional ? argument.value : argument.names.front() + " " + argument.value;
    }
    return name;
}

/// "OPTION: words (allowed)", which our own checks of values say, in its parts.
Error of_an_option(const std::string& message) {
    const std::size_t colon = message.find(": "), open = message.rfind(" (");
    if (colon == std::string::npos) return {ErrorCode::InvalidInput, message};
    const std::string option = message.substr(0, colon);
    if (open == std::string::npos || open < colon || message.back() != ')')
        return {ErrorCode::InvalidInput, message.substr(colon + 2), option};
    return {ErrorCode::InvalidInput, message.substr(colon + 2, open - colon - 2), option,
            message.substr(open + 2, message.size() - open - 3)};
}

/// Options that need or exclude each other, as the command was given them.
std::optional<Error> conflict_of(const CLI::App& verb) {
    for (const CLI::Option* option : verb.get_options()) {
        if (option->count() == 0) continue;
        for (const CLI::Option* other : option->get_needs()) {
            if (other->count() == 0)
                return Error(ErrorCode::InvalidInput, "has no effect without " + other->get_name(), option->get_name());
        }
        for (const CLI::Option* other : option->get_excludes()) {
            if (other->count() > 0)
                return Error(ErrorCode::InvalidInput, "cannot be given together with " + other->get_name(), option->get_name());
        }
    }
    return std::nullopt;
}

}  // namespace

void check_verb(const CLI::App& program, const std::vector<std::string>& arguments) {
    std::vector<std::string> known;
    for (const CLI::App* verb : verbs_of(program)) known.push_back(verb->get_name());
    if (arguments.empty()) throw Error(ErrorCode::InvalidInput, "a verb is needed: " + join(known), {}, "see subvol --help");
    const std::string& given = arguments.front();
    if (given.starts_with('-') || std::ranges::find(known, given) != known.end()) return;
    throw Error(ErrorCode::InvalidInput, "'" + given + "' is not a verb" + detail::did_you_mean(given, known), {}, join(known));
}

Error explained(const CLI::App& program, const CLI::ParseError& error) {
    const CLI::App* verb = parsed_verb(program);
    const std::string message = error.what();
    if (!verb) {
        const auto extras = program.remaining();
        if (extras.empty()) return {ErrorCode::InvalidInput, message, {}, help_hint(nullptr)};
        const std::string near = detail::did_you_mean(extras.front(), option_names(program));
        return {ErrorCode::InvalidInput, "there is no such option" + near, extras.front(), help_hint(nullptr)};
    }
    try {
        check_extras(program, *verb);
    } catch (const Error& extra) {
        return extra;
    }
    const bool missing = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    for (const CLI::Option* option : verb->get_options()) {
        if (!missing || !option->get_required() || option->count() > 0) continue;
        return {ErrorCode::InvalidInput, usage_name(*verb, option->get_name()) + " is needed", verb->get_name(),
                help_hint(verb)};
    }
    const bool in_conflict = dynamic_cast<const CLI::RequiresError*>(&error) != nullptr ||
                             dynamic_cast<const CLI::ExcludesError*>(&error) != nullptr;
    if (const auto conflict = in_conflict ? conflict_of(*verb) : std::nullopt) return *conflict;
    if (dynamic_cast<const CLI::ValidationError*>(&error) != nullptr) return of_an_option(message);
    return {ErrorCode::InvalidInput, message, {}, help_hint(verb)};
}

Error explained(const CLI::App& program, const Error& error) {
    if (const CLI::App* verb = parsed_verb(program)) check_extras(program, *verb);
    return error;
}

std::string error_json(const Error& error, int code) {
    nlohmann::ordered_json json;
    const auto part = [](const std::string& text) { return detail::printable_message(detail::error_sentence({}, text, {})); };
    json["error"] = {{"code", code},
                     {"what", part(error.message())},
                     {"where", detail::printable_message(error.where())},
                     {"allowed", detail::printable_message(error.allowed())}};
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace subvol::cli
