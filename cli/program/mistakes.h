// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "subvol/error.h"

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace subvol::cli {

/// For a mistyped verb the list of verbs is more helpful than the parser's words.
///
/// throws: Error(InvalidInput) if there is no verb, or an unknown one
void check_verb(const CLI::App& program, const std::vector<std::string>& arguments);

/// What the parser found wrong, as a sentence that names the option, what would be right, and the verb's own help.
[[nodiscard]] Error explained(const CLI::App& program, const CLI::ParseError& error);

/// The same of an error of our own: an unknown option on the line says more than what it leaves wrong.
[[nodiscard]] Error explained(const CLI::App& program, const Error& error);

/// An error as the JSON object that --json prints: {"error": {code, what, where, allowed}}. code: the program's exit code
///
/// all: its parts, if it is of several mistakes; they are listed under "mistakes"
[[nodiscard]] std::string error_json(const Error& error, int code, std::span<const Error> all = {});

}  // namespace subvol::cli
