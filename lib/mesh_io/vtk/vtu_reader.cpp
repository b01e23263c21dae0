// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <tuple>
#include <utility>

#include "assemble.h"
#include "formats.h"
#include "vtk_cells.h"
#include "vtk_xml_grid.h"

namespace subvol::detail {

namespace {

// An array with more components is an error; with fewer no product of counts exceeds 64 bits.
constexpr std::size_t kMostComponents = 1 << 16;

class VtuReader {
public:
    VtuReader(std::string_view text, std::string_view file, const ReadOptions& options, VtkGrid kind)
        : file_(file),
          options_(options),
          kind_(kind),
          xml_(text, file, name_of(kind), "a volume mesh of that type is needed"),
          arrays_(xml_.arrays()),
          sorter_(xml_.in(), found_, options) {}

    ReadResult read() {
        read_pieces(false);
        return assemble(std::move(found_), xml_.in(), file_, kVtkNames, options_);
    }

    MeshFile read_part() {
        read_pieces(true);
        refuse_not_finite(found_, xml_.in(), kVtkNames);
        return std::move(found_);
    }

private:
    // may_be_empty: of a part of a mesh
    void read_pieces(bool may_be_empty) {
        const pugi::xml_node grid = xml_.data_set();
        if (xml_.is_older_than(2, 1)) sorter_.set_old_order();
        for (const auto& piece : grid.children("Piece")) {
            ++pieces_;
            read_piece(piece);
        }
        if (pieces_ == 0) xml_.fail_at(grid, "there is no Piece element");
        if (pieces_ > 1)
            found_.warnings.push_back(std::to_string(pieces_) + " pieces put together" +
                                      (options_.weld ? "" : "; points where they touch stay apart without welding"));
        drop_partial_arrays();
        sorter_.report(may_be_empty ? std::nullopt : std::optional(file_));
    }

    void read_piece(const pugi::xml_node& piece) {
        const std::size_t first_point = found_.points.size();
        const std::size_t first_cell = cells_before_;
        const bool structured = kind_ != VtkGrid::Unstructured;
        const VtkExtent extent = structured ? extent_of(xml_, piece) : VtkExtent{};
        const std::size_t points = structured ? extent.grid.point_count() : xml_.count(piece, "NumberOfPoints");
        const std::size_t cells = structured ? extent.grid.cell_count() : xml_.count(piece, "NumberOfCells");
        if (points >= kNone - first_point || cells >= kNone - first_cell) xml_.fail_at(piece, "too many points or cells");
        if (points > 0) read_points(piece, extent, points);
        if (structured) {
            add_hexes(found_, extent.grid, first_point, first_cell);
        } else if (cells > 0) {
            read_cells(piece.child("Cells"), piece, first_point, cells);
        }
        cells_before_ += cells;
        if (points > 0) read_arrays(piece.child("PointData"), false, first_point, points);
        if (cells > 0) read_arrays(piece.child("CellData"), true, first_cell, cells);
    }

    void read_points(const pugi::xml_node& piece, const VtkExtent& extent, std::size_t count) {
        if (kind_ == VtkGrid::Rectilinear || kind_ == VtkGrid::Image) {
            add_grid_points(xml_, kind_, piece, extent, found_);
            return;
        }
        const pugi::xml_node array = xml_.coordinates(piece, count);
        const std::size_t position = xml_.place(array);
        Vec3 point;
        int axis = 0;
        arrays_.each_real(array, [&](std::span<const double> values) {
            for (const double value : values) {
                point[axis] = value;
                if (axis == 2) add_point(found_, point, position);
                axis = (axis + 1) % 3;
            }
        });
    }

    pugi::xml_node cell_array(const pugi::xml_node& cells, const pugi::xml_node& piece, const char* name) const {
        const pugi::xml_node array = cells.find_child_by_attribute("DataArray", "Name", name);
        if (!array) xml_.fail_at(piece, std::string("the piece has no array ") + name + " of its Cells");
        return array;
    }

    void read_cells(const pugi::xml_node& element, const pugi::xml_node& piece, std::size_t first_point, std::size_t count) {
        const pugi::xml_node connectivity = cell_array(element, piece, "connectivity");
        const auto ends = read_offsets(cell_array(element, piece, "offsets"), count, arrays_.size(connectivity));
        const pugi::xml_node type_array = cell_array(element, piece, "types");
        const auto types = arrays_.integers(type_array);
        xml_.expect_size(type_array, types.size(), count, "one a cell");
        if (found_.hexes.corners.empty()) {  // most meshes have only hexahedra
            found_.hexes.corners.reserve(count);
            found_.hexes.numbers.reserve(count);
        }
        const std::size_t position = xml_.place(connectivity);
        const auto points = static_cast<std::int64_t>(found_.points.size() - first_point);
        std::vector<Index> corners;  // of cell c, those read so far
        std::size_t c = 0, end = 0;
        const auto take_full = [&] {
            for (; c < count && end == ends[c]; ++c) {
                sorter_.take(types[c], corners, position);
                corners.clear();
            }
        };
        take_full();
        arrays_.each_integer(connectivity, [&](std::span<const std::int64_t> some) {
            for (const std::int64_t corner : some) {
                if (corner < 0 || corner >= points) {
                    arrays_.fail(connectivity,
                                 kVtkNames.cell(cells_before_ + c) + ": there is no point with index " + std::to_string(corner),
                                 "there are " + std::to_string(points) + " points, counted from 0");
                }
                corners.push_back(static_cast<Index>(first_point + static_cast<std::size_t>(corner)));
                ++end;
                take_full();
            }
        });
    }

    // The end of each cell in the list of corners.
    [[nodiscard]] std::vector<std::size_t> read_offsets(const pugi::xml_node& array, std::size_t count,
                                                        std::size_t corners) const {
        xml_.expect_size(array, arrays_.size(array), count, "one a cell");
        std::vector<std::size_t> ends;
        std::size_t last = 0;
        arrays_.each_integer(array, [&](std::span<const std::int64_t> offsets) {
            for (const std::int64_t offset : offsets) {
                if (offset < static_cast<std::int64_t>(last) || offset > static_cast<std::int64_t>(corners)) {
                    arrays_.fail(array, "offset " + std::to_string(ends.size()) + " is " + std::to_string(offset),
                                 "up to " + std::to_string(corners) + ", never falling");
                }
                last = static_cast<std::size_t>(offset);
                ends.push_back(last);
            }
        });
        if (last != corners) {
            arrays_.fail(array, "the last offset is " + std::to_string(last) + ", but the connectivity has " +
                                    std::to_string(corners) + " corners");
        }
        return ends;
    }

    void read_arrays(const pugi::xml_node& element, bool at_cells, std::size_t before, std::size_t tuples) {
        for (const auto& array : element.children()) {
            const std::string_view kind = array.name();
            if (kind != "DataArray" && kind != "Array") continue;
            const std::string name = as_utf8(array.attribute("Name").as_string("unnamed"));
            const std::string_view type = array.attribute("type").as_string();
            if (type == "String" || type == "Bit") {
                found_.warnings.push_back("array " + in_quotes(name) + " of type " + shortened(type) + " ignored");
                continue;
            }
            const std::size_t components = number_attribute(array, "NumberOfComponents").value_or(1);
            if (components < 1 || components > kMostComponents) {
                arrays_.fail(array, "it cannot have " + std::to_string(components) + " components");
            }
            xml_.expect_size(array, arrays_.size(array), tuples * components,
                             std::to_string(components) + " a " + (at_cells ? "cell" : "point"));
            std::vector<double>& values = values_of(name, at_cells, components, before);
            arrays_.each_real(array,
                              [&](std::span<const double> some) { values.insert(values.end(), some.begin(), some.end()); });
        }
    }

    // The values of a piece follow those of the piece before. An array that an earlier piece lacks is started anew, and removed
    // at the end.
    std::vector<double>& values_of(const std::string& name, bool at_cells, std::size_t components, std::size_t before) {
        Alike& alike = alike_[{name, at_cells, components}];
        if (std::exchange(alike.piece, pieces_) != pieces_) alike.next = 0;
        while (alike.next < alike.places.size()) {
            std::vector<double>& values = found_.arrays[alike.places[alike.next++]].values;
            if (values.size() == before * components) return values;
        }
        alike.places.push_back(found_.arrays.size());
        alike.next = alike.places.size();
        found_.arrays.push_back({name, static_cast<int>(components), at_cells, {}});
        return found_.arrays.back().values;
    }

    void drop_partial_arrays() {
        std::erase_if(found_.arrays, [&](const FileArray& array) {
            const std::size_t tuples = array.at_cells ? cells_before_ : found_.points.size();
            const bool partial = array.values.size() != tuples * static_cast<std::size_t>(array.components);
            if (partial) found_.warnings.push_back("array " + in_quotes(array.name) + " is not in every piece: ignored");
            return partial;
        });
    }

    std::string_view file_;
    ReadOptions options_;
    VtkGrid kind_;
    VtkXml xml_;
    const VtuArrays& arrays_;
    MeshFile found_;
    VtkCellSorter sorter_;
    std::size_t cells_before_ = 0, pieces_ = 0;
    // The arrays of a name: those of a piece belong to them in their order.
    struct Alike {
        std::vector<std::size_t> places;
        std::size_t next = 0, piece = 0;
    };
    std::map<std::tuple<std::string, bool, std::size_t>, Alike> alike_;
};

}  // namespace

ReadResult read_vtu(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options, VtkGrid::Unstructured).read();
}

MeshFile read_vtu_piece(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options, VtkGrid::Unstructured).read_part();
}

ReadResult read_vts(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options, VtkGrid::Structured).read();
}

MeshFile read_vts_piece(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options, VtkGrid::Structured).read_part();
}

ReadResult read_vtr(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options, VtkGrid::Rectilinear).read();
}

MeshFile read_vtr_piece(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options, VtkGrid::Rectilinear).read_part();
}

ReadResult read_vti(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options, VtkGrid::Image).read();
}

MeshFile read_vti_piece(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options, VtkGrid::Image).read_part();
}

}  // namespace subvol::detail
