// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "netcdf_source.h"

namespace subvol::detail {

/// An Exodus II file: dimensions and variables over them, by name. Every failure is an Error(InvalidInput).
///
/// Never reads more values than the size of the file allows.
class ExodusFile {
public:
    /// bytes: of the file; file: its path. Both must outlive it. HDF5's library reads the file itself.
    ExodusFile(std::string_view bytes, std::string_view file);

    /// The length of a dimension; 0 if there is no dimension of that name.
    [[nodiscard]] std::size_t dimension(const std::string& name) const;
    [[nodiscard]] bool has(const std::string& variable) const { return source_->variables.contains(variable); }

    /// The values at given places along the first dimensions of a variable. count: their expected number
    [[nodiscard]] std::vector<double> reals(const std::string& variable, const std::vector<std::size_t>& places,
                                            std::size_t count) const;
    /// All values of a variable of integers.
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& variable, std::size_t count) const;
    /// The rows of characters of a variable as texts, without trailing blanks. count: their expected number
    [[nodiscard]] std::vector<std::string> names(const std::string& variable, std::size_t count) const;
    /// A text attribute of a variable; empty if there is none.
    [[nodiscard]] std::string attribute(const std::string& variable, const std::string& name) const;

    /// Fails if the file is too short for so many things of so many bytes each.
    void expect_room(std::size_t things, std::size_t bytes, const std::string& what) const;

    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;

private:
    /// The variable; fails unless it has so many values at these places.
    [[nodiscard]] const NetcdfVariable& checked(const std::string& name, const std::vector<std::size_t>& places,
                                                std::size_t count) const;

    std::string_view bytes_;
    std::string_view file_;
    std::unique_ptr<NetcdfSource> source_;
};

}  // namespace subvol::detail
