// SPDX-License-Identifier: Apache-2.0
// Reads MEDIT's meshes as text and as binary, and writes them as text. A section has entities of one kind: their count, then
// for each its vertices, counted from 1, and a reference.
//
//     text     one pass. Cells that come before the vertices are read at the end, when their indices can be checked
//     binary   the first number gives the byte order, the version the widths of numbers. Each section has the position of the
//              next one: a first pass finds all of them, then they are read in a fixed order
//
// Faces and edges become sharp if their reference is that of a wanted group; ridges are the numbers of edges. Cells other than
// hexahedra are read, or counted for a warning. Creases are written as edges that are ridges, and sharp faces as quadrilaterals
// of reference 1; of attributes and sets, which are not written, a warning tells.
#include <algorithm>
#include <charconv>
#include <map>
#include <set>

#include "assemble.h"
#include "formats.h"
#include "sharp_groups.h"
#include "subvol/detail/number_type.h"
#include "subvol/detail/output_file.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr EntityNames kMeditNames{"vertex", "hex", 1};

bool is_keyword(std::string_view word) {
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    return !word.empty() && is_letter(word[0]) &&
           std::all_of(word.begin(), word.end(), [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

// Cells other than hexahedra: singular and plural.
const std::map<std::string_view, std::array<std::string_view, 2>> kVolumeCells{{"Tetrahedra", {"tetrahedron", "tetrahedra"}},
                                                                               {"Prisms", {"prism", "prisms"}},
                                                                               {"Pentahedra", {"prism", "prisms"}},
                                                                               {"Wedges", {"wedge", "wedges"}},
                                                                               {"Pyramids", {"pyramid", "pyramids"}}};

// Sections of which groups of faces and edges are made.
const std::set<std::string_view> kTagSections{"Edges", "Ridges", "Triangles", "Quadrilaterals"};

// "2 prisms", or "Corners (8)".
std::string words_of(const IgnoredPart& section) {
    const auto cells = kVolumeCells.find(section.name);
    if (cells == kVolumeCells.end()) return section.name + " (" + std::to_string(section.count) + ")";
    return counted(section.count, cells->second[0], cells->second[1]);
}

class MeditReader {
public:
    MeditReader(std::string_view text, std::string_view file, const ReadOptions& options)
        : in_(text, file, TextScanner::Comments::Hash), file_(file), options_(options), groups_(options.sharp) {}

    ReadResult read() {
        read_header();
        while (!in_.at_end()) {
            const std::string_view keyword = in_.word();
            if (keyword == "End") break;
            if (!is_keyword(keyword)) in_.fail_word({"section"}, "a keyword", keyword);
            read_section(keyword);
        }
        if (!has_vertices_) in_.fail("there is no Vertices section");
        // The format lets cells come before the vertices; their indices can be checked only now.
        for (const auto& [keyword, place] : early_cells_) {
            in_ = place;
            read_cells(keyword);
        }
        tag_ridges();
        groups_.check(file_);
        list_left_out();
        return assemble(std::move(found_), in_, file_, kMeditNames, options_);
    }

private:
    void read_header() {
        if (in_.at_end()) in_.fail("the file is empty");
        const std::string_view first = in_.word();
        if (first == "MFEM") {
            in_.fail("a mesh in MFEM's own format, which is not read",
                     "MFEM's Mesh::PrintVTK, or its ParaViewDataCollection, writes files that are");
        }
        if (first != "MeshVersionFormatted") {
            in_.fail("not a MEDIT file: it begins with " + in_quotes(first), "MeshVersionFormatted is missing");
        }
        in_.integer({"MeshVersionFormatted"});
    }

    void read_section(std::string_view keyword) {
        if (keyword == "Dimension") {
            read_dimension();
        } else if (keyword == "Vertices") {
            read_vertices();
        } else if (keyword == "Hexahedra" || (kVolumeCells.contains(keyword) && options_.other_cells != OtherCells::Ignore) ||
                   (kTagSections.contains(keyword) && groups_.any())) {
            if (!cell_sections_.insert(keyword).second) in_.fail("there is a second " + shortened(keyword) + " section");
            if (has_vertices_) {
                read_cells(keyword);
            } else {
                early_cells_.emplace_back(keyword, in_);
                skip_numbers();
            }
        } else {
            left_out_[std::string(keyword)] += count_of_left_out(keyword);
            skip_numbers();
        }
    }

    void read_dimension() {
        const std::int64_t dimension = in_.integer({"Dimension"});
        if (dimension != 3) in_.fail("dimension " + std::to_string(dimension) + " is not supported", "it has to be 3");
        has_dimension_ = true;
    }

    void read_vertices() {
        if (!has_dimension_) in_.fail("Vertices come before Dimension");
        if (has_vertices_) in_.fail("there is a second Vertices section");
        has_vertices_ = true;
        const std::size_t count = in_.count({"Vertices"});
        found_.points.reserve(std::min(count, in_.room_for(4)));
        for (std::size_t v = 0; v < count; ++v) {
            read_point(in_, found_, kMeditNames, count);
            in_.integer({"reference of vertex", static_cast<std::int64_t>(v + 1), count});
        }
    }

    void read_cells(std::string_view keyword) {
        if (keyword == "Hexahedra") {
            read_cells(keyword, kMeditNames, found_.hexes.corners);
        } else if (keyword == "Tetrahedra") {
            read_cells(keyword, {"vertex", "tetrahedron", 1}, found_.tets.corners);
        } else if (keyword == "Pyramids") {
            read_cells(keyword, {"vertex", "pyramid", 1}, found_.pyramids.corners);
        } else if (keyword == "Quadrilaterals") {
            read_tags<4>(keyword, "quadrilateral", [&](const auto& quad) { found_.sharp.faces.push_back(quad); });
        } else if (keyword == "Triangles") {
            read_tags<3>(keyword, "triangle", [&](const auto& t) { found_.sharp.faces.push_back({t[0], t[1], t[2], t[2]}); });
        } else if (keyword == "Edges") {
            read_tags<2>(keyword, "edge", [&](const auto& edge) { found_.sharp.edges.push_back(edge); });
        } else if (keyword == "Ridges") {
            const std::size_t count = in_.count({keyword});
            for (std::size_t r = 0; r < count; ++r) {
                ridges_.push_back(in_.integer({"ridge", static_cast<std::int64_t>(r + 1), count}));
            }
        } else {
            read_cells(keyword, {"vertex", "prism", 1}, found_.prisms.corners);
        }
    }

    // Reads faces or edges, and calls take(corners) for those whose reference is that of a wanted group.
    template <std::size_t N, class Take>
    void read_tags(std::string_view keyword, std::string_view word, const Take& take) {
        const std::size_t count = in_.count({keyword});
        const std::string reference = "reference of " + std::string(word);
        for (std::size_t t = 0; t < count; ++t) {
            const auto number = static_cast<std::int64_t>(t + 1);
            std::array<Index, N> corners;
            for (Index& corner : corners) corner = read_vertex_index({word, number, count});
            if constexpr (N == 2) edges_.push_back(corners);
            if (groups_.takes(std::to_string(in_.integer({reference, number, count})))) take(corners);
        }
    }

    // Ridges are numbers of edges, from 1.
    void tag_ridges() {
        if (ridges_.empty() || !groups_.takes("Ridges")) return;
        for (const std::int64_t ridge : ridges_) {
            if (ridge < 1 || ridge > static_cast<std::int64_t>(edges_.size())) {
                in_.fail("Ridges: there is no edge with index " + std::to_string(ridge),
                         "indices are 1 to " + std::to_string(edges_.size()));
            }
            found_.sharp.edges.push_back(edges_[static_cast<std::size_t>(ridge - 1)]);
        }
    }

    template <std::size_t N>
    void read_cells(std::string_view keyword, const EntityNames& names, std::vector<std::array<Index, N>>& cells) {
        const std::size_t count = in_.count({keyword});
        const std::string reference = "reference of " + std::string(names.cell_word);
        cells.reserve(cells.size() + std::min(count, in_.room_for(N + 1)));
        for (std::size_t c = 0; c < count; ++c) {
            const auto number = static_cast<std::int64_t>(c + 1);
            auto& cell = cells.emplace_back();
            for (std::size_t k = 0; k < N; ++k) cell[k] = read_vertex_index({names.cell_word, number, count});
            in_.integer({reference, number, count});
        }
    }

    Index read_vertex_index(const Place& place) {
        const std::int64_t index = in_.integer(place);
        const std::size_t count = found_.points.size();
        if (index < 1 || index > static_cast<std::int64_t>(count)) {
            in_.fail(std::string(place.what) + " " + std::to_string(place.number) + ": there is no vertex with index " +
                         std::to_string(index),
                     "indices are 1 to " + std::to_string(count));
        }
        return static_cast<Index>(index - 1);
    }

    // Sections of other programs may begin with anything; the count of cells that are left out must be right, for the warning.
    std::size_t count_of_left_out(std::string_view keyword) {
        if (kVolumeCells.contains(keyword)) return in_.count({keyword});
        std::size_t count = 0;
        const std::string_view first = in_.peek();
        std::from_chars(first.data(), first.data() + first.size(), count);
        return count;
    }

    void skip_numbers() {
        while (!in_.at_end() && !is_keyword(in_.peek())) in_.word();
    }

    // Warns of the cells and of the other sections that are left out, except empty ones.
    void list_left_out() {
        std::erase_if(left_out_, [](const auto& section) { return section.second == 0; });
        std::vector<IgnoredPart> cells = ignored_parts("section", left_out_);
        bool some = false;
        each_kind(found_, [&](const auto& kind) { some = some || !kind.corners.empty(); });
        const auto others = std::stable_partition(cells.begin(), cells.end(),
                                                  [](const IgnoredPart& part) { return kVolumeCells.contains(part.name); });
        const std::vector<IgnoredPart> sections(others, cells.end());
        if (some) cells.erase(others, cells.end());
        add_left_out_warning(found_, cells, file_, words_of);
        if (sections.empty()) return;
        std::string list;
        for (const IgnoredPart& part : sections) list += (list.empty() ? "" : ", ") + words_of(part);
        found_.warnings.push_back("sections ignored: " + list);
        found_.ignored.insert(found_.ignored.end(), sections.begin(), sections.end());
    }

    TextScanner in_;
    std::string_view file_;
    ReadOptions options_;
    MeshFile found_;
    SharpGroups groups_;
    std::vector<std::array<Index, 2>> edges_;
    std::vector<std::int64_t> ridges_;
    std::vector<std::pair<std::string_view, TextScanner>> early_cells_;
    std::set<std::string_view> cell_sections_;
    std::map<std::string, std::size_t> left_out_;
    bool has_dimension_ = false;
    bool has_vertices_ = false;
};

void append_number(std::string& text, double value) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
    text.append(digits, end);
    text += ' ';
}

// A section of entities that are lists of points, each followed by its reference.
template <std::size_t N>
void write_section(OutputFile& out, const std::string& keyword, const std::vector<std::array<Index, N>>& entities,
                   const std::string& reference) {
    out.write(keyword + "\n" + std::to_string(entities.size()) + "\n");
    std::string line;
    for (const auto& entity : entities) {
        line.clear();
        for (const Index p : entity) line += std::to_string(std::size_t{p} + 1) + ' ';
        out.write(line += reference + "\n");
    }
}

// Creases as ridges, as other programs have them, and sharp faces as a group: --sharp reads both.
void write_sharp(OutputFile& out, const HexMesh& mesh) {
    if (!mesh.creases.empty()) {
        write_section(out, "Edges", mesh.creases, "1");
        out.write("Ridges\n" + std::to_string(mesh.creases.size()) + "\n");
        for (std::size_t r = 1; r <= mesh.creases.size(); ++r) out.write(std::to_string(r) + "\n");
    }
    if (!mesh.sharp_faces.empty()) write_section(out, "Quadrilaterals", mesh.sharp_faces, "1");
}

}  // namespace

ReadResult read_medit(std::string_view text, std::string_view file, const ReadOptions& options) {
    return MeditReader(text, file, options).read();
}

std::vector<std::string> write_medit(const std::filesystem::path& path, const WrittenMesh& written) {
    const HexMesh& mesh = written.mesh;
    OutputFile out(path);
    out.write("MeshVersionFormatted 2\nDimension 3\nVertices\n" + std::to_string(mesh.points.size()) + "\n");
    std::string line;
    for (const Vec3& x : mesh.points) {
        line.clear();
        for (int i = 0; i < 3; ++i) append_number(line, x[i]);
        out.write(line += "0\n");
    }
    write_section(out, "Hexahedra", mesh.cells, "0");
    write_sharp(out, mesh);
    out.write("End\n");
    out.commit();

    std::vector<std::string> warnings;
    warn_of_lost_fields(".mesh", mesh.attributes, warnings);
    if (!mesh.creases.empty() || !mesh.sharp_faces.empty()) {
        warnings.push_back(sharp_counts(mesh) + " written as groups, which only --sharp 1 reads again");
    }
    if (!written.sets.empty()) warnings.push_back(list_of(written.sets) + " not written: .mesh files of ours do not have them");
    return warnings;
}

namespace {

constexpr EntityNames kMeshbNames{"vertex", "hex", 1};

// Sections by their numbers in the format.
constexpr std::int64_t kDimension = 3;
constexpr std::int64_t kVertices = 4;
constexpr std::int64_t kEdges = 5;
constexpr std::int64_t kTriangles = 6;
constexpr std::int64_t kQuadrilaterals = 7;
constexpr std::int64_t kTetrahedra = 8;
constexpr std::int64_t kPrisms = 9;
constexpr std::int64_t kHexahedra = 10;
constexpr std::int64_t kRidges = 14;
constexpr std::int64_t kPyramids = 49;
constexpr std::int64_t kEnd = 54;

// MEDIT's binary files: sections, each of which has the position of the next one.
class MeshbReader {
public:
    MeshbReader(std::string_view text, std::string_view file, const ReadOptions& options)
        : in_(text, file, TextScanner::Comments::None), file_(file), options_(options), groups_(options.sharp) {
        in_.name_bytes();
        in_.seek(0);
    }

    ReadResult read() {
        read_header();
        find_sections();
        if (!sections_.contains(kDimension)) in_.fail("there is no Dimension");
        in_.seek(sections_[kDimension]);
        const std::int64_t dimension = number({"Dimension"}, NumberType::Int32);
        if (dimension != 3) in_.fail("dimension " + std::to_string(dimension) + " is not supported", "it has to be 3");
        read_vertices();
        read_cells(kHexahedra, "hex", found_.hexes);
        if (options_.other_cells == OtherCells::Ignore) {
            list_left_out();
        } else {
            read_cells(kTetrahedra, "tetrahedron", found_.tets);
            read_cells(kPrisms, "prism", found_.prisms);
            read_cells(kPyramids, "pyramid", found_.pyramids);
        }
        if (groups_.any()) read_groups();
        groups_.check(file_);
        add_left_out_warning(found_, left_out_, file_, words_of);
        note_other_sections();
        return assemble(std::move(found_), in_, file_, kMeshbNames, options_);
    }

private:
    // The file begins with the number 1, from which the byte order follows. In version 1 all numbers have 4 bytes; in version 2
    // reals have 8, in 3 also positions, in 4 also integers.
    void read_header() {
        if (in_.bytes_left() == 0) in_.fail("the file is empty");
        const std::string_view one = in_.bytes(size_of(NumberType::Int32), {"byte order"});
        for (const std::endian order : {std::endian::little, std::endian::big}) {
            order_ = order;
            if (integer_from(one, NumberType::Int32, order) == 1) break;
        }
        if (integer_from(one, NumberType::Int32, order_) != 1) {
            in_.fail("not a binary MEDIT file: it does not begin with the number 1", "text files are called .mesh");
        }
        const std::int64_t version = number({"version"}, NumberType::Int32);
        if (version < 1 || version > 4) in_.fail("version " + std::to_string(version) + " is not supported", "1 to 4 are");
        real_ = version == 1 ? NumberType::Float32 : NumberType::Float64;
        position_ = version < 3 ? NumberType::Int32 : NumberType::Int64;
        integer_ = version < 4 ? NumberType::Int32 : NumberType::Int64;
    }

    // Each section begins after the one before it, so the loop ends.
    void find_sections() {
        while (in_.bytes_left() > 0) {
            const std::int64_t section = number({"section"}, NumberType::Int32);
            if (section == kEnd) return;
            const std::size_t begin = in_.position();
            const std::int64_t next = number({"position of the next section"}, position_);
            if (!sections_.emplace(section, in_.position() + size_of(position_)).second) {
                in_.fail("there is a second section of the kind " + std::to_string(section));
            }
            if (next == 0) return;
            if (next <= static_cast<std::int64_t>(begin)) in_.fail("a section begins before the one that names it");
            if (static_cast<std::size_t>(next) > in_.position() + in_.bytes_left()) {
                in_.fail("the next section should begin at byte " + std::to_string(next) + ", after the end of the file");
            }
            in_.seek(static_cast<std::size_t>(next));
        }
    }

    std::int64_t number(const Place& place, NumberType type) {
        return integer_from(in_.bytes(size_of(type), place), type, order_);
    }

    // Reads the count at the beginning of a section. bytes: of each item; refuses a count that the rest of the file is too
    // short for
    std::size_t count_in(std::int64_t section, const Place& place, std::size_t bytes) {
        in_.seek(sections_[section]);
        const std::size_t count = in_.as_count(number(place, integer_), place);
        if (count > in_.bytes_left() / bytes) {
            in_.fail(std::string(place.what) + ": count out of range: " + std::to_string(count),
                     std::to_string(in_.bytes_left()) + " bytes are left");
        }
        return count;
    }

    void read_vertices() {
        if (!sections_.contains(kVertices)) in_.fail("there are no Vertices");
        const std::size_t count = count_in(kVertices, {"Vertices"}, 3 * size_of(real_) + size_of(integer_));
        found_.points.reserve(count);
        for (std::size_t v = 0; v < count; ++v) {
            const Place place{"vertex", static_cast<std::int64_t>(v + 1), count};
            Vec3 point;
            for (int i = 0; i < 3; ++i) point[i] = real_from(in_.bytes(size_of(real_), place), real_, order_);
            add_point(found_, point, in_.position());
            number(place, integer_);
        }
    }

    template <std::size_t N>
    void read_cells(std::int64_t section, std::string_view name, FileCells<N>& into) {
        if (!sections_.contains(section)) return;
        const std::size_t count = count_in(section, {name}, (N + 1) * size_of(integer_));
        into.corners.resize(count);
        for (std::size_t c = 0; c < count; ++c) {
            const Place place{name, static_cast<std::int64_t>(c + 1), count};
            for (Index& corner : into.corners[c]) corner = read_corner(place);
            number(place, integer_);
        }
    }

    void read_groups() {
        auto& faces = found_.sharp.faces;
        auto& edges = found_.sharp.edges;
        read_tags<4>(kQuadrilaterals, "quadrilateral", [&](const auto& quad) { faces.push_back(quad); });
        read_tags<3>(kTriangles, "triangle", [&](const auto& t) { faces.push_back({t[0], t[1], t[2], t[2]}); });
        std::vector<std::array<Index, 2>> all;
        read_tags<2>(
            kEdges, "edge", [&](const auto& edge) { edges.push_back(edge); }, &all);
        if (!sections_.contains(kRidges)) return;
        const std::size_t count = count_in(kRidges, {"Ridges"}, size_of(integer_));
        if (count == 0 || !groups_.takes("Ridges")) return;
        for (std::size_t r = 0; r < count; ++r) {
            const std::int64_t edge = number({"ridge", static_cast<std::int64_t>(r + 1), count}, integer_);
            if (edge < 1 || edge > static_cast<std::int64_t>(all.size())) {
                in_.fail("Ridges: there is no edge with index " + std::to_string(edge),
                         "indices are 1 to " + std::to_string(all.size()));
            }
            edges.push_back(all[static_cast<std::size_t>(edge - 1)]);
        }
    }

    // Reads faces or edges, and calls take(corners) for those whose reference is that of a wanted group.
    template <std::size_t N, class Take>
    void read_tags(std::int64_t section, std::string_view name, const Take& take,
                   std::vector<std::array<Index, N>>* all = nullptr) {
        if (!sections_.contains(section)) return;
        const std::size_t count = count_in(section, {name}, (N + 1) * size_of(integer_));
        for (std::size_t t = 0; t < count; ++t) {
            const Place place{name, static_cast<std::int64_t>(t + 1), count};
            std::array<Index, N> corners;
            for (Index& corner : corners) corner = read_corner(place);
            if (all) all->push_back(corners);
            if (groups_.takes(std::to_string(number(place, integer_)))) take(corners);
        }
    }

    Index read_corner(const Place& place) {
        const std::int64_t index = number(place, integer_);
        const std::size_t points = found_.points.size();
        if (index < 1 || index > static_cast<std::int64_t>(points)) {
            in_.fail(std::string(place.what) + " " + std::to_string(place.number) + ": there is no vertex with index " +
                         std::to_string(index),
                     "indices are 1 to " + std::to_string(points));
        }
        return static_cast<Index>(index - 1);
    }

    void list_left_out() {
        const std::map<std::int64_t, std::string> names{
            {kTetrahedra, "Tetrahedra"}, {kPrisms, "Prisms"}, {kPyramids, "Pyramids"}};
        for (const auto& [section, name] : names) {
            if (!sections_.contains(section)) continue;
            const std::size_t count = count_in(section, {name}, 1);
            if (count > 0) left_out_.push_back({"section", name, count});
        }
    }

    // Sections are known by their numbers in the format.
    void note_other_sections() {
        std::set<std::int64_t> taken{kDimension, kVertices, kTetrahedra, kPrisms, kHexahedra, kPyramids, kEnd};
        if (groups_.any()) taken.insert({kEdges, kTriangles, kQuadrilaterals, kRidges});
        for (const auto& section : sections_) {
            if (!taken.contains(section.first)) found_.ignored.push_back({"section", std::to_string(section.first)});
        }
    }

    TextScanner in_;
    std::string_view file_;
    ReadOptions options_;
    std::endian order_ = std::endian::little;
    NumberType real_ = NumberType::Float64;
    NumberType position_ = NumberType::Int32;
    NumberType integer_ = NumberType::Int32;
    std::map<std::int64_t, std::size_t> sections_;  // the position of the count of each
    MeshFile found_;
    SharpGroups groups_;
    std::vector<IgnoredPart> left_out_;
};

}  // namespace

ReadResult read_meshb(std::string_view text, std::string_view file, const ReadOptions& options) {
    return MeshbReader(text, file, options).read();
}

}  // namespace subvol::detail
