// SPDX-License-Identifier: Apache-2.0
// Reads and writes the volume data sets of VTK XML: unstructured grids, and blocks whose points are listed (structured), lie on
// planes (rectilinear) or are evenly spaced and may be turned (image). Pieces are read one after the other into the same mesh:
// the indices of a piece are counted from the points and cells before it. In each come points, then cells, then arrays. The
// list of corners is read as a stream: a cell is taken when its offset is reached, so only the corners of one cell are kept.
//
// An array goes on in the next piece under its name, place and components; where a piece lacks it, it has gaps. Fields of the
// whole file are read last. What is written has one piece:
//
//     hexahedra, quads, lines → connectivity, offsets, types → fields at points → fields at cells → sets as flags 0 and 1
//
// Shells share the points of the hexahedra where they meet, and add their other points. Quads and lines have the means of their
// corners where a field is at cells.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <pugixml.hpp>
#include <tuple>
#include <utility>

#include "assemble.h"
#include "formats.h"
#include "join_pieces.h"
#include "mesh_arrays.h"
#include "mesh_file.h"
#include "subvol/detail/mesh_subset.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/vtk_xml.h"
#include "subvol/detail/vtk_xml_writer.h"
#include "subvol/hex_mesh.h"
#include "vtk_cells.h"
#include "vtk_image.h"

namespace subvol::detail {

namespace {

/// The volume data sets of VTK XML: cells with their corners, or a block of hexahedra. The points of a block are listed, or
/// given by the coordinates of its planes on each axis, or evenly spaced.
enum class VtkGrid { Unstructured, Structured, Rectilinear, Image };

std::array<std::vector<double>, 3> cuts(const VtkXml& xml, const pugi::xml_node& piece, const VtkExtent& extent) {
    std::array<std::vector<double>, 3> at;
    pugi::xml_node array = piece.child("Coordinates").child("DataArray");
    for (std::size_t a = 0; a < 3; ++a) {
        if (!array) xml.fail_at(piece, "the piece does not have three arrays of Coordinates");
        at[a] = xml.arrays().reals(array);
        xml.expect_size(array, at[a].size(), extent.grid.points[a], "the coordinates along an axis");
        array = array.next_sibling("DataArray");
    }
    return at;
}

// Coordinates along the axes of the image, from its origin, which belongs to the number 0.
std::array<std::vector<double>, 3> even_cuts(const VtkExtent& extent, const std::array<double, 3>& spacing) {
    std::array<std::vector<double>, 3> at;
    for (std::size_t a = 0; a < 3; ++a) {
        for (std::size_t i = 0; i < extent.grid.points[a]; ++i) {
            at[a].push_back(spacing[a] * static_cast<double>(extent.first[a] + static_cast<std::int64_t>(i)));
        }
    }
    return at;
}

// The name of the data set's element.
const char* name_of(VtkGrid grid) {
    constexpr std::array<const char*, 4> kNames{"UnstructuredGrid", "StructuredGrid", "RectilinearGrid", "ImageData"};
    return kNames[static_cast<std::size_t>(grid)];
}

// Appends the points of a piece. kind: Rectilinear or Image
void add_grid_points(const VtkXml& xml, VtkGrid kind, const pugi::xml_node& piece, const VtkExtent& extent, MeshFile& into) {
    if (into.points.size() + extent.grid.point_count() > most_points(xml.most_bytes())) {  // of all pieces
        xml.fail_at(piece, size_text(extent.grid) + " are more than the file can have values for");
    }
    const auto position = xml.place(piece);
    if (kind == VtkGrid::Rectilinear) {
        add_points(into, cuts(xml, piece, extent), position);
        return;
    }
    MeshFile along;
    add_points(along, even_cuts(extent, spacing_of(xml)), position);
    const ImagePlacement place = placement_of(xml);
    for (const Vec3& point : along.points) add_point(into, place(point), position);
}

// An array with more components is an error; with fewer no product of counts exceeds 64 bits.
constexpr std::size_t kMostVtuComponents = 1 << 16;

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
        add_gaps();
        take_node_set_arrays(found_);
        // A program that adds arrays of its own may write a second list of them.
        for (const auto& element : grid.children("FieldData")) read_field_data(element);
        sorter_.report(may_be_empty ? std::nullopt : std::optional(file_));
    }

    void read_field_data(const pugi::xml_node& element) {
        std::vector<NamedNumbers> taken;
        std::vector<std::string> ignored;
        for (const auto& array : element.children()) {
            const std::string name = as_utf8(array.attribute("Name").as_string());
            if (is_time_array(name) && arrays_.size(array) == 1) {
                arrays_.each_real(array, [&](std::span<const double> values) { take_time(name, values, found_); });
                continue;
            }
            if (!is_field_array(name)) {
                found_.ignored.push_back(ignored_field_data(name));
                continue;
            }
            if (arrays_.has_integers(array)) {
                taken.push_back({name, arrays_.integers(array)});
            } else {
                ignored.push_back(name);
            }
        }
        take_field_arrays(taken, found_);
        ignore_field_arrays(ignored, found_);
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
        const bool polyhedra = std::ranges::find(types, kVtkPolyhedron) != types.end();
        const VtkFaces faces = polyhedra ? read_faces(element, piece, count) : VtkFaces{};
        const std::size_t position = xml_.place(connectivity);
        const auto points = static_cast<std::int64_t>(found_.points.size() - first_point);
        std::vector<Index> corners;  // of cell c, those read so far
        std::size_t c = 0, end = 0;
        const auto take_full = [&] {
            for (; c < count && end == ends[c]; ++c) {
                if (types[c] == kVtkPolyhedron) {
                    auto of_cell = faces.of_cell(c, first_point, static_cast<std::size_t>(points));
                    if (!of_cell)
                        xml_.fail_at(piece, kVtkNames.cell(cells_before_ + c) + ": its faces are not those of a polyhedron");
                    sorter_.take_polyhedron(std::move(*of_cell));
                } else {
                    sorter_.take(types[c], corners, position);
                }
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

    VtkFaces read_faces(const pugi::xml_node& element, const pugi::xml_node& piece, std::size_t count) const {
        const auto list = [&](const char* name) { return arrays_.integers(cell_array(element, piece, name)); };
        // Offsets begin with a 0 in some files.
        const auto ends = [&](const char* name, std::optional<std::size_t> wanted) {
            std::vector<std::int64_t> all = list(name);
            const bool starts = !all.empty() && all.front() == 0 && (!wanted || all.size() == *wanted + 1);
            if (starts) all.erase(all.begin());
            if (wanted) xml_.expect_size(cell_array(element, piece, name), all.size(), *wanted, "one a cell");
            return all;
        };
        VtkFaces faces;
        if (element.find_child_by_attribute("DataArray", "Name", "polyhedron_to_faces")) {
            faces.points = list("face_connectivity");
            faces.point_ends = ends("face_offsets", std::nullopt);
            faces.numbers = list("polyhedron_to_faces");
            faces.number_ends = ends("polyhedron_offsets", count);
        } else {
            faces.stream = list("faces");
            faces.ends = ends("faceoffsets", count);
            std::int64_t last = 0;  // other cells have -1 or nothing between
            for (std::int64_t& end : faces.ends) {
                if (end < 0) end = last;
                last = end;
            }
        }
        return faces;
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
                found_.ignore({"array", name, 1, "it is of type " + shortened(type)});
                continue;
            }
            const bool integers = arrays_.has_integers(array);
            const std::string_view said = array.attribute("NumberOfComponents").as_string("1");
            const std::size_t components = number_attribute(array, "NumberOfComponents").value_or(said == "1" ? 1 : 0);
            if (components < 1 || components > kMostVtuComponents)
                arrays_.fail(array, "it cannot have " + in_quotes(said) + " components");
            // Values at the wrong number of cells put no cell in doubt.
            const std::size_t size = arrays_.size(array);
            if (at_cells && size != tuples * components && !is_set_array(name, components)) {
                found_.unread.push_back({name, xml_.in().place_of(xml_.place(array)) + ": it has " +
                                                   counted(size, "value", "values") + ", " + std::to_string(components) +
                                                   " a cell for " + counted(tuples, "cell", "cells") + " are needed"});
                continue;
            }
            xml_.expect_size(array, size, tuples * components,
                             std::to_string(components) + " a " + (at_cells ? "cell" : "point"));
            if (at_cells && is_set_array(name, components)) {
                std::size_t first = before;
                arrays_.each_real(array, [&](std::span<const double> some) {
                    add_to_set(sets_, name, first, some);
                    first += some.size();
                });
                continue;
            }
            std::vector<double>& values =
                values_of({name, static_cast<int>(components), at_cells, {}, {}, {}, integers}, before, tuples);
            arrays_.each_real(array,
                              [&](std::span<const double> some) { values.insert(values.end(), some.begin(), some.end()); });
        }
    }

    // Where the values of a piece go: after those of the piece before, whether or not that has the array. before: tuples of the
    // pieces before
    std::vector<double>& values_of(FileArray array, std::size_t before, std::size_t tuples) {
        Alike& alike = alike_[{array.name, array.at_cells, static_cast<std::size_t>(array.components)}];
        if (std::exchange(alike.piece, pieces_) != pieces_) alike.next = 0;
        if (alike.next == alike.places.size()) {
            alike.places.push_back(found_.arrays.size());
            found_.arrays.push_back(std::move(array));
            stretches_.emplace_back();
        }
        const std::size_t place = alike.places[alike.next++];
        stretches_[place].push_back({before, tuples});
        return found_.arrays[place].values;
    }

    // Values of arrays that are not in every piece go to their cells or points: others have none, or are no ghosts.
    void add_gaps() {
        std::size_t values = 0;
        for (const FileArray& array : found_.arrays) values += array.values.size();
        GapLimit gaps(values);
        std::map<std::pair<std::string, bool>, int> first_components;
        std::vector<FileArray> arrays;
        for (std::size_t k = 0; k < found_.arrays.size(); ++k) {
            FileArray& array = found_.arrays[k];
            const std::size_t tuples = array.at_cells ? cells_before_ : found_.points.size();
            const auto components = static_cast<std::size_t>(array.components);
            const int of_first = first_components.try_emplace({array.name, array.at_cells}, array.components).first->second;
            if (array.values.size() != tuples * components) {
                if (array.components != of_first || !gaps.allows(array.name, tuples * components)) {
                    found_.ignore(array.components != of_first ? other_components(array.name, 1, "piece")
                                                               : not_everywhere(array.name, "piece"));
                    continue;
                }
                std::vector<double> whole(tuples * components, array.name == kGhostArray ? 0 : std::nan(""));
                const double* from = array.values.data();
                for (const auto& [begin, count] : stretches_[k]) {
                    std::copy_n(from, count * components, whole.data() + begin * components);
                    from += count * components;
                }
                array.values = std::move(whole);
            }
            arrays.push_back(std::move(array));
        }
        found_.arrays = std::move(arrays);
    }

    std::string_view file_;
    ReadOptions options_;
    VtkGrid kind_;
    VtkXml xml_;
    const VtuArrays& arrays_;
    MeshFile found_;
    ByName<FileSet> sets_{found_.sets};
    VtkCellSorter sorter_;
    std::size_t cells_before_ = 0, pieces_ = 0;
    // The arrays of a name: those of a piece belong to them in their order.
    struct Alike {
        std::vector<std::size_t> places;
        std::size_t next = 0, piece = 0;
    };
    std::map<std::tuple<std::string, bool, std::size_t>, Alike> alike_;
    struct Stretch {
        std::size_t begin, tuples;
    };
    std::vector<std::vector<Stretch>> stretches_;  // the tuples of each array that pieces have
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

namespace {

constexpr std::uint8_t kHexType = 12, kQuadType = 9, kLineType = 3;

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");

/// What is written: a mesh with its patches and sets, then quads and lines over its points and those that follow them.
struct Contents {
    const HexMesh& mesh;
    const MeshSets& sets;
    const std::vector<std::array<Index, 4>>& quads;
    const std::vector<std::array<Index, 2>>& lines;
};

void write_cells(VtkXmlWriter& out, const Contents& contents) {
    const HexMesh& mesh = contents.mesh;
    const auto& quads = contents.quads;
    const auto& lines = contents.lines;
    const std::size_t cells = mesh.cells.size(), of_cells = 8 * cells, of_quads = of_cells + 4 * quads.size();
    const auto corner = [&](std::size_t i) {
        if (i < of_cells) return static_cast<std::int64_t>(mesh.cells[i / 8][i % 8]);
        if (i < of_quads) return static_cast<std::int64_t>(quads[(i - of_cells) / 4][(i - of_cells) % 4]);
        return static_cast<std::int64_t>(lines[(i - of_quads) / 2][(i - of_quads) % 2]);
    };
    const std::size_t with_quads = cells + quads.size(), all = with_quads + lines.size();
    out.line("<Cells>");
    out.made_array<std::int64_t>("connectivity", 1, of_quads + 2 * lines.size(), corner);
    out.made_array<std::int64_t>("offsets", 1, all, [&](std::size_t c) {
        const std::size_t hexes = std::min(c + 1, cells), more = c + 1 - hexes, of_quad = std::min(more, quads.size());
        return static_cast<std::int64_t>(8 * hexes + 4 * of_quad + 2 * (more - of_quad));
    });
    out.made_array<std::uint8_t>("types", 1, all, [&](std::size_t c) {
        return c < cells ? kHexType : c < with_quads ? kQuadType : kLineType;
    });
    out.line("</Cells>");
}

/// The values at all cells of a field at cells: quads and lines have the means of their corners.
std::vector<double> values_at_cells(const Attribute& field, const Contents& contents) {
    std::vector<double> values = field.cells;
    const auto channels = static_cast<std::size_t>(field.channels);
    const auto add = [&](const auto& cells) {
        for (const auto& cell : cells) {
            for (std::size_t c = 0; c < channels; ++c) {
                double sum = 0;
                for (const Index p : cell) sum += field.values[p * channels + c];
                values.push_back(sum / static_cast<double>(cell.size()));
            }
        }
    };
    add(contents.quads);
    add(contents.lines);
    return values;
}

void write_piece(VtkXmlWriter& out, const Contents& contents) {
    const HexMesh& mesh = contents.mesh;
    const std::size_t points = mesh.points.size();
    const std::size_t cells = mesh.cells.size() + contents.quads.size() + contents.lines.size();
    out.line("<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" + std::to_string(cells) +
             "\">\n<Points>");
    out.array<double>("Points", 3, {reinterpret_cast<const double*>(mesh.points.data()), 3 * points});
    out.line("</Points>");
    write_cells(out, contents);
    out.line("<PointData>");
    for (const auto& attribute : mesh.attributes) {
        if (is_at_cells(mesh, attribute)) continue;
        out.array<double>(attribute.name, static_cast<std::size_t>(attribute.channels), attribute.values);
    }
    for (const NodeSet& set : contents.sets.nodes) {
        if (!set.cells.empty()) out.array<std::uint8_t>(node_array_name(set), 1, flags_of(mesh, set, points));
    }
    out.line("</PointData>\n<CellData>");
    for (const auto& attribute : mesh.attributes) {
        if (!is_at_cells(mesh, attribute)) continue;
        const std::vector<double> values = values_at_cells(attribute, contents);
        const auto channels = static_cast<std::size_t>(attribute.channels);
        if (attribute.constant && are_whole(values)) {  // labels, which readers take for such by their type
            out.array<std::int64_t>(attribute.name, channels, std::vector<std::int64_t>(values.begin(), values.end()));
        } else {
            out.array<double>(attribute.name, channels, values);
        }
    }
    std::vector<std::uint8_t> in_set;
    for (const CellSet& set : contents.sets.sets) {
        if (set.cells.empty()) continue;
        in_set.assign(cells, 0);
        for (const Index c : set.cells) in_set[c] = 1;
        out.array<std::uint8_t>(set_array_name(set), 1, in_set);
    }
    out.line("</CellData>\n</Piece>");
}

std::vector<std::string> write(const std::filesystem::path& path, const Contents& contents) {
    OutputFile out(path);
    VtkXmlWriter xml(out, "UnstructuredGrid");
    xml.line("<FieldData>");
    for (const NamedNumbers& array : settled_arrays(contents.mesh, contents.sets))
        xml.field<std::int64_t>(array.name, array.numbers);
    xml.line("</FieldData>");
    write_piece(xml, contents);
    xml.end();
    out.commit();
    return {};
}

}  // namespace

std::vector<std::string> write_vtu(const std::filesystem::path& path, const WrittenMesh& written) {
    const auto& [mesh, shells, sets] = written;
    if (shells.empty()) return write(path, {mesh, sets, {}, {}});
    HexMesh with = mesh;
    std::vector<Index> number;
    for (std::size_t p = 0; p < shells.points.size(); ++p) {
        const auto& [cell, corner] = shells.solid[p];
        number.push_back(cell != kNone ? mesh.cells[cell][corner] : static_cast<Index>(with.points.size()));
        if (cell != kNone) continue;
        with.points.push_back(shells.points[p]);
        for (std::size_t a = 0; a < with.attributes.size(); ++a) {
            const auto channels = static_cast<std::size_t>(with.attributes[a].channels);
            const auto first = shells.attributes[a].values.data() + p * channels;
            with.attributes[a].values.insert(with.attributes[a].values.end(), first, first + channels);
        }
    }
    auto quads = shells.quads;
    for (auto& quad : quads) {
        for (Index& p : quad) p = number[p];
    }
    auto lines = shells.lines;
    for (auto& line : lines) {
        for (Index& p : line) p = number[p];
    }
    return write(path, {with, sets, quads, lines});
}

}  // namespace subvol::detail
