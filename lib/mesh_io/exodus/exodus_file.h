// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "netcdf_source.h"

namespace subvol::detail {

/// An Exodus II file: dimensions, and variables over them, by name. Every failure is an Error(InvalidInput).
///
/// No more values are asked for than the file's bytes can hold.
class ExodusFile {
public:
    /// bytes, file: must outlive it
    ExodusFile(std::string_view bytes, std::string_view file);

    /// The length of a dimension; 0 if there is none of that name.
    [[nodiscard]] std::size_t dimension(const std::string& name) const;
    [[nodiscard]] bool has(const std::string& variable) const { return source_->variables.contains(variable); }

    /// The values at given places along the first dimensions of a variable. count: how many there have to be
    [[nodiscard]] std::vector<double> reals(const std::string& variable, const std::vector<std::size_t>& places,
                                            std::size_t count) const;
    /// All values of a variable of integers.
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& variable, std::size_t count) const;
    /// Rows of characters as texts, so many, without the blanks behind them.
    [[nodiscard]] std::vector<std::string> names(const std::string& variable, std::size_t count) const;
    /// An attribute of a variable; empty if there is no such text.
    [[nodiscard]] std::string attribute(const std::string& variable, const std::string& name) const;

    /// Fails if the file cannot hold so many things of some bytes each.
    void expect_room(std::size_t things, std::size_t bytes, const std::string& what) const;

    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;

private:
    /// The variable, if it has so many values at these places.
    [[nodiscard]] const NetcdfVariable& checked(const std::string& name, const std::vector<std::size_t>& places,
                                                std::size_t count) const;

    std::string_view bytes_;
    std::string_view file_;
    std::unique_ptr<NetcdfSource> source_;
};

}  // namespace subvol::detail
