// SPDX-License-Identifier: Apache-2.0
#include "brick_file.h"

#include <algorithm>
#include <bit>
#include <cstdio>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>

#include "subvol/detail/byte_hash.h"
#include "subvol/detail/output_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/detail/vtk_xml.h"
#include "subvol/detail/vtk_xml_writer.h"
#include "subvol/error.h"

// A brick is a .vtu file that opens alone: one piece of appended raw arrays, so that it is written and read without copies.
//
//      points, cells, fields       as in any .vtu file
//      GlobalNodeId, GlobalCellId  numbers in the whole mesh, ascending
//      vtkGhostType                1 in the halo: ParaView then shows no cell twice
//      subvol_creases, …           tags of edges and faces, in the field data, with the id of the folder
//
// The index has a hash of the bytes, and the reader refuses a file with another one.

namespace subvol::detail {

namespace {

constexpr std::uint8_t kHexahedron = 12;
constexpr std::uint8_t kGhost = 1;  // VTK's duplicate cell, and duplicate point
constexpr const char* kStart = "<?xml version=\"1.0\"?>\n<VTKFile";
constexpr const char* kId = "subvol_bricks";
constexpr const char* kCreases = "subvol_creases";
constexpr const char* kSharpFaces = "subvol_sharp_faces";
constexpr const char* kCellNumbers = "GlobalCellId";

static_assert(sizeof(Vec3) == 3 * sizeof(double), "points are written as they lie in memory");

/// Arrays that are appended as they lie in memory. The elements of all arrays are written first and refer to their bytes by an
/// offset; the bytes follow in the same order, each with its size in 8 bytes before it.
class RawArrays {
public:
    /// The element of an array; its bytes must live until `write_all`.
    template <class Number>
    std::string element(const char* type, std::string_view name, std::size_t components, std::span<const Number> values,
                        const std::string& more = {}) {
        const std::string text = "<DataArray type=\"" + std::string(type) + "\" Name=\"" + attribute_value(name) +
                                 "\" NumberOfComponents=\"" + std::to_string(components) + "\"" + more +
                                 " format=\"appended\" offset=\"" + std::to_string(offset_) + "\"/>\n";
        parts_.push_back({reinterpret_cast<const char*>(values.data()), values.size_bytes()});
        offset_ += sizeof(std::uint64_t) + values.size_bytes();
        return text;
    }
    template <class Write>
    void write_all(const Write& write) const {
        for (const std::string_view bytes : parts_) {
            const std::uint64_t size = bytes.size();
            write(std::string_view(reinterpret_cast<const char*>(&size), sizeof size));
            write(bytes);
        }
    }

private:
    std::vector<std::string_view> parts_;
    std::uint64_t offset_ = 0;
};

template <class T, std::size_t N>
std::span<const T> flat(const std::vector<std::array<T, N>>& tuples) {
    return {reinterpret_cast<const T*>(tuples.data()), N * tuples.size()};
}

const char* const kIndexType = sizeof(Index) == 4 ? "Int32" : "Int64";

/// VTK's flags of duplicates, which are the opposite of the flags of what is owned.
std::vector<std::uint8_t> ghosts(const std::vector<std::uint8_t>& owned) {
    std::vector<std::uint8_t> types(owned.size());
    for (std::size_t i = 0; i < owned.size(); ++i) types[i] = owned[i] ? 0 : kGhost;
    return types;
}

/// Reads the arrays of a brick: their bytes are appended as they lie in memory.
class RawReader {
public:
    RawReader(std::string_view text, const std::string& file)
        : file_(file), xml_(text, file, "UnstructuredGrid", "a brick is one") {
        // The appended bytes may hold anything, also "</VTKFile>", so the XML parser must not see them: they begin after the
        // first underscore behind the tag.
        const std::size_t tag = text.find("<AppendedData"), begin = text.find('_', tag);
        if (tag == std::string_view::npos || begin == std::string_view::npos) fail("it has no appended data");
        appended_ = text.substr(begin + 1);
        piece_ = xml_.data_set().child("Piece");
        points_ = xml_.count(piece_, "NumberOfPoints");
        cells_ = xml_.count(piece_, "NumberOfCells");
    }

    [[nodiscard]] std::size_t points() const { return points_; }
    [[nodiscard]] std::size_t cells() const { return cells_; }
    [[nodiscard]] pugi::xml_node group(const char* name) const { return piece_.child(name); }
    [[nodiscard]] pugi::xml_node field_data() const { return xml_.data_set().child("FieldData"); }
    [[nodiscard]] pugi::xml_node array(const pugi::xml_node& parent, const char* name) const {
        return xml_.array(parent, name);
    }

    /// count: how many elements there must be; none: any number
    template <class Element>
    void read(const pugi::xml_node& array, const char* type, std::optional<std::size_t> count,
              std::vector<Element>& values) const {
        const std::uint64_t offset = array.attribute("offset").as_ullong(~0ULL);
        std::uint64_t size = 0;
        // The subtraction cannot wrap, as it comes after the comparison of the sizes; an offset near 2⁶⁴ is refused in this
        // way, too.
        if (std::string_view(array.attribute("type").as_string()) != type || appended_.size() < sizeof size ||
            offset > appended_.size() - sizeof size) {
            fail("an array is not as this program writes it");
        }
        std::memcpy(&size, appended_.data() + offset, sizeof size);
        const bool fits = size <= appended_.size() - sizeof size - offset && size % sizeof(Element) == 0;
        if (!fits || (count && size / sizeof(Element) != *count)) fail("an array has the wrong length");
        values.resize(size / sizeof(Element));
        if (size > 0) std::memcpy(values.data(), appended_.data() + offset + sizeof size, size);
    }

    [[noreturn]] void fail(const std::string& what) const { throw Error(ErrorCode::InvalidInput, what, file_); }

private:
    std::string file_;
    VtkXml xml_;
    std::string_view appended_;
    pugi::xml_node piece_;
    std::size_t points_ = 0, cells_ = 0;
};

template <class Entities>
void check_corners(const RawReader& in, const Entities& entities) {
    for (const auto& entity : entities) {
        for (const Index p : entity) {
            if (p >= in.points())
                in.fail("a corner is " + std::to_string(p) + "; there are " + std::to_string(in.points()) + " points");
        }
    }
}

/// Numbers must ascend, because bricks are merged in one pass over sorted lists, which never looks back for a number.
void check_ascending(const RawReader& in, const std::vector<std::uint64_t>& numbers) {
    for (std::size_t i = 1; i < numbers.size(); ++i) {
        if (numbers[i - 1] >= numbers[i]) in.fail("its numbers do not ascend");
    }
}

void turn_into_owned(std::vector<std::uint8_t>& ghosts) {
    for (std::uint8_t& flag : ghosts) flag = flag == 0;
}

/// The id of the folder that a brick belongs to; nothing if the text is not that of a brick.
std::optional<std::uint64_t> id_of(std::string_view text, const std::string& file) {
    try {
        const RawReader in(text, file);
        std::vector<std::uint64_t> found;
        in.read(in.array(in.field_data(), kId), "Int64", 1, found);
        return found[0];
    } catch (const Error&) {
        return {};
    }
}

MeshPiece parse(std::string_view text, const std::string& file) {
    const RawReader in(text, file);
    MeshPiece brick;
    HexMesh& mesh = brick.mesh;
    // Lengths are checked against the counts of the piece while reading, corners and numbers afterwards: then later code may
    // use them as indices.
    const pugi::xml_node of_points = in.group("PointData"), of_cells = in.group("CellData");
    in.read(in.array(in.group("Points"), "Points"), "Float64", in.points(), mesh.points);
    in.read(in.array(in.group("Cells"), "connectivity"), kIndexType, in.cells(), mesh.cells);
    in.read(in.array(of_points, kNodeNumbers), "Int64", in.points(), brick.point_numbers);
    in.read(in.array(of_cells, kCellNumbers), "Int64", in.cells(), brick.cell_numbers);
    in.read(in.array(of_points, kGhosts), "UInt8", in.points(), brick.owned_points);
    in.read(in.array(of_cells, kGhosts), "UInt8", in.cells(), brick.owned_cells);
    in.read(in.array(in.field_data(), kCreases), kIndexType, {}, mesh.creases);
    in.read(in.array(in.field_data(), kSharpFaces), kIndexType, {}, mesh.sharp_faces);
    for (const auto& array : of_points.children("DataArray")) {
        const std::string name = array.attribute("Name").as_string();
        if (name == kNodeNumbers || name == kGhosts) continue;
        const int channels = array.attribute("NumberOfComponents").as_int(1);
        if (channels < 1) in.fail("a field has no channels");
        Attribute& field = mesh.attributes.emplace_back(Attribute{name, channels, {}});
        in.read(array, "Float64", in.points() * static_cast<std::size_t>(channels), field.values);
    }
    check_corners(in, mesh.cells);
    check_corners(in, mesh.creases);
    check_corners(in, mesh.sharp_faces);
    check_ascending(in, brick.point_numbers);
    check_ascending(in, brick.cell_numbers);
    turn_into_owned(brick.owned_points);
    turn_into_owned(brick.owned_cells);
    return brick;
}

}  // namespace

WrittenBrick write_brick_file(const std::filesystem::path& path, const MeshPiece& brick, std::uint64_t id) {
    const HexMesh& mesh = brick.mesh;
    const std::size_t points = mesh.points.size(), cells = mesh.cells.size();
    // VTK's offsets are written in 32 bits, and the last of them is 8 times the number of cells.
    if (8 * cells >= std::numeric_limits<std::int32_t>::max()) {
        throw Error(ErrorCode::InvalidInput, std::to_string(cells) + " cells are too many for a brick", path.string(),
                    "at most 268 million: use more bricks");
    }
    std::vector<std::int32_t> offsets(cells);
    for (std::size_t c = 0; c < cells; ++c) offsets[c] = static_cast<std::int32_t>(8 * (c + 1));
    const std::vector<std::uint8_t> types(cells, kHexahedron);
    const std::vector<std::uint8_t> point_ghosts = ghosts(brick.owned_points), cell_ghosts = ghosts(brick.owned_cells);
    const auto tuples = [](std::size_t n) { return " NumberOfTuples=\"" + std::to_string(n) + "\""; };
    RawArrays arrays;
    const std::string order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
    std::string text = std::string(kStart) + " type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"" + order +
                       "\" header_type=\"UInt64\">\n<UnstructuredGrid>\n<FieldData>\n";
    text += arrays.element("Int64", kId, 1, std::span<const std::uint64_t>(&id, 1), tuples(1));
    text += arrays.element(kIndexType, kCreases, 2, flat(mesh.creases), tuples(mesh.creases.size()));
    text += arrays.element(kIndexType, kSharpFaces, 4, flat(mesh.sharp_faces), tuples(mesh.sharp_faces.size()));
    text += "</FieldData>\n<Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" + std::to_string(cells) +
            "\">\n<Points>\n";
    text += arrays.element("Float64", "Points", 3, std::span(reinterpret_cast<const double*>(mesh.points.data()), 3 * points));
    text += "</Points>\n<Cells>\n";
    text += arrays.element(kIndexType, "connectivity", 1, flat(mesh.cells));
    text += arrays.element("Int32", "offsets", 1, std::span<const std::int32_t>(offsets));
    text += arrays.element("UInt8", "types", 1, std::span<const std::uint8_t>(types));
    text += "</Cells>\n<PointData GlobalIds=\"" + std::string(kNodeNumbers) + "\">\n";
    text += arrays.element("Int64", kNodeNumbers, 1, std::span<const std::uint64_t>(brick.point_numbers));
    text += arrays.element("UInt8", kGhosts, 1, std::span<const std::uint8_t>(point_ghosts));
    for (const Attribute& field : mesh.attributes) {
        text += arrays.element("Float64", field.name, static_cast<std::size_t>(field.channels),
                               std::span<const double>(field.values));
    }
    text += "</PointData>\n<CellData GlobalIds=\"" + std::string(kCellNumbers) + "\">\n";
    text += arrays.element("Int64", kCellNumbers, 1, std::span<const std::uint64_t>(brick.cell_numbers));
    text += arrays.element("UInt8", kGhosts, 1, std::span<const std::uint8_t>(cell_ghosts));
    text += "</CellData>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_";

    OutputFile out(path);
    ByteHash hash;
    // The hash is taken of the bytes on their way into the file, so that the file is not read again.
    const auto write = [&](std::string_view bytes) {
        out.write(bytes);
        hash.add(bytes);
    };
    write(text);
    arrays.write_all(write);
    write("\n</AppendedData>\n</VTKFile>\n");
    const std::uint64_t bytes = out.position();
    // All bricks are flushed to the disk together when the split ends, and not one by one.
    out.commit(Sync::Later);
    return {bytes, hash.value()};
}

MeshPiece read_brick_file(const std::filesystem::path& path, std::uint64_t hash, std::uint64_t id) {
    const std::string text = read_regular(path);
    ByteHash found;
    found.add(text);
    // The id is looked at first, because a brick of another split of the same mesh deserves another message than a damaged
    // file.
    const bool foreign = id_of(text, path.string()).value_or(id) != id;
    if (foreign || found.value() != hash) {
        throw Error(ErrorCode::InvalidInput,
                    foreign ? "is a brick of another mesh" : "has changed since the index was written, or is damaged",
                    path.string(), "split the mesh again");
    }
    return parse(text, path.string());
}

bool is_brick_of(const std::filesystem::path& path, std::uint64_t id) {
    const std::string text = read_text(path);
    // A loss of power may leave nothing, zeros or the beginning of what was not yet on the disk.
    const bool torn = text.find_first_not_of('\0') == std::string::npos || text.starts_with(kStart);
    const auto found = id_of(text, path.string());
    return found ? *found == id : torn;
}

std::uint64_t hash_of_file(const std::filesystem::path& path) {
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) throw Error(ErrorCode::Io, "cannot be read", path.string());
    ByteHash hash;
    // The file is read in parts, because a finished brick is only compared here and need not be held in memory.
    std::vector<char> chunk(1 << 20);
    while (const std::size_t length = std::fread(chunk.data(), 1, chunk.size(), file.get())) hash.add({chunk.data(), length});
    return hash.value();
}

}  // namespace subvol::detail
