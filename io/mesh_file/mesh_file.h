// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "curved_cells.h"
#include "subvol/detail/distinct_names.h"
#include "subvol/detail/flat_array.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/index.h"
#include "subvol/patch_values.h"
#include "subvol/read_options.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// What a file says of an array on the faces of one of its patches.
struct FileOnPatch {
    std::size_t patch = 0;
    bool along = false;               ///< vectors have no component along the normal, and nothing else is known
    std::vector<double> values = {};  ///< a tuple for each face; not a number: unknown
    bool level = false;               ///< the array does not change across the faces
};

/// An array of a file.
struct FileArray {
    std::string name;
    int components = 1;
    bool at_cells = false;  ///< one tuple for each cell of the file, of any kind; else one for each point
    std::vector<double> values;
    std::string unit = {};  ///< such as m/s
    std::vector<FileOnPatch> on_patches = {};
    bool integers = false;  ///< the file has it in a type of integers
};

/// Symmetric tensors have their components in the order xx, yy, zz, xy, yz, xz. The place of each in files that list the upper
/// triangle by rows: xx, xy, xz, yy, yz, zz.
inline constexpr std::array<std::size_t, 6> kSymmetricByRows{0, 3, 5, 1, 4, 2};

/// Values of symmetric tensors in our order. places: of our components in the file
void order_symmetric(std::vector<double>& values, const std::array<std::size_t, 6>& places);

/// The cells of one kind.
template <std::size_t N>
struct FileCells {
    std::vector<std::array<Index, N>> corners;
    std::vector<Index> numbers;  ///< number of each cell among all cells of the file, from 0; empty if no array needs it
};

/// All nodes of the curved ones among the hexahedra, which have their corners as all others.
struct CurvedHexes {
    std::vector<Index> numbers;  ///< as in FileCells
    std::vector<CurvedOrder> orders;
    std::vector<std::size_t> ends;  ///< where the nodes of each cell end
    std::vector<Index> nodes;

    [[nodiscard]] std::size_t size() const { return numbers.size(); }
    [[nodiscard]] std::span<const Index> nodes_of(std::size_t k) const {
        const std::size_t begin = k == 0 ? 0 : ends[k - 1];
        return std::span(nodes).subspan(begin, ends[k] - begin);
    }
    void add(std::size_t number, CurvedOrder order, std::span<const Index> of_cell) {
        numbers.push_back(static_cast<Index>(number));
        orders.push_back(order);
        nodes.insert(nodes.end(), of_cell.begin(), of_cell.end());
        ends.push_back(nodes.size());
    }
};

/// The faces and edges of the groups that ReadOptions::sharp names. A triangle repeats its last corner.
struct FileTags {
    std::vector<std::array<Index, 4>> faces;
    std::vector<std::array<Index, 2>> edges;
    bool settled = false;  ///< the file says which edges and faces are sharp, even if there are none

    [[nodiscard]] bool empty() const { return faces.empty() && edges.empty(); }
};

/// A named part of the surface of cells: faces by their corners, each a cycle of points.
struct FilePatch {
    std::string name;
    std::vector<std::size_t> ends = {};
    std::vector<Index> corners = {};
    PatchRole role = PatchRole::Open;

    [[nodiscard]] std::size_t size() const { return ends.size(); }
    [[nodiscard]] std::span<const Index> face(std::size_t f) const {
        const std::size_t begin = f == 0 ? 0 : ends[f - 1];
        return std::span(corners).subspan(begin, ends[f] - begin);
    }
    void add(std::span<const Index> face) {
        corners.insert(corners.end(), face.begin(), face.end());
        ends.push_back(corners.size());
    }
};

/// A named set of cells, by their numbers among all cells of the file; or of nodes, by the numbers of points.
struct FileSet {
    std::string name;
    std::vector<Index> numbers;
};

/// Finds the patches or sets of a list by their names, and adds those that are not there.
template <class Named>
class ByName {
public:
    /// all: is referred to, and changed by nobody else
    explicit ByName(std::vector<Named>& all) : all_(all) {}

    Named& operator[](const std::string& name) {
        const auto [at, is_new] = places_.try_emplace(name, all_.size());
        if (is_new) all_.emplace_back().name = name;
        return all_[at->second];
    }

private:
    std::vector<Named>& all_;
    std::unordered_map<std::string, std::size_t> places_;
};

/// The contents of a file as a reader found them; `assemble` makes a mesh of them.
struct MeshFile {
    struct NotFinite {
        std::size_t point;
        std::size_t position;
    };
    std::vector<Vec3> points;
    FileCells<8> hexes;
    FileCells<4> tets;
    FileCells<6> prisms;  ///< prisms of either handedness, since formats differ; otherwise as in MixedCells
    FileCells<5> pyramids;
    FileCells<4> quads;  ///< quads of shells; they need numbers
    FileCells<2> lines;  ///< lines of beams; they need numbers
    CurvedHexes curved;
    FileTags sharp;
    std::vector<FileArray> arrays;
    std::vector<UnreadField> unread;  ///< fields that could not be read
    /// Points with a coordinate that is not finite, and their position in the text: an error if a cell uses the point
    std::vector<NotFinite> not_finite;
    std::vector<std::string> warnings;
    std::vector<IgnoredPart> ignored;
    std::vector<MeshBlock> blocks;
    std::vector<FilePatch> patches;
    std::vector<FileSet> sets;
    std::vector<FileSet> node_sets;
    /// For points that were made in curved cells: the corners between which each lies; none: points are those of the file
    IndexRows carriers;
    std::optional<double> time;  ///< what the file says of itself
    bool cut = false;            ///< the cells fit together only if all are cut into tetrahedra
    bool turned = false;         ///< the hexahedra stay as they are, also where their volume is negative

    /// Notes a part that is not taken, and warns by `ignored_text`.
    void ignore(IgnoredPart part);
};

/// Calls call(cells) for the FileCells of each kind of cells with a volume.
template <class File, class Call>
void each_kind(File& file, const Call& call) {
    call(file.hexes);
    call(file.tets);
    call(file.prisms);
    call(file.pyramids);
}

/// A format's words for a point and a cell, and the number that it gives to the first of them, for messages.
struct EntityNames {
    std::string_view point_word;
    std::string_view cell_word;
    std::size_t first;
    std::span<const std::int64_t> point_numbers = {};  ///< number of each point where the numbers are not consecutive

    /// "vertex 13" for point 12 of a format that counts from 1.
    [[nodiscard]] std::string point(std::size_t p) const {
        return std::string(point_word) + " " +
               (point_numbers.empty() ? std::to_string(p + first) : std::to_string(point_numbers[p]));
    }
    [[nodiscard]] std::string cell(std::size_t c) const { return std::string(cell_word) + " " + std::to_string(c + first); }
};

/// Appends a point. position: where it was read in the text
void add_point(MeshFile& file, const Vec3& point, std::size_t position);

/// Reads three coordinates and appends them as a point. in: a TextScanner, VtkValues or GmshValues; of: as in Place
template <class Numbers>
void read_point(Numbers& in, MeshFile& file, const EntityNames& names, std::size_t of) {
    const Place place{names.point_word, static_cast<std::int64_t>(file.points.size() + names.first), of};
    Vec3 point;
    for (int i = 0; i < 3; ++i) point[i] = in.real(place);
    add_point(file, point, in.position());
}

/// 'array "a" ignored: it consists of texts'.
[[nodiscard]] std::string ignored_text(const IgnoredPart& part);

/// "4 elements of type S4", as formats say it that name the types of elements.
[[nodiscard]] std::string elements_of_type(const IgnoredPart& type);

/// Notes the cells that the reader left out, with one warning for all; refuses a file that has no other cells, unless `file`
/// is none.
///
/// types: with the number of cells of each; empty if there are none
/// text:  how many cells of a type there are
void add_left_out_warning(MeshFile& found, const std::vector<IgnoredPart>& types, std::optional<std::string_view> file,
                          const std::function<std::string(const IgnoredPart&)>& text = elements_of_type);

/// The names that were counted while a file was read, as parts of one kind that are not taken.
template <class Counts>
[[nodiscard]] std::vector<IgnoredPart> ignored_parts(std::string_view kind, const Counts& counts) {
    std::vector<IgnoredPart> parts;
    for (const auto& [name, count] : counts) parts.push_back({std::string(kind), std::string(name), count});
    return parts;
}

/// What a reader leaves out because it cannot read it, and nothing else needs it: one warning tells of all.
class LeftOut {
public:
    /// why: with the place in the file
    void add(const std::string& name, const std::string& why) { parts_.push_back({{}, name, 1, why}); }
    [[nodiscard]] bool empty() const { return parts_.empty(); }
    /// Appends "3 fields left out ("a", "b", "c"): " and why the first one is. one, many: words for them
    void report(std::string_view one, std::string_view many, std::vector<std::string>& warnings,
                std::vector<IgnoredPart>& ignored) const;

private:
    std::vector<IgnoredPart> parts_;  // without their kind
};

/// Names of the things of a mesh that are made distinct: one warning for each name that several have.
class NamesApart {
public:
    /// thing: a word for them, such as "array"
    explicit NamesApart(std::string thing) : thing_(std::move(thing)) {}

    /// The name that the next thing gets; "unnamed" if it has none.
    [[nodiscard]] std::string take(const std::string& name);
    /// Appends 'there is more than one array "T": another is called "T_2"'.
    void report(std::vector<std::string>& warnings) const;

private:
    struct Repeated {
        std::string name, first, last;
        std::size_t others = 0;
    };
    std::string thing_;
    DistinctNames distinct_;
    std::vector<Repeated> repeated_;
    std::unordered_map<std::string, std::size_t> places_;  // of names in `repeated_`
};

/// Leaves out the quads that are faces of hexahedra and the lines that are edges of them, and all of them if there are other
/// cells or curved ones, or no cells.
///
/// alone: keeps them if there are no cells
/// returns: the numbers of quads and of lines that were left out
std::array<std::size_t, 2> drop_parts_of_cells(MeshFile& found, bool alone);

/// Leaves out the cells for which drops(number in the list) is true. Returns how many.
template <std::size_t N, class Drops>
std::size_t drop_where(FileCells<N>& cells, const Drops& drops) {
    std::size_t kept = 0;
    for (std::size_t c = 0; c < cells.corners.size(); ++c) {
        if (drops(c)) continue;
        cells.corners[kept] = cells.corners[c];
        cells.numbers[kept++] = cells.numbers[c];
    }
    const std::size_t dropped = cells.corners.size() - kept;
    cells.corners.resize(kept);
    cells.numbers.resize(kept);
    return dropped;
}

/// Returns the array of that name and shape, or null.
[[nodiscard]] const FileArray* find_array(const MeshFile& found, std::string_view name, bool at_cells, int components);

/// A flag for each point: whether a cell uses it.
[[nodiscard]] std::vector<std::uint8_t> used_points(const MeshFile& found);

/// A block of points and the hexahedra between them, both counted along i first, then j, then k.
struct StructuredGrid {
    std::array<std::size_t, 3> points{};  ///< number of points along i, j and k

    /// The number of points and of cells; kNone if it is out of the range of Index.
    [[nodiscard]] std::size_t point_count() const;
    [[nodiscard]] std::size_t cell_count() const;
};

/// "3 x 4 x 5 points"
[[nodiscard]] std::string size_text(const StructuredGrid& grid);

/// A limit for the points of a grid that the file does not list one by one: a fixed number, plus one for each value that the
/// file can have.
[[nodiscard]] std::size_t most_points(std::size_t values);

/// Appends the points of a grid with planes perpendicular to the axes. at: the coordinates of the planes on each axis
void add_points(MeshFile& into, const std::array<std::vector<double>, 3>& at, std::size_t position);

/// Appends the hexahedra. first_point, first_cell: the numbers in the file of the first point and cell of the block
void add_hexes(MeshFile& into, const StructuredGrid& grid, std::size_t first_point, std::size_t first_cell);

/// Which of a file's blocks are read.
class BlockChoice {
public:
    /// wanted: their names, or if there is none of this name, names that differ in the case of letters; none: all of them.
    /// there: the names of all blocks
    ///
    /// throws: Error(InvalidInput) if a block that is wanted is not there
    BlockChoice(std::span<const std::string> wanted, const std::vector<std::string>& there, std::string_view file);

    [[nodiscard]] bool takes(const std::string& name) const { return wanted_.empty() || wanted_.contains(name); }

private:
    std::set<std::string> wanted_;
};

/// The step that the options choose; of several the last one, with a warning, if they choose none.
///
/// steps:  how many there are, at least 1
/// throws: Error(InvalidInput) if there is no such step
[[nodiscard]] std::size_t chosen_step(const ReadOptions& options, std::size_t steps, std::string_view file,
                                      std::vector<std::string>& warnings);

}  // namespace subvol::detail
