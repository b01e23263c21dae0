// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace subvol::cli {

/// What `subvol --generate` can write: from the argument table, and the table of methods and options for docs/pictures.md.
inline const std::vector<std::string> kManuals{"man", "bash", "zsh", "methods"};

/// The manual page subvol(1), in man's macros. Its date is that of SOURCE_DATE_EPOCH, else today.
void write_man_page(std::ostream& out, const CLI::App& program);

/// Completion of verbs, options and values for bash.
void write_bash_completion(std::ostream& out, const CLI::App& program);

/// The same for zsh.
void write_zsh_completion(std::ostream& out, const CLI::App& program);

/// One of `kManuals`.
void write_manual(std::ostream& out, const std::string& kind, const CLI::App& program);

/// An option as the manuals see it.
struct Argument {
    std::vector<std::string> names;  ///< "-o", "--output"; of a positional argument its name
    std::string value;               ///< the name of its value, as "FILE"; empty for a flag
    std::string range;               ///< the allowed values, as "INT in [1 - 64]"; empty: all
    std::vector<std::string> choices;
    std::string description;
    bool positional = false, required = false, repeatable = false, value_optional = false;
    std::vector<std::string> excludes, needs;
};

/// The visible arguments of a verb in one of the help's groups ("Options", "Positionals"), in its order.
[[nodiscard]] std::vector<Argument> arguments_of(const CLI::App& verb, const std::string& group);

/// Those of all groups.
[[nodiscard]] std::vector<Argument> arguments_of(const CLI::App& verb);

/// The headings of a verb's options, its own "Options" first, those of all verbs last.
[[nodiscard]] std::vector<std::string> groups_of(const CLI::App& verb);

[[nodiscard]] std::vector<const CLI::App*> verbs_of(const CLI::App& program);

}  // namespace subvol::cli
