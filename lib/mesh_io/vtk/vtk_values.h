// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "number_type.h"
#include "text_scanner.h"

namespace subvol::detail {

/// A data type of legacy VTK. bits: eight values a byte
struct VtkType {
    NumberType number = NumberType::Float64;
    bool bits = false;
};

/// The values of legacy VTK: words of the text, or in a BINARY file big-endian numbers between its lines.
///
/// Keywords, names and counts are text in both; they are read from the scanner, and the values that follow them from here.
class VtkValues {
public:
    explicit VtkValues(TextScanner& in) : in_(in) {}

    void set_binary();
    [[nodiscard]] bool binary() const { return binary_; }

    /// Reads the word for a data type; refuses any other.
    VtkType read_type(const std::string& what);

    /// Values of this type begin here: in a BINARY file behind the end of the line.
    void begin(VtkType type);
    /// The same for values to be read as integers.
    void begin_integers(VtkType type, const std::string& what);

    double real(const Place& place);
    std::int64_t integer(const Place& place);
    /// As TextScanner::count.
    std::size_t count(const Place& place);
    /// Passes over so many values, where they begin.
    void skip(std::size_t values, const std::string& what);
    /// Passes over so many texts, where they begin.
    void skip_texts(std::size_t texts, const std::string& what);

    /// How many values the rest of the file can hold at most.
    [[nodiscard]] std::size_t room() const;
    [[nodiscard]] std::size_t position() const { return in_.position(); }

private:
    std::int64_t bit(const Place& place);
    void skip_text(const Place& place);

    TextScanner& in_;
    VtkType type_;
    bool binary_ = false;
    std::size_t bits_read_ = 0;
    unsigned char bits_ = 0;
};

}  // namespace subvol::detail
