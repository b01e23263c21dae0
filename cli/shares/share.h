// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "subvol/share.h"

namespace CLI {
class App;
}

namespace subvol::cli {

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
