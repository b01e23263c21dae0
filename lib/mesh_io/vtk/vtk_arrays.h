// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "vtk_values.h"

namespace subvol::detail {

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

    /// To be called at POINT_DATA or CELL_DATA. tuples: of each array that follows
    void start_data(bool at_cells, std::size_t tuples);

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
};

}  // namespace subvol::detail
