// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace subvol {

enum class ErrorCode { InvalidInput, Io, MissingCapability, Cancelled };

/// The one exception of the library: bad input, I/O, a missing capability, a cancelled run.
///
/// where:   the file and line, or the entity, that is wrong; may be empty
/// allowed: what would be right; may be empty
/// what():  one sentence for users, "where: message (allowed)"
class Error : public std::runtime_error {
public:
    Error(ErrorCode code, const std::string& message, const std::string& where = {}, const std::string& allowed = {})
        : std::runtime_error((where.empty() ? "" : where + ": ") + message + (allowed.empty() ? "" : " (" + allowed + ")")),
          code_(code) {}

    [[nodiscard]] ErrorCode code() const noexcept { return code_; }

private:
    ErrorCode code_;
};

}  // namespace subvol
