// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "subvol/detail/number_type.h"
#include "subvol/detail/text_scanner.h"

namespace subvol::detail {

/// A data type of legacy VTK.
struct VtkType {
    NumberType number = NumberType::Float64;
    bool bits = false;  ///< eight values in each byte
};

/// Reads the values of a legacy VTK file: words of the text or, in a BINARY file, big-endian numbers between its lines.
///
/// Keywords, names and counts are always text. They are read from the scanner, the values after them from here.
class VtkValues {
public:
    explicit VtkValues(TextScanner& in) : in_(in) {}

    void set_binary();
    [[nodiscard]] bool binary() const { return binary_; }

    /// Reads the name of a data type.
    VtkType read_type(const std::string& what);

    /// To be called before values of this type: in a BINARY file they begin after the end of the line.
    void begin(VtkType type);
    /// The same for values that are read as integers.
    void begin_integers(VtkType type, const std::string& what);

    double real(const Place& place);
    std::int64_t integer(const Place& place);
    /// An integer checked as by TextScanner::count.
    std::size_t count(const Place& place);
    /// Skips so many values.
    void skip(std::size_t values, const std::string& what);
    /// Skips so many texts.
    void skip_texts(std::size_t texts, const std::string& what);

    /// An upper bound for how many values are left in the file.
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

/// Skips the lines after the word METADATA, up to an empty one.
void skip_metadata(TextScanner& in);

/// Reads the arrays of legacy VTK: the sections after POINT_DATA and CELL_DATA, and FIELD anywhere.
class VtkArrayReader {
public:
    VtkArrayReader(TextScanner& in, VtkValues& values, MeshFile& found) : in_(in), values_(values), found_(found) {}

    /// Reads the section whose keyword (in capitals) was the last word, if it has arrays.
    ///
    /// returns: whether it has
    bool read_section(const std::string& keyword);

    /// To be called at POINT_DATA or CELL_DATA.
    ///
    /// tuples: of each array that follows, as the file announces them
    /// wrong:  why the arrays are left out; empty: they are read
    void start_data(bool at_cells, std::size_t tuples, std::string wrong = {});

    /// Whether the arrays that follow are left out, since there are other points or cells than they are for.
    [[nodiscard]] bool leaves_out() const { return !wrong_.empty(); }

private:
    void read_scalars();
    void read_attribute(const std::string& keyword, std::size_t components);
    void read_colors();
    void read_texture_coordinates();
    void read_field();
    void read_field_array();
    void read_lookup_table();
    void read_values(const std::string& name, VtkType type, std::size_t components);
    void skip_values(const std::string& name, VtkType type, std::size_t values);

    TextScanner& in_;
    VtkValues& values_;
    MeshFile& found_;
    bool in_data_ = false;
    bool at_cells_ = false;
    std::size_t tuples_ = 0;
    std::string wrong_;  // why the arrays that follow are left out
};

}  // namespace subvol::detail
