// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/detail/text_scanner.h"

namespace subvol::detail {

/// How the numbers of an EnSight file are written: as text, or as lines of 80 bytes and numbers of 32 bits, one after the other
/// (C) or each line and list as a record with its length before and behind it (Fortran).
enum class EnsightForm { Text, C, Fortran };

/// The number of nodes of an element; 0 if the type is unknown or has any number of them.
[[nodiscard]] std::size_t nodes_of_ensight(std::string_view type);

/// The lines and numbers of an EnSight file.
class EnsightData {
public:
    /// form: of a variable, that of the geometry; only geometries say what they are
    /// step: which of several steps in the file is read, from 0; nothing: the file is one step
    explicit EnsightData(const std::filesystem::path& path, std::optional<EnsightForm> form = {},
                         std::optional<std::size_t> step = {});
    /// The bytes of a file of Gold, binary and in this machine's byte order. name: for messages
    EnsightData(std::string gold, const std::string& name);
    EnsightData(const EnsightData&) = delete;
    EnsightData& operator=(const EnsightData&) = delete;

    [[nodiscard]] EnsightForm form() const { return form_; }
    [[nodiscard]] bool binary() const { return form_ != EnsightForm::Text; }
    /// The order of bytes that the file was found to have, and that of another file for this one.
    [[nodiscard]] std::endian order() const { return order_; }
    void set_order(std::endian order);
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
    /// The same in columns of a fixed width, as texts of version 6 have them, with no blanks between where the numbers are
    /// wide.
    std::vector<std::int64_t> column_integers(std::size_t count, const std::string& what);
    std::vector<double> column_reals(std::size_t count, const std::string& what);
    /// Reads a line "node id given" and returns its last word.
    std::string kind_of_ids(const std::string& owner);

    [[nodiscard]] const TextScanner& in() const { return in_; }
    /// The place of the last line or number, for messages.
    [[nodiscard]] std::string place() const { return in_.place_of(in_.position()); }
    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const { in_.fail(message, allowed); }

private:
    void expect_room(std::size_t count, const std::string& what) const;
    std::string_view column(std::size_t width, const std::string& what, bool of_reals);
    void find_order(std::string_view bytes);
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
