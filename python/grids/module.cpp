// SPDX-License-Identifier: Apache-2.0
// The extension subvol._grids: the calls that need OpenVDB, loaded when the first of them is made. It shares the classes of
// subvol._core, which pybind11 knows by the names of their C++ types.
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <set>

#include "bind.h"
#include "given_grids.h"
#include "grid_arrays.h"
#include "subvol/detail/vdb_file.h"
#include "subvol/nanovdb.h"
#include "subvol/option.h"
#include "subvol/rasterize.h"
#include "subvol/vdb_contents.h"
#include "subvol/vdb_grid.h"
#include "subvol/vdb_points.h"
#include "subvol/vdb_sample.h"
#include "subvol/version.h"
#include "uninitialised.h"

namespace subvol::python {
namespace {

using Grid = std::shared_ptr<VdbGrid>;

/// The grids as a list for Python.
std::vector<Grid> shared(std::vector<VdbGrid> grids) {
    std::vector<Grid> list;
    for (VdbGrid& grid : grids) list.push_back(std::make_shared<VdbGrid>(std::move(grid)));
    return list;
}

py::dict report_of(const VdbGrid& grid) {
    const GridReport& about = grid.report();
    py::dict report;
    report["name"] = about.name;
    report["kind"] = about.kind;
    report["level_set"] = about.level_set;
    report["active_voxels"] = about.active_voxels;
    report["voxel_size"] = about.voxel_size_world;
    report["bytes"] = about.bytes;
    report["min"] = about.min;
    report["max"] = about.max;
    return report;
}

py::tuple values_at(const VdbGrid& grid, const py::object& at) {
    const py::array_t<double> rows = rows_of<double>(at, 3, "at");
    const auto count = static_cast<std::size_t>(rows.shape(0));
    py::array_t<double> values(rows.shape(0));
    py::array_t<bool> inside(rows.shape(0));
    double* const to_value = values.mutable_data();
    bool* const to_inside = inside.mutable_data();
    const double* const from = rows.data();
    run(py::none(), [&](Progress* listener) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const auto& range) {
            if (listener->cancelled()) return;  // `run` raises what cancelled it
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                const double* x = from + 3 * i;
                const std::optional<double> value = grid.value({x[0], x[1], x[2]});
                to_value[i] = value.value_or(std::numeric_limits<double>::quiet_NaN());
                to_inside[i] = value.has_value();
            }
        });
    });
    return py::make_tuple(values, inside);
}

void write_files(const std::string& path, std::span<const VdbGrid> grids, bool nano) {
    write_vdb(path, grids);
    if (nano) write_nanovdb(std::filesystem::path(path).replace_extension(".nvdb"), grids);
}

/// The grids, or where they were written, their reports.
py::object written_or_made(std::vector<VdbGrid> grids, const std::optional<std::string>& path) {
    if (!path) return py::cast(shared(std::move(grids)));
    py::list reports;
    for (const VdbGrid& grid : grids) reports.append(report_of(grid));
    return py::object(reports);
}

/// Grids of a mesh: of its limit, or of a level.
///
/// path: None: the grids are returned; else they are written, and their reports are returned
py::tuple rasterize_mesh(const HexMesh& mesh, const std::vector<std::string>& fields, const std::optional<std::string>& path,
                         bool nano, const py::object& progress, const py::kwargs& keywords) {
    GivenGrids given;
    set_options(options_of(given), keywords);
    RasterizeOptions options = given.chosen();
    options.on_limit = !interpolates(given.scheme.kind);
    LimitCells limit;
    std::vector<VdbGrid> grids = result_of(progress, [&](Progress* listener) {
        options.progress = options.refine.progress = listener;
        check_voxels(mesh, options);
        options.voxel_size_world = voxel_size_of(bounds(mesh), options);
        if (!given.levels) {
            limit = limit_for_voxels(mesh, options.refine, options.voxel_size_world);
            options.limit = &limit;
        }
        options.metadata = {{"subvol_from", "mesh"},
                            {"subvol_version", SUBVOL_VERSION},
                            {"subvol_scheme", std::string(name_of(given.scheme.kind))},
                            {"subvol_level", std::to_string(given.levels ? *given.levels : finest_level(limit))}};
        std::vector<VdbGrid> made = rasterize(mesh, fields, options);
        if (path) write_files(*path, made, nano);
        return made;
    });
    return py::make_tuple(written_or_made(std::move(grids), path),
                          given.levels ? py::object(py::none()) : py::object(py::float_(limit.value_of_range)),
                          given.levels || limit.converged);
}

py::object rasterize_volume(const RbfVolume& volume, const std::optional<std::string>& path, bool nano,
                            const py::object& progress, const py::kwargs& keywords) {
    GivenGrids given;
    set_options(options_of(given), keywords);
    RasterizeOptions options = given.chosen();
    options.metadata = {{"subvol_from", "points"}, {"subvol_version", SUBVOL_VERSION}};
    std::vector<std::size_t> channels(volume.channels.size());
    std::iota(channels.begin(), channels.end(), std::size_t{0});
    std::vector<VdbGrid> grids = result_of(progress, [&](Progress* listener) {
        options.progress = listener;
        options.voxel_size_world = voxel_size_of(volume.bounds, options);
        std::vector<VdbGrid> made = rasterize_points(volume, channels, options);
        if (path) write_files(*path, made, nano);
        return made;
    });
    return written_or_made(std::move(grids), path);
}

/// The grids of Python stay as they are, and other threads may use them meanwhile.
void write_grids(const std::string& path, const py::object& given, bool nano) {
    const std::vector<const VdbGrid*> grids = objects_of<VdbGrid>(given, "grids", "a Grid");
    if (grids.empty()) throw Error(ErrorCode::InvalidInput, "there is no grid", path, "at least one");
    if (std::set<const VdbGrid*>(grids.begin(), grids.end()).size() < grids.size()) {
        throw Error(ErrorCode::InvalidInput, "a grid is listed twice", path, "each once");
    }
    std::vector<VdbGrid> side_by_side;
    for (const VdbGrid* const grid : grids) side_by_side.push_back(detail::shared_grid(*grid));
    const py::gil_scoped_release without_gil;
    write_files(path, side_by_side, nano);
}

py::tuple sample_grid(const VdbGrid& grid, double spacing_world, const py::object& progress) {
    VoxelSampleResult result = result_of(progress, [&](Progress* listener) {
        return sample_rbf_points(grid, {.spacing_world = spacing_world, .progress = listener});
    });
    return py::make_tuple(std::move(result.volume), result.report.left_out);
}

}  // namespace
}  // namespace subvol::python

PYBIND11_MODULE(_grids, module) {
    using namespace subvol;
    using namespace subvol::python;
    py::module_::import("subvol._core");
    py::class_<VdbGrid, Grid>(module, "Grid",
                              "An OpenVDB grid: sparse voxels with values at their centres. help(subvol.Grid) says more.")
        .def(py::init(&grid_of_array), py::arg("array"), py::arg("voxel_size") = py::none(), py::arg("origin") = py::none(),
             py::arg("name") = "density", py::kw_only(), py::arg("transform") = py::none(), py::arg("level_set") = false,
             py::arg("background") = py::none())
        .def("array", &array_of_grid)
        .def_property_readonly("shape", &shape_of_grid)
        .def_property_readonly("origin", &origin_of_grid)
        .def_property_readonly("voxel_size", &voxel_size_of_grid)
        .def_property_readonly("transform", &transform_of_grid)
        .def_property_readonly("background", [](const VdbGrid& grid) { return grid.report().outside; })
        .def_property_readonly("name", [](const VdbGrid& grid) { return grid.report().name; })
        .def_property_readonly("report", [](const VdbGrid& grid) { return read_only(report_of(grid), "the report of a grid"); })
        .def_property_readonly("bounds",
                               [](const VdbGrid& grid) {
                                   const Box& box = grid.report().bounds;
                                   return py::make_tuple(as_tuple(box.lower), as_tuple(box.upper));
                               })
        .def_property_readonly("frame",
                               [](const VdbGrid& grid) {
                                   const Box& box = grid.report().frame;
                                   return py::make_tuple(as_tuple(box.lower), as_tuple(box.upper));
                               })
        .def("values", &values_at, py::arg("at"))
        .def("voxels", [](const VdbGrid& grid) { return grid.voxels(); })
        .def(
            "difference",
            [](const VdbGrid& grid, const VdbGrid& other) {
                const GridDifference difference = compare_voxels(grid, other);
                py::dict figures;
                figures["voxels"] = difference.voxels;
                figures["rms"] = difference.rms;
                figures["max"] = difference.max;
                return figures;
            },
            py::arg("other"))
        .def("__repr__", [](const VdbGrid& grid) {
            return "<subvol.Grid: " + grid.report().name + ", " + std::to_string(grid.report().active_voxels) +
                   " active voxels>";
        });
    module.def("rasterize", &rasterize_mesh, py::arg("mesh"), py::arg("fields"), py::arg("path"), py::arg("nano"),
               py::arg("progress"));
    module.def("rasterize_points", &rasterize_volume, py::arg("volume"), py::arg("path"), py::arg("nano"), py::arg("progress"));
    module.def("write", &write_grids, py::arg("path"), py::arg("grids"), py::arg("nano"));
    module.def(
        "read_vdb", [](const std::string& path) { return shared(read_vdb(path)); }, py::arg("path"),
        py::call_guard<py::gil_scoped_release>());
    module.def(
        "read_vdb_contents", [](const std::string& path) { return shared(read_vdb_contents(path).grids); }, py::arg("path"),
        py::call_guard<py::gil_scoped_release>());
    module.def(
        "write_points", [](const std::string& path, const RbfVolume& volume) { write_vdb_points(path, volume); },
        py::arg("path"), py::arg("volume"), py::call_guard<py::gil_scoped_release>());
    module.def(
        "read_points", [](const std::string& path) { return read_vdb_points(path); }, py::arg("path"),
        py::call_guard<py::gil_scoped_release>());
    module.def(
        "holds_points", [](const std::string& path) { return holds_vdb_points(path); }, py::arg("path"));
    module.def("sample", &sample_grid, py::arg("grid"), py::arg("spacing_world"), py::arg("progress"));
    module.def("has_nanovdb", &has_nanovdb);
    refuse_uninitialised(module);
}
