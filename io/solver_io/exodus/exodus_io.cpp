// SPDX-License-Identifier: Apache-2.0
// Reads Exodus II files, in netCDF's classic form or in HDF5. A file has dimensions and variables over them; which ones they
// are follows from their names. Points come first, then blocks of elements of one type, counted one after the other:
//
//     points → blocks: cells and a set each → side sets: patches → element sets → variables of the chosen step
//
// Elements of blocks that are not read keep their numbers, so that values and sets refer to the right ones; their values are
// NaN where the file has none. Scalars whose names say that they are components are read as one vector or tensor. A count is
// checked against the size of the file before anything of that many is read.
//
// A mesh may lie in several files, NAME.4.0 to NAME.4.3. Each is read alone, with the numbers of its nodes in the whole mesh
// where it has them, and then the pieces are joined.
#include <algorithm>
#include <charconv>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "assemble.h"
#include "exodus_sides.h"
#include "join_pieces.h"
#include "mesh_file.h"
#include "polyhedra.h"
#include "solver_readers.h"
#include "subvol/detail/netcdf_source.h"
#include "subvol/detail/read_file.h"
#include "subvol/detail/scalar_groups.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

/// An Exodus II file: dimensions and variables over them, by name. Every failure is an Error(InvalidInput).
///
/// Never reads more values than the size of the file allows.
class ExodusFile {
public:
    /// bytes: of the file; file: its path. Both must outlive it. HDF5's library reads the file itself.
    ExodusFile(std::string_view bytes, std::string_view file);

    /// The length of a dimension; 0 if there is no dimension of that name.
    [[nodiscard]] std::size_t dimension(const std::string& name) const;
    [[nodiscard]] bool has(const std::string& variable) const { return source_->variables.contains(variable); }

    /// The variables of which no value was read.
    [[nodiscard]] std::vector<std::string> unused() const {
        std::vector<std::string> names;
        for (const auto& variable : source_->variables) {
            if (!used_.contains(variable.first)) names.push_back(variable.first);
        }
        std::ranges::sort(names);
        return names;
    }

    /// The values at given places along the first dimensions of a variable. count: their expected number
    [[nodiscard]] std::vector<double> reals(const std::string& variable, const std::vector<std::size_t>& places,
                                            std::size_t count) const;
    /// All values of a variable of integers.
    [[nodiscard]] std::vector<std::int64_t> integers(const std::string& variable, std::size_t count) const;
    /// The rows of characters of a variable as texts, without trailing blanks. count: their expected number
    [[nodiscard]] std::vector<std::string> names(const std::string& variable, std::size_t count) const;
    /// A text attribute of a variable; empty if there is none.
    [[nodiscard]] std::string attribute(const std::string& variable, const std::string& name) const;

    /// Fails if the file is too short for so many things of so many bytes each.
    void expect_room(std::size_t things, std::size_t bytes, const std::string& what) const;

    [[noreturn]] void fail(const std::string& message, const std::string& allowed = {}) const;

private:
    /// The variable; fails unless it has so many values at these places.
    [[nodiscard]] const NetcdfVariable& checked(const std::string& name, const std::vector<std::size_t>& places,
                                                std::size_t count) const;

    std::string_view bytes_;
    std::string_view file_;
    std::unique_ptr<NetcdfSource> source_;
    mutable std::set<std::string> used_;  // the variables of which values were read
};

// netCDF pads names with zeros or blanks.
std::string netcdf_text(std::string_view text) {
    text = text.substr(0, text.find('\0'));
    return as_utf8(text.substr(0, text.find_last_not_of(' ') + 1));
}

ExodusFile::ExodusFile(std::string_view bytes, std::string_view file) : bytes_(bytes), file_(file) {
    if (bytes.empty()) fail("the file is empty");
    if (bytes.starts_with("CDF")) {
        source_ = open_classic_netcdf(bytes, file);
    } else if (bytes.starts_with("\x89HDF")) {
        source_ = open_netcdf4(file);
    } else {
        fail("not an Exodus II file: it begins neither as netCDF nor as HDF5");
    }
}

std::size_t ExodusFile::dimension(const std::string& name) const {
    const auto found = source_->dimensions.find(name);
    return found == source_->dimensions.end() ? 0 : found->second;
}

const NetcdfVariable& ExodusFile::checked(const std::string& name, const std::vector<std::size_t>& places,
                                          std::size_t count) const {
    const auto found = source_->variables.find(name);
    if (found == source_->variables.end()) fail("there is no " + name);
    used_.insert(name);
    const NetcdfVariable& variable = found->second;
    if (variable.lengths.size() < places.size() || (variable.record && places.empty())) {
        fail(name + " has " + counted(variable.lengths.size(), "dimension", "dimensions"));
    }
    expect_room(count, size_of(variable.type), name);
    std::size_t values = 1;
    bool too_many = false;  // so that no product overflows
    for (std::size_t d = 0; d < variable.lengths.size(); ++d) {
        const std::size_t length = variable.lengths[d];
        if (d < places.size()) {
            if (places[d] >= length) fail(name + " has " + std::to_string(length) + " values along a dimension");
            continue;
        }
        too_many = too_many || (length > 0 && values > count / length);
        if (!too_many) values *= length;
    }
    if (too_many || values != count) fail(name + " does not have the " + std::to_string(count) + " values that are needed");
    return variable;
}

void ExodusFile::expect_room(std::size_t things, std::size_t bytes, const std::string& what) const {
    if (things <= bytes_.size() * source_->growth() / bytes) return;
    fail(what + ": count out of range: " + std::to_string(things), "the file has " + counted(bytes_.size(), "byte", "bytes"));
}

std::vector<double> ExodusFile::reals(const std::string& variable, const std::vector<std::size_t>& places,
                                      std::size_t count) const {
    const NetcdfVariable& found = checked(variable, places, count);
    if (found.characters) fail(variable + " does not consist of numbers");
    return reals_from(source_->values(variable, places), found.type, std::endian::native);
}

std::vector<std::int64_t> ExodusFile::integers(const std::string& variable, std::size_t count) const {
    const NetcdfVariable& found = checked(variable, {}, count);
    if (found.characters || !is_integer(found.type)) fail(variable + " does not consist of integers");
    return integers_from(source_->values(variable, {}), found.type, std::endian::native);
}

std::vector<std::string> ExodusFile::names(const std::string& variable, std::size_t count) const {
    if (count == 0) return {};
    const auto found = source_->variables.find(variable);
    const bool rows = found != source_->variables.end() && found->second.characters && found->second.lengths.size() == 2;
    const std::size_t length = rows ? found->second.lengths[1] : 0;
    if (length == 0 || found->second.lengths[0] != count)
        fail("there are no " + std::to_string(count) + " names in " + variable);
    expect_room(count, length, variable);
    std::ignore = checked(variable, {}, count * length);
    const std::string text = source_->values(variable, {});
    std::vector<std::string> names;
    for (std::size_t i = 0; i < count; ++i) names.push_back(netcdf_text(std::string_view(text).substr(i * length, length)));
    return names;
}

std::string ExodusFile::attribute(const std::string& variable, const std::string& name) const {
    return netcdf_text(source_->attribute(variable, name));
}

void ExodusFile::fail(const std::string& message, const std::string& allowed) const {
    throw Error(ErrorCode::InvalidInput, printable(message), std::string(file_), printable(allowed));
}

constexpr EntityNames kExodusNames{"node", "element", 1};

// A block of elements of one type.
//
// number: in the names of its variables, from 1
// first:  the number of its first element among all, from 0
// name:   its own, or "block" and the file's number for it
// taken:  it is read as cells
struct Block {
    std::size_t number, first, size, nodes;
    std::string type;
    std::string name = {};
    bool taken = false;
};

constexpr const char* kNfaced = "NFACED";

struct Variable {
    std::string name;
    std::vector<std::size_t> numbers;  // of its components, from 1
};

// Exodus has only scalars: those whose names say that they are components are read as a vector or a tensor.
std::vector<Variable> with_components(const std::vector<std::string>& names) {
    std::vector<Variable> variables;
    std::vector<bool> grouped(names.size());
    for (const detail::ScalarGroup& group : detail::scalar_groups(names)) {
        Variable& variable = variables.emplace_back(Variable{group.name, {}});
        for (const std::size_t member : group.members) {
            variable.numbers.push_back(member + 1);
            grouped[member] = true;
        }
    }
    for (std::size_t n = 0; n < names.size(); ++n) {
        if (!grouped[n]) variables.push_back({names[n], {n + 1}});
    }
    std::ranges::sort(variables, {}, [](const Variable& variable) { return *std::ranges::min_element(variable.numbers); });
    return variables;
}

class ExodusReader {
public:
    ExodusReader(std::string_view bytes, std::string_view file, const ReadOptions& options)
        : in_(std::string_view(), file, TextScanner::Comments::None),
          file_(file),
          options_(options),
          exodus_(bytes, file),
          bytes_(bytes.size()) {
        in_.name_no_place();
    }

    ReadResult read() {
        fill();
        return assemble(std::move(found_), in_, file_, kExodusNames, options_);
    }

    /// One of several pieces of a mesh, with the numbers of its nodes in the whole where it has them.
    MeshFile read_piece() {
        fill();
        refuse_not_finite(found_, in_, kExodusNames);
        if (exodus_.has("node_num_map")) {
            const auto numbers = exodus_.integers("node_num_map", found_.points.size());
            found_.arrays.push_back({std::string(kNodeNumberMap), 1, false, {numbers.begin(), numbers.end()}});
        }
        return std::move(found_);
    }

private:
    void fill() {
        read_points();
        find_blocks();
        name_blocks();
        const BlockChoice choice(options_.blocks, names_of_blocks(), file_);
        for (Block& block : blocks_) {
            if (!choice.takes(block.name)) continue;
            take(block);
            if (!block.taken) continue;
            found_.blocks.push_back({block.name, block.size});
            FileSet& set = found_.sets.emplace_back(FileSet{block.name, {}});
            for (std::size_t e = 0; e < block.size; ++e) set.numbers.push_back(static_cast<Index>(block.first + e));
        }
        // What names parts of the mesh stops nothing but itself where it cannot be read.
        const auto read_or_ignore = [&](const std::string& what, const auto& read) {
            try {
                read();
            } catch (const Error& error) {
                found_.ignore({what, {}, 1, error.message()});
            }
        };
        read_or_ignore("side sets", [&] { read_side_sets(); });
        read_or_ignore("node sets", [&] { read_node_sets(); });
        read_or_ignore("element sets", [&] { read_element_sets(); });
        read_variables();
        const std::size_t others = polyhedra_.take_into(found_, options_.other_cells == OtherCells::Ignore);
        if (others > 0) left_out_[kNfaced] += others;
        list_left_out();
        for (const std::string& variable : exodus_.unused()) found_.ignored.push_back({"variable", variable});
    }

    void read_points() {
        const std::size_t count = exodus_.dimension("num_nodes"), dimension = exodus_.dimension("num_dim");
        if (count == 0) exodus_.fail("not an Exodus II file, or it has no nodes");
        if (dimension != 3) exodus_.fail("dimension " + std::to_string(dimension) + " is not supported", "it has to be 3");
        if (count >= kNone) exodus_.fail("count out of range: " + std::to_string(count) + " nodes");
        std::vector<std::vector<double>> axes;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::string name = std::string("coord") + "xyz"[a];
            // The first versions have one variable for all coordinates.
            axes.push_back(exodus_.has(name) ? exodus_.reals(name, {}, count) : exodus_.reals("coord", {a}, count));
        }
        found_.points.reserve(count);
        for (std::size_t p = 0; p < count; ++p) add_point(found_, {axes[0][p], axes[1][p], axes[2][p]}, 0);
    }

    void find_blocks() {
        const std::size_t count = exodus_.dimension("num_el_blk");
        exodus_.expect_room(count, sizeof(std::int32_t), "num_el_blk");
        for (std::size_t b = 1; b <= count; ++b) {
            const std::string number = std::to_string(b);
            const std::size_t size = exodus_.dimension("num_el_in_blk" + number);
            if (size == 0) continue;
            exodus_.expect_room(size, 1, "block " + number);
            if (size >= kNone - elements_) exodus_.fail("there are too many elements");
            const std::string list = exodus_.has("facconn" + number) ? "facconn" : "connect";  // by faces, or by nodes
            blocks_.push_back({b, elements_, size, exodus_.dimension("num_nod_per_el" + number),
                               upper_case(exodus_.attribute(list + number, "elem_type"))});
            elements_ += size;
        }
    }

    void name_blocks() {
        const std::size_t count = exodus_.dimension("num_el_blk");
        const auto names = exodus_.has("eb_names") ? exodus_.names("eb_names", count) : std::vector<std::string>();
        const auto ids = exodus_.has("eb_prop1") ? exodus_.integers("eb_prop1", count) : std::vector<std::int64_t>();
        for (Block& block : blocks_) {
            const std::size_t b = block.number - 1;
            if (b < names.size()) block.name = printable(names[b]);
            if (!block.name.empty()) continue;
            block.name = "block " + (b < ids.size() ? std::to_string(ids[b]) : std::to_string(block.number));
        }
    }

    [[nodiscard]] std::vector<std::string> names_of_blocks() const {
        std::vector<std::string> names;
        for (const Block& block : blocks_) names.push_back(block.name);
        return names;
    }

    void take(Block& block) {
        const std::string& type = block.type;
        const bool others = options_.other_cells != OtherCells::Ignore;
        if (type.starts_with("HEX") && type != "HEXSHELL") {
            take_as(found_.hexes, block, "a hexahedron");
        } else if (others && type.starts_with("TET")) {
            take_as(found_.tets, block, "a tetrahedron");
        } else if (others && type.starts_with("WEDGE")) {
            take_as(found_.prisms, block, "a wedge");
        } else if (others && type.starts_with("PYR")) {
            take_as(found_.pyramids, block, "a pyramid");
        } else if (type == kNfaced) {
            take_polyhedra(block);
        } else {
            left_out_[type] += block.size;
        }
    }

    // The faces of elements of the type NFACED are those of all blocks of faces, counted from 1.
    void take_polyhedra(Block& block) {
        block.taken = true;
        if (faces_.empty()) read_faces();
        const std::string number = std::to_string(block.number);
        const auto counts = exodus_.integers("ebepecnt" + number, block.size);
        const auto list = exodus_.integers("facconn" + number, total(counts, "ebepecnt" + number));
        std::size_t next = 0;
        for (std::size_t e = 0; e < block.size; ++e) {
            CellFaces faces;
            for (std::int64_t k = 0; k < counts[e]; ++k) {
                const std::int64_t face = list[next++];
                if (face < 1 || static_cast<std::uint64_t>(face) > faces_.size()) {
                    exodus_.fail(kExodusNames.cell(block.first + e) + ": there is no face " + std::to_string(face),
                                 "faces are 1 to " + std::to_string(faces_.size()));
                }
                faces.push_back(faces_[static_cast<std::size_t>(face - 1)]);
            }
            polyhedra_.add(block.first + e, std::move(faces));
        }
    }

    void read_faces() {
        const std::size_t blocks = exodus_.dimension("num_fa_blk");
        exodus_.expect_room(blocks, sizeof(std::int32_t), "num_fa_blk");
        for (std::size_t b = 1; b <= blocks; ++b) {
            const std::string number = std::to_string(b);
            const auto counts = exodus_.integers("fbepecnt" + number, exodus_.dimension("num_fa_in_blk" + number));
            const auto nodes = exodus_.integers("fbconn" + number, total(counts, "fbepecnt" + number));
            std::size_t next = 0;
            for (const std::int64_t count : counts) {
                auto& face = faces_.emplace_back();
                for (std::int64_t k = 0; k < count; ++k) face.push_back(corner_of_face(nodes[next++], faces_.size()));
            }
        }
    }

    /// The sum of counts, which are those of things that the file has.
    [[nodiscard]] std::size_t total(const std::vector<std::int64_t>& counts, const std::string& variable) const {
        std::size_t sum = 0;
        for (const std::int64_t count : counts) {
            if (count < 0 || static_cast<std::uint64_t>(count) >= kNone - sum) exodus_.fail(variable + ": count out of range");
            sum += static_cast<std::size_t>(count);
        }
        return sum;
    }

    // The corners come first, then the nodes in the middle of edges, faces and the element.
    template <std::size_t N>
    void take_as(FileCells<N>& into, Block& block, std::string_view kind) {
        block.taken = true;
        if (block.nodes < N) {
            exodus_.fail("block " + std::to_string(block.number) + " of type " + in_quotes(block.type) + " has " +
                             std::to_string(block.nodes) + " nodes an element",
                         std::string(kind) + " has " + std::to_string(N));
        }
        exodus_.expect_room(block.size, block.nodes, "block " + std::to_string(block.number));
        const bool whole = N == 8 && options_.curved_tolerance && (block.nodes == 20 || block.nodes == 27);
        if (block.nodes > N && !whole) curved_ += block.size;
        std::vector<Index> all;
        const auto nodes = exodus_.integers("connect" + std::to_string(block.number), block.size * block.nodes);
        for (std::size_t e = 0; e < block.size; ++e) {
            auto& corners = into.corners.emplace_back();
            const std::size_t number = block.first + e;
            for (std::size_t k = 0; k < N; ++k) corners[k] = corner(nodes[e * block.nodes + k], number);
            into.numbers.push_back(static_cast<Index>(number));
            if (!whole) continue;
            all.clear();
            for (std::size_t k = 0; k < block.nodes; ++k) all.push_back(corner(nodes[e * block.nodes + k], number));
            found_.curved.add(number, CurvedOrder::Exodus, all);
        }
    }

    [[nodiscard]] Index corner(std::int64_t node, std::size_t element) const {
        return corner(node, [&] { return kExodusNames.cell(element); });
    }
    [[nodiscard]] Index corner_of_face(std::int64_t node, std::size_t face) const {
        return corner(node, [&] { return "face " + std::to_string(face); });
    }
    [[nodiscard]] Index corner(std::int64_t node, const auto& owner) const {
        const std::size_t count = found_.points.size();
        if (node < 1 || static_cast<std::uint64_t>(node) > count) {
            exodus_.fail(owner() + ": there is no node " + std::to_string(node), "nodes are 1 to " + std::to_string(count));
        }
        return static_cast<Index>(node - 1);
    }

    // The names of sets; those without one are called by their numbers. kind: "side set"; of: the part of Exodus's names
    [[nodiscard]] std::vector<std::string> names_of_sets(std::size_t count, const std::string& of,
                                                         const std::string& kind) const {
        exodus_.expect_room(count, sizeof(std::int32_t), kind + "s");
        auto names = exodus_.has(of + "_names") ? exodus_.names(of + "_names", count) : std::vector<std::string>(count);
        const auto ids = exodus_.has(of + "_prop1") ? exodus_.integers(of + "_prop1", count) : std::vector<std::int64_t>();
        for (std::size_t k = 0; k < count; ++k) {
            if (names[k].empty()) names[k] = kind + " " + std::to_string(k < ids.size() ? ids[k] : std::int64_t(k + 1));
        }
        return names;
    }

    // The elements of a set, from 0; those that are not there are refused.
    [[nodiscard]] std::vector<std::size_t> elements_in(const std::string& variable, std::size_t count) const {
        std::vector<std::size_t> elements;
        for (const std::int64_t element : exodus_.integers(variable, count)) {
            if (element < 1 || static_cast<std::uint64_t>(element) > elements_)
                exodus_.fail(variable + ": there is no element " + std::to_string(element));
            elements.push_back(static_cast<std::size_t>(element - 1));
        }
        return elements;
    }

    void read_side_sets() {
        const std::size_t count = exodus_.dimension("num_side_sets");
        const auto names = names_of_sets(count, "ss", "side set");
        std::map<std::size_t, std::vector<std::int64_t>> nodes_of;  // of blocks that sides are of
        std::vector<Index> corners;
        for (std::size_t k = 0; k < count; ++k) {
            const std::string number = std::to_string(k + 1);
            const std::size_t sides = exodus_.dimension("num_side_ss" + number);
            if (sides == 0) continue;
            const auto elements = elements_in("elem_ss" + number, sides);
            const auto places = exodus_.integers("side_ss" + number, sides);
            FilePatch patch{.name = names[k]};
            for (std::size_t s = 0; s < sides; ++s) {
                // Blocks have elements, one behind the other.
                const auto block = std::ranges::upper_bound(blocks_, elements[s], {}, &Block::first) - 1;
                if (!block->taken || block->type == kNfaced) continue;
                const CornersOfSides& all = exodus_sides(block->type);
                if (places[s] < 1 || static_cast<std::size_t>(places[s]) > all.size())
                    exodus_.fail(names[k] + ": " + kExodusNames.cell(elements[s]) + " has no side " +
                                 std::to_string(places[s]));
                auto& nodes = nodes_of[block->number];
                if (nodes.empty())
                    nodes = exodus_.integers("connect" + std::to_string(block->number), block->size * block->nodes);
                corners.clear();
                for (const std::size_t corner_of : all[static_cast<std::size_t>(places[s] - 1)])
                    corners.push_back(corner(nodes[(elements[s] - block->first) * block->nodes + corner_of], elements[s]));
                patch.add(corners);
            }
            found_.patches.push_back(std::move(patch));
        }
    }

    void read_node_sets() {
        const std::size_t count = exodus_.dimension("num_node_sets");
        const auto names = names_of_sets(count, "ns", "node set");
        for (std::size_t k = 0; k < count; ++k) {
            const std::string variable = "node_ns" + std::to_string(k + 1);
            const std::size_t size = exodus_.dimension("num_nod_ns" + std::to_string(k + 1));
            if (size == 0) continue;
            FileSet set{names[k], {}};
            for (const std::int64_t node : exodus_.integers(variable, size)) {
                if (node < 1 || static_cast<std::uint64_t>(node) > found_.points.size())
                    exodus_.fail(variable + ": there is no node " + std::to_string(node));
                set.numbers.push_back(static_cast<Index>(node - 1));
            }
            found_.node_sets.push_back(std::move(set));
        }
    }

    void read_element_sets() {
        const std::size_t count = exodus_.dimension("num_elem_sets");
        const auto names = names_of_sets(count, "els", "element set");
        for (std::size_t k = 0; k < count; ++k) {
            const std::string number = std::to_string(k + 1);
            const std::size_t size = exodus_.dimension("num_ele_els" + number);
            if (size == 0) continue;
            FileSet set{names[k], {}};
            for (const std::size_t element : elements_in("elem_els" + number, size))
                set.numbers.push_back(static_cast<Index>(element));
            found_.sets.push_back(std::move(set));
        }
    }

    void list_left_out() {
        if (curved_ > 0) {
            found_.warnings.push_back(counted(curved_, "element has", "elements have") +
                                      " more nodes than corners: only the corners are used");
        }
        add_left_out_warning(found_, ignored_parts("element type", left_out_), file_);
    }

    void read_variables() {
        const std::size_t steps = exodus_.dimension("time_step");
        step_ = chosen_step(options_, std::max<std::size_t>(1, steps), file_, found_.warnings);
        if (steps == 0) return;
        const auto of_nodes = exodus_.names("name_nod_var", exodus_.dimension("num_nod_var"));
        const auto of_elements = exodus_.names("name_elem_var", exodus_.dimension("num_elem_var"));
        for (const Variable& variable : with_components(of_nodes)) add_array(variable, false);
        for (const Variable& variable : with_components(of_elements)) add_array(variable, true);
    }

    void add_array(const Variable& variable, bool at_cells) {
        const std::size_t components = variable.numbers.size();
        FileArray array{variable.name, static_cast<int>(components), at_cells, {}};
        array.values.resize((at_cells ? elements_ : found_.points.size()) * components);
        for (std::size_t c = 0; c < components; ++c) {
            const std::size_t number = variable.numbers[c];
            const auto values = at_cells ? element_values(number) : node_values(number);
            if (values.empty()) {
                return found_.ignore({"array", variable.name, 1, "it is not in the blocks that are read, or in too few"});
            }
            for (std::size_t i = 0; i < values.size(); ++i) array.values[i * components + c] = values[i];
        }
        found_.arrays.push_back(std::move(array));
    }

    [[nodiscard]] std::vector<double> node_values(std::size_t variable) const {
        const std::string name = "vals_nod_var" + std::to_string(variable);
        const std::size_t nodes = found_.points.size();
        if (exodus_.has(name)) return exodus_.reals(name, {step_}, nodes);
        return exodus_.reals("vals_nod_var", {step_, variable - 1}, nodes);  // as in the first versions
    }

    // One value for each element of the file: NaN where a block has none. Empty if no block that is taken has one, or if too
    // many are missing for a file of this size.
    [[nodiscard]] std::vector<double> element_values(std::size_t variable) {
        std::vector<double> values(elements_, std::numeric_limits<double>::quiet_NaN());
        bool any = false;
        for (const Block& block : blocks_) {
            const std::string name = "vals_elem_var" + std::to_string(variable) + "eb" + std::to_string(block.number);
            if (!exodus_.has(name)) {
                if (block.taken) missing_ += block.size;
                continue;
            }
            any = any || block.taken;
            const auto of_block = exodus_.reals(name, {step_}, block.size);
            std::copy(of_block.begin(), of_block.end(), values.begin() + static_cast<std::ptrdiff_t>(block.first));
        }
        if (!any || missing_ > std::max(kFewMissing, bytes_)) return {};
        return values;
    }

    TextScanner in_;
    std::string_view file_;
    ReadOptions options_;
    ExodusFile exodus_;
    std::size_t bytes_;
    MeshFile found_;
    std::vector<Block> blocks_;
    std::size_t elements_ = 0;
    static constexpr std::size_t kFewMissing = std::size_t{1} << 20;

    std::size_t curved_ = 0;
    std::size_t missing_ = 0;  // values that blocks lack
    std::size_t step_ = 0;
    std::map<std::string, std::size_t> left_out_;
    CellFaces faces_;  // of the blocks of faces, read when the first polyhedra are
    Polyhedra polyhedra_;
};

}  // namespace

std::vector<double> exodus_times(const std::filesystem::path& path) {
    const std::string bytes = read_text(path), file = path.string();
    const ExodusFile exodus(bytes, file);
    const std::size_t steps = exodus.dimension("time_step");
    exodus.expect_room(steps, 1, "time_step");
    const bool has_times = exodus.has("time_whole");
    std::vector<double> times;
    for (std::size_t k = 0; k < steps; ++k) {
        times.push_back(has_times ? exodus.reals("time_whole", {k}, 1).front() : static_cast<double>(k));
    }
    return times;
}

ReadResult read_exodus(std::string_view text, std::string_view file, const ReadOptions& options) {
    return ExodusReader(text, file, options).read();
}

namespace {

// The files of a mesh in pieces, of which one is called NAME.4.0, NAME.4.1, … or with zeros before the last number: none if the
// name is not of this form.
std::vector<std::filesystem::path> exodus_pieces(const std::filesystem::path& path) {
    const std::string last = path.extension().string(), count = path.stem().extension().string();
    const auto number = [](const std::string& extension) -> std::optional<std::size_t> {
        const std::string_view digits = std::string_view(extension).substr(extension.empty() ? 0 : 1);
        std::size_t value = 0;
        const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        const bool whole = !digits.empty() && error == std::errc() && end == digits.data() + digits.size();
        return whole ? std::optional(value) : std::nullopt;
    };
    const auto pieces = number(count), which = number(last);
    constexpr std::size_t kMostPieces = 100000;
    if (!pieces || !which || *pieces < 2 || *pieces > kMostPieces || *which >= *pieces) return {};
    std::vector<std::filesystem::path> files;
    for (std::size_t k = 0; k < *pieces; ++k) {
        std::string digits = std::to_string(k);
        if (digits.size() + 1 < last.size()) digits.insert(0, last.size() - 1 - digits.size(), '0');
        files.push_back(path.parent_path() / (path.stem().string() + "." + digits));
    }
    return files;
}

MeshFile read_piece_file(const std::filesystem::path& file, const ReadOptions& options) {
    const std::string text = read_regular(file), name = file.string();
    return read_exodus_piece(text, name, options);
}

}  // namespace

std::size_t exodus_parts(const std::filesystem::path& path) {
    return exodus_pieces(path).size();
}

MeshFile read_exodus_part(const std::filesystem::path& path, std::size_t part, const ReadOptions& options) {
    return read_piece_file(exodus_pieces(path).at(part), options);
}

MeshFile read_exodus_piece(std::string_view text, std::string_view file, const ReadOptions& options) {
    return ExodusReader(text, file, options).read_piece();
}

ReadResult read_exodus_file(const std::filesystem::path& path, const ReadOptions& options) {
    const std::vector<std::filesystem::path> files = exodus_pieces(path);
    if (files.empty()) return read_exodus(read_text(path), path.string(), options);
    std::vector<MeshFile> pieces;
    for (const auto& file : files) pieces.push_back(read_piece_file(file, options));
    MeshFile found = join_pieces(std::move(pieces), "piece", path.string());
    std::erase_if(found.arrays, [](const FileArray& array) { return array.name == kNodeNumberMap; });
    std::vector<MeshBlock> blocks;
    ByName<MeshBlock> by_name(blocks);
    for (const MeshBlock& block : found.blocks) by_name[block.name].cells += block.cells;
    found.blocks = std::move(blocks);
    return assemble(std::move(found), path.string(), kExodusNames, options);
}

}  // namespace subvol::detail
