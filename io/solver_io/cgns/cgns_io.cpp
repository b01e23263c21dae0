// SPDX-License-Identifier: Apache-2.0
// Reads meshes of CGNS from HDF5: the first base, its chosen zones, and the solutions of one step. A zone is read as a part of
// its own, and the parts are joined:
//
//     zone → coordinates of the step → sections of elements, or one block → boundary conditions → solutions → polyhedra
//
// Sections are read in the order of their numbers, as cells are counted over all of them. Polyhedra are lists of numbered
// faces, so the faces of all sections are known before a polyhedron is put together; the signs of the numbers are not used.
// Faces are kept after that only for boundary conditions. Solutions belong to the step that lists of the zone name them for;
// those that no list names belong to every step. Layers of values about a structured zone (Rind) are cut off, and three arrays
// whose names end in X, Y and Z become a vector. A solution that cannot be read stops no other one.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "assemble.h"
#include "cgns_patches.h"
#include "cgns_tree.h"
#include "join_pieces.h"
#include "mesh_file.h"
#include "polyhedra.h"
#include "solver_readers.h"
#include "subvol/detail/hdf5_file.h"
#include "subvol/detail/printable.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr EntityNames kCgnsNames{"vertex", "element", 1};
constexpr std::int64_t kMixed = 20, kPolygons = 22, kPolyhedra = 23;

// The nodes of each type of element; those of volumes begin with a T, P or H.
struct CgnsType {
    std::size_t nodes;
    std::string_view name;
};
constexpr std::array<CgnsType, 40> kCgnsTypes{
    {{0, ""},          {0, "USER"},      {1, "NODE"},      {2, "BAR_2"},    {3, "BAR_3"},     {3, "TRI_3"},    {6, "TRI_6"},
     {4, "QUAD_4"},    {8, "QUAD_8"},    {9, "QUAD_9"},    {4, "TETRA_4"},  {10, "TETRA_10"}, {5, "PYRA_5"},   {14, "PYRA_14"},
     {6, "PENTA_6"},   {15, "PENTA_15"}, {18, "PENTA_18"}, {8, "HEXA_8"},   {20, "HEXA_20"},  {27, "HEXA_27"}, {0, "MIXED"},
     {13, "PYRA_13"},  {0, "NGON_n"},    {0, "NFACE_n"},   {4, "BAR_4"},    {9, "TRI_9"},     {10, "TRI_10"},  {12, "QUAD_12"},
     {16, "QUAD_16"},  {16, "TETRA_16"}, {20, "TETRA_20"}, {21, "PYRA_21"}, {29, "PYRA_29"},  {30, "PYRA_30"}, {24, "PENTA_24"},
     {38, "PENTA_38"}, {40, "PENTA_40"}, {32, "HEXA_32"},  {56, "HEXA_56"}, {64, "HEXA_64"}}};

bool is_volume(const CgnsType& type) {
    return type.name.starts_with("TETRA") || type.name.starts_with("P") || type.name.starts_with("HEXA");
}

// The places of CGNS's 27 nodes in Exodus II's order: in CGNS the middle comes last, and the faces come in another order.
constexpr std::array<std::size_t, 7> kFacesAndMiddle{26, 20, 25, 24, 22, 21, 23};

struct Zone {
    std::string path, name;
    bool structured = false;
    StructuredGrid grid;
    std::size_t points = 0, cells = 0;
};

class CgnsReader {
public:
    CgnsReader(const Hdf5File& file, const ReadOptions& options)
        : tree_(file), options_(options), in_(std::string_view(), file.name(), TextScanner::Comments::None) {
        in_.name_no_place();
    }

    /// The times in the order of the file.
    [[nodiscard]] std::vector<double> times() {
        find_base();
        const auto steps = tree_.child(base_, "BaseIterativeData_t");
        if (!steps) return {};
        for (const std::string& array : tree_.children(*steps, "DataArray_t")) {
            if (CgnsTree::name_of(array) == "TimeValues") return tree_.reals(array);
        }
        const auto count = tree_.has_data(*steps) ? tree_.integers(*steps) : std::vector<std::int64_t>();
        if (count.size() != 1 || count[0] < 1 || count[0] > 1000000) return {};
        std::vector<double> numbers(static_cast<std::size_t>(count[0]));
        std::iota(numbers.begin(), numbers.end(), 0.0);
        return numbers;
    }

    ReadResult read() {
        const std::vector<double> all = times();
        std::vector<std::size_t> order(all.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t k) { return all[k]; });
        std::vector<std::string> warnings;
        const std::size_t step = chosen_step(options_, std::max<std::size_t>(1, all.size()), tree_.file().name(), warnings);
        if (!order.empty()) step_ = order[step];
        std::vector<std::string> names;
        const auto zones = tree_.children(base_, "Zone_t");
        for (const std::string& zone : zones) names.push_back(printable(CgnsTree::name_of(zone)));
        const BlockChoice choice(options_.blocks, names, tree_.file().name());
        std::vector<MeshFile> parts;
        for (std::size_t z = 0; z < zones.size(); ++z) {
            if (!choice.takes(names[z])) continue;
            MeshFile part = read_zone(zones[z]);
            std::size_t cells = 0;
            each_kind(part, [&](const auto& of_kind) { cells += of_kind.corners.size(); });
            if (cells == 0) continue;
            part.blocks = {{names[z], cells}};
            parts.push_back(std::move(part));
        }
        if (parts.empty()) parts.emplace_back();
        MeshFile found =
            parts.size() == 1 ? std::move(parts.front()) : join_pieces(std::move(parts), "zone", tree_.file().name());
        found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
        if (curved_ > 0) {
            found.warnings.push_back(counted(curved_, "element has", "elements have") +
                                     " more nodes than corners: only the corners are used");
        }
        note_unread_nodes(zones, found);
        conditions_.report("boundary condition", "boundary conditions", found.warnings, found.ignored);
        add_left_out_warning(found, ignored_parts("element type", left_out_), tree_.file().name());
        return assemble(std::move(found), tree_.file().name(), kCgnsNames, options_);
    }

private:
    // The nodes below the base and its zones that no step reads.
    void note_unread_nodes(const std::vector<std::string>& zones, MeshFile& found) const {
        static const std::set<std::string_view> kRead{
            "Zone_t",   "BaseIterativeData_t", "ZoneType_t",         "GridCoordinates_t", "Elements_t",
            "ZoneBC_t", "FlowSolution_t",      "ZoneIterativeData_t"};
        const auto note = [&](const std::string& node) {
            for (const auto& [path, label] : tree_.labelled_children(node)) {
                if (!kRead.contains(label))
                    found.ignored.push_back({label.empty() ? "node" : printable(label), printable(path)});
            }
        };
        note(base_);
        for (const std::string& zone : zones) note(zone);
    }

    void find_base() {
        const auto bases = tree_.children("", "CGNSBase_t");
        if (bases.empty()) tree_.file().fail("not a CGNS file, or it has no base");
        base_ = bases.front();
        const auto dimensions = tree_.integers(base_);
        if (dimensions.size() != 2 || dimensions[0] != 3 || dimensions[1] != 3) {
            tree_.file().fail("the dimensions of base " + in_quotes(base_) + " are not 3", "volumes in space are needed");
        }
    }

    [[nodiscard]] std::size_t size(std::int64_t value, const std::string& node) const {
        if (value < 0 || value >= static_cast<std::int64_t>(kNone))
            tree_.file().fail("node " + in_quotes(node) + ": size out of range: " + std::to_string(value));
        return static_cast<std::size_t>(value);
    }

    [[nodiscard]] Zone zone_of(const std::string& path) const {
        Zone zone{path, CgnsTree::name_of(path), false, {}, 0, 0};
        const auto type = tree_.child(path, "ZoneType_t");
        zone.structured = type && tree_.text(*type) == "Structured";
        const auto sizes = tree_.integers(path);
        if (zone.structured) {
            if (sizes.size() != 9) tree_.file().fail("zone " + in_quotes(zone.name) + " does not have three dimensions");
            for (std::size_t a = 0; a < 3; ++a) zone.grid.points[a] = size(sizes[a], path);
            zone.points = zone.grid.point_count();
            zone.cells = zone.grid.cell_count();
        } else {
            if (sizes.size() < 2) tree_.file().fail("zone " + in_quotes(zone.name) + " has no sizes");
            zone.points = size(sizes[0], path);
            zone.cells = size(sizes[1], path);
        }
        if (zone.points == kNone || zone.cells == kNone) tree_.file().fail("zone " + in_quotes(zone.name) + " is too large");
        return zone;
    }

    // The node that a list of the zone names for this step: of solutions or coordinates.
    [[nodiscard]] std::optional<std::string> of_step(const Zone& zone, const std::string& list,
                                                     const std::string& label) const {
        const auto steps = tree_.child(zone.path, "ZoneIterativeData_t");
        if (!steps) return std::nullopt;
        for (const std::string& array : tree_.children(*steps, "DataArray_t")) {
            if (CgnsTree::name_of(array) != list) continue;
            const auto names = tree_.texts(array);
            if (step_ >= names.size())
                tree_.file().fail("node " + in_quotes(array) + " names nothing for step " + std::to_string(step_));
            for (const std::string& node : tree_.children(zone.path, label)) {
                if (CgnsTree::name_of(node) == names[step_]) return node;
            }
            if (names[step_] == "Null") return std::nullopt;
            tree_.file().fail("zone " + in_quotes(zone.name) + " has no node " + in_quotes(names[step_]));
        }
        return std::nullopt;
    }

    MeshFile read_zone(const std::string& path) {
        const Zone zone = zone_of(path);
        MeshFile found;
        auto coordinates = of_step(zone, "GridCoordinatesPointers", "GridCoordinates_t");
        if (!coordinates) coordinates = tree_.child(path, "GridCoordinates_t");
        if (!coordinates) tree_.file().fail("zone " + in_quotes(zone.name) + " has no coordinates");
        std::array<std::vector<double>, 3> axes;
        for (std::size_t a = 0; a < 3; ++a) {
            axes[a] = values(*coordinates, *coordinates + "/Coordinate" + "XYZ"[a], zone, false);
        }
        found.points.reserve(zone.points);
        for (std::size_t p = 0; p < zone.points; ++p) add_point(found, {axes[0][p], axes[1][p], axes[2][p]}, 0);
        if (zone.structured) {
            if (zone.cells > 0) add_hexes(found, zone.grid, 0, 0);
        } else {
            read_sections(zone, found);
        }
        refuse_not_finite(found, in_, kCgnsNames);
        read_boundary_conditions(tree_, path, zone.structured ? &zone.grid : nullptr, faces_, found, conditions_);
        faces_ = {};
        for (const std::string& solution : solutions_of(zone, found)) {
            try {
                read_solution(zone, solution, found);
            } catch (const Error& error) {
                found.unread.push_back({CgnsTree::name_of(solution), error.what()});
            }
        }
        const std::size_t others = polyhedra_.take_into(found, options_.other_cells == OtherCells::Ignore);
        if (others > 0) left_out_["NFACE_n"] += others;
        return found;
    }

    // The solutions of the step: those that FlowSolutionPointers and lists like it name, or whose names end so where there is a
    // VertexPrefix or CellCenterPrefix. Those that the lists do not name belong to every step.
    [[nodiscard]] std::vector<std::string> solutions_of(const Zone& zone, MeshFile& into) const {
        const std::vector<std::string> all = tree_.children(zone.path, "FlowSolution_t");
        const auto steps = tree_.child(zone.path, "ZoneIterativeData_t");
        if (!steps) return all;
        const auto texts = tree_.children(*steps, "Descriptor_t");
        const bool prefixed =
            std::ranges::any_of(texts, [](const std::string& text) { return CgnsTree::name_of(text).ends_with("Prefix"); });
        const auto is_of = [&](const std::string& node, const std::string& name) {
            const std::string of_node = CgnsTree::name_of(node);
            return of_node == name || (prefixed && !name.empty() && of_node.ends_with(name));
        };
        std::set<std::string> others, chosen;
        for (const std::string& array : tree_.children(*steps, "DataArray_t")) {
            const std::string list = CgnsTree::name_of(array);
            if (!list.starts_with("FlowSolution") || !list.ends_with("Pointers")) continue;
            const auto names = tree_.texts(array);
            const std::set<std::string> once(names.begin(), names.end());
            const std::string mine = step_ < names.size() ? names[step_] : std::string();
            bool known = mine.empty() || mine == "Null";
            for (const std::string& node : all) {
                const bool of_this = !mine.empty() && is_of(node, mine);
                known |= of_this;
                if (of_this) chosen.insert(node);
                // Names are few where each node is looked for among them.
                const bool of_any =
                    once.contains(CgnsTree::name_of(node)) ||
                    (prefixed && std::ranges::any_of(once, [&](const auto& name) { return is_of(node, name); }));
                if (of_any && !of_this) others.insert(node);
            }
            if (!known) into.unread.push_back({mine, "zone " + in_quotes(zone.name) + " has no such node"});
        }
        std::vector<std::string> found;
        for (const std::string& node : all) {
            if (chosen.contains(node) || !others.contains(node)) found.push_back(node);
        }
        return found;
    }

    // The values of an array at the points or cells of a zone, without the layers about it (Rind).
    [[nodiscard]] std::vector<double> values(const std::string& parent, const std::string& node, const Zone& zone,
                                             bool at_cells) const {
        std::vector<double> all = tree_.reals(node);
        const std::size_t count = at_cells ? zone.cells : zone.points;
        const std::vector<std::int64_t>& layers = layers_of(parent);
        if (zone.structured && layers.size() == 6 && std::ranges::any_of(layers, [](std::int64_t n) { return n != 0; })) {
            all = inner(all, zone, at_cells, layers, node);
        }
        if (all.size() != count) {
            tree_.file().fail("node " + in_quotes(node) + " has " + counted(all.size(), "value", "values"),
                              std::to_string(count) + " are needed");
        }
        return all;
    }

    // Looked for once for all arrays of a node.
    [[nodiscard]] const std::vector<std::int64_t>& layers_of(const std::string& parent) const {
        if (layers_parent_ != parent) {
            const auto rind = tree_.child(parent, "Rind_t");
            layers_ = rind ? tree_.integers(*rind) : std::vector<std::int64_t>();
            layers_parent_ = parent;
        }
        return layers_;
    }

    [[nodiscard]] std::vector<double> inner(const std::vector<double>& all, const Zone& zone, bool at_cells,
                                            const std::vector<std::int64_t>& layers, const std::string& node) const {
        std::array<std::size_t, 3> counts{}, sizes{}, first{};
        std::size_t total = 1;
        for (std::size_t a = 0; a < 3; ++a) {
            counts[a] = zone.grid.points[a] - (at_cells && zone.grid.points[a] > 0 ? 1 : 0);
            first[a] = size(layers[2 * a], node);
            sizes[a] = counts[a] + first[a] + size(layers[2 * a + 1], node);
            if (sizes[a] > 0 && total > all.size() / sizes[a])
                tree_.file().fail("node " + in_quotes(node) + " has fewer values than its layers need");
            total *= sizes[a];
        }
        if (total != all.size()) tree_.file().fail("node " + in_quotes(node) + " does not have the values of its layers");
        std::vector<double> values;
        for (std::size_t k = 0; k < counts[2]; ++k) {
            for (std::size_t j = 0; j < counts[1]; ++j) {
                const std::size_t row = ((k + first[2]) * sizes[1] + j + first[1]) * sizes[0] + first[0];
                for (std::size_t i = 0; i < counts[0]; ++i) values.push_back(all[row + i]);
            }
        }
        return values;
    }

    void read_sections(const Zone& zone, MeshFile& found) {
        std::map<std::int64_t, std::string> sections;  // in the order of their numbers
        for (const std::string& section : tree_.children(zone.path, "Elements_t")) {
            const auto range = tree_.integers(section + "/ElementRange");
            if (range.size() != 2 || range[1] < range[0])
                tree_.file().fail("node " + in_quotes(section) + " has no range of numbers");
            if (!sections.try_emplace(range[0], section).second) tree_.file().fail("two sections have the same numbers");
        }
        std::size_t cells = 0;
        CgnsFaces polygons;
        keeps_faces_ = has_boundary_conditions(tree_, zone.path);
        std::vector<std::pair<std::size_t, std::vector<std::int64_t>>> polyhedra;
        for (const auto& [first, section] : sections) {
            const auto data = tree_.integers(section);
            const auto range = tree_.integers(section + "/ElementRange");
            const std::uint64_t count = static_cast<std::uint64_t>(range[1]) - static_cast<std::uint64_t>(range[0]) + 1;
            const std::int64_t type = data.empty() ? 0 : data[0];
            if (type == kPolygons || type == kPolyhedra) {
                auto lists = lists_of(section, count);
                for (std::size_t k = 0; k < lists.size(); ++k) {
                    if (type == kPolygons) polygons.emplace(first + static_cast<std::int64_t>(k), std::move(lists[k]));
                    if (type == kPolyhedra) polyhedra.emplace_back(cells++, std::move(lists[k]));
                }
                continue;
            }
            const auto numbers = tree_.integers(section + "/ElementConnectivity");
            std::size_t at = 0;
            for (std::uint64_t e = 0; e < count; ++e) {
                std::int64_t kind = type;
                if (type == kMixed) {
                    if (at == numbers.size()) tree_.file().fail("node " + in_quotes(section) + " ends before its elements do");
                    kind = numbers[at++];
                }
                const CgnsType& element = known(kind, section);
                if (element.nodes > numbers.size() - at)
                    tree_.file().fail("node " + in_quotes(section) + " ends before its elements do");
                take(element, std::span(numbers).subspan(at, element.nodes), first + static_cast<std::int64_t>(e), cells,
                     found);
                at += element.nodes;
                if (is_volume(element)) ++cells;
            }
        }
        cells_of_sections_ = cells;
        if (polyhedra.empty() && !polygons.empty()) left_out_["NGON_n"] += polygons.size();
        for (const auto& [cell, faces] : polyhedra) add_polyhedron(cell, faces, polygons, found);
        if (keeps_faces_) faces_.merge(polygons);
    }

    using Lists = std::vector<std::vector<std::int64_t>>;

    // The nodes of polygons or the faces of polyhedra: by where each begins, or before version 3.4 with its length before it.
    [[nodiscard]] Lists lists_of(const std::string& section, std::uint64_t count) const {
        const auto numbers = tree_.integers(section + "/ElementConnectivity");
        const std::string starts_at = section + "/ElementStartOffset";
        const bool has_starts = tree_.has_data(starts_at);
        const auto starts = has_starts ? tree_.integers(starts_at) : std::vector<std::int64_t>();
        const auto ends = [&] { tree_.file().fail("node " + in_quotes(section) + " does not have the lists of its elements"); };
        if (count > numbers.size() || (has_starts && starts.size() != count + 1)) ends();
        Lists lists;
        std::size_t at = 0;
        for (std::uint64_t e = 0; e < count; ++e) {
            if (!has_starts && at == numbers.size()) ends();
            const std::int64_t begin = has_starts ? starts[e] : static_cast<std::int64_t>(at) + 1;
            const std::int64_t end = has_starts ? starts[e + 1] : begin + std::min(numbers[at], std::int64_t{1} << 40);
            if (begin < 0 || end < begin || static_cast<std::uint64_t>(end) > numbers.size()) ends();
            lists.emplace_back(numbers.begin() + begin, numbers.begin() + end);
            at = static_cast<std::size_t>(end);
        }
        return lists;
    }

    // A face has a sign where the cell sees it from the other side.
    void add_polyhedron(std::size_t cell, const std::vector<std::int64_t>& numbers, const CgnsFaces& polygons,
                        const MeshFile& found) {
        CellFaces faces;
        for (const std::int64_t number : numbers) {
            const auto polygon = polygons.find(number < 0 ? -number : number);
            if (polygon == polygons.end()) tree_.file().fail("there is no face " + std::to_string(number));
            auto& face = faces.emplace_back();
            for (const std::int64_t node : polygon->second) {
                if (node < 1 || static_cast<std::uint64_t>(node) > found.points.size()) {
                    tree_.file().fail("face " + std::to_string(polygon->first) + ": there is no vertex " + std::to_string(node),
                                      "vertices are 1 to " + std::to_string(found.points.size()));
                }
                face.push_back(static_cast<Index>(node - 1));
            }
        }
        polyhedra_.add(cell, std::move(faces));
    }

    [[nodiscard]] const CgnsType& known(std::int64_t type, const std::string& section) const {
        const bool sound = type >= 2 && type < static_cast<std::int64_t>(kCgnsTypes.size()) &&
                           kCgnsTypes[static_cast<std::size_t>(type)].nodes > 0;
        if (!sound) tree_.file().fail("node " + in_quotes(section) + " has elements of type " + std::to_string(type));
        return kCgnsTypes[static_cast<std::size_t>(type)];
    }

    void take(const CgnsType& type, std::span<const std::int64_t> nodes, std::int64_t number, std::size_t cell,
              MeshFile& found) {
        const bool others = options_.other_cells != OtherCells::Ignore;
        const bool hex = type.name.starts_with("HEXA");
        if (!is_volume(type) || (!hex && !others)) {
            const std::size_t corners = type.name.starts_with("TRI") ? 3 : type.name.starts_with("QUAD") ? 4 : 0;
            if (keeps_faces_ && corners > 0) {
                faces_[number].assign(nodes.begin(), nodes.begin() + static_cast<std::ptrdiff_t>(corners));
                return;
            }
            ++left_out_[type.name];
            return;
        }
        std::vector<Index> of_cell;
        for (const std::int64_t node : nodes) {
            if (node < 1 || static_cast<std::uint64_t>(node) > found.points.size()) {
                tree_.file().fail("element " + std::to_string(number) + ": there is no vertex " + std::to_string(node),
                                  "vertices are 1 to " + std::to_string(found.points.size()));
            }
            of_cell.push_back(static_cast<Index>(node - 1));
        }
        if (hex) {
            const bool whole = (of_cell.size() == 20 || of_cell.size() == 27) && options_.curved_tolerance;
            put(found.hexes, of_cell, cell, whole);
            if (!whole) return;
            std::vector<Index> ordered = of_cell;
            for (std::size_t k = 20; k < ordered.size(); ++k) ordered[k] = of_cell[kFacesAndMiddle[k - 20]];
            found.curved.add(cell, CurvedOrder::Exodus, ordered);
        } else if (type.name.starts_with("TETRA")) {
            put(found.tets, of_cell, cell, false);
        } else if (type.name.starts_with("PENTA")) {
            put(found.prisms, of_cell, cell, false);
        } else {
            put(found.pyramids, of_cell, cell, false);
        }
    }

    template <std::size_t N>
    void put(FileCells<N>& into, const std::vector<Index>& nodes, std::size_t cell, bool whole) {
        curved_ += nodes.size() > N && !whole;
        std::copy_n(nodes.begin(), N, into.corners.emplace_back().begin());
        into.numbers.push_back(static_cast<Index>(cell));
    }

    // Three arrays whose names end in X, Y and Z are a vector.
    void read_solution(const Zone& zone, const std::string& solution, MeshFile& found) {
        const auto location = tree_.child(solution, "GridLocation_t");
        const std::string where = location ? tree_.text(*location) : "Vertex";
        if (where != "Vertex" && where != "CellCenter") {
            return found.ignore({"solution", CgnsTree::name_of(solution), 1, "it is at " + in_quotes(where)});
        }
        const bool at_cells = where == "CellCenter";
        if (at_cells && !zone.structured && cells_of_sections_ != zone.cells) {
            return found.ignore({"solution", CgnsTree::name_of(solution), 1, "it is not at the elements that are read"});
        }
        const std::vector<std::string> nodes = tree_.children(solution, "DataArray_t");
        std::set<std::string_view> left(nodes.begin(), nodes.end());
        for (const std::string& node : nodes) {
            if (left.erase(node) == 0) continue;  // a part of a vector
            std::string name = CgnsTree::name_of(node);
            std::vector<std::string> parts{node};
            if (name.size() > 1 && name.back() == 'X') {
                const std::string stem = node.substr(0, node.size() - 1);
                const std::string y = stem + "Y", z = stem + "Z";
                if (left.contains(y) && left.contains(z)) {
                    parts = {node, y, z};
                    name.pop_back();
                    left.erase(y);
                    left.erase(z);
                }
            }
            FileArray array{as_utf8(name), static_cast<int>(parts.size()), at_cells, {}};
            for (std::size_t c = 0; c < parts.size(); ++c) {
                const auto values_of = values(solution, parts[c], zone, at_cells);
                array.values.resize(values_of.size() * parts.size());
                for (std::size_t i = 0; i < values_of.size(); ++i) array.values[i * parts.size() + c] = values_of[i];
            }
            found.arrays.push_back(std::move(array));
        }
    }

    CgnsTree tree_;
    ReadOptions options_;
    TextScanner in_;
    Polyhedra polyhedra_;  // of the zone at hand
    CgnsFaces faces_;      // of the zone at hand, if it has boundary conditions
    bool keeps_faces_ = false;
    LeftOut conditions_;
    std::string base_;
    std::map<std::string_view, std::size_t> left_out_;
    std::size_t step_ = 0, curved_ = 0, cells_of_sections_ = 0;
    mutable std::string layers_parent_;
    mutable std::vector<std::int64_t> layers_;
};

Hdf5File open(const std::filesystem::path& path) {
    std::array<char, 32> begin{};
    if (not_regular(path).empty()) std::ifstream(path, std::ios::binary).read(begin.data(), begin.size());
    if (std::string_view(begin.data(), begin.size()).find("ADF Database") != std::string_view::npos) {
        throw Error(ErrorCode::InvalidInput, "the CGNS file is of the older kind ADF", path.string(),
                    "cgnsconvert -h, of Debian's cgns-convert, makes it HDF5");
    }
    return {open_hdf5(path), path.string()};
}

}  // namespace

ReadResult read_cgns(const Hdf5File& file, const ReadOptions& options) {
    return CgnsReader(file, options).read();
}

ReadResult read_cgns(const std::filesystem::path& path, const ReadOptions& options) {
    return read_cgns(open(path), options);
}

std::vector<double> cgns_times(const std::filesystem::path& path) {
    const Hdf5File file = open(path);
    std::vector<double> times = CgnsReader(file, {}).times();
    std::ranges::stable_sort(times);
    return times;
}

}  // namespace subvol::detail
