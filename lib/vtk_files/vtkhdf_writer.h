// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "hdf5_file.h"
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
        std::string unique = unique_name(name);
        out_.put("/VTKHDF/PointData/" + unique, values, components > 1 ? components : 0);
        return unique;
    }
    /// An array of one component that belongs to the whole mesh.
    void field(const std::string& name, std::span<const std::int64_t> values) { out_.put("/VTKHDF/FieldData/" + name, values); }
    void commit() { out_.commit(); }

private:
    std::string unique_name(std::string name);

    Hdf5Output out_;
    std::set<std::string> names_;
};

}  // namespace subvol::detail
