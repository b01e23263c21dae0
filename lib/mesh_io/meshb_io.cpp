// SPDX-License-Identifier: Apache-2.0
#include <map>

#include "assemble.h"
#include "formats.h"
#include "number_type.h"
#include "sharp_groups.h"

namespace subvol::detail {

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
        add_left_out_warning(found_, left_out_, file_);
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
        const std::map<std::int64_t, std::array<std::string_view, 2>> names{
            {kTetrahedra, {"tetrahedron", "tetrahedra"}}, {kPrisms, {"prism", "prisms"}}, {kPyramids, {"pyramid", "pyramids"}}};
        for (const auto& [section, name] : names) {
            if (!sections_.contains(section)) continue;
            const std::size_t count = count_in(section, {name[0]}, 1);
            if (count > 0) left_out_ += (left_out_.empty() ? "" : ", ") + counted(count, name[0], name[1]);
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
    std::string left_out_;
};

}  // namespace

ReadResult read_meshb(std::string_view text, std::string_view file, const ReadOptions& options) {
    return MeshbReader(text, file, options).read();
}

}  // namespace subvol::detail
