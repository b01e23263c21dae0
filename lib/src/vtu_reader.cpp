#include <algorithm>
#include <limits>
#include <pugixml.hpp>

#include "mesh_file.h"
#include "vtk_cells.h"
#include "vtu_arrays.h"

namespace subvol {

namespace {

constexpr std::string_view kAppendedTag = "<AppendedData";

// More components are a mistake, and fewer keep every product of counts within 64 bits.
constexpr std::size_t kMostComponents = 1 << 16;

class VtuReader {
public:
    VtuReader(std::string_view text, std::string_view file, const ReadOptions& options)
        : text_(text),
          file_(file),
          options_(options),
          in_(text, file, TextScanner::Comments::None),
          arrays_(text, file, in_, encoding_),
          sorter_(in_, found_, options) {}

    ReadResult read() {
        const pugi::xml_node root = parse();
        read_encoding(root);
        const pugi::xml_node grid = root.child("UnstructuredGrid");
        if (!grid) fail_at(root, "there is no UnstructuredGrid element");
        std::size_t pieces = 0;
        for (const auto& piece : grid.children("Piece")) {
            read_piece(piece);
            ++pieces;
        }
        if (pieces == 0) fail_at(grid, "there is no Piece element");
        if (pieces > 1) {
            found_.warnings.push_back(std::to_string(pieces) +
                                      " pieces put together; points where they touch are joined only if they share them");
        }
        drop_partial_arrays();
        sorter_.report(file_);
        return finish(std::move(found_), in_, file_, kVtkWording, options_);
    }

private:
    [[noreturn]] void fail_at(const pugi::xml_node& node, const std::string& message, const std::string& allowed = {}) const {
        in_.fail_at(static_cast<std::size_t>(node.offset_debug()), message, allowed);
    }

    // Appended data need not be well-formed XML: the parser is given what stands before them.
    pugi::xml_node parse() {
        if (in_.at_end()) in_.fail("the file is empty");
        const std::size_t tag = text_.find(kAppendedTag);
        const std::size_t tag_end = tag == std::string_view::npos ? tag : text_.find('>', tag);
        if (tag_end == std::string_view::npos) {
            xml_ = text_;
        } else {
            xml_ = text_.substr(0, tag_end + 1);
            xml_ += text_[tag_end - 1] == '/' ? "</VTKFile>" : "</AppendedData></VTKFile>";
            find_appended(tag_end + 1);
        }
        const auto result = document_.load_buffer_inplace(xml_.data(), xml_.size(), pugi::parse_default, pugi::encoding_utf8);
        if (!result) {
            const auto offset = std::min(static_cast<std::size_t>(result.offset), text_.size());
            in_.fail_at(offset, std::string("not well-formed XML: ") + result.description());
        }
        const pugi::xml_node root = document_.document_element();
        if (std::string_view(root.name()) != "VTKFile") {
            fail_at(root, "not a VTK XML file: its root element is " + in_quotes(root.name()), "VTKFile is needed");
        }
        const char* type = root.attribute("type").as_string();
        if (std::string_view(type) != "UnstructuredGrid") {
            fail_at(root, in_quotes(type) + " is not an UnstructuredGrid", "a volume mesh of that type is needed");
        }
        return root;
    }

    void find_appended(std::size_t tag_end) {
        const std::size_t begin = text_.find_first_not_of(" \t\r\n", tag_end);
        if (begin == std::string_view::npos || text_[begin] != '_') return;
        encoding_.appended = text_.substr(begin + 1);
    }

    void read_encoding(const pugi::xml_node& root) {
        const std::string_view order = root.attribute("byte_order").as_string("LittleEndian");
        if (order != "LittleEndian" && order != "BigEndian") {
            fail_at(root, "byte_order " + in_quotes(order) + " is unknown", "LittleEndian or BigEndian");
        }
        encoding_.order = order == "BigEndian" ? std::endian::big : std::endian::little;
        const std::string_view header = root.attribute("header_type").as_string("UInt32");
        if (header != "UInt32" && header != "UInt64") {
            fail_at(root, "header_type " + in_quotes(header) + " is unknown", "UInt32 or UInt64");
        }
        encoding_.header = header == "UInt64" ? NumberType::UInt64 : NumberType::UInt32;
        const char* name = root.attribute("compressor").as_string();
        const auto compressor = compressor_named(name);
        if (!compressor) fail_at(root, "compressor " + in_quotes(name) + " is not supported", "zlib, LZMA and LZ4 are");
        encoding_.compressor = *compressor;
        const pugi::xml_node appended = root.child("AppendedData");
        const std::string_view encoding = appended.attribute("encoding").as_string("base64");
        if (encoding != "raw" && encoding != "base64") {
            fail_at(appended, "encoding " + in_quotes(encoding) + " is unknown", "raw or base64");
        }
        encoding_.appended_base64 = encoding == "base64";
        if (encoding_.appended_base64) encoding_.appended = encoding_.appended.substr(0, encoding_.appended.find('<'));
    }

    void read_piece(const pugi::xml_node& piece) {
        const std::size_t first_point = found_.points.size();
        const std::size_t first_cell = cells_before_;
        const std::size_t points = count_of(piece, "NumberOfPoints");
        const std::size_t cells = count_of(piece, "NumberOfCells");
        if (first_point + points >= kNone || first_cell + cells >= kNone) fail_at(piece, "too many points or cells");
        if (points > 0) read_points(piece, points);
        if (cells > 0) read_cells(piece.child("Cells"), piece, first_point, cells);
        cells_before_ += cells;
        if (points > 0) read_arrays(piece.child("PointData"), false, first_point, points);
        if (cells > 0) read_arrays(piece.child("CellData"), true, first_cell, cells);
    }

    std::size_t count_of(const pugi::xml_node& piece, const char* name) const {
        const auto count = number_attribute(piece, name);
        if (!count) fail_at(piece, std::string(name) + " is missing or no count");
        if (*count >= kNone) fail_at(piece, std::string(name) + ": count out of range: " + std::to_string(*count));
        return *count;
    }

    void read_points(const pugi::xml_node& piece, std::size_t count) {
        const pugi::xml_node array = piece.child("Points").child("DataArray");
        if (!array) fail_at(piece, "the piece has no Points");
        const auto values = arrays_.reals(array);
        expect_size(array, values.size(), 3 * count, "3 coordinates of " + std::to_string(count) + " points");
        for (std::size_t p = 0; p < count; ++p) {
            const auto x = values.begin() + static_cast<std::ptrdiff_t>(3 * p);
            add_point(found_, {x[0], x[1], x[2]}, static_cast<std::size_t>(array.offset_debug()));
        }
    }

    void expect_size(const pugi::xml_node& array, std::size_t size, std::size_t needed, const std::string& what) const {
        if (size == needed) return;
        arrays_.fail(array, "it has " + counted(size, "value", "values"), std::to_string(needed) + " are needed: " + what);
    }

    pugi::xml_node cell_array(const pugi::xml_node& cells, const pugi::xml_node& piece, const char* name) const {
        const pugi::xml_node array = cells.find_child_by_attribute("DataArray", "Name", name);
        if (!array) fail_at(piece, std::string("the piece has no array ") + name + " of its Cells");
        return array;
    }

    void read_cells(const pugi::xml_node& element, const pugi::xml_node& piece, std::size_t first_point, std::size_t count) {
        const pugi::xml_node connectivity = cell_array(element, piece, "connectivity");
        VtkCells cells;
        cells.positions = {static_cast<std::size_t>(connectivity.offset_debug())};
        const auto corners = arrays_.integers(connectivity);
        read_offsets(cell_array(element, piece, "offsets"), count, corners.size(), cells);
        const pugi::xml_node types = cell_array(element, piece, "types");
        cells.types = arrays_.integers(types);
        expect_size(types, cells.types.size(), count, "one a cell");
        const auto points = static_cast<std::int64_t>(found_.points.size() - first_point);
        cells.connectivity.reserve(corners.size());
        for (std::size_t c = 0; c < count; ++c) {
            for (std::size_t k = cells.offsets[c]; k < cells.offsets[c + 1]; ++k) {
                if (corners[k] < 0 || corners[k] >= points) {
                    arrays_.fail(connectivity,
                                 kVtkWording.name_cell(cells_before_ + c) + ": there is no point with index " +
                                     std::to_string(corners[k]),
                                 "there are " + std::to_string(points) + " points, counted from 0");
                }
                cells.connectivity.push_back(static_cast<Index>(first_point + static_cast<std::size_t>(corners[k])));
            }
        }
        sorter_.take(cells);
    }

    // Each is the end of its cell in the list of corners.
    void read_offsets(const pugi::xml_node& array, std::size_t count, std::size_t corners, VtkCells& cells) const {
        const auto offsets = arrays_.integers(array);
        expect_size(array, offsets.size(), count, "one a cell");
        cells.offsets.reserve(count + 1);
        for (std::size_t c = 0; c < count; ++c) {
            if (offsets[c] < static_cast<std::int64_t>(cells.offsets.back()) ||
                offsets[c] > static_cast<std::int64_t>(corners)) {
                arrays_.fail(array, "offset " + std::to_string(c) + " is " + std::to_string(offsets[c]),
                             "up to " + std::to_string(corners) + ", never falling");
            }
            cells.offsets.push_back(static_cast<std::size_t>(offsets[c]));
        }
        if (cells.offsets.back() != corners) {
            arrays_.fail(array, "the last offset is " + std::to_string(cells.offsets.back()) + ", but the connectivity has " +
                                    std::to_string(corners) + " corners");
        }
    }

    void read_arrays(const pugi::xml_node& element, bool at_cells, std::size_t before, std::size_t tuples) {
        for (const auto& array : element.children()) {
            const std::string_view kind = array.name();
            if (kind != "DataArray" && kind != "Array") continue;
            const std::string name = as_utf8(array.attribute("Name").as_string("unnamed"));
            const std::string_view type = array.attribute("type").as_string();
            if (type == "String" || type == "Bit") {
                found_.warnings.push_back("array \"" + name + "\" of type " + std::string(type) + " ignored");
                continue;
            }
            const std::size_t components = number_attribute(array, "NumberOfComponents").value_or(1);
            if (components < 1 || components > kMostComponents) {
                arrays_.fail(array, "it cannot have " + std::to_string(components) + " components");
            }
            const auto values = arrays_.reals(array);
            expect_size(array, values.size(), tuples * components,
                        std::to_string(components) + " a " + (at_cells ? "cell" : "point"));
            append(name, at_cells, components, before, values);
        }
    }

    // An array of a piece goes on where that of the piece before ended; one that pieces before lacked begins nowhere.
    void append(const std::string& name, bool at_cells, std::size_t components, std::size_t before,
                const std::vector<double>& values) {
        const auto continues = [&](const FileArray& array) {
            return array.at_cells == at_cells && array.name == name && array.values.size() == before * components &&
                   static_cast<std::size_t>(array.components) == components;
        };
        auto array = found_.arrays.end();
        if (before > 0) array = std::find_if(found_.arrays.begin(), found_.arrays.end(), continues);
        if (array == found_.arrays.end()) {
            found_.arrays.push_back({name, static_cast<int>(components), at_cells, {}});
            array = found_.arrays.end() - 1;
        }
        array->values.insert(array->values.end(), values.begin(), values.end());
    }

    void drop_partial_arrays() {
        std::erase_if(found_.arrays, [&](const FileArray& array) {
            const std::size_t tuples = array.at_cells ? cells_before_ : found_.points.size();
            const bool partial = array.values.size() != tuples * static_cast<std::size_t>(array.components);
            if (partial) found_.warnings.push_back("array \"" + array.name + "\" is not in every piece: ignored");
            return partial;
        });
    }

    std::string_view text_;
    std::string_view file_;
    ReadOptions options_;
    TextScanner in_;
    std::string xml_;
    pugi::xml_document document_;
    VtuEncoding encoding_;
    VtuArrays arrays_;
    MeshFile found_;
    VtkCellSorter sorter_;
    std::size_t cells_before_ = 0;
};

}  // namespace

ReadResult read_vtu(std::string_view text, std::string_view file, const ReadOptions& options) {
    return VtuReader(text, file, options).read();
}

}  // namespace subvol
