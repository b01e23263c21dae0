// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "text_scanner.h"

namespace subvol::detail {

/// How the numbers of an EnSight file are written: as text, or as lines of 80 bytes and numbers of 32 bits, one after the other
/// (C) or each line and list as a record with its length before and behind it (Fortran).
enum class EnsightForm { Text, C, Fortran };

/// The lines and numbers of an EnSight file.
class EnsightData {
public:
    /// form: of a variable, that of the geometry; only geometries say what they are
    /// step: which of several steps in the file is read, from 0; nothing: the file is one step
    explicit EnsightData(const std::filesystem::path& path, std::optional<EnsightForm> form = {},
                         std::optional<std::size_t> step = {});
    EnsightData(const EnsightData&) = delete;
    EnsightData& operator=(const EnsightData&) = delete;

    [[nodiscard]] EnsightForm form() const { return form_; }
    [[nodiscard]] bool binary() const { return form_ != EnsightForm::Text; }
    [[nodiscard]] bool at_end();
    /// The next line without blanks around it.
    std::string line();
    /// The next line, which may be empty: what stands in the place of a description.
    std::string description();
    /// The next line that is not empty, in lower case.
    std::string keyword();
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
    void take_records();
    void take_step(std::size_t step);

    std::string name_, text_;
    TextScanner in_;
    EnsightForm form_ = EnsightForm::Text;
    bool has_order_ = false,
         in_line_ = false;  // in_line_: numbers of a text were read last, and the rest of their line is left
    std::endian order_ = std::endian::little;
};

}  // namespace subvol::detail
