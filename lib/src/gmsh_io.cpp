#include <algorithm>
#include <limits>
#include <map>
#include <set>

#include "mesh_file.h"

namespace subvol {

namespace {

struct ElementKind {
    std::size_t nodes;
    std::string_view one, many;
};

constexpr std::int64_t kTetrahedron = 4;
constexpr std::int64_t kHexahedron = 5;
constexpr std::int64_t kPrism = 6;
constexpr std::int64_t kPyramid = 7;

const std::map<std::int64_t, ElementKind> kKinds{{1, {2, "line", "lines"}},
                                                 {2, {3, "triangle", "triangles"}},
                                                 {3, {4, "quad", "quads"}},
                                                 {kTetrahedron, {4, "tetrahedron", "tetrahedra"}},
                                                 {kHexahedron, {8, "hexahedron", "hexahedra"}},
                                                 {kPrism, {6, "prism", "prisms"}},
                                                 {kPyramid, {5, "pyramid", "pyramids"}},
                                                 {8, {3, "quadratic line", "quadratic lines"}},
                                                 {9, {6, "quadratic triangle", "quadratic triangles"}},
                                                 {10, {9, "quadratic quad", "quadratic quads"}},
                                                 {11, {10, "quadratic tetrahedron", "quadratic tetrahedra"}},
                                                 {12, {27, "quadratic hexahedron", "quadratic hexahedra"}},
                                                 {13, {18, "quadratic prism", "quadratic prisms"}},
                                                 {14, {14, "quadratic pyramid", "quadratic pyramids"}},
                                                 {15, {1, "point", "points"}},
                                                 {16, {8, "quadratic quad", "quadratic quads"}},
                                                 {17, {20, "quadratic hexahedron", "quadratic hexahedra"}},
                                                 {18, {15, "quadratic prism", "quadratic prisms"}},
                                                 {19, {13, "quadratic pyramid", "quadratic pyramids"}}};

class GmshReader {
public:
    GmshReader(std::string_view text, std::string_view file, const ReadOptions& options)
        : in_(text, file, TextScanner::Comments::None), file_(file), options_(options) {}

    ReadResult read() {
        read_format();
        while (!in_.at_end()) {
            const std::string_view keyword = in_.word();
            if (!keyword.starts_with('$')) in_.fail_word({"section"}, "a keyword that begins with $", keyword);
            read_section(keyword);
        }
        if (found_.points.empty()) in_.fail("there is no $Nodes section, or it is empty");
        list_left_out();
        return finish(std::move(found_), in_, file_, wording_, options_);
    }

private:
    void read_format() {
        if (in_.at_end()) in_.fail("the file is empty");
        const std::string_view first = in_.word();
        if (first != "$MeshFormat") in_.fail("not a Gmsh file: it begins with " + in_quotes(first), "$MeshFormat is missing");
        const double version = in_.real({"version"});
        if (!(version >= 2 && version < 3)) {
            in_.fail("version " + number_word() + " of Gmsh's format is not supported", "2 is: gmsh -save -format msh2");
        }
        if (in_.integer({"file type"}) != 0) {
            in_.fail("binary Gmsh files are not supported", "ASCII is: gmsh -save -format msh2 -bin 0");
        }
        in_.integer({"data size"});
        read_end("$MeshFormat");
    }

    // The word that was read last, as it stands there.
    [[nodiscard]] std::string number_word() const {
        TextScanner again = in_;
        again.seek(in_.position());
        return std::string(again.word().substr(0, 8));
    }

    void read_end(std::string_view keyword) {
        const std::string end = "$End" + std::string(keyword.substr(1));
        const std::string_view word = in_.word();
        if (word != end) in_.fail_word({keyword}, end, word);
    }

    void read_section(std::string_view keyword) {
        if (keyword == "$Nodes") {
            read_nodes();
        } else if (keyword == "$Elements") {
            read_elements();
        } else if (keyword == "$NodeData") {
            read_node_data();
        } else {
            skip_section(keyword);
            return;
        }
        read_end(keyword);
    }

    // Names of physical groups and remarks are not worth a word, data are.
    void skip_section(std::string_view keyword) {
        const std::string end = "$End" + std::string(keyword.substr(1));
        while (!in_.at_end()) {
            if (in_.word() != end) continue;
            if (keyword.ends_with("Data")) found_.warnings.push_back("section " + std::string(keyword) + " ignored");
            return;
        }
        in_.fail_word({keyword}, end, "");
    }

    void read_nodes() {
        if (!found_.points.empty()) in_.fail("there is a second $Nodes section");
        const std::size_t count = in_.count({"$Nodes"});
        found_.points.reserve(std::min(count, in_.room_for(4)));
        numbers_.reserve(found_.points.capacity());
        for (std::size_t n = 0; n < count; ++n) {
            numbers_.push_back(in_.integer({"number of node", static_cast<std::int64_t>(n + 1), count}));
            read_point(in_, found_, wording_, count);
        }
        wording_.point_numbers = numbers_;
        ids_.reserve(numbers_.size());
        for (Index n = 0; n < numbers_.size(); ++n) ids_.emplace_back(numbers_[n], n);
        std::sort(ids_.begin(), ids_.end());
        const auto same = [](const auto& a, const auto& b) { return a.first == b.first; };
        const auto twice = std::adjacent_find(ids_.begin(), ids_.end(), same);
        if (twice != ids_.end()) in_.fail("there are two nodes " + std::to_string(twice->first));
    }

    // The numbers of nodes may be any; most often they are 1, 2, 3…
    Index read_node(const Place& place) {
        const std::int64_t id = in_.integer(place);
        const auto guess = static_cast<std::size_t>(id) - 1;
        if (guess < ids_.size() && ids_[guess].first == id) return ids_[guess].second;
        const auto found = std::lower_bound(ids_.begin(), ids_.end(), std::pair{id, Index{0}});
        if (found == ids_.end() || found->first != id) {
            in_.fail(std::string(place.what) + " " + std::to_string(place.number) + ": there is no node " + std::to_string(id));
        }
        return found->second;
    }

    void read_elements() {
        if (has_elements_) in_.fail("there is a second $Elements section");
        if (found_.points.empty()) in_.fail("$Elements come before $Nodes");
        has_elements_ = true;
        const std::size_t count = in_.count({"$Elements"});
        for (std::size_t e = 0; e < count; ++e) read_element({"element", static_cast<std::int64_t>(e + 1), count});
    }

    void read_element(const Place& place) {
        in_.integer(place);
        const std::int64_t type = in_.integer(place);
        const auto kind = kKinds.find(type);
        if (kind == kKinds.end()) {
            in_.fail("element " + std::to_string(place.number) + " is of the unknown type " + std::to_string(type));
        }
        const std::size_t tags = in_.count(place);
        for (std::size_t t = 0; t < tags; ++t) in_.integer(place);
        const bool others = options_.other_cells != OtherCells::Ignore;
        if (type == kHexahedron) {
            read_corners(found_.hexes, place, "a hexahedron");
        } else if (type == kTetrahedron && others) {
            read_corners(found_.tets, place, "a tetrahedron");
        } else if (type == kPrism && others) {
            read_corners(found_.prisms, place, "a prism");
        } else if (type == kPyramid && others) {
            read_corners(found_.pyramids, place, "a pyramid");
        } else {
            for (std::size_t k = 0; k < kind->second.nodes; ++k) in_.integer(place);
            ++left_out_[type];
        }
    }

    template <std::size_t N>
    void read_corners(FileCells<N>& into, const Place& place, std::string_view kind) {
        auto& corners = into.corners.emplace_back();
        for (Index& corner : corners) corner = read_node(place);
        check_corners(in_, in_.position(), corners, static_cast<std::size_t>(place.number - 1), wording_, kind);
    }

    // Texts (the first is the name), real numbers (times), integers (step, components, nodes); then a node a line.
    void read_node_data() {
        const std::size_t texts = in_.count({"texts of $NodeData"});
        in_.line();
        std::string name = "unnamed";
        for (std::size_t t = 0; t < texts && !in_.at_end(); ++t) {
            const std::string_view text = in_.line();
            if (t == 0) name = unquoted(text);
        }
        const std::size_t reals = in_.count({"real numbers of $NodeData"});
        for (std::size_t r = 0; r < reals; ++r) in_.real({"real number of $NodeData"});
        const std::size_t integers = in_.count({"integers of $NodeData"});
        if (integers < 3) in_.fail("$NodeData needs at least 3 integers");
        in_.integer({"time step"});
        const std::size_t components = in_.count({"components of $NodeData"});
        if (components < 1 || components > 9)
            in_.fail("$NodeData has " + std::to_string(components) + " components", "1, 3 or 9");
        const std::size_t nodes = in_.count({"nodes of $NodeData"});
        for (std::size_t i = 3; i < integers; ++i) in_.integer({"integer of $NodeData"});
        read_values(name, components, nodes);
    }

    void read_values(const std::string& name, std::size_t components, std::size_t nodes) {
        const std::string what = "array " + in_quotes(name) + ": line";
        FileArray array{name, static_cast<int>(components), false, {}};
        array.values.resize(found_.points.size() * components);
        std::vector<std::uint8_t> given(found_.points.size());
        for (std::size_t n = 0; n < nodes; ++n) {
            const Place place{what, static_cast<std::int64_t>(n + 1), nodes};
            const std::size_t node = read_node(place);
            given[node] = 1;
            for (std::size_t k = 0; k < components; ++k) array.values[node * components + k] = in_.real(place);
        }
        const auto missing = static_cast<std::size_t>(std::count(given.begin(), given.end(), std::uint8_t{0}));
        if (missing == 0) {
            found_.arrays.push_back(std::move(array));
        } else {
            found_.warnings.push_back("array \"" + name + "\" has no value at " + counted(missing, "node", "nodes") +
                                      ": ignored");
        }
    }

    static std::string unquoted(std::string_view text) {
        const std::size_t begin = text.find_first_not_of(" \t\"");
        if (begin == std::string_view::npos) return "unnamed";
        return as_utf8(text.substr(begin, text.find_last_not_of(" \t\"") + 1 - begin));
    }

    void list_left_out() {
        std::map<std::string_view, std::pair<std::size_t, std::string_view>> by_name;
        for (const auto& [type, count] : left_out_) {
            const ElementKind& kind = kKinds.at(type);
            by_name[kind.one].first += count;
            by_name[kind.one].second = kind.many;
        }
        std::string list;
        for (const auto& [one, rest] : by_name) list += (list.empty() ? "" : ", ") + counted(rest.first, one, rest.second);
        report_left_out(found_, list, file_);
    }

    TextScanner in_;
    std::string_view file_;
    ReadOptions options_;
    MeshFile found_;
    Wording wording_{"node", "element", 1};
    std::vector<std::int64_t> numbers_;                // of the nodes, as they come
    std::vector<std::pair<std::int64_t, Index>> ids_;  // the number of each node and its place, sorted
    std::map<std::int64_t, std::size_t> left_out_;
    bool has_elements_ = false;
};

}  // namespace

ReadResult read_gmsh(std::string_view text, std::string_view file, const ReadOptions& options) {
    return GmshReader(text, file, options).read();
}

}  // namespace subvol
