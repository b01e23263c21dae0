// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "structured_grid.h"
#include "vtk_xml.h"

namespace subvol::detail {

/// What VTK's XML has of volumes: cells with their corners, or a block of hexahedra whose points are listed, are given by where
/// its planes cut the axes, or are evenly spaced.
enum class VtkGrid { Unstructured, Structured, Rectilinear, Image };

/// The element's name.
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
