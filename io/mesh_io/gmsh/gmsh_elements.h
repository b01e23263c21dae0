// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh_file.h"
#include "sharp_groups.h"
#include "subvol/detail/number_type.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/hex_mesh.h"
#include "subvol/read_options.h"

namespace subvol::detail {

/// Reads the numbers of a Gmsh file: words of the text or, in a binary file, bytes between its lines.
class GmshValues {
public:
    explicit GmshValues(TextScanner& in) : in_(in) {}

    void set_binary(std::endian order) {
        order_ = order;
        in_.name_bytes();
    }
    [[nodiscard]] bool binary() const { return order_.has_value(); }

    /// To be called before the numbers of a section: in a binary file they begin after the end of the line.
    void begin() {
        if (order_) in_.line();
    }

    /// type: of the number in a binary file, Int32 or UInt64
    std::int64_t integer(const Place& place, NumberType type = NumberType::Int32) {
        return order_ ? integer_from(in_.bytes(size_of(type), place), type, *order_) : in_.integer(place);
    }
    std::size_t count(const Place& place, NumberType type = NumberType::Int32) {
        return in_.as_count(integer(place, type), place);
    }
    double real(const Place& place) {
        constexpr NumberType kType = NumberType::Float64;
        return order_ ? real_from(in_.bytes(size_of(kType), place), kType, *order_) : in_.real(place);
    }

    /// An upper bound for how many numbers are left in the file.
    [[nodiscard]] std::size_t room() const { return order_ ? in_.bytes_left() / size_of(NumberType::Int32) : in_.room_for(1); }
    [[nodiscard]] std::size_t position() const { return in_.position(); }

private:
    TextScanner& in_;
    std::optional<std::endian> order_;  // set if the file is binary
};

/// The numbers of the nodes, or of the elements, of a file: arbitrary but unique. Most often they are 1, 2, 3…
class GmshNumbers {
public:
    void add(std::int64_t number) { numbers_.push_back(number); }
    void reserve(std::size_t count) { numbers_.reserve(count); }
    [[nodiscard]] std::size_t size() const { return numbers_.size(); }
    /// In the order of `add`.
    [[nodiscard]] std::span<const std::int64_t> all() const { return numbers_; }

    /// To be called after the last `add` and before `find`. returns: a number that occurs twice
    std::optional<std::int64_t> sort() {
        places_.reserve(numbers_.size());
        for (Index n = 0; n < numbers_.size(); ++n) places_.emplace_back(numbers_[n], n);
        std::sort(places_.begin(), places_.end());
        const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
        const auto twice = std::adjacent_find(places_.begin(), places_.end(), same);
        return twice == places_.end() ? std::nullopt : std::optional(twice->first);
    }

    /// The place of a number in the order of `add`; kNone if it does not occur.
    [[nodiscard]] Index find(std::int64_t number) const {
        const auto guess = static_cast<std::uint64_t>(number) - 1;
        if (guess < places_.size() && places_[guess].first == number) return places_[guess].second;
        const auto found = std::lower_bound(places_.begin(), places_.end(), std::pair{number, Index{0}});
        return found == places_.end() || found->first != number ? kNone : found->second;
    }

private:
    std::vector<std::int64_t> numbers_;
    std::vector<std::pair<std::int64_t, Index>> places_;  // sorted by number
};

/// The kind of cell that a Gmsh element is read as; lines, triangles and quads as parts of groups.
enum class GmshShape { Other, Line, Triangle, Quad, Hexahedron, Tetrahedron, Prism, Pyramid };

/// A type of elements.
struct GmshElement {
    std::size_t nodes;  ///< number of nodes; the corners come first, then those in the middle of edges, faces and the element
    std::string_view one, many;
    GmshShape shape = GmshShape::Other;
};

/// The types of elements by Gmsh's number.
inline const std::map<std::int64_t, GmshElement> kGmshElements{
    {1, {2, "line", "lines", GmshShape::Line}},
    {2, {3, "triangle", "triangles", GmshShape::Triangle}},
    {3, {4, "quad", "quads", GmshShape::Quad}},
    {4, {4, "tetrahedron", "tetrahedra", GmshShape::Tetrahedron}},
    {5, {8, "hexahedron", "hexahedra", GmshShape::Hexahedron}},
    {6, {6, "prism", "prisms", GmshShape::Prism}},
    {7, {5, "pyramid", "pyramids", GmshShape::Pyramid}},
    {8, {3, "quadratic line", "quadratic lines", GmshShape::Line}},
    {9, {6, "quadratic triangle", "quadratic triangles", GmshShape::Triangle}},
    {10, {9, "quadratic quad", "quadratic quads", GmshShape::Quad}},
    {11, {10, "quadratic tetrahedron", "quadratic tetrahedra", GmshShape::Tetrahedron}},
    {12, {27, "quadratic hexahedron", "quadratic hexahedra", GmshShape::Hexahedron}},
    {13, {18, "quadratic prism", "quadratic prisms", GmshShape::Prism}},
    {14, {14, "quadratic pyramid", "quadratic pyramids", GmshShape::Pyramid}},
    {15, {1, "point", "points"}},
    {16, {8, "quadratic quad", "quadratic quads", GmshShape::Quad}},
    {17, {20, "quadratic hexahedron", "quadratic hexahedra", GmshShape::Hexahedron}},
    {18, {15, "quadratic prism", "quadratic prisms", GmshShape::Prism}},
    {19, {13, "quadratic pyramid", "quadratic pyramids", GmshShape::Pyramid}},
    {21, {10, "cubic triangle", "cubic triangles", GmshShape::Triangle}},
    {23, {15, "quartic triangle", "quartic triangles", GmshShape::Triangle}},
    {26, {4, "cubic line", "cubic lines", GmshShape::Line}},
    {27, {5, "quartic line", "quartic lines", GmshShape::Line}},
    {29, {20, "cubic tetrahedron", "cubic tetrahedra", GmshShape::Tetrahedron}},
    {30, {35, "quartic tetrahedron", "quartic tetrahedra", GmshShape::Tetrahedron}},
    {36, {16, "cubic quad", "cubic quads", GmshShape::Quad}},
    {37, {25, "quartic quad", "quartic quads", GmshShape::Quad}},
    {90, {40, "cubic prism", "cubic prisms", GmshShape::Prism}},
    {91, {75, "quartic prism", "quartic prisms", GmshShape::Prism}},
    {92, {64, "cubic hexahedron", "cubic hexahedra", GmshShape::Hexahedron}},
    {93, {125, "quartic hexahedron", "quartic hexahedra", GmshShape::Hexahedron}}};

/// A name without the quotes and blanks around it; "unnamed" if it is empty.
[[nodiscard]] std::string unquoted(std::string_view text);

/// The physical groups of a Gmsh file, and which of them the user wants to be sharp. They are of curves (dimension 1) and
/// surfaces (2).
class GmshGroups {
public:
    explicit GmshGroups(std::span<const std::string> wanted) : wanted_(wanted) {}

    /// Whether any are wanted.
    [[nodiscard]] bool any() const { return wanted_.any(); }

    /// Reads the section $PhysicalNames, whose keyword was the last word.
    void read_names(TextScanner& in);

    /// Reads the section $Entities, whose keyword was the last word.
    ///
    /// places: points of the geometry have their coordinates there, as in version 4.1, and no box
    void read_entities(GmshValues& values, bool places);

    /// Whether the user wants a group. group: negative where the element is turned round
    [[nodiscard]] bool is_sharp(std::int64_t dimension, std::int64_t group);

    /// Whether the user wants one of the groups that an entity of the geometry is in.
    [[nodiscard]] bool has_sharp(std::int64_t dimension, std::int64_t entity);

    /// The names of the groups of an entity of the geometry, or of one group; numbers where they have none.
    [[nodiscard]] std::vector<std::string> names_of_entity(std::int64_t dimension, std::int64_t entity) const;
    [[nodiscard]] std::string name_of(std::int64_t dimension, std::int64_t group) const;

    /// To be called after the last element. throws: as SharpGroups::check
    void check(std::string_view file) const { wanted_.check(file); }

private:
    using Key = std::pair<std::int64_t, std::int64_t>;  // dimension and number

    SharpGroups wanted_;
    std::map<Key, std::string> names_;
    std::map<Key, std::vector<std::int64_t>> groups_of_;  // of an entity of the geometry
    std::map<Key, bool> sharp_;                           // groups that occurred
};

/// 0 to 3; other elements than points, lines, triangles and quads count as solid.
[[nodiscard]] std::int64_t dimension_of(const GmshElement& element);

/// Puts the elements of a Gmsh file where they belong: cells, shells and beams, tags of sharp groups. Counts what is left out.
class GmshCells {
public:
    /// All are referred to.
    GmshCells(TextScanner& in, GmshValues& values, const GmshNumbers& nodes, const ReadOptions& options, MeshFile& found)
        : in_(in), values_(values), nodes_(nodes), options_(options), found_(found) {}

    /// Reads the nodes of an element.
    ///
    /// number:  in the order of the file, from 0
    /// sharp:   whether it is in a group that the user wants to be sharp
    /// type:    of the nodes' numbers
    /// returns: whether it is read as a cell
    bool take(const GmshElement& element, std::size_t number, bool sharp, NumberType type, const Place& place);

    /// The names of the groups of the elements that follow: points and lines become sets of nodes, triangles and quads patches,
    /// cells sets.
    void set_groups(std::vector<std::string> names) { groups_ = std::move(names); }

    /// To be called after the last element: warnings of what is left out.
    void list_left_out(std::string_view file);

private:
    Index read_corner(const Place& place, NumberType type);
    void take_tag(const GmshElement& element, NumberType type, const Place& place);
    void take_nodes(const GmshElement& element, std::size_t number, NumberType type, const Place& place);
    void take_surface(const GmshElement& element, std::size_t number, NumberType type, const Place& place);
    template <std::size_t N>
    void take_shell(FileCells<N>& into, const GmshElement& element, std::size_t number, NumberType type, const Place& place);
    template <std::size_t N>
    bool take_as(FileCells<N>& into, const GmshElement& element, std::size_t number, NumberType type, const Place& place);
    void leave_out(const GmshElement& element, std::size_t how_many);

    TextScanner& in_;
    GmshValues& values_;
    const GmshNumbers& nodes_;
    const ReadOptions& options_;
    MeshFile& found_;
    ByName<FilePatch> patches_{found_.patches};
    ByName<FileSet> sets_{found_.sets}, node_sets_{found_.node_sets};
    std::vector<std::string> groups_;
    std::size_t curved_ = 0;
    std::map<std::string_view, std::pair<std::size_t, std::string_view>> left_out_;
    std::vector<Index> grouped_;  // numbers of quads and lines that are in groups, ascending
};

}  // namespace subvol::detail
