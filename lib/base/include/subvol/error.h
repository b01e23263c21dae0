// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>
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
          code_(code),
          where_size_(where.size()),
          allowed_size_(allowed.size()) {}

    [[nodiscard]] ErrorCode code() const noexcept { return code_; }

    /// Parts of what(): they live as long as the error.
    [[nodiscard]] std::string_view where() const noexcept { return std::string_view(what(), where_size_); }
    [[nodiscard]] std::string_view allowed() const noexcept {
        const std::string_view text(what());
        if (allowed_size_ == 0 || text.size() <= allowed_size_) return {};
        return {text.data() + text.size() - 1 - allowed_size_, allowed_size_};
    }

private:
    ErrorCode code_;
    std::size_t where_size_;
    std::size_t allowed_size_;
};

}  // namespace subvol
