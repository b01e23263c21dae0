// SPDX-License-Identifier: Apache-2.0
// Reads legacy VTK files, as text or binary: unstructured grids, and the structured ones as blocks of hexahedra. The header
// says which kind it is; then sections follow by their keywords, first those of the mesh, then those of arrays.
//
//     unstructured   POINTS, CELLS, CELL_TYPES. Up to version 4 CELLS has a count before the corners of each cell, later
//                    offsets and one list of corners
//     structured     DIMENSIONS, and POINTS or three lists of coordinates or an origin and a spacing
//
// Cells are sorted by their types after the last section, since only types tell corners from the faces of polyhedra; each cell
// keeps its position in the text for messages. Counts reserve no more memory than the rest of the file can fill.
#include <algorithm>
#include <optional>
#include <string>

#include "assemble.h"
#include "formats.h"
#include "mesh_arrays.h"
#include "mesh_file.h"
#include "subvol/detail/refuse_surface.h"
#include "subvol/error.h"
#include "vtk_cells.h"
#include "vtk_values.h"

namespace subvol::detail {

namespace {

/// The block of hexahedra of a structured data set of legacy VTK. Its points are listed (STRUCTURED_GRID), or given by the
/// coordinates of its planes on each axis (RECTILINEAR_GRID), or evenly spaced (STRUCTURED_POINTS).
class VtkBlock {
public:
    /// Nothing if the data set is not structured. type: its name in capitals
    [[nodiscard]] static std::optional<VtkBlock> for_type(const std::string& type);

    /// Reads the section whose keyword (in capitals) was the last word, if it belongs to this data set.
    ///
    /// returns: whether it does
    bool read_section(const std::string& keyword, TextScanner& in, VtkValues& values);

    /// Appends the points unless they are listed in a section POINTS; further calls do nothing.
    void add_points(const TextScanner& in, MeshFile& into);
    /// Appends the hexahedra; fails if the number of points is wrong, or if there are no cells.
    void add_cells(const TextScanner& in, MeshFile& into) const;

    void expect_cells(const TextScanner& in) const;
    [[nodiscard]] bool lists_points() const { return kind_ == Kind::Points; }
    [[nodiscard]] const StructuredGrid& grid() const { return grid_; }

private:
    enum class Kind { Points, Cuts, Even } kind_ = Kind::Points;
    void read_cuts(std::size_t axis, const std::string& keyword, TextScanner& in, VtkValues& values);

    StructuredGrid grid_;
    std::array<std::vector<double>, 3> cuts_;
    std::array<double, 3> origin_{0, 0, 0}, spacing_{1, 1, 1};
    bool has_points_ = false;
};

void read_three(const std::string& keyword, TextScanner& in, std::array<double, 3>& numbers) {
    for (double& number : numbers) number = in.real({keyword});
}

std::optional<VtkBlock> VtkBlock::for_type(const std::string& type) {
    VtkBlock block;
    if (type == "STRUCTURED_GRID") return block;
    block.kind_ = type == "RECTILINEAR_GRID" ? Kind::Cuts : Kind::Even;
    if (type == "RECTILINEAR_GRID" || type == "STRUCTURED_POINTS") return block;
    return std::nullopt;
}

bool VtkBlock::read_section(const std::string& keyword, TextScanner& in, VtkValues& values) {
    if (keyword == "DIMENSIONS") {
        for (std::size_t& along : grid_.points) along = in.count({"DIMENSIONS"});
    } else if (kind_ == Kind::Cuts && keyword.size() == 13 && keyword.ends_with("_COORDINATES") && keyword[0] >= 'X' &&
               keyword[0] <= 'Z') {
        read_cuts(static_cast<std::size_t>(keyword[0] - 'X'), keyword, in, values);
    } else if (kind_ == Kind::Even && keyword == "ORIGIN") {
        read_three(keyword, in, origin_);
    } else if (kind_ == Kind::Even && (keyword == "SPACING" || keyword == "ASPECT_RATIO")) {
        read_three(keyword, in, spacing_);
    } else {
        return false;
    }
    return true;
}

void VtkBlock::read_cuts(std::size_t axis, const std::string& keyword, TextScanner& in, VtkValues& values) {
    const std::size_t count = in.count({keyword});
    values.begin(values.read_type(keyword));
    cuts_[axis].clear();
    cuts_[axis].reserve(std::min(count, values.room()));
    for (std::size_t i = 0; i < count; ++i) cuts_[axis].push_back(values.real({keyword, static_cast<std::int64_t>(i), count}));
}

void VtkBlock::expect_cells(const TextScanner& in) const {
    if (grid_.cell_count() == 0) in.fail("there is no cell between " + size_text(grid_));
}

void VtkBlock::add_points(const TextScanner& in, MeshFile& into) {
    if (lists_points() || has_points_) return;
    has_points_ = true;
    expect_cells(in);
    constexpr std::size_t kBits = 8;  // a value takes at least one
    if (grid_.point_count() > most_points(kBits * in.size())) {
        in.fail("DIMENSIONS: " + size_text(grid_) + " are more than the file can have values for");
    }
    for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t along = grid_.points[a];
        if (kind_ == Kind::Cuts) {
            if (cuts_[a].size() == along) continue;
            in.fail("there are " + std::to_string(cuts_[a].size()) + " " + "XYZ"[a] + "_COORDINATES, but DIMENSIONS says " +
                    size_text(grid_));
        }
        for (std::size_t i = 0; i < along; ++i) cuts_[a].push_back(origin_[a] + spacing_[a] * static_cast<double>(i));
    }
    detail::add_points(into, cuts_, in.position());
}

void VtkBlock::add_cells(const TextScanner& in, MeshFile& into) const {
    if (into.points.size() != grid_.point_count()) {
        in.fail("there are " + std::to_string(into.points.size()) + " POINTS, but DIMENSIONS says " + size_text(grid_));
    }
    expect_cells(in);
    add_hexes(into, grid_, 0, 0);
}

constexpr VtkType kInt{NumberType::Int32};

/// offsets:   corners of cell c: connectivity[offsets[c] .. offsets[c + 1])
/// positions: of the cells in the text; the last one is also that of all cells that follow
struct VtkCells {
    std::vector<std::size_t> offsets{0};
    std::vector<Index> connectivity;
    std::vector<std::int64_t> types;
    std::vector<std::size_t> positions;

    [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
};

class VtkReader {
public:
    VtkReader(std::string_view text, std::string_view file, const ReadOptions& options)
        : in_(text, file, TextScanner::Comments::None),
          file_(file),
          options_(options),
          values_(in_),
          arrays_(in_, values_, found_) {}

    ReadResult read() {
        read_header();
        while (!in_.at_end()) {
            const std::string_view word = in_.word();
            const std::string keyword = upper_case(word);
            if (!read_section(keyword) && !read_arrays(keyword, word)) break;
        }
        if (cells_.types.size() != cells_.size()) in_.fail("CELLS without CELL_TYPES");
        VtkCellSorter sorter(in_, found_, options_);
        if (old_order_) sorter.set_old_order();
        if (block_) {
            block_->add_points(in_, found_);
            block_->add_cells(in_, found_);
        } else {
            sort_cells(sorter);
        }
        take_set_arrays(found_);
        sorter.report(file_);
        return assemble(std::move(found_), in_, file_, kVtkNames, options_);
    }

private:
    void read_header() {
        TextScanner whole = in_;
        if (whole.at_end()) in_.fail("the file is empty");
        const std::string_view first = in_.line();
        if (!upper_case(first).starts_with("# VTK DATAFILE VERSION")) {
            in_.fail("not a legacy VTK file: it begins with " + in_quotes(first), "# vtk DataFile Version is missing");
        }
        old_order_ = first.substr(first.find_last_of(" \t") + 1) < "5.1";
        in_.line();  // the title may be anything, in any encoding
        const std::string encoding = upper_case(in_.word());
        if (encoding == "BINARY") values_.set_binary();
        if (encoding != "BINARY" && encoding != "ASCII") in_.fail_word({"encoding"}, "ASCII or BINARY", encoding);
        if (upper_case(in_.peek()) == "FIELD") {
            in_.word();
            arrays_.read_section("FIELD");
        }
        const std::string_view dataset = in_.word();
        if (upper_case(dataset) != "DATASET") in_.fail_word({"dataset"}, "DATASET", dataset);
        const std::string type = upper_case(in_.word());
        constexpr const char* kAllowed = "UNSTRUCTURED_GRID, STRUCTURED_GRID, RECTILINEAR_GRID and STRUCTURED_POINTS are";
        if (type == "POLYDATA") in_.fail("POLYDATA is not a volume mesh, but a surface", way_to_cells(file_));
        block_ = VtkBlock::for_type(type);
        if (!block_ && type != "UNSTRUCTURED_GRID") in_.fail("DATASET " + in_quotes(type) + " is not supported", kAllowed);
    }

    bool read_section(const std::string& keyword) {
        if (keyword == "POINTS" && (!block_ || block_->lists_points())) {
            read_points();
        } else if (block_ && block_->read_section(keyword, in_, values_)) {
            return true;
        } else if (keyword == "CELLS" && !block_) {
            read_cells();
        } else if (keyword == "CELL_TYPES" && !block_) {
            read_cell_types();
        } else if (keyword == "POINT_DATA") {
            if (block_) block_->add_points(in_, found_);
            start_data(false, found_.points.size(), "points");
        } else if (keyword == "CELL_DATA") {
            start_data(true, block_ ? block_->grid().cell_count() : cells_.size(), "cells");
        } else if (keyword == "METADATA") {
            skip_metadata(in_);
        } else {
            return false;
        }
        return true;
    }

    /// Returns false where arrays that are left out do not end where their number of tuples says so: what follows cannot be
    /// told from their values.
    bool read_arrays(const std::string& keyword, std::string_view word) {
        const TextScanner begin = in_;
        try {
            if (!arrays_.read_section(keyword)) in_.fail("a keyword is expected, not " + in_quotes(word));
        } catch (const Error&) {
            if (!arrays_.leaves_out()) throw;
            found_.warnings.push_back("the rest of the file is left out (" + begin.place_of(begin.position()) +
                                      "): there are not as many values as CELL_DATA says");
            return false;
        }
        return true;
    }

    void read_points() {
        if (!found_.points.empty()) in_.fail("there is a second POINTS section");
        const std::size_t count = in_.count({"POINTS"});
        values_.begin(values_.read_type("POINTS"));
        found_.points.reserve(std::min(count, values_.room() / 3));
        for (std::size_t p = 0; p < count; ++p) read_point(values_, found_, kVtkNames, 0);
    }

    void read_cells() {
        if (cells_.size() > 0) in_.fail("there is a second CELLS section");
        const std::size_t first = in_.count({"CELLS"});
        const std::size_t second = in_.count({"CELLS"});
        if (upper_case(in_.peek()) == "OFFSETS") {
            read_offsets_and_connectivity(first, second);
        } else {
            read_counted_cells(first, second);
        }
    }

    // Up to version 4: for each cell the number of its corners, then the corners. size: the count of all these numbers
    void read_counted_cells(std::size_t count, std::size_t size) {
        values_.begin(kInt);
        cells_.offsets.reserve(std::min(count, values_.room()) + 1);
        cells_.connectivity.reserve(std::min(size, values_.room()));
        std::size_t left = size;
        for (std::size_t c = 0; c < count; ++c) {
            const auto number = static_cast<std::int64_t>(c);
            const std::size_t corners = values_.count({"corners of cell", number});
            if (corners >= left) {
                in_.fail("cell " + std::to_string(c) + " does not fit into the " + std::to_string(size) +
                             " numbers that CELLS announces",
                         "it would have " + std::to_string(corners) + " corners" +
                             (values_.binary() ? "; BINARY numbers have to be big-endian" : ""));
            }
            left -= corners + 1;
            for (std::size_t k = 0; k < corners; ++k) read_corner(c, k == 0);
            cells_.offsets.push_back(cells_.connectivity.size());
        }
        if (left > 0) {
            in_.fail("CELLS announces " + std::to_string(size) + " numbers, " + std::to_string(left) +
                     " more than its cells have");
        }
    }

    // From version 5 on: the offset of each cell in the list of corners, then this list.
    void read_offsets_and_connectivity(std::size_t offset_count, std::size_t size) {
        in_.word();
        values_.begin_integers(values_.read_type("OFFSETS"), "OFFSETS");
        std::vector<std::size_t> offsets;
        offsets.reserve(std::min(offset_count, values_.room()));
        for (std::size_t c = 0; c < offset_count; ++c) {
            const std::size_t offset = values_.count({"offset", static_cast<std::int64_t>(c)});
            if (offset < (offsets.empty() ? 0 : offsets.back()) || offset > size || (offsets.empty() && offset > 0)) {
                in_.fail("offset " + std::to_string(c) + " is " + std::to_string(offset),
                         "from 0 to " + std::to_string(size) + ", never falling");
            }
            offsets.push_back(offset);
        }
        if ((offsets.empty() ? 0 : offsets.back()) != size) in_.fail("the offsets do not end at " + std::to_string(size));
        const std::string_view word = in_.word();
        if (upper_case(word) != "CONNECTIVITY") in_.fail_word({"CELLS"}, "CONNECTIVITY", word);
        values_.begin_integers(values_.read_type("CONNECTIVITY"), "CONNECTIVITY");
        cells_.connectivity.reserve(std::min(size, values_.room()));
        for (std::size_t c = 0; c + 1 < offsets.size(); ++c) {
            for (std::size_t k = offsets[c]; k < offsets[c + 1]; ++k) read_corner(c, k == offsets[c]);
        }
        if (!offsets.empty()) cells_.offsets = std::move(offsets);
    }

    void read_corner(std::size_t cell, bool first) {
        const std::int64_t index = values_.integer({"cell", static_cast<std::int64_t>(cell)});
        if (first) cells_.positions.resize(cell + 1, in_.position());
        // Which numbers are points, the types say, which come later: those of a polyhedron are its faces.
        if (index < 0 || index >= static_cast<std::int64_t>(kNone)) no_point(in_.position(), cell, index);
        cells_.connectivity.push_back(static_cast<Index>(index));
    }

    [[noreturn]] void no_point(std::size_t position, std::size_t cell, std::int64_t index) const {
        in_.fail_at(position, "cell " + std::to_string(cell) + ": there is no point with index " + std::to_string(index),
                    "there are " + std::to_string(found_.points.size()) + " points, counted from 0");
    }

    void read_cell_types() {
        if (!cells_.types.empty()) in_.fail("there is a second CELL_TYPES section");
        const std::size_t count = in_.count({"CELL_TYPES"});
        if (count != cells_.size()) {
            in_.fail("there are " + std::to_string(count) + " CELL_TYPES for " + std::to_string(cells_.size()) + " CELLS");
        }
        values_.begin(kInt);
        cells_.types.reserve(count);
        for (std::size_t c = 0; c < count; ++c) {
            cells_.types.push_back(values_.integer({"type of cell", static_cast<std::int64_t>(c)}));
        }
    }

    void sort_cells(VtkCellSorter& sorter) const {
        const auto& [offsets, connectivity, types, positions] = cells_;
        for (std::size_t c = 0; c < cells_.size(); ++c) {
            const auto corners = std::span(connectivity).subspan(offsets[c], offsets[c + 1] - offsets[c]);
            const std::size_t place = positions.empty() ? in_.position() : positions[std::min(c, positions.size() - 1)];
            if (types[c] == kVtkPolyhedron) {
                const std::vector<std::int64_t> stream(corners.begin(), corners.end());
                auto faces = faces_of_stream(stream, 0, found_.points.size());
                if (!faces) in_.fail_at(place, "cell " + std::to_string(c) + ": these are not the faces of a polyhedron");
                sorter.take_polyhedron(std::move(*faces));
                continue;
            }
            for (const Index p : corners) {
                if (p >= found_.points.size()) no_point(place, c, p);
            }
            sorter.take(types[c], corners, place);
        }
    }

    void start_data(bool at_cells, std::size_t tuples, const std::string& what) {
        const std::size_t count = in_.count({at_cells ? "CELL_DATA" : "POINT_DATA"});
        if (count == tuples) return arrays_.start_data(at_cells, tuples);
        if (block_) block_->expect_cells(in_);  // a flat one has no cells that values could be at
        const std::string wrong = (at_cells ? "CELL_DATA is for " : "POINT_DATA is for ") + std::to_string(count) + " " + what +
                                  ", but there are " + std::to_string(tuples);
        // Values of points that are not those of the file put its points in doubt.
        if (!at_cells) in_.fail(wrong);
        arrays_.start_data(at_cells, count, in_.place_of(in_.position()) + ": " + wrong);
    }

    TextScanner in_;
    std::string_view file_;
    ReadOptions options_;
    MeshFile found_;
    VtkValues values_;
    VtkArrayReader arrays_;
    VtkCells cells_;
    bool old_order_ = false;         // of the nodes of Lagrange hexahedra, before version 5.1
    std::optional<VtkBlock> block_;  // of a structured data set
};

}  // namespace

ReadResult read_legacy_vtk(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtkReader(text, file, options).read();
}

}  // namespace subvol::detail
