// SPDX-License-Identifier: Apache-2.0
// Contents of files as values, and what a mesh that is made of them has, by brute force.
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "assemble.h"
#include "lib/temp_folder.h"
#include "lib/test_meshes.h"
#include "lib/volume_of.h"
#include "mesh_file.h"
#include "subvol/cell.h"
#include "subvol/hex_mesh.h"

namespace subvol::test {

inline constexpr detail::EntityNames kMadeNames{"point", "cell", 0};
inline constexpr const char* kMadeFile = "made.file";

/// Appends a cell with the number that comes next among all cells.
template <std::size_t N>
void add_cell(detail::MeshFile& file, detail::FileCells<N>& cells, const std::array<Index, N>& corners) {
    std::size_t number = file.quads.numbers.size() + file.lines.numbers.size();
    detail::each_kind(file, [&](const auto& kind) { number += kind.numbers.size(); });
    cells.corners.push_back(corners);
    cells.numbers.push_back(static_cast<Index>(number));
}

/// The hexahedra of a mesh, with numbers.
inline detail::MeshFile file_of(const HexMesh& mesh) {
    detail::MeshFile file;
    file.points = mesh.points;
    for (const auto& cell : mesh.cells) add_cell(file, file.hexes, cell);
    return file;
}

inline ReadResult assembled(detail::MeshFile file, const ReadOptions& options = {}) {
    return detail::assemble(std::move(file), kMadeFile, kMadeNames, options);
}

/// The sentence of the Error that the contents of a file lead to.
inline std::string refusal_of(const detail::MeshFile& file, const ReadOptions& options = {}) {
    return error_of([&] { static_cast<void>(assembled(file, options)); });
}

/// Adds an array of one component at the points, with the values of a function.
template <class Function>
void add_at_points(detail::MeshFile& file, const std::string& name, const Function& f) {
    detail::FileArray array{name, 1, false, {}};
    for (const Vec3& x : file.points) array.values.push_back(f(x));
    file.arrays.push_back(std::move(array));
}

inline void add_at_cells(detail::MeshFile& file, const std::string& name, const std::vector<double>& values) {
    file.arrays.push_back({name, 1, true, values});
}

inline std::array<Vec3, 8> corners_of(const HexMesh& mesh, std::size_t cell) {
    std::array<Vec3, 8> corners;
    for (std::size_t k = 0; k < 8; ++k) corners[k] = mesh.points[mesh.cells[cell][k]];
    return corners;
}

inline double least_volume(const HexMesh& mesh) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) least = std::min(least, cell_volume(corners_of(mesh, c)));
    return least;
}

/// The area of a plane quad by its diagonals.
inline double area_of(const HexMesh& mesh, const std::array<Index, 4>& quad) {
    const auto& x = mesh.points;
    return glm::length(glm::cross(x[quad[2]] - x[quad[0]], x[quad[3]] - x[quad[1]])) / 2;
}

inline std::array<Index, 4> side_of(const HexMesh& mesh, std::size_t cell, std::size_t side) {
    std::array<Index, 4> quad;
    for (std::size_t k = 0; k < 4; ++k) quad[k] = mesh.cells[cell][kCellFaces[side][k]];
    return quad;
}

/// The area of the faces that only one cell has: of a mesh whose cells fit together, that of its hull. Faces have to be plane.
inline double open_area(const HexMesh& mesh) {
    std::map<std::array<Index, 4>, std::pair<int, double>> faces;
    for (std::size_t c = 0; c < mesh.cells.size(); ++c) {
        for (std::size_t side = 0; side < 6; ++side) {
            std::array<Index, 4> quad = side_of(mesh, c, side);
            const double area = area_of(mesh, quad);
            std::ranges::sort(quad);
            auto& [count, area_there] = faces[quad];
            ++count;
            area_there = area;
        }
    }
    double open = 0;
    for (const auto& [quad, found] : faces) {
        EXPECT_LE(found.first, 2) << "cells share the face " << quad[0] << ", " << quad[1] << ", " << quad[2];
        if (found.first == 1) open += found.second;
    }
    return open;
}

/// A field's value at the point of a place; fails if there is no such point.
inline double value_at(const HexMesh& mesh, const std::string& field, const Vec3& place) {
    const auto point = std::ranges::find_if(mesh.points, [&](const Vec3& x) { return glm::distance(x, place) < 1e-12; });
    const Attribute* attribute = mesh.find_attribute(field);
    if (point == mesh.points.end() || attribute == nullptr) {
        ADD_FAILURE() << "no field " << field << ", or no point at " << place.x << ", " << place.y << ", " << place.z;
        return std::numeric_limits<double>::quiet_NaN();
    }
    return attribute->values[static_cast<std::size_t>(point - mesh.points.begin())];
}

}  // namespace subvol::test
