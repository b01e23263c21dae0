// SPDX-License-Identifier: Apache-2.0
// Meshes in Python: read from files or VTK grids, or made from arrays; and what is asked of them and written.
//
//     arrays ─► checked mesh ─► creases by the rule by which files are read ─► HexMesh, with patches and sets beside it
//     HexMesh ─► read-only views of points, cells, creases and fields; dictionaries that refuse changes
//
// A HexMesh does not change: every call that changes something returns another mesh. Patches and sets are no part of the C++
// mesh. They are an attribute of the Python object, are copied when they are read, and are passed on to the meshes of the same
// cells, or, of a part, to what is left of them. Pickles hold the arrays, the patches and sets, and what fields have beside
// their values at points: bounds, values at cells, gradients at walls. Files are read and written without the GIL.
#include <algorithm>
#include <iterator>
#include <string_view>
#include <tuple>
#include <utility>

#include "bind.h"
#include "subvol/detail/printable.h"
#include "subvol/expression.h"
#include "subvol/field_bounds.h"
#include "subvol/mesh_io.h"
#include "subvol/mesh_motion.h"
#include "subvol/mesh_report.h"
#include "subvol/mesh_series.h"
#include "subvol/model.h"
#include "subvol/option.h"
#include "subvol/part_of_limit.h"
#include "subvol/quantity.h"
#include "subvol/region.h"
#include "subvol/series_file.h"
#include "subvol/surface.h"
#include "subvol/topology.h"
#include "subvol/vtk_grid.h"
#include "subvol/warp.h"
#include "subvol/wavelet_file.h"

namespace subvol::python {
namespace {

template <std::size_t N>
py::array view_of_rows(const std::vector<std::array<Index, N>>& rows, const py::handle& owner) {
    return view(rows.empty() ? nullptr : rows.front().data(), {length(rows.size()), length(N)}, owner);
}

py::object fields_of(const py::object& self) {
    py::dict fields;
    for (const Attribute& attribute : self.cast<const HexMesh&>().attributes) {
        const auto channels = length(static_cast<std::size_t>(attribute.channels));
        const py::ssize_t points = length(attribute.values.size()) / channels;
        std::vector<py::ssize_t> shape{points};
        if (channels > 1) shape.push_back(channels);
        fields[py::str(attribute.name)] = view(attribute.values.data(), std::move(shape), self);
    }
    return read_only(fields, "the fields of a mesh", "mesh.with_fields({...}) is a mesh with others");
}

py::object cell_fields_of(const py::object& self) {
    py::dict fields;
    const auto& mesh = self.cast<const HexMesh&>();
    for (const Attribute& attribute : mesh.attributes) {
        if (attribute.cells.empty()) continue;
        const auto channels = length(static_cast<std::size_t>(attribute.channels));
        std::vector<py::ssize_t> shape{length(attribute.cells.size()) / channels};
        if (channels > 1) shape.push_back(channels);
        fields[py::str(attribute.name)] = view(attribute.cells.data(), std::move(shape), self);
    }
    return read_only(fields, "the fields at cells of a mesh");
}

/// What fields have beside values at points, for pickles.
py::dict rest_of_fields(const HexMesh& mesh) {
    py::dict rest;
    for (const Attribute& field : mesh.attributes) {
        if (field.cells.empty() && field.bounds.empty()) continue;
        py::list gradients;
        for (const Vec3& g : field.walls.gradients) gradients.append(py::make_tuple(g.x, g.y, g.z));
        rest[py::str(field.name)] =
            py::make_tuple(field.bounds, field.cells, field.constant, field.walls.points, std::move(gradients));
    }
    return rest;
}

void put_rest_of_fields(const py::dict& rest, HexMesh& mesh) {
    for (Attribute& field : mesh.attributes) {
        if (!rest.contains(py::str(field.name))) continue;
        const py::tuple of_field = rest[py::str(field.name)];
        field.bounds = of_field[0].cast<std::vector<std::array<double, 2>>>();
        field.cells = of_field[1].cast<std::vector<double>>();
        field.constant = of_field[2].cast<bool>();
        field.walls.points = of_field[3].cast<std::vector<Index>>();
        for (const auto& [x, y, z] : of_field[4].cast<std::vector<std::array<double, 3>>>())
            field.walls.gradients.emplace_back(x, y, z);
    }
}

}  // namespace

Attribute attribute_of(const std::string& name, const py::handle& given, std::size_t points) {
    const std::string what = "fields['" + name + "']";
    const py::array array =
        array_from(given, {ErrorCode::InvalidInput, "cannot be made an array", what, "an array of numbers"});
    const bool flat = array.ndim() != 2;
    const py::ssize_t channels = flat ? 1 : array.shape(1);
    const py::array_t<double> rows = flat ? numbers<double>(array, what) : rows_of<double>(array, channels, what);
    if (channels < 1 || static_cast<std::size_t>(rows.shape(0)) != points) {
        throw Error(ErrorCode::InvalidInput, "has " + std::to_string(rows.shape(0)) + " rows", what,
                    "one for each of the " + std::to_string(points) + " points");
    }
    return {name, static_cast<int>(channels), std::vector<double>(rows.data(), rows.data() + rows.size())};
}

namespace {

/// Creases by the rule by which files are read. settled: the mesh has its own
void find_creases(HexMesh& mesh, const std::optional<double>& angle_deg, bool settled) {
    if (!angle_deg && !settled) keep_sharp_edges(mesh);
    if (angle_deg.value_or(0) > 0) tag_creases(mesh, *angle_deg);
}

HexMesh mesh_of(const py::object& points, const py::object& cells, const py::object& fields, const py::object& creases,
                const py::object& sharp_faces, const py::object& crease_angle) {
    ReadOptions options;
    set_options(options_of(options), py::dict(py::arg("crease_angle") = crease_angle));
    HexMesh mesh;
    mesh.points = vectors(points, "points");
    const std::size_t count = mesh.points.size();
    mesh.cells = index_rows<8>(cells, count, "cells");
    if (!creases.is_none()) mesh.creases = index_rows<2>(creases, count, "creases");
    if (!sharp_faces.is_none()) mesh.sharp_faces = index_rows<4>(sharp_faces, count, "sharp_faces");
    if (!fields.is_none()) {
        for_each_named(fields, "fields", [&](const std::string& name, const py::handle& values) {
            mesh.attributes.push_back(attribute_of(name, values, count));
        });
    }
    const py::gil_scoped_release without_gil;
    validate(mesh);
    find_creases(mesh, options.crease_angle_deg, !creases.is_none() || !sharp_faces.is_none());
    return mesh;
}

std::string mesh_text(const HexMesh& mesh) {
    std::string text = "<subvol.HexMesh: " + std::to_string(mesh.points.size()) + " points, " +
                       std::to_string(mesh.cells.size()) + (mesh.cells.size() == 1 ? " cell" : " cells");
    for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
        const Attribute& field = mesh.attributes[i];
        text += (i == 0 ? ", fields " : ", ") + detail::printable(field.name);
        if (field.channels > 1) text += "[" + std::to_string(field.channels) + "]";
    }
    return text + ">";
}

py::dict figures_of(const HexMesh& mesh) {
    const MeshReport report = result_of(py::none(), [&](Progress* listener) { return inspect(mesh, listener); });
    py::dict figures = dict_of(facts_of(report));
    figures["interior_edge_valence"] = report.interior_edge_valence;  // by number
    figures["bounds"] = as_array(report.bounds);
    return figures;
}

py::tuple read(const std::string& path, const py::kwargs& given) {
    ReadOptions options;
    set_options(options_of(options), given);
    ReadResult result = [&] {
        const py::gil_scoped_release without_gil;
        return read_mesh(path, options);
    }();
    if (!result.shells.empty()) result.warnings.emplace_back("quads and lines of shells and beams left out");
    return py::make_tuple(with_sets(std::move(result.mesh), std::move(result.sets)), result.warnings);
}

/// Those that have an effect on a grid in memory.
std::vector<Option> options_of_grids(ReadOptions& options) {
    constexpr std::string_view kNames[]{"other-cells", "weld-distance", "curved", "cell-values", "crease-angle"};
    std::vector<Option> all = options_of(options);
    std::erase_if(all, [&](const Option& option) { return std::ranges::find(kNames, option.name) == std::end(kNames); });
    return all;
}

/// An array of a VTK grid: (name, whether at the cells, numbers).
VtkGridArray vtk_array_of(const py::handle& given) {
    const auto [name, at_cells, numbers] = given.cast<std::tuple<std::string, bool, py::object>>();
    const py::array array = array_from(numbers, Error(ErrorCode::InvalidInput, "is not an array", name));
    const bool flat = array.ndim() < 2;
    const int components = flat ? 1 : static_cast<int>(array.shape(1));
    const py::array_t<double> rows =
        flat ? subvol::python::numbers<double>(array, name) : rows_of<double>(array, components, name);
    const char kind = array.dtype().kind();
    return {name, components, at_cells, {rows.data(), rows.data() + rows.size()}, kind == 'i' || kind == 'u' || kind == 'b'};
}

py::tuple from_vtk(const py::object& points, const py::object& types, const py::object& ends, const py::object& connectivity,
                   const py::object& faces, const py::object& face_ends, const py::list& arrays, const py::list& field_arrays,
                   const py::kwargs& given) {
    ReadOptions options;
    set_options(options_of_grids(options), given);
    const auto whole = [](const py::object& list, const char* what) {
        const py::array_t<std::int64_t> all = numbers<std::int64_t>(list, what);
        return std::vector<std::int64_t>(all.data(), all.data() + all.size());
    };
    VtkUnstructuredGrid grid;
    grid.points = vectors(points, "points");
    for (const std::int64_t type : whole(types, "types")) {
        if (type < 0 || type > 255)
            throw Error(ErrorCode::InvalidInput, "there is no type " + std::to_string(type), "types", "0 to 255");
        grid.types.push_back(static_cast<std::uint8_t>(type));
    }
    grid.ends = whole(ends, "offsets");
    grid.connectivity = whole(connectivity, "connectivity");
    grid.faces = whole(faces, "faces");
    grid.face_ends = whole(face_ends, "face offsets");
    for (const py::handle& array : arrays) grid.arrays.push_back(vtk_array_of(array));
    for (const py::handle& given_array : field_arrays) {
        const auto [name, numbers] = given_array.cast<std::tuple<std::string, py::object>>();
        grid.field_arrays.push_back({name, whole(numbers, name.c_str())});
    }
    ReadResult result = [&] {
        const py::gil_scoped_release without_gil;
        return mesh_of_vtk(std::move(grid), options);
    }();
    return py::make_tuple(with_sets(std::move(result.mesh), std::move(result.sets)), result.warnings);
}

/// The mesh whose fields stay between the points within the range that they have in the file; of fields at cells, within that
/// of the cells.
py::object bounded(const py::object& self) {
    HexMesh mesh = self.cast<const HexMesh&>();
    std::vector<Attribute> at_cells;
    for (const Attribute& field : mesh.attributes) {
        if (!field.cells.empty()) at_cells.push_back({field.name, field.channels, field.cells});
    }
    bound_as_given(mesh, at_cells);
    return with_sets(std::move(mesh), sets_of(self));
}

/// The mesh of some cells, with what is left of its patches and sets, and a warning.
py::object only_of(const py::object& self, const std::vector<std::string>& texts, int levels) {
    const auto& mesh = self.cast<const HexMesh&>();
    const MeshSets sets = sets_of(self);
    auto [part, of_part] = [&] {
        const py::gil_scoped_release without_gil;
        const std::vector<std::uint8_t> cells = cells_in(mesh, parse_regions(texts), sets);
        PartOfLimit taken = part_of_limit(mesh, cells, {.max_levels = levels});
        MeshSets left = sets_of_children(sets_of_cells(sets, cells), taken.levels);
        return std::pair(std::move(taken), std::move(left));
    }();
    const std::string warning = detail::part_warning(part, OptionNames::Keywords);
    return py::make_tuple(with_sets(std::move(part.mesh), std::move(of_part)), warning);
}

py::object warped(const py::object& self, const std::string& field, std::optional<double> factor) {
    HexMesh mesh = self.cast<const HexMesh&>();
    {
        const py::gil_scoped_release without_gil;
        move_points(mesh, {field, factor});
    }
    return with_sets(std::move(mesh), sets_of(self));
}

py::object patches_of(const py::object& self) {
    py::dict patches;
    const MeshSets given = sets_of(self);
    for (const Patch& patch : given.patches) {
        std::vector<Index> rows;
        for (const CellSide& side : patch.sides) rows.insert(rows.end(), {side.cell, Index{side.side}});
        patches[py::str(patch.name)] = read_only(owned(std::move(rows), {length(patch.sides.size()), 2}));
    }
    return read_only(patches, "the patches of a mesh");
}

py::object cell_sets_of(const py::object& self) {
    py::dict sets;
    MeshSets given = sets_of(self);
    for (CellSet& set : given.sets) {
        const py::ssize_t cells = length(set.cells.size());
        sets[py::str(set.name)] = read_only(owned(std::move(set.cells), {cells}));
    }
    return read_only(sets, "the sets of a mesh");
}

py::object node_sets_of(const py::object& self) {
    py::dict sets;
    for (const NodeSet& set : sets_of(self).nodes) {
        std::vector<Index> points = points_of(self.cast<const HexMesh&>(), set);
        const py::ssize_t count = length(points.size());
        sets[py::str(set.name)] = read_only(owned(std::move(points), {count}));
    }
    return read_only(sets, "the sets of nodes of a mesh");
}

/// The mesh with other fields, and all else that it has.
py::object with_fields(const py::object& self, const py::object& fields) {
    const auto& mesh = self.cast<const HexMesh&>();
    HexMesh changed{mesh.points, mesh.cells, {}, mesh.creases, mesh.sharp_faces};
    for_each_named(fields, "fields", [&](const std::string& name, const py::handle& values) {
        Attribute field = attribute_of(name, values, changed.points.size());
        const Attribute* const before = mesh.find_attribute(name);
        const bool same = before != nullptr && before->channels == field.channels && before->values == field.values;
        changed.attributes.push_back(same ? *before : std::move(field));
    });
    validate(changed);
    return with_sets(std::move(changed), sets_of(self));
}

py::tuple selected(const HexMesh& mesh, const std::optional<std::string>& name) {
    SelectedField field = result_of(py::none(), [&](Progress* listener) { return select_field(mesh, name, listener); });
    HexMesh with{mesh.points, mesh.cells, {std::move(field.scalar)}, mesh.creases, mesh.sharp_faces};
    return py::make_tuple(std::move(with), field.warning);
}

SurfaceArrays boundary_of(const HexMesh& mesh) {
    Surface surface = boundary_surface(mesh);
    std::vector<Index> corners;
    corners.reserve(3 * surface.triangles.size());
    for (const auto& triangle : surface.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());
    const py::ssize_t triangles = length(surface.triangles.size());
    return {owned(std::move(surface.points)), owned(std::move(corners), {triangles, 3})};
}

/// The scheme without angles of creases: they are those of the mesh.
std::vector<Option> keywords_of(WaveletFileOptions& options) {
    std::vector<Option> all = scheme_and(options.scheme, options_of(options));
    std::erase_if(all, [](const Option& option) { return option.name == "crease-angle"; });
    return all;
}

py::dict write_wavelets(const std::string& path, const HexMesh& mesh, const py::object& progress, const py::kwargs& keywords) {
    WaveletFileOptions options;
    set_options(keywords_of(options), keywords);
    const WaveletFileReport report = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return write_wavelet_file(path, mesh, options);
    });
    py::dict figures, arrays;
    for (const WaveletArrayReport& array : report.arrays) {
        py::dict kept;
        kept["coefficients"] = array.coefficients;
        kept["kept"] = array.kept;
        kept["rms"] = array.rms;
        kept["max"] = array.max;
        arrays[py::str(array.name)] = kept;
    }
    figures["levels"] = report.levels;
    figures["coarse_cells"] = report.coarse_cells;
    figures["cells"] = report.cells;
    figures["bytes"] = report.bytes;
    figures["inverted_cells"] = report.inverted_cells;
    figures["arrays"] = arrays;
    return figures;
}

/// read: a call that returns the mesh of a step
py::dict write_series(const std::string& path, const std::vector<double>& times, const py::function& read,
                      const py::object& progress, const py::kwargs& keywords) {
    SeriesFileOptions options;
    set_options(options_of(options), keywords);
    MeshSets sets;
    const MeshSteps steps{times,
                          [&](std::size_t step) {
                              const py::gil_scoped_acquire gil;
                              const py::object mesh = read(step);
                              const HexMesh& given =
                                  object_of<HexMesh>(mesh, "steps[" + std::to_string(step) + "]", "a HexMesh");
                              sets = sets_of(mesh);
                              return given;
                          },
                          [&] { return sets; }};
    return dict_of(facts_of(result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        return write_series_file(path, steps, options);
    })));
}

constexpr const char* kSets = "_sets";

/// What pickles hold of the sets of nodes, by name (n,2): the cells and their corners as bits.
py::dict corners_of_node_sets(const py::object& self) {
    py::dict sets;
    for (const NodeSet& set : sets_of(self).nodes) {
        std::vector<Index> rows;
        for (const CellCorners& of_cell : set.cells) rows.insert(rows.end(), {of_cell.cell, Index{of_cell.corners}});
        sets[py::str(set.name)] = owned(std::move(rows), {length(set.cells.size()), 2});
    }
    return sets;
}

/// Numbers of cells or points. What is no such number becomes kNone.
std::vector<Index> indices_of(const py::handle& given, const std::string& name) {
    const py::array_t<std::int64_t> all = numbers<std::int64_t>(given, name.c_str());
    std::vector<Index> indices;
    for (py::ssize_t i = 0; i < all.size(); ++i)
        indices.push_back(std::in_range<Index>(all.data()[i]) ? static_cast<Index>(all.data()[i]) : kNone);
    return indices;
}

/// Sides (n,2) as cells and their sides, or points (n,), for the sides of the boundary between them.
std::vector<Patch> patches_from(const py::object& given, const HexMesh& mesh) {
    std::vector<Patch> patches;
    for_each_named(given, "patches", [&](const std::string& name, const py::handle& rows) {
        const Error no_array(ErrorCode::InvalidInput, "cannot be made an array", name,
                             "an array of cells and sides, or of points");
        if (const py::array array = array_from(rows, no_array); array.ndim() == 1) {
            const std::vector<Index> points = array.size() > 0 ? indices_of(rows, name) : std::vector<Index>();
            patches.push_back(boundary_of(mesh, node_set_of(mesh, name, points)));
            return;
        }
        Patch& patch = patches.emplace_back(Patch{.name = name, .sides = {}});
        constexpr Index kNoSide = 6;
        for (const auto& [cell, side] : index_rows<2>(rows, std::max<std::size_t>(mesh.cells.size(), kNoSide), name))
            patch.sides.push_back({cell, static_cast<std::uint8_t>(std::min(side, kNoSide))});
    });
    return patches;
}

std::vector<CellSet> cell_sets_from(const py::object& given) {
    std::vector<CellSet> sets;
    for_each_named(given, "sets", [&](const std::string& name, const py::handle& cells) {
        sets.push_back({.name = name, .cells = indices_of(cells, name)});
        std::ranges::sort(sets.back().cells);
    });
    return sets;
}

/// The patches and sets of a pickled mesh.
MeshSets sets_from(const py::object& patches, const py::object& cells, const py::object& nodes, const HexMesh& mesh) {
    MeshSets sets{patches_from(patches, mesh), cell_sets_from(cells)};
    for_each_named(nodes, "sets of nodes", [&](const std::string& name, const py::handle& rows) {
        NodeSet& set = sets.nodes.emplace_back(NodeSet{.name = name, .cells = {}});
        constexpr Index kAllCorners = 255;
        for (const auto& [cell, corners] : index_rows<2>(rows, std::max<std::size_t>(mesh.cells.size(), kAllCorners + 1), name))
            set.cells.push_back({cell, static_cast<std::uint8_t>(std::min(corners, kAllCorners))});
    });
    validate(sets, mesh);
    return sets;
}

void check_on_boundary(const HexMesh& mesh, const std::vector<Patch>& patches) {
    const Topology topology = build_topology(mesh);
    for (const Patch& patch : patches) {
        for (const CellSide& side : patch.sides) {
            if (topology.face_on_hull(topology.cell_faces[side.cell][side.side])) continue;
            throw Error(ErrorCode::InvalidInput,
                        "side " + std::to_string(side.side) + " of cell " + std::to_string(side.cell) + " lies inside the mesh",
                        "patches['" + patch.name + "']", "sides on its boundary");
        }
    }
}

/// The mesh with other patches and sets; those that are None stay.
py::object with_other_sets(const py::object& self, const py::object& patches, const py::object& cells,
                           const py::object& nodes) {
    const auto& mesh = self.cast<const HexMesh&>();
    MeshSets sets = sets_of(self);
    if (!patches.is_none()) sets.patches = patches_from(patches, mesh);
    if (!cells.is_none()) sets.sets = cell_sets_from(cells);
    if (!nodes.is_none()) {
        sets.nodes.clear();
        for_each_named(nodes, "node_sets", [&](const std::string& name, const py::handle& points) {
            sets.nodes.push_back(node_set_of(mesh, name, indices_of(points, name)));
        });
    }
    validate(sets, mesh);
    if (!patches.is_none()) check_on_boundary(mesh, sets.patches);
    return with_sets(mesh, std::move(sets));
}

}  // namespace

MeshSets sets_of(const py::object& mesh) {
    const py::object sets = py::getattr(mesh, kSets, py::none());
    return sets.is_none() ? MeshSets{} : object_of<MeshSets>(sets, "_sets", "MeshSets");
}

MeshSets sets_of(const HexMesh& mesh) {
    return sets_of(py::cast(&mesh, py::return_value_policy::reference));
}

py::object with_sets(HexMesh mesh, MeshSets sets) {
    py::object object = py::cast(std::move(mesh));
    if (!sets.empty()) object.attr(kSets) = py::cast(std::move(sets));
    return object;
}

void bind_mesh(py::module_& module) {
    // Assigning to a property says how to have another mesh.
    const auto refuse = [](const char* sentence) {
        return [sentence](HexMesh&, const py::object&) { throw py::attribute_error(sentence); };
    };
    const char* const no_points =
        "the points and cells of a mesh cannot be changed; HexMesh(points, cells, mesh.fields) is a mesh with others";
    const char* const no_sets =
        "the patches and sets of a mesh cannot be changed; mesh.with_sets(patches={...}, sets={...}, node_sets={...}) is a "
        "mesh "
        "with others";
    py::class_<MeshSets>(module, "MeshSets");
    py::class_<HexMesh>(module, "HexMesh", py::dynamic_attr(),
                        "A hexahedral mesh with fields at its points. It does not change: its arrays are read-only views.")
        .def(py::init(&mesh_of), py::arg("points"), py::arg("cells"), py::arg("fields") = py::none(),
             py::arg("creases") = py::none(), py::arg("sharp_faces") = py::none(), py::arg("crease_angle") = "auto")
        .def_property(
            "points",
            [](const py::object& self) {
                const auto& points = self.cast<const HexMesh&>().points;
                return view(reinterpret_cast<const double*>(points.data()), {length(points.size()), 3}, self);
            },
            refuse(no_points))
        .def_property(
            "cells", [](const py::object& self) { return view_of_rows(self.cast<const HexMesh&>().cells, self); },
            refuse(no_points))
        .def_property_readonly("creases",
                               [](const py::object& self) { return view_of_rows(self.cast<const HexMesh&>().creases, self); })
        .def_property_readonly(
            "sharp_faces", [](const py::object& self) { return view_of_rows(self.cast<const HexMesh&>().sharp_faces, self); })
        .def_property("fields", &fields_of,
                      refuse("the fields of a mesh cannot be changed; mesh.with_fields({...}) is a mesh with others"))
        .def_property_readonly("cell_fields", &cell_fields_of)
        .def_property("patches", &patches_of, refuse(no_sets))
        .def_property("sets", &cell_sets_of, refuse(no_sets))
        .def_property("node_sets", &node_sets_of, refuse(no_sets))
        .def_property_readonly("bounds", [](const HexMesh& mesh) { return read_only(as_array(bounds(mesh))); })
        .def("report", &figures_of)
        .def("boundary",
             [](const HexMesh& mesh) {
                 SurfaceArrays surface = boundary_of(mesh);
                 return py::make_tuple(surface.points, surface.triangles);
             })
        .def(
            "without_unused_points",
            [](const py::object& self) { return with_sets(without_unused_points(self.cast<const HexMesh&>()), sets_of(self)); })
        .def(
            "with_creases",
            [](const py::object& self, double angle_deg) {
                auto tagged = self.cast<HexMesh>();
                tag_creases(tagged, angle_deg);
                return with_sets(std::move(tagged), sets_of(self));
            },
            py::arg("angle_deg"))
        .def("with_fields", &with_fields, py::arg("fields"))
        .def("with_sets", &with_other_sets, py::kw_only(), py::arg("patches") = py::none(), py::arg("sets") = py::none(),
             py::arg("node_sets") = py::none())
        .def(
            "same_cells", [](const HexMesh& mesh, const HexMesh& other) { return same_cells(mesh, other); }, py::arg("other"))
        .def("__repr__", &mesh_text)
        .def("_repr_html_",
             [](const py::object& self) { return py::module_::import("subvol._notebook").attr("mesh_html")(self); })
        .def(py::pickle(
            [](const py::object& self) {
                return py::make_tuple(self.attr("points"), self.attr("cells"), self.attr("fields"), self.attr("creases"),
                                      self.attr("sharp_faces"), self.attr("patches"), self.attr("sets"),
                                      corners_of_node_sets(self), rest_of_fields(self.cast<const HexMesh&>()));
            },
            [](const py::tuple& state) {
                if (state.size() != 9) throw Error(ErrorCode::InvalidInput, "is not a mesh of this version", "pickle");
                HexMesh mesh = mesh_of(state[0], state[1], state[2], state[3], state[4], py::none());
                put_rest_of_fields(state[8], mesh);
                py::dict attributes;
                MeshSets sets = sets_from(state[5], state[6], state[7], mesh);
                if (!sets.empty()) attributes[kSets] = std::move(sets);
                return std::pair(std::move(mesh), attributes);
            }));

    module.def("read_mesh", &read, py::arg("path"));
    ReadOptions reading;
    describe(module, "read_mesh", options_of(reading));
    module.def("from_vtk", &from_vtk, py::arg("points"), py::arg("types"), py::arg("ends"), py::arg("connectivity"),
               py::arg("faces"), py::arg("face_ends"), py::arg("arrays"), py::arg("field_arrays"));
    module.def("is_vtk_field_array", &is_vtk_field_array, py::arg("name"));
    module.def(
        "vtk_field_arrays",
        [](const HexMesh& mesh) {
            py::dict arrays;
            for (VtkFieldArray& array : vtk_field_arrays(mesh, sets_of(mesh))) {
                const py::ssize_t count = length(array.numbers.size());
                arrays[py::str(array.name)] = owned(std::move(array.numbers), {count});
            }
            return arrays;
        },
        py::arg("mesh"));
    module.def(
        "vtk_set_arrays",
        [](const HexMesh& mesh) {
            py::dict arrays;
            const std::size_t cells = mesh.cells.size();
            for (const CellSet& set : sets_of(mesh).sets) {
                std::vector<std::uint8_t> in_set(cells, 0);
                for (const Index c : set.cells) in_set[c] = 1;
                arrays[py::str(vtk_set_array(set))] = owned(std::move(in_set), {length(cells)});
            }
            return arrays;
        },
        py::arg("mesh"));
    module.def(
        "vtk_node_arrays",
        [](const HexMesh& mesh) {
            py::dict arrays;
            for (const NodeSet& set : sets_of(mesh).nodes) {
                std::vector<std::uint8_t> in_set(mesh.points.size(), 0);
                for (const Index p : points_of(mesh, set)) in_set[p] = 1;
                arrays[py::str(vtk_node_array(set))] = owned(std::move(in_set), {length(mesh.points.size())});
            }
            return arrays;
        },
        py::arg("mesh"));
    describe(module, "from_vtk", options_of_grids(reading));
    module.def(
        "series_times",
        [](const std::string& path) {
            const py::gil_scoped_release without_gil;
            return open_series(path).times;
        },
        py::arg("path"));
    module.def(
        "write_mesh",
        [](const std::string& path, const HexMesh& mesh) {
            const MeshSets& sets = sets_of(mesh);
            const py::gil_scoped_release without_gil;
            return write_mesh(path, mesh, {}, sets);
        },
        py::arg("path"), py::arg("mesh"));
    module.def("write_wavelets", &write_wavelets, py::arg("path"), py::arg("mesh"), py::arg("progress"));
    WaveletFileOptions wavelets;
    describe(module, "write_wavelets", keywords_of(wavelets));
    module.def("write_series", &write_series, py::arg("path"), py::arg("times"), py::arg("read"), py::arg("progress"));
    SeriesFileOptions series;
    describe(module, "write_series", options_of(series));
    module.def(
        "quantity",
        [](const HexMesh& mesh, const std::string& source) {
            Attribute field =
                result_of(py::none(), [&](Progress* listener) { return field_of(mesh, source, source, listener); });
            const py::ssize_t points = length(mesh.points.size()), channels = field.channels;
            return channels == 1 ? owned(std::move(field.values), {points})
                                 : owned(std::move(field.values), {points, channels});
        },
        py::arg("mesh"), py::arg("source"));
    module.def("warp", &warped, py::arg("mesh"), py::arg("field"), py::arg("factor"));
    module.def("bounded", &bounded, py::arg("mesh"));
    module.def("only", &only_of, py::arg("mesh"), py::arg("regions"), py::arg("levels"));
    module.def("select_field", &selected, py::arg("mesh"), py::arg("name"));
    module.def(
        "make_model",
        [](const std::string& name, int resolution) {
            const py::gil_scoped_release without_gil;
            return make_model(name, resolution);
        },
        py::arg("name"), py::arg("resolution"));
    module.def("list_models", [] {
        py::dict models;
        for (const ModelInfo& info : list_models()) models[py::str(info.name)] = info.description;
        return models;
    });
    module.def(
        "evaluate_expression",
        [](const std::string& expression, const py::object& points) {
            std::vector<double> values = evaluate_expression(expression, vectors(points, "points"));
            const py::ssize_t count = length(values.size());
            return owned(std::move(values), {count});
        },
        py::arg("expression"), py::arg("points"));
    module.def("readable_extensions", &readable_mesh_extensions);
    module.def(
        "is_mesh_file", [](const std::string& path) { return is_mesh_file(path); }, py::arg("path"));
}

}  // namespace subvol::python
