// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>
#include <algorithm>
#include <ostream>

#include "manual.h"
#include "subvol/model.h"
#include "text.h"

namespace subvol::cli {
namespace {

std::string with_spaces(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
    return out;
}

std::string model_names() {
    std::vector<std::string> names;
    for (const ModelInfo& model : list_models()) names.push_back(model.name);
    return with_spaces(names);
}

bool names_a_file(const Argument& argument) {
    return argument.value.find("FILE") != std::string::npos || argument.value == "IMAGE";
}

/// Fields are completed from the file that is named before on the line.
bool names_a_field(const Argument& argument) {
    return std::ranges::any_of(argument.names, [](const std::string& name) {
        return name == "--field" || name == "--fields" || name == "--color-field";
    });
}

/// Inside '…' of a shell; zsh's _arguments also wants [, ] and : escaped.
std::string quoted(const std::string& text, const std::string& escaped) {
    std::string out;
    for (const char c : text) {
        if (escaped.find(c) != std::string::npos) out += '\\';
        out += c == '\'' ? std::string("'\\''") : std::string(1, c);
    }
    return out;
}

/// '(-o --output)'{-o,--output}'[what it is]:FILE:_files'
std::string zsh_argument(const Argument& argument, const CLI::App& verb) {
    std::string action = argument.choices.empty() ? "" : "(" + with_spaces(argument.choices) + ")";
    if (names_a_file(argument)) action = "_files";
    if (argument.value == "DIR") action = "_files -/";
    if (names_a_field(argument)) action = "_subvol_fields";
    if (argument.positional) {
        const bool model = verb.get_name() == "model";
        if (model) action = "(" + model_names() + ")";
        if (argument.value == "FILE") action = "_subvol_input";
        return text("'", argument.repeatable ? "*" : "", ":", quoted(argument.value, ":"), ":", action, "'");
    }
    const std::string alternatives = join(argument.names);
    std::string out;
    if (argument.names.size() > 1 && !argument.repeatable) out += "'(" + with_spaces(argument.names) + ")'";
    if (argument.repeatable) out += "'*'";
    std::string names;
    for (const std::string& name : argument.names) names += (names.empty() ? "" : ",") + name;
    out += argument.names.size() > 1 ? "{" + names + "}" : names;
    out += "'[" + quoted(argument.description, "[]:") + "]";
    if (!argument.value.empty()) {
        out += (argument.value_optional ? "::" : ":") + quoted(argument.value, ":") + ":" + quoted(action, "");
    }
    return out + "'";
}

}  // namespace

void write_bash_completion(std::ostream& out, const CLI::App& program) {
    std::vector<std::string> verbs;
    for (const CLI::App* verb : verbs_of(program)) verbs.push_back(verb->get_name());
    out << "# Made by the build: subvol --generate bash\n"
           "_subvol_fields() { # of the first file on the line\n"
           "    local word\n"
           "    for word in \"${COMP_WORDS[@]:2}\"; do\n"
           "        [ -f \"$word\" ] || continue\n"
           "        SUBVOL_COMPLETION=1 \"${COMP_WORDS[0]}\" info \"$word\" --list-fields 2> /dev/null | grep -v ' '\n"
           "        return\n"
           "    done\n"
           "}\n"
           "_subvol() {\n"
           "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} words=\n"
           "    COMPREPLY=() # the rest is left to bash, which completes files\n"
           "    local models='"
        << model_names()
        << "'\n"
           "    if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
           "        words='"
        << with_spaces(verbs)
        << " help --help --version'\n"
           "    elif [ \"${COMP_WORDS[1]}\" = help ]; then\n"
           "        words='"
        << with_spaces(verbs)
        << "'\n"
           "    elif [ \"$before\" = : ] || [ \"$word\" = : ]; then # model:NAME, which bash splits into three words\n"
           "        words=$models\n"
           "        word=${word#:}\n"
           "    else\n"
           "        case \"${COMP_WORDS[1]} $before\" in\n";
    for (const CLI::App* verb : verbs_of(program)) {
        for (const Argument& argument : arguments_of(*verb)) {
            if (argument.positional || argument.value.empty()) continue;
            const std::string choices = with_spaces(argument.choices);
            const std::string action = names_a_field(argument) ? "words=$(_subvol_fields)"
                                       : choices.empty()       ? "return"
                                                               : "words='" + choices + "'";
            for (const std::string& name : argument.names)
                out << "            '" << verb->get_name() << ' ' << name << "') " << action << " ;;\n";
        }
    }
    out << "            *)\n"
           "                case \"${COMP_WORDS[1]}\" in\n";
    for (const CLI::App* verb : verbs_of(program)) {
        std::vector<std::string> names;
        for (const Argument& argument : arguments_of(*verb)) {
            if (!argument.positional) names.insert(names.end(), argument.names.begin(), argument.names.end());
        }
        out << "                    " << verb->get_name() << ") words='" << with_spaces(names) << "' ;;\n";
    }
    out << "                esac\n"
           "                case \"${COMP_WORDS[1]} $word\" in\n"
           "                    *' -'*) ;;\n"
           "                    'model '*) words=$models ;;\n"
           "                    *) return ;;\n"
           "                esac\n"
           "                ;;\n"
           "        esac\n"
           "    fi\n"
           "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$word\")\n"
           "}\n"
           "complete -o default -F _subvol subvol\n";
}

void write_zsh_completion(std::ostream& out, const CLI::App& program) {
    std::vector<std::string> verbs;
    for (const CLI::App* verb : verbs_of(program)) verbs.push_back(verb->get_name());
    out << "#compdef subvol\n"
           "# Made by the build: subvol --generate zsh\n"
           "_subvol_input() {\n"
           "    if compset -P 'model:'; then\n"
           "        compadd -- "
        << model_names()
        << "\n"
           "    else\n"
           "        _files\n"
           "    fi\n"
           "}\n"
           "_subvol_fields() { # of the first file on the line\n"
           "    local word\n"
           "    for word in ${words[2,-1]}; do\n"
           "        [[ -f $word ]] || continue\n"
           "        compadd -- ${(f)\"$(SUBVOL_COMPLETION=1 subvol info $word --list-fields 2> /dev/null)\"}\n"
           "        return\n"
           "    done\n"
           "}\n"
           "_subvol() {\n"
           "    local curcontext=$curcontext state line\n"
           "    local -a verbs\n"
           "    _arguments -C '(- *)--help[print help]' '(- *)--version[print the version]' '1:verb:->verb' "
           "'*::argument:->argument'\n"
           "    case $state in\n"
           "        verb)\n"
           "            verbs=(\n";
    for (const CLI::App* verb : verbs_of(program))
        out << "                '" << verb->get_name() << ":" << quoted(verb->get_description(), ":") << "'\n";
    out << "                'help:Everything about a verb'\n"
           "            )\n"
           "            _describe verb verbs\n"
           "            ;;\n"
           "        argument)\n"
           "            case $words[1] in\n";
    for (const CLI::App* verb : verbs_of(program)) {
        out << "                " << verb->get_name() << ")\n                    _arguments";
        for (const Argument& argument : arguments_of(*verb))
            out << " \\\n                        " << zsh_argument(argument, *verb);
        out << "\n                    ;;\n";
    }
    out << "                help)\n                    _arguments '1:verb:(" << with_spaces(verbs)
        << ")'\n                    ;;\n"
           "            esac\n"
           "            ;;\n"
           "    esac\n"
           "}\n"
           "_subvol \"$@\"\n";
}

}  // namespace subvol::cli
