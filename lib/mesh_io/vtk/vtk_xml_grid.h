// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "structured_grid.h"
#include "vtk_xml.h"

namespace subvol::detail {

/// The volume data sets of VTK XML: cells with their corners, or a block of hexahedra. The points of a block are listed, or
/// given by the coordinates of its planes on each axis, or evenly spaced.
enum class VtkGrid { Unstructured, Structured, Rectilinear, Image };

/// The name of the data set's element.
[[nodiscard]] const char* name_of(VtkGrid grid);

/// A block of a structured data set. first: the number of its first point along each axis
struct VtkExtent {
    StructuredGrid grid;
    std::array<std::int64_t, 3> first{};
};

[[nodiscard]] VtkExtent extent_of(const VtkXml& xml, const pugi::xml_node& piece);

/// Appends the points of a piece. kind: Rectilinear or Image
void add_grid_points(const VtkXml& xml, VtkGrid kind, const pugi::xml_node& piece, const VtkExtent& extent, MeshFile& into);

}  // namespace subvol::detail
