// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <filesystem>
#include <string>
#include <vector>

#include "text_scanner.h"

namespace subvol::detail {

/// The lines and numbers of an EnSight Gold file: of text, or of C's binary files with lines of 80 bytes and 32-bit numbers.
class EnsightData {
public:
    /// binary: of a variable, whether the geometry is; only geometries say what they are
    explicit EnsightData(const std::filesystem::path& path, bool binary = false);
    EnsightData(const EnsightData&) = delete;
    EnsightData& operator=(const EnsightData&) = delete;

    [[nodiscard]] bool binary() const { return binary_; }
    [[nodiscard]] bool at_end();
    /// The next line without blanks around it.
    std::string line();
    /// The number of a part or a count. The first one shows the byte order of the file.
    std::int64_t integer(const std::string& what);
    std::size_t count(const std::string& what);
    std::vector<std::int64_t> integers(std::size_t count, const std::string& what);
    std::vector<double> reals(std::size_t count, const std::string& what);

    [[nodiscard]] const TextScanner& in() const { return in_; }
    /// The place of the last line or number, for messages.
    [[nodiscard]] std::string place() const { return in_.place_of(in_.position()); }
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const { in_.fail(message, allowed); }

private:
    void expect_room(std::size_t count, const std::string& what) const;

    std::string name_, text_;
    TextScanner in_;
    bool binary_ = false, has_order_ = false;
    std::endian order_ = std::endian::little;
};

}  // namespace subvol::detail
