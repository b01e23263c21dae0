// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

namespace subvol::cli {

/// Breaks a text between words into lines of at most `width` characters of UTF-8. Lines after the first begin with `indent`
/// blanks, which count. Line breaks of the text stay.
[[nodiscard]] std::string wrapped(const std::string& text, std::size_t indent, std::size_t width);

/// The help in 80 columns: --help shows a verb's essential options, --help-all all of them under headings.
class Help : public CLI::FormatterBase {
public:
    void set_essentials(const std::string& verb, std::vector<std::string> options) { essentials_[verb] = std::move(options); }

    [[nodiscard]] std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;

private:
    [[nodiscard]] std::string essential_options(const CLI::App& verb) const;

    std::map<std::string, std::vector<std::string>> essentials_;
};

}  // namespace subvol::cli
