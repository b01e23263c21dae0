#include <algorithm>
#include <map>

#include "mesh_file.h"
#include "subvol/error.h"
#include "vtk_arrays.h"

namespace subvol {

namespace {

constexpr Wording kWording{"point", "cell", 0};

constexpr std::int64_t kTetrahedron = 10;
constexpr std::int64_t kVoxel = 11;
constexpr std::int64_t kHexahedron = 12;

const std::map<std::int64_t, std::array<std::string_view, 2>> kCellNames{
    {1, {"vertex", "vertices"}},
    {2, {"vertex cell", "vertex cells"}},
    {3, {"line", "lines"}},
    {4, {"polyline", "polylines"}},
    {5, {"triangle", "triangles"}},
    {7, {"polygon", "polygons"}},
    {8, {"pixel", "pixels"}},
    {9, {"quad", "quads"}},
    {10, {"tetrahedron", "tetrahedra"}},
    {13, {"wedge", "wedges"}},
    {14, {"pyramid", "pyramids"}},
    {24, {"quadratic tetrahedron", "quadratic tetrahedra"}},
    {25, {"quadratic hexahedron", "quadratic hexahedra"}},
    {42, {"polyhedron", "polyhedra"}}};

class VtkReader {
public:
    VtkReader(std::string_view text, std::string_view file)
        : in_(text, file, TextScanner::Comments::None), file_(file), arrays_(in_, found_) {}

    ReadResult read() {
        read_header();
        while (!in_.at_end()) {
            const std::string_view word = in_.word();
            const std::string keyword = upper_case(word);
            if (!read_section(keyword) && !arrays_.read_section(keyword)) {
                in_.fail("a keyword is expected, not " + in_quotes(word));
            }
        }
        choose_hexes();
        return finish(std::move(found_), in_, file_, kWording);
    }

private:
    void read_header() {
        TextScanner whole = in_;
        if (whole.at_end()) in_.fail("the file is empty");
        const std::string_view first = in_.line();
        if (!upper_case(first).starts_with("# VTK DATAFILE VERSION")) {
            in_.fail("not a legacy VTK file: it begins with " + in_quotes(first), "# vtk DataFile Version is missing");
        }
        in_.line();  // the title may be anything, in any encoding
        const std::string encoding = upper_case(in_.word());
        if (encoding == "BINARY") in_.fail("BINARY legacy VTK is not supported yet", "ASCII is");
        if (encoding != "ASCII") in_.fail_word({"encoding"}, "ASCII or BINARY", encoding);
        if (upper_case(in_.peek()) == "FIELD") {
            in_.word();
            arrays_.read_section("FIELD");
        }
        const std::string_view dataset = in_.word();
        if (upper_case(dataset) != "DATASET") in_.fail_word({"dataset"}, "DATASET", dataset);
        const std::string type = upper_case(in_.word());
        if (type == "POLYDATA") in_.fail("POLYDATA is not a volume mesh", "UNSTRUCTURED_GRID is needed");
        if (type != "UNSTRUCTURED_GRID") {
            in_.fail("DATASET " + in_quotes(type) + " is not supported yet", "UNSTRUCTURED_GRID is");
        }
    }

    bool read_section(const std::string& keyword) {
        if (keyword == "POINTS") {
            read_points();
        } else if (keyword == "CELLS") {
            read_cells();
        } else if (keyword == "CELL_TYPES") {
            read_cell_types();
        } else if (keyword == "POINT_DATA") {
            start_data(false, found_.points.size(), "points");
        } else if (keyword == "CELL_DATA") {
            start_data(true, cell_count(), "cells");
        } else if (keyword == "METADATA") {
            skip_metadata(in_);
        } else {
            return false;
        }
        return true;
    }

    void read_points() {
        if (!found_.points.empty()) in_.fail("there is a second POINTS section");
        const std::size_t count = in_.count({"POINTS"});
        arrays_.read_type("POINTS");
        found_.points.reserve(std::min(count, in_.room_for(3)));
        for (std::size_t p = 0; p < count; ++p) read_point(in_, found_, kWording, 0);
    }

    [[nodiscard]] std::size_t cell_count() const { return offsets_.size() - 1; }

    void read_cells() {
        if (cell_count() > 0) in_.fail("there is a second CELLS section");
        const std::size_t first = in_.count({"CELLS"});
        const std::size_t second = in_.count({"CELLS"});
        if (upper_case(in_.peek()) == "OFFSETS") {
            read_offsets_and_connectivity(first, second);
        } else {
            read_counted_cells(first, second);
        }
    }

    // Up to version 4: each cell as the number of its corners and the corners. size: how many numbers these are in all
    void read_counted_cells(std::size_t count, std::size_t size) {
        offsets_.reserve(std::min(count, in_.room_for(1)) + 1);
        connectivity_.reserve(std::min(size, in_.room_for(1)));
        std::size_t left = size;
        for (std::size_t c = 0; c < count; ++c) {
            const auto number = static_cast<std::int64_t>(c);
            const std::size_t corners = in_.count({"corners of cell", number});
            if (corners >= left) {
                in_.fail("cell " + std::to_string(c) + " does not fit into the " + std::to_string(size) +
                         " numbers that CELLS announces");
            }
            left -= corners + 1;
            for (std::size_t k = 0; k < corners; ++k) read_corner(c, k == 0);
            offsets_.push_back(connectivity_.size());
        }
        if (left > 0) {
            in_.fail("CELLS announces " + std::to_string(size) + " numbers, " + std::to_string(left) +
                     " more than its cells have");
        }
    }

    // From version 5 on: where each cell begins in the list of corners, and the list.
    void read_offsets_and_connectivity(std::size_t offset_count, std::size_t size) {
        in_.word();
        arrays_.read_type("OFFSETS");
        std::vector<std::size_t> offsets;
        offsets.reserve(std::min(offset_count, in_.room_for(1)));
        for (std::size_t c = 0; c < offset_count; ++c) {
            const std::size_t offset = in_.count({"offset", static_cast<std::int64_t>(c)});
            if (offset < (offsets.empty() ? 0 : offsets.back()) || offset > size || (offsets.empty() && offset > 0)) {
                in_.fail("offset " + std::to_string(c) + " is " + std::to_string(offset),
                         "from 0 to " + std::to_string(size) + ", never falling");
            }
            offsets.push_back(offset);
        }
        if ((offsets.empty() ? 0 : offsets.back()) != size) in_.fail("the offsets do not end at " + std::to_string(size));
        const std::string_view word = in_.word();
        if (upper_case(word) != "CONNECTIVITY") in_.fail_word({"CELLS"}, "CONNECTIVITY", word);
        arrays_.read_type("CONNECTIVITY");
        connectivity_.reserve(std::min(size, in_.room_for(1)));
        for (std::size_t c = 0; c + 1 < offsets.size(); ++c) {
            for (std::size_t k = offsets[c]; k < offsets[c + 1]; ++k) read_corner(c, k == offsets[c]);
        }
        if (!offsets.empty()) offsets_ = std::move(offsets);
    }

    void read_corner(std::size_t cell, bool first) {
        const std::int64_t index = in_.integer({"cell", static_cast<std::int64_t>(cell)});
        if (first) positions_.resize(cell + 1, in_.position());
        if (index < 0 || index >= static_cast<std::int64_t>(found_.points.size())) {
            const std::string points = std::to_string(found_.points.size());
            in_.fail("cell " + std::to_string(cell) + ": there is no point with index " + std::to_string(index),
                     "there are " + points + " points, counted from 0");
        }
        connectivity_.push_back(static_cast<Index>(index));
    }

    void read_cell_types() {
        if (!types_.empty()) in_.fail("there is a second CELL_TYPES section");
        const std::size_t count = in_.count({"CELL_TYPES"});
        if (count != cell_count()) {
            in_.fail("there are " + std::to_string(count) + " CELL_TYPES for " + std::to_string(cell_count()) + " CELLS");
        }
        types_.reserve(count);
        for (std::size_t c = 0; c < count; ++c) types_.push_back(in_.integer({"type of cell", static_cast<std::int64_t>(c)}));
    }

    void start_data(bool at_cells, std::size_t tuples, const std::string& what) {
        const std::size_t count = in_.count({at_cells ? "CELL_DATA" : "POINT_DATA"});
        if (count != tuples) {
            in_.fail((at_cells ? "CELL_DATA is for " : "POINT_DATA is for ") + std::to_string(count) + " " + what +
                     ", but there are " + std::to_string(tuples));
        }
        arrays_.start_data(at_cells, tuples);
    }

    // Files exist whose hexahedra are called tetrahedra: eight corners say more than the type.
    [[nodiscard]] bool is_hex(std::size_t cell) const {
        const std::size_t corners = offsets_[cell + 1] - offsets_[cell];
        return types_[cell] == kHexahedron || types_[cell] == kVoxel || (types_[cell] == kTetrahedron && corners == 8);
    }

    void choose_hexes() {
        if (types_.size() != cell_count()) in_.fail("CELLS without CELL_TYPES");
        std::map<std::int64_t, std::size_t> left_out;
        std::size_t mislabelled = 0;
        for (std::size_t c = 0; c < cell_count(); ++c) {
            if (!is_hex(c)) {
                ++left_out[types_[c]];
                continue;
            }
            take_hex(c);
            if (types_[c] == kTetrahedron) ++mislabelled;
        }
        if (found_.hexes.size() == cell_count()) found_.hex_numbers.clear();
        if (mislabelled > 0) {
            found_.warnings.push_back(counted(mislabelled, "cell", "cells") +
                                      " with 8 corners but the type of a tetrahedron (10) taken as hexahedra");
        }
        report_left_out(left_out);
    }

    void take_hex(std::size_t cell) {
        const std::size_t corners = offsets_[cell + 1] - offsets_[cell];
        const std::size_t position = cell < positions_.size() ? positions_[cell] : in_.position();
        if (corners != 8) {
            in_.fail_at(position, kWording.name_cell(cell) + " has " + std::to_string(corners) + " corners",
                        "a hexahedron has 8");
        }
        auto& hex = found_.hexes.emplace_back();
        std::copy_n(connectivity_.begin() + static_cast<std::ptrdiff_t>(offsets_[cell]), 8, hex.begin());
        if (types_[cell] == kVoxel) {
            std::swap(hex[2], hex[3]);
            std::swap(hex[6], hex[7]);
        }
        found_.hex_numbers.push_back(cell);
        check_corners(in_, position, hex, cell, kWording);
    }

    void report_left_out(const std::map<std::int64_t, std::size_t>& left_out) {
        std::string list;
        for (const auto& [type, count] : left_out) {
            const auto names = kCellNames.find(type);
            const bool known = names != kCellNames.end();
            list += (list.empty() ? "" : ", ") +
                    counted(count, known ? names->second[0] : "cell", known ? names->second[1] : "cells") + " (VTK type " +
                    std::to_string(type) + ")";
        }
        if (found_.hexes.empty()) {
            throw Error(ErrorCode::InvalidInput, "no hexahedra" + (list.empty() ? "" : ", but " + list + ", not supported"),
                        std::string(file_));
        }
        if (!list.empty()) found_.warnings.push_back(list + " ignored");
    }

    TextScanner in_;
    std::string_view file_;
    MeshFile found_;
    VtkArrayReader arrays_;
    std::vector<std::size_t> offsets_{0};  // of cell c: connectivity_[offsets_[c] .. offsets_[c + 1])
    std::vector<Index> connectivity_;
    std::vector<std::size_t> positions_;  // of each cell in the text
    std::vector<std::int64_t> types_;
};

}  // namespace

ReadResult read_legacy_vtk(std::string_view text, std::string_view file) {
    return VtkReader(text, file).read();
}

}  // namespace subvol
