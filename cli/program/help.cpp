// SPDX-License-Identifier: Apache-2.0
#include "help.h"

#include <algorithm>
#include <sstream>

#include "manual.h"
#include "text.h"

namespace subvol::cli {
namespace {

constexpr std::size_t kWidth = 80;
constexpr std::size_t kColumn = 24;  // where descriptions begin

std::size_t width_of(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count_if(text, [](char c) { return (c & 0xC0) != 0x80; }));
}

/// "  left    right", the right part wrapped within its column; on lines of its own if the left part is too long.
std::string entry(const std::string& left, const std::string& right) {
    const std::size_t width = width_of(left) + 2;
    const std::string gap = width + 2 > kColumn ? "\n" + std::string(kColumn, ' ') : std::string(kColumn - width, ' ');
    return "  " + left + gap + wrapped(right, kColumn, kWidth) + "\n";
}

/// "INT in [1 - 64]" as "1 to 64".
std::string range_words(const Argument& argument) {
    const std::size_t begin = argument.range.find('['), dash = argument.range.find(" - "), end = argument.range.find(']');
    if (begin == std::string::npos || dash == std::string::npos || end == std::string::npos) return {};
    return argument.range.substr(begin + 1, dash - begin - 1) + " to " + argument.range.substr(dash + 3, end - dash - 3);
}

std::string names_of(const Argument& argument) {
    std::string left = join(argument.names);
    if (argument.positional) return argument.value;
    if (argument.value.empty()) return left;
    return left + " " + (argument.value_optional ? "[" + argument.value + "]" : argument.value);
}

std::string argument_entry(const Argument& argument, bool in_full) {
    std::string words = argument.description;
    if (in_full) {
        if (const std::string range = range_words(argument); !range.empty()) words += "; " + range;
        if (!argument.needs.empty()) words += "; with " + join(argument.needs);
        if (!argument.excludes.empty()) words += "; not with " + join(argument.excludes);
    }
    return entry(names_of(argument), words);
}

std::string usage_of(const CLI::App& verb) {
    std::string usage = "Usage: subvol " + verb.get_name();
    for (const Argument& argument : arguments_of(verb, "Positionals")) {
        const std::string name = argument.value + (argument.repeatable ? "…" : "");
        usage += argument.required ? " " + name : " [" + name + "]";
    }
    for (const Argument& argument : arguments_of(verb)) {
        if (!argument.positional && argument.required) usage += " " + argument.names.front() + " " + argument.value;
    }
    return usage + " [options]\n";
}

/// Paragraphs as they are, but those without indented lines are wrapped.
std::string footer_of(const CLI::App& app) {
    std::string rest = app.get_footer(), footer;
    while (!rest.empty()) {
        const std::size_t end = rest.find("\n\n");
        const std::string paragraph = rest.substr(0, end);
        footer += "\n" + (paragraph.find("\n ") == std::string::npos ? wrapped(paragraph, 0, kWidth) : paragraph) + "\n";
        rest = end == std::string::npos ? "" : rest.substr(end + 2);
    }
    return footer;
}

std::string help_of_program(const CLI::App& program) {
    std::string help = wrapped(program.get_description(), 0, kWidth) + "\n\nUsage: subvol VERB [arguments]\n\nVerbs:\n";
    for (const CLI::App* verb : verbs_of(program)) help += entry(verb->get_name(), verb->get_description());
    help += entry("help VERB", "Show the help of a command.");
    help += "\nOptions:\n";
    for (const Argument& argument : arguments_of(program)) help += argument_entry(argument, false);
    return help + footer_of(program);
}

std::string positionals_of(const CLI::App& verb, bool in_full) {
    std::string words;
    for (const Argument& argument : arguments_of(verb, "Positionals")) words += argument_entry(argument, in_full);
    return words.empty() ? words : "\n" + words;
}

std::string all_options(const CLI::App& verb) {
    std::string words;
    for (const std::string& group : groups_of(verb)) {
        const auto arguments = arguments_of(verb, group);
        if (arguments.empty()) continue;
        words += "\n" + group + ":\n";
        for (const Argument& argument : arguments) words += argument_entry(argument, true);
    }
    return words;
}

}  // namespace

std::string wrapped(const std::string& text, std::size_t indent, std::size_t width) {
    std::string out, line;
    const auto end_line = [&] {
        out += line;
        line.clear();
    };
    std::istringstream lines(text);
    bool first = true;
    for (std::string given; std::getline(lines, given);) {
        if (!first) {
            end_line();
            out += "\n" + std::string(indent, ' ');
        }
        first = false;
        std::istringstream words(given);
        for (std::string word; words >> word;) {
            if (!line.empty() && indent + width_of(line) + 1 + width_of(word) > width) {
                end_line();
                out += "\n" + std::string(indent, ' ');
            }
            line += (line.empty() ? "" : " ") + word;
        }
    }
    end_line();
    return out;
}

std::string Help::essential_options(const CLI::App& verb) const {
    const auto known = essentials_.find(verb.get_name());
    const bool own = known == essentials_.end() || known->second.empty();
    std::string words;
    std::size_t hidden = 0;
    for (const std::string& group : groups_of(verb)) {
        for (const Argument& argument : arguments_of(verb, group)) {
            const auto listed = [&](const std::string& name) {
                return std::ranges::find(known->second, name) != known->second.end();
            };
            const bool shown = own ? group == "Options" : std::ranges::any_of(argument.names, listed) || argument.required;
            const bool help = argument.names.back() == "--help" || argument.names.back() == "--help-all";
            if (shown && !help) {
                words += argument_entry(argument, false);
            } else if (!help) {
                ++hidden;
            }
        }
    }
    return "\nOptions:\n" + words + entry("--help-all", text("all options: ", hidden, " more, such as --json and --quiet"));
}

std::string Help::make_help(const CLI::App* app, std::string /*name*/, CLI::AppFormatMode mode) const {
    if (app->get_parent() == nullptr) return help_of_program(*app);
    const bool all = mode == CLI::AppFormatMode::All;
    return wrapped(app->get_description(), 0, kWidth) + "\n\n" + usage_of(*app) + positionals_of(*app, all) +
           (all ? all_options(*app) : essential_options(*app)) + footer_of(*app);
}

}  // namespace subvol::cli
