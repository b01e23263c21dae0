// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "subvol/error.h"

namespace subvol::detail {

/// Several mistakes in one input, said together. what() has a line for each of the first of them.
class SeveralErrors : public Error {
public:
    /// where: the input; the places in it, "where: PLACE", are shown without it
    SeveralErrors(const std::string& where, std::vector<Error> all);

    [[nodiscard]] const std::vector<Error>& all() const noexcept { return all_; }
    /// How many there are, one for each of the first, and how many more. No line has control characters.
    [[nodiscard]] const std::vector<std::string>& lines() const noexcept { return lines_; }

private:
    SeveralErrors(std::vector<Error> all, std::vector<std::string> lines);

    std::vector<Error> all_;
    std::vector<std::string> lines_;
};

/// Collects mistakes while an input is read part by part.
class Mistakes {
public:
    /// Reads a part, and keeps what is wrong with it. returns: whether nothing was
    template <class Read>
    bool none_in(const Read& read) {
        try {
            read();
            return true;
        } catch (const SeveralErrors& several) {
            all_.insert(all_.end(), several.all().begin(), several.all().end());
        } catch (const Error& error) {
            if (error.code() != ErrorCode::InvalidInput) throw;
            all_.push_back(error);
        }
        return false;
    }

    [[nodiscard]] bool empty() const { return all_.empty(); }

    /// where:  as of SeveralErrors
    /// throws: the mistake, if one was kept; SeveralErrors if they are more
    void check(const std::string& where = {}) const {
        if (all_.size() > 1) throw SeveralErrors(where, all_);
        if (!all_.empty()) throw Error(all_.front());
    }

private:
    std::vector<Error> all_;
};

}  // namespace subvol::detail
