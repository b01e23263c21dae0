// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mesh_file.h"
#include "vtk_values.h"

namespace subvol::detail {

/// Skips what follows the word METADATA: the lines up to an empty one.
void skip_metadata(TextScanner& in);

/// The arrays of legacy VTK: the sections behind POINT_DATA and CELL_DATA, and FIELD anywhere.
class VtkArrayReader {
public:
    VtkArrayReader(TextScanner& in, VtkValues& values, MeshFile& found) : in_(in), values_(values), found_(found) {}

    /// Reads the section whose keyword (in capitals) was the last word, if it is one of arrays.
    ///
    /// returns: whether it was
    bool read_section(const std::string& keyword);

    /// The arrays that follow have one tuple a point, or one a cell.
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
