// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "subvol/detail/hdf5_file.h"
#include "subvol/vec.h"

namespace subvol::detail {

/// Writes a .vtkhdf file of version 1.0, which ParaView 5.10, VTK 9.1 and later read: an unstructured grid of cells of one
/// type.
class VtkHdfWriter {
public:
    explicit VtkHdfWriter(const std::filesystem::path& target);

    /// connectivity: the corners of all cells; type: VTK's number for the cells; per_cell: their number of corners
    void grid(std::span<const Vec3> points, std::span<const std::int64_t> connectivity, std::uint8_t type,
              std::size_t per_cell);
    /// An array at the points.
    ///
    /// returns: its name in the file: '/' becomes '_', since HDF5 has folders, and names are unique
    template <class T>
    std::string array(const std::string& name, std::span<const T> values, std::size_t components) {
        std::string unique = unique_name(name, at_points_);
        out_.put("/VTKHDF/PointData/" + unique, values, components > 1 ? components : 0);
        return unique;
    }
    /// An array at the cells. returns: as `array`
    template <class T>
    std::string cell_array(const std::string& name, std::span<const T> values, std::size_t components = 1) {
        std::string unique = unique_name(name, at_cells_);
        out_.put("/VTKHDF/CellData/" + unique, values, components > 1 ? components : 0);
        return unique;
    }
    /// An array of one component that belongs to the whole mesh. returns: as `array`
    std::string field(const std::string& name, std::span<const std::int64_t> values) {
        std::string unique = unique_name(name, of_mesh_);
        out_.put("/VTKHDF/FieldData/" + unique, values);
        return unique;
    }
    void commit() { out_.commit(); }

private:
    /// taken: the names in the same group
    static std::string unique_name(std::string name, std::set<std::string>& taken);

    Hdf5Output out_;
    std::set<std::string> at_points_, at_cells_, of_mesh_;
};

}  // namespace subvol::detail
