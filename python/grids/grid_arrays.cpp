// SPDX-License-Identifier: Apache-2.0
#include "grid_arrays.h"

#include <cmath>

namespace subvol::python {

namespace {

/// The numbers of an array of a shape, in C order.
py::array_t<double> numbers_of(const py::object& given, const std::string& what, const std::string& allowed) {
    const Error otherwise(ErrorCode::InvalidInput, "cannot be made an array", what, allowed);
    const py::array array = array_from(given, otherwise);
    const char kind = array.dtype().kind();
    if (kind != 'i' && kind != 'u' && kind != 'f') throw otherwise;
    return py::array_t<double, py::array::c_style | py::array::forcecast>(array);
}

/// The edges of voxels and the centre of the first one, from `transform`, or `voxel_size` and `origin`.
void place(GridArray& dense, const py::object& voxel_size, const py::object& origin, const py::object& transform) {
    if (!transform.is_none()) {
        const std::string allowed = "(4, 4) numbers whose last row is 0, 0, 0, 1, without voxel_size and origin";
        const py::array_t<double> rows = numbers_of(transform, "transform", allowed);
        const bool right = rows.ndim() == 2 && rows.shape(0) == 4 && rows.shape(1) == 4 && voxel_size.is_none() &&
                           origin.is_none() && rows.at(3, 0) == 0 && rows.at(3, 1) == 0 && rows.at(3, 2) == 0 &&
                           rows.at(3, 3) == 1;
        if (!right) throw Error(ErrorCode::InvalidInput, "places no voxels", "transform", allowed);
        for (int k = 0; k < 3; ++k) {
            for (int axis = 0; axis < 3; ++axis) dense.to_world[axis][k] = rows.at(k, axis);
            dense.origin[k] = rows.at(k, 3);
        }
        return;
    }
    const std::string allowed = "the edge of a voxel in the world, above 0, or three of them";
    if (voxel_size.is_none()) throw Error(ErrorCode::InvalidInput, "is missing", "voxel_size", allowed);
    const py::array_t<double> edges = numbers_of(voxel_size, "voxel_size", allowed);
    if (edges.ndim() > 1 || (edges.size() != 1 && edges.size() != 3)) {
        throw Error(ErrorCode::InvalidInput, "is not the size of a voxel", "voxel_size", allowed);
    }
    for (int k = 0; k < 3; ++k) {
        const double edge = edges.data()[edges.size() == 3 ? k : 0];
        if (!(edge > 0)) throw Error(ErrorCode::InvalidInput, "is not above 0", "voxel_size", allowed);
        dense.to_world[k][k] = edge;
    }
    if (origin.is_none()) return;
    const std::string a_place = "three finite numbers: the centre of voxel 0, 0, 0 in the world";
    const py::array_t<double> at = numbers_of(origin, "origin", a_place);
    if (at.ndim() != 1 || at.size() != 3) throw Error(ErrorCode::InvalidInput, "is not a place", "origin", a_place);
    dense.origin = {at.data()[0], at.data()[1], at.data()[2]};
}

}  // namespace

std::shared_ptr<VdbGrid> grid_of_array(const py::object& given, const py::object& voxel_size, const py::object& origin,
                                       const std::string& name, const py::object& transform, bool level_set,
                                       std::optional<double> background) {
    const Error otherwise(ErrorCode::InvalidInput, "is not an array of voxels", "array",
                          "real numbers (nx, ny, nz), or (nx, ny, nz, 3) of vectors");
    const py::array array = array_from(given, otherwise);
    const char kind = array.dtype().kind();
    const bool vectors = array.ndim() == 4 && array.shape(3) == 3;
    if ((array.ndim() != 3 && !vectors) || array.size() == 0 || (kind != 'i' && kind != 'u' && kind != 'f')) throw otherwise;
    if (background && !level_set)
        throw Error(ErrorCode::InvalidInput, "is of level sets", "background", "level_set=True with it");
    GridArray dense;
    dense.components = vectors ? 3 : 1;
    for (std::size_t k = 0; k < 3; ++k) dense.size[k] = static_cast<std::size_t>(array.shape(length(k)));
    place(dense, voxel_size, origin, transform);
    const py::array_t<float, py::array::c_style | py::array::forcecast> floats(array);
    const py::gil_scoped_release without_gil;
    dense.values.assign(floats.data(), floats.data() + floats.size());
    return std::make_shared<VdbGrid>(make_grid(dense, {.name = name, .level_set = level_set, .background = background}));
}

py::array array_of_grid(const VdbGrid& grid) {
    GridArray dense = [&] {
        const py::gil_scoped_release without_gil;
        return subvol::grid_array(grid);
    }();
    std::vector<py::ssize_t> shape{length(dense.size[0]), length(dense.size[1]), length(dense.size[2])};
    if (dense.components == 3) shape.push_back(3);
    return owned(std::move(dense.values), std::move(shape));
}

py::tuple shape_of_grid(const VdbGrid& grid) {
    const GridArray box = grid_box(grid);
    return box.components == 3 ? py::make_tuple(box.size[0], box.size[1], box.size[2], 3)
                               : py::make_tuple(box.size[0], box.size[1], box.size[2]);
}

py::array transform_of_grid(const VdbGrid& grid) {
    const GridArray box = grid_box(grid);
    std::vector<double> rows(16, 0.0);
    for (int k = 0; k < 3; ++k) {
        for (int axis = 0; axis < 3; ++axis) rows[static_cast<std::size_t>(4 * k + axis)] = box.to_world[axis][k];
        rows[static_cast<std::size_t>(4 * k + 3)] = box.origin[k];
    }
    rows[15] = 1;
    return read_only(owned(std::move(rows), {4, 4}));
}

py::array origin_of_grid(const VdbGrid& grid) {
    const Vec3 origin = grid_box(grid).origin;
    return read_only(owned(std::vector<double>{origin.x, origin.y, origin.z}, {3}));
}

double voxel_size_of_grid(const VdbGrid& grid) {
    const Mat3 to_world = grid_box(grid).to_world;
    if (to_world == Mat3(to_world[0][0]) && to_world[0][0] > 0) return to_world[0][0];
    throw Error(ErrorCode::InvalidInput, "its voxels are no cubes along the axes", "grid " + grid.report().name,
                "transform has their edges");
}

}  // namespace subvol::python
