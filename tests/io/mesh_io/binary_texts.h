// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::test {

/// The bytes of numbers in a byte order.
template <class T>
std::string bytes_of(const std::vector<T>& values, std::endian order) {
    std::string result;
    for (const T& value : values) {
        char bytes[sizeof(T)];
        std::memcpy(bytes, &value, sizeof(T));
        if (order != std::endian::native) std::reverse(bytes, bytes + sizeof(T));
        result.append(bytes, sizeof(T));
    }
    return result;
}

template <class T>
std::vector<T> coordinates_as(const HexMesh& mesh) {
    std::vector<T> result;
    for (const Vec3& x : mesh.points) {
        for (int i = 0; i < 3; ++i) result.push_back(static_cast<T>(x[i]));
    }
    return result;
}

template <class T>
std::vector<T> corners_as(const HexMesh& mesh) {
    std::vector<T> result;
    for (const auto& cell : mesh.cells) result.insert(result.end(), cell.begin(), cell.end());
    return result;
}

/// Legacy VTK 3.0, BINARY, without arrays: further sections can be appended.
inline std::string binary_vtk_text(const HexMesh& mesh) {
    const std::string count = std::to_string(mesh.cells.size());
    std::vector<std::int32_t> cells;
    for (const auto& cell : mesh.cells) {
        cells.push_back(8);
        cells.insert(cells.end(), cell.begin(), cell.end());
    }
    return "# vtk DataFile Version 3.0\ntitle\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS " +
           std::to_string(mesh.points.size()) + " double\n" + bytes_of(coordinates_as<double>(mesh), std::endian::big) +
           "\nCELLS " + count + " " + std::to_string(cells.size()) + "\n" + bytes_of(cells, std::endian::big) +
           "\nCELL_TYPES " + count + "\n" + bytes_of(std::vector<std::int32_t>(mesh.cells.size(), 12), std::endian::big) + "\n";
}

}  // namespace subvol::test
