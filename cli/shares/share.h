// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>
#include <utility>

namespace CLI {
class App;
}

namespace subvol::cli {

/// One of several shares of the work of a verb.
///
/// part: from 1 to `of`
struct Share {
    int part = 1, of = 1;

    [[nodiscard]] bool whole() const { return of == 1; }

    /// The first of so many things that is the share's, and the first that is not: all shares together have each once.
    [[nodiscard]] std::pair<std::size_t, std::size_t> range(std::size_t things) const;

    /// "2/4"
    [[nodiscard]] std::string name() const;
};

/// "2/4" is the second of four shares.
///
/// option: named in the error
/// throws: Error(InvalidInput) unless it is K/N with K from 1 to N
[[nodiscard]] Share parse_share(const std::string& option, const std::string& text);

/// The option --part K/N of a verb.
class ShareArgument {
public:
    /// does: what a share is, for the help
    void add_to(CLI::App& app, const std::string& does);

    [[nodiscard]] bool given() const { return !text_.empty(); }

    /// The whole work if the option was not given.
    ///
    /// throws: Error(InvalidInput) as `parse_share`
    [[nodiscard]] Share share() const;

private:
    std::string text_;
};

}  // namespace subvol::cli
