// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <pugixml.hpp>

#include "mesh_file.h"
#include "subvol/detail/vtk_xml.h"

namespace subvol::detail {

/// A block of a structured data set of VTK XML. first: the number of its first point along each axis
struct VtkExtent {
    StructuredGrid grid;
    std::array<std::int64_t, 3> first{};
};

/// The extent of a piece. throws: Error(InvalidInput) if it is not six integers
[[nodiscard]] VtkExtent extent_of(const VtkXml& xml, const pugi::xml_node& piece);

/// The distances of an image's points along its axes.
[[nodiscard]] std::array<double, 3> spacing_of(const VtkXml& xml);

/// The position of an image in the world: its origin, and its axes as the columns of a matrix that is stored row by row.
struct ImagePlacement {
    std::array<double, 3> origin;
    std::array<double, 9> axes;

    [[nodiscard]] Vec3 operator()(const Vec3& along) const;
};
[[nodiscard]] ImagePlacement placement_of(const VtkXml& xml);

}  // namespace subvol::detail
