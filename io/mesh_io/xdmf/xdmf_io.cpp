// SPDX-License-Identifier: Apache-2.0
// Reads meshes of XDMF. The first temporal collection of the domain gives the steps, each a grid with a time, and puts them in
// the order of the times; without one the domain is the only step. A grid of the chosen step is a tree of grids, whose leaves
// are read one by one and joined:
//
//     step → grids → Geometry: points → Topology: cells, or a block of hexahedra → Attributes: arrays → joined
//
// A step that has no cells or points of its own has those of the first step. In a list of mixed cells, each begins with the
// number of its type. Of hexahedra with 20 and 27 nodes, writers disagree about the order of the nodes in the middle of edges:
// that order is taken in which they are nearer to the middles. An array that cannot be read stops no other one.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <vector>

#include "assemble.h"
#include "formats.h"
#include "join_pieces.h"
#include "mesh_file.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/text_scanner.h"
#include "subvol/error.h"
#include "vtk_cells.h"
#include "xdmf_file.h"

namespace subvol::detail {

namespace {

constexpr int kMostNestedGrids = 16;

constexpr std::size_t kMostGrids = 100000;

/// The grids of each step, in the order of the times. A file without steps has its domain as the only one, and no times.
struct XdmfSteps {
    std::vector<double> times;
    std::vector<pugi::xml_node> grids;
    pugi::xml_node collection;  ///< that the steps are those of
};

bool is_temporal(const pugi::xml_node& grid) {
    return kind_of(grid, {"GridType"}) == "COLLECTION" && kind_of(grid, {"CollectionType"}) == "TEMPORAL";
}

class StepFinder {
public:
    explicit StepFinder(XdmfFile& file) : file_(file) {}

    XdmfSteps find() {
        const auto grids = file_.children(file_.domain(), "Grid");
        if (grids.empty()) file_.fail_at(file_.domain(), "it has no grids");
        const auto temporal = std::ranges::find_if(grids, is_temporal);
        if (temporal == grids.end()) return {{}, {file_.domain()}, {}};
        XdmfSteps steps;
        steps.grids = file_.children(*temporal, "Grid");
        if (steps.grids.empty()) file_.fail_at(*temporal, "it has no steps");
        if (steps.grids.size() > kMostGrids) file_.fail_at(*temporal, "it has too many steps");
        const auto listed = listed_times(*temporal, steps.grids.size());
        for (std::size_t k = 0; k < steps.grids.size(); ++k) {
            const auto time = listed.empty() ? time_of(steps.grids[k], 0) : listed[k];
            steps.times.push_back(time.value_or(static_cast<double>(k)));
        }
        std::vector<std::size_t> order(steps.times.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::stable_sort(order, {}, [&](std::size_t k) { return steps.times[k]; });
        XdmfSteps sorted{{}, {}, *temporal};
        for (const std::size_t k : order) {
            sorted.times.push_back(steps.times[k]);
            sorted.grids.push_back(steps.grids[k]);
        }
        return sorted;
    }

    // The time of a grid, or of the first one in it.
    std::optional<double> time_of(const pugi::xml_node& grid, int depth) {
        if (const pugi::xml_node time = file_.child(grid, "Time"); time.attribute("Value")) {
            const auto value = number_from(trimmed(time.attribute("Value").as_string()));
            if (!value || !std::isfinite(*value)) file_.fail_at(time, "its value is not a number");
            return value;
        }
        const pugi::xml_node first = file_.child(grid, "Grid");
        return first && depth < kMostNestedGrids ? time_of(first, depth + 1) : std::nullopt;
    }

private:
    // The times of a collection that has them in one place.
    std::vector<double> listed_times(const pugi::xml_node& collection, std::size_t count) {
        const pugi::xml_node time = file_.child(collection, "Time");
        const std::string kind = kind_of(time, {"TimeType", "Type"});
        if (!time || kind.empty() || kind == "SINGLE") return {};
        auto values = file_.items(time, 1).front();
        if (kind == "HYPERSLAB" && values.size() >= 2) {
            std::vector<double> times;
            for (std::size_t k = 0; k < count; ++k) times.push_back(values[0] + static_cast<double>(k) * values[1]);
            values = std::move(times);
        }
        if (values.size() != count || !std::ranges::all_of(values, [](double t) { return std::isfinite(t); })) {
            file_.fail_at(time, "it does not give a time for each of the " + counted(count, "step", "steps"));
        }
        return values;
    }

    XdmfFile& file_;
};

// throws: Error(InvalidInput) if there are no grids or too many steps, or a step has no time
XdmfSteps xdmf_steps(XdmfFile& file) {
    return StepFinder(file).find();
}

constexpr int kVariable = -1;  // the number of nodes follows in the list of mixed cells

// number: of the type in lists of mixed cells; vtk: of the type in VTK
struct Topology {
    std::string_view name;
    int number;
    int nodes;
    std::int64_t vtk;
};
constexpr std::array<Topology, 30> kTopologies{{{"POLYVERTEX", 1, kVariable, 2},
                                                {"POLYLINE", 2, kVariable, 4},
                                                {"POLYGON", 3, kVariable, 7},
                                                {"TRIANGLE", 4, 3, 5},
                                                {"QUADRILATERAL", 5, 4, 9},
                                                {"TETRAHEDRON", 6, 4, 10},
                                                {"PYRAMID", 7, 5, 14},
                                                {"WEDGE", 8, 6, 13},
                                                {"HEXAHEDRON", 9, 8, 12},
                                                {"POLYHEDRON", 16, kVariable, 42},
                                                {"EDGE_3", 34, 3, 21},
                                                {"QUAD_9", 35, 9, 28},
                                                {"QUADRILATERAL_9", 35, 9, 28},
                                                {"TRI_6", 36, 6, 22},
                                                {"TRIANGLE_6", 36, 6, 22},
                                                {"QUAD_8", 37, 8, 23},
                                                {"QUADRILATERAL_8", 37, 8, 23},
                                                {"TET_10", 38, 10, 24},
                                                {"TETRAHEDRON_10", 38, 10, 24},
                                                {"PYRAMID_13", 39, 13, 27},
                                                {"WEDGE_15", 40, 15, 26},
                                                {"WEDGE_18", 41, 18, 32},
                                                {"HEX_20", 48, 20, 25},
                                                {"HEXAHEDRON_20", 48, 20, 25},
                                                {"HEX_24", 49, 24, 33},
                                                {"HEXAHEDRON_24", 49, 24, 33},
                                                {"HEX_27", 50, 27, 29},
                                                {"HEXAHEDRON_27", 50, 27, 29},
                                                {"QUAD", 5, 4, 9},
                                                {"HEX", 9, 8, 12}}};

const Topology* topology_of(const std::string& name) {
    const auto* found = std::ranges::find(kTopologies, name, &Topology::name);
    return found == kTopologies.end() ? nullptr : found;
}
const Topology* topology_of(std::int64_t number) {
    const auto* found = std::ranges::find_if(kTopologies, [&](const Topology& t) { return t.number == number; });
    return found == kTopologies.end() ? nullptr : found;
}

bool is_collection(const pugi::xml_node& grid) {
    const std::string kind = kind_of(grid, {"GridType"});
    return kind == "COLLECTION" || kind == "TREE";
}
class XdmfReader {
public:
    XdmfReader(std::string_view text, std::string_view file, const ReadOptions& options)
        : file_(text, std::filesystem::path(file)),
          options_(options),
          in_(std::string_view(), file, TextScanner::Comments::None) {
        in_.name_no_place();
    }

    ReadResult read() {
        const XdmfSteps steps = xdmf_steps(file_);
        std::vector<std::string> warnings;
        const std::size_t step = chosen_step(options_, steps.grids.size(), file_.name(), warnings);
        first_ = steps.grids.front();
        const pugi::xml_node& grid = steps.grids[step];
        const bool whole = grid == file_.domain();
        std::vector<MeshFile> parts;
        for (const auto& child : whole ? file_.children(grid, "Grid") : std::vector<pugi::xml_node>{grid}) add(child, 0, parts);
        std::erase_if(parts, [](const MeshFile& part) { return part.points.empty(); });
        if (parts.empty()) file_.fail_at(grid, "it has no grids with points");
        MeshFile found = parts.size() == 1 ? std::move(parts.front()) : join_pieces(std::move(parts), "grid", file_.name());
        found.warnings.insert(found.warnings.begin(), warnings.begin(), warnings.end());
        if (steps.times.empty()) found.time = StepFinder(file_).time_of(grid, 0);
        for (const pugi::xml_node& above : {file_.domain().parent(), file_.domain(), steps.collection}) ignore_notes(above);
        if (steps.collection) ignore_beside(steps.collection, found);
        found.ignored.insert(found.ignored.end(), ignored_.begin(), ignored_.end());
        add_left_out_warning(found, {}, file_.name());
        return assemble(std::move(found), file_.name(), kVtkNames, options_);
    }

private:
    void add(const pugi::xml_node& grid, int depth, std::vector<MeshFile>& parts) {
        if (depth > kMostNestedGrids) file_.fail_at(grid, "grids are nested too deeply");
        if (parts.size() > kMostGrids) file_.fail_at(grid, "there are too many grids");
        if (is_collection(grid)) {
            ignore_notes(grid);
            for (const auto& child : file_.children(grid, "Grid")) add(child, depth + 1, parts);
            return;
        }
        parts.push_back(read_grid(grid));
    }

    void ignore_notes(const pugi::xml_node& element) {
        for (const char* kind : {"Set", "Information"}) {
            for (const auto& note : file_.children(element, kind))
                ignored_.push_back({kind, as_utf8(note.attribute("Name").as_string())});
        }
    }

    // Steps may have the cells of a grid beside them, but its arrays are those of no step.
    void ignore_beside(const pugi::xml_node& steps, MeshFile& found) const {
        for (const auto& grid : file_.children(file_.domain(), "Grid")) {
            if (grid == steps) continue;
            if (is_collection(grid))
                found.ignore({"grid", as_utf8(grid.attribute("Name").as_string()), 1, "it is beside the steps"});
            if (!is_collection(grid) && std::ranges::find(used_, grid) == used_.end())
                found.ignored.push_back({"grid", as_utf8(grid.attribute("Name").as_string()), 1, "it is beside the steps"});
            for (const auto& attribute : file_.children(grid, "Attribute"))
                found.ignore({"array", as_utf8(attribute.attribute("Name").as_string()), 1, "its grid is beside the steps"});
        }
    }

    // A step without cells or points has those of the first one.
    [[nodiscard]] pugi::xml_node part_of(const pugi::xml_node& grid, const char* name) const {
        if (const auto part = file_.child(grid, name)) return part;
        if (const auto first = file_.child(first_, name)) return first;
        file_.fail_at(grid, std::string("the grid has no ") + name);
    }

    MeshFile read_grid(const pugi::xml_node& grid) {
        MeshFile found;
        const pugi::xml_node topology = part_of(grid, "Topology"), geometry = part_of(grid, "Geometry");
        for (const pugi::xml_node& owner : {topology.parent(), geometry.parent()}) {
            if (owner != grid && std::ranges::find(used_, owner) == used_.end()) used_.push_back(owner);
        }
        const std::string kind = kind_of(topology, {"TopologyType", "Type"});
        if (kind == "3DSMESH" || kind == "3DRECTMESH" || kind == "3DCORECTMESH") {
            read_block(topology, geometry, kind, found);
        } else {
            read_points(geometry, found);
            read_cells(topology, kind, found);
        }
        refuse_not_finite(found, in_, kVtkNames);
        read_arrays(grid, found);
        return found;
    }

    void read_points(const pugi::xml_node& geometry, MeshFile& found) {
        const std::string kind = kind_of(geometry, {"GeometryType", "Type"});
        if (kind == "XYZ" || kind.empty()) {
            const auto values = file_.items(geometry, 1).front();
            if (values.size() % 3 != 0 || values.size() / 3 >= kNone) {
                file_.fail_at(geometry, "it has " + counted(values.size(), "value", "values"),
                              "three for each point are needed");
            }
            found.points.reserve(values.size() / 3);
            for (std::size_t i = 0; i < values.size(); i += 3) add_point(found, {values[i], values[i + 1], values[i + 2]}, 0);
        } else if (kind == "X_Y_Z") {
            const auto axes = file_.items(geometry, 3);
            if (axes[0].size() != axes[1].size() || axes[0].size() != axes[2].size() || axes[0].size() >= kNone) {
                file_.fail_at(geometry, "its coordinates are not as many on each axis");
            }
            for (std::size_t p = 0; p < axes[0].size(); ++p) add_point(found, {axes[0][p], axes[1][p], axes[2][p]}, 0);
        } else {
            file_.fail_at(geometry, "points of the type " + in_quotes(kind) + " are not supported", "XYZ and X_Y_Z are");
        }
    }

    // Sizes, origin and spacing are those of z, y and x.
    void read_block(const pugi::xml_node& topology, const pugi::xml_node& geometry, const std::string& kind, MeshFile& found) {
        auto sizes = file_.sizes(topology, "Dimensions");
        if (sizes.empty()) sizes = file_.sizes(topology, "NumberOfElements");
        if (sizes.size() != 3) file_.fail_at(topology, "it does not have the three sizes of its grid");
        const StructuredGrid grid{{sizes[2], sizes[1], sizes[0]}};
        if (grid.cell_count() == 0 || grid.point_count() == kNone) {
            file_.fail_at(topology, size_text(grid), "at least two along each axis, and fewer than 4 billion");
        }
        if (kind == "3DSMESH") {
            read_points(geometry, found);
        } else if (kind == "3DRECTMESH") {
            expect_values(topology, grid);
            const auto cuts = file_.items(geometry, 3);
            if (cuts[0].size() != grid.points[0] || cuts[1].size() != grid.points[1] || cuts[2].size() != grid.points[2]) {
                file_.fail_at(geometry, "its planes are not those of " + size_text(grid));
            }
            add_points(found, {cuts[0], cuts[1], cuts[2]}, 0);
        } else {
            read_even_points(topology, geometry, grid, found);
        }
        if (found.points.size() != grid.point_count()) {
            file_.fail_at(geometry, "it has " + counted(found.points.size(), "point", "points"),
                          size_text(grid) + " are needed");
        }
        add_hexes(found, grid, 0, 0);
        cells_ = grid.cell_count();
    }

    // Few numbers make many points: they may be as many as the values of the arrays, and some more.
    void expect_values(const pugi::xml_node& topology, const StructuredGrid& grid) {
        std::size_t values = 0;
        for (const auto& array : file_.children(topology.parent(), "Attribute")) {
            const auto sizes = file_.sizes(file_.child(array, "DataItem"), "Dimensions");
            if (!sizes.empty()) values = std::max(values, file_.values(file_.child(array, "DataItem")).size());
        }
        if (grid.point_count() > most_points(8 * values)) file_.fail_at(topology, "its points are more than its values");
        constexpr std::size_t kBytesOfPoint = 64;  // with its cell
        file_.make(topology, grid.point_count() * kBytesOfPoint);
    }

    void read_even_points(const pugi::xml_node& topology, const pugi::xml_node& geometry, const StructuredGrid& grid,
                          MeshFile& found) {
        expect_values(topology, grid);
        const auto items = file_.items(geometry, 2);
        if (items[0].size() != 3 || items[1].size() != 3) file_.fail_at(geometry, "an origin and a spacing are needed");
        std::array<std::vector<double>, 3> cuts;
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t i = 0; i < grid.points[a]; ++i) {
                cuts[a].push_back(items[0][2 - a] + static_cast<double>(i) * items[1][2 - a]);
            }
        }
        add_points(found, cuts, 0);
    }

    void read_cells(const pugi::xml_node& element, const std::string& kind, MeshFile& found) {
        const Topology* one = topology_of(kind);
        if (one == nullptr && kind != "MIXED") {
            file_.fail_at(element, "cells of the type " + in_quotes(kind) + " are not supported",
                          "Mixed, Hexahedron, Wedge, Pyramid, Tetrahedron and 3DSMesh, 3DRectMesh, 3DCoRectMesh are");
        }
        const auto numbers = file_.items(element, 1).front();
        const auto base = number_from(trimmed(element.attribute("BaseOffset").as_string("0")));
        if (!base) file_.fail_at(element, "its BaseOffset is not a number");
        VtkCellSorter sorter(in_, found, options_);
        std::size_t at = 0, cell = 0;
        const auto next = [&]() -> std::int64_t {
            if (at == numbers.size()) file_.fail_at(element, kVtkNames.cell(cell) + " ends after the last number");
            const double number = numbers[at++];
            if (number != std::floor(number) || std::abs(number) > 1e15) {
                file_.fail_at(element, kVtkNames.cell(cell) + ": there is a number that is not whole");
            }
            return static_cast<std::int64_t>(number);
        };
        std::vector<Index> nodes;
        while (at < numbers.size()) {
            const Topology* type = one;
            if (type == nullptr) {
                const std::int64_t number = next();
                type = topology_of(number);
                if (type == nullptr) {
                    file_.fail_at(element, kVtkNames.cell(cell) + " is of type " + std::to_string(number),
                                  "types of XDMF are needed, such as 9 for hexahedra");
                }
            }
            nodes.clear();
            if (type->number == 16) {
                skip_polyhedron(next);
            } else {
                const int given = type->nodes != kVariable ? 0
                                  : one != nullptr         ? nodes_per_element(element)
                                                           : static_cast<int>(std::clamp<std::int64_t>(next(), 0, 1 << 30));
                for (int k = type->nodes == kVariable ? given : type->nodes; k > 0; --k)
                    nodes.push_back(point(next(), *base, cell, found, element));
            }
            in_vtk_order(*type, found, nodes);
            sorter.take(type->vtk, nodes, 0);
            ++cell;
        }
        cells_ = cell;
        sorter.report(std::nullopt);
    }

    template <class Next>
    static void skip_polyhedron(const Next& next) {
        for (std::int64_t faces = next(); faces > 0; --faces) {
            for (std::int64_t corners = next(); corners > 0; --corners) std::ignore = next();
        }
    }

    [[nodiscard]] int nodes_per_element(const pugi::xml_node& element) const {
        const int nodes = element.attribute("NodesPerElement").as_int(1);
        if (nodes < 1) file_.fail_at(element, "NodesPerElement is not a count");
        return nodes;
    }

    [[nodiscard]] Index point(std::int64_t number, double base, std::size_t cell, const MeshFile& found,
                              const pugi::xml_node& element) const {
        const double index = static_cast<double>(number) - base;
        if (!(index >= 0 && index < static_cast<double>(found.points.size()))) {
            file_.fail_at(element, kVtkNames.cell(cell) + ": there is no point with index " + std::to_string(number),
                          "there are " + std::to_string(found.points.size()) + " points");
        }
        return static_cast<Index>(index);
    }

    // Writers disagree whether the nodes of the upright edges come before or after those of the top. The places show it.
    static void in_vtk_order(const Topology& type, const MeshFile& found, std::vector<Index>& nodes) {
        if (type.vtk != 25 && type.vtk != 29) return;
        const auto off = [&](std::size_t node, std::size_t a, std::size_t b) {
            const auto x = [&](std::size_t k) { return found.points[nodes[k]]; };
            return glm::distance(x(node), (x(a) + x(b)) / 2.0);
        };
        double top = 0, upright = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            top += off(12 + k, 4 + k, 4 + (k + 1) % 4) + off(16 + k, k, 4 + k);
            upright += off(12 + k, k, 4 + k) + off(16 + k, 4 + k, 4 + (k + 1) % 4);
        }
        if (top <= upright) return;
        std::swap_ranges(nodes.begin() + 12, nodes.begin() + 16, nodes.begin() + 16);
        nodes.resize(20);  // the order of the others is not certain either
    }

    // An array that cannot be read stops no other, and the file only if there is no other.
    void read_arrays(const pugi::xml_node& grid, MeshFile& found) {
        ignore_notes(grid);
        constexpr std::size_t kMostUnread = 1000;
        std::optional<Error> first;
        for (const auto& attribute : file_.children(grid, "Attribute")) {
            const std::size_t before = found.arrays.size();
            try {
                read_array(attribute, found);
            } catch (const Error& error) {
                if (found.unread.size() > kMostUnread) throw;
                found.arrays.resize(before);
                found.unread.push_back({attribute.attribute("Name").as_string("unnamed"), error.what()});
                if (!first) first = error;
            }
        }
        if (first && found.arrays.empty()) throw Error(*first);
    }

    void read_array(const pugi::xml_node& attribute, MeshFile& found) {
        const std::string center = kind_of(attribute, {"Center"}), name = as_utf8(attribute.attribute("Name").as_string());
        const bool at_cells = center == "CELL";
        if (!at_cells && center != "NODE" && !center.empty()) {
            found.ignore({"array", name, 1, "it is neither at points nor at cells"});
            return;
        }
        const std::size_t count = at_cells ? cells_ : found.points.size();
        auto values = file_.items(attribute, 1).front();
        const std::string kind = kind_of(attribute, {"AttributeType", "Type"});
        std::size_t components = kind == "VECTOR"                   ? 3
                                 : kind == "TENSOR"                 ? 9
                                 : kind == "TENSOR6"                ? 6
                                 : kind == "SCALAR" || kind.empty() ? 1
                                                                    : 0;
        if (components == 0 || (count > 0 && values.size() != count * components)) {
            components = count == 0 || values.size() % count != 0 ? 0 : values.size() / count;
        }
        constexpr std::size_t kMostComponents = 1 << 10;
        if (components == 0 || components > kMostComponents) {
            file_.fail_at(attribute, "array " + in_quotes(name) + " has " + counted(values.size(), "value", "values") +
                                         " for " + counted(count, at_cells ? "cell" : "point", at_cells ? "cells" : "points"));
        }
        if (kind == "TENSOR6" && components == kSymmetricByRows.size()) order_symmetric(values, kSymmetricByRows);
        found.arrays.push_back({name, static_cast<int>(components), at_cells, std::move(values)});
        const std::string type = kind_of(attribute.child("DataItem"), {"NumberType", "DataType"});
        found.arrays.back().integers = type == "INT" || type == "UINT" || type == "CHAR" || type == "UCHAR";
    }

    XdmfFile file_;
    ReadOptions options_;
    TextScanner in_;
    pugi::xml_node first_;
    std::vector<IgnoredPart> ignored_;  // notes of all elements
    std::vector<pugi::xml_node> used_;  // other grids whose cells or points were taken
    std::size_t cells_ = 0;             // of the grid
};

}  // namespace

ReadResult read_xdmf(std::string_view text, std::string_view file, const ReadOptions& options) {
    return XdmfReader(text, file, options).read();
}

std::vector<double> xdmf_times(const std::filesystem::path& path) {
    const std::string text = read_text(path);
    XdmfFile file(text, path);
    return xdmf_steps(file).times;
}

}  // namespace subvol::detail
