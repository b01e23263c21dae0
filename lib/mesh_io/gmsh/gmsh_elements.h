// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string_view>

namespace subvol::detail {

/// The kind of cell that a Gmsh element is read as; lines, triangles and quads as parts of groups.
enum class GmshShape { Other, Line, Triangle, Quad, Hexahedron, Tetrahedron, Prism, Pyramid };

/// A type of elements. nodes: their number; the corners come first, then those in the middle of edges, faces and the element
struct GmshElement {
    std::size_t nodes;
    std::string_view one, many;
    GmshShape shape = GmshShape::Other;
};

/// The types of elements by Gmsh's number.
inline const std::map<std::int64_t, GmshElement> kGmshElements{
    {1, {2, "line", "lines", GmshShape::Line}},
    {2, {3, "triangle", "triangles", GmshShape::Triangle}},
    {3, {4, "quad", "quads", GmshShape::Quad}},
    {4, {4, "tetrahedron", "tetrahedra", GmshShape::Tetrahedron}},
    {5, {8, "hexahedron", "hexahedra", GmshShape::Hexahedron}},
    {6, {6, "prism", "prisms", GmshShape::Prism}},
    {7, {5, "pyramid", "pyramids", GmshShape::Pyramid}},
    {8, {3, "quadratic line", "quadratic lines", GmshShape::Line}},
    {9, {6, "quadratic triangle", "quadratic triangles", GmshShape::Triangle}},
    {10, {9, "quadratic quad", "quadratic quads", GmshShape::Quad}},
    {11, {10, "quadratic tetrahedron", "quadratic tetrahedra", GmshShape::Tetrahedron}},
    {12, {27, "quadratic hexahedron", "quadratic hexahedra", GmshShape::Hexahedron}},
    {13, {18, "quadratic prism", "quadratic prisms", GmshShape::Prism}},
    {14, {14, "quadratic pyramid", "quadratic pyramids", GmshShape::Pyramid}},
    {15, {1, "point", "points"}},
    {16, {8, "quadratic quad", "quadratic quads", GmshShape::Quad}},
    {17, {20, "quadratic hexahedron", "quadratic hexahedra", GmshShape::Hexahedron}},
    {18, {15, "quadratic prism", "quadratic prisms", GmshShape::Prism}},
    {19, {13, "quadratic pyramid", "quadratic pyramids", GmshShape::Pyramid}},
    {21, {10, "cubic triangle", "cubic triangles", GmshShape::Triangle}},
    {23, {15, "quartic triangle", "quartic triangles", GmshShape::Triangle}},
    {26, {4, "cubic line", "cubic lines", GmshShape::Line}},
    {27, {5, "quartic line", "quartic lines", GmshShape::Line}},
    {29, {20, "cubic tetrahedron", "cubic tetrahedra", GmshShape::Tetrahedron}},
    {30, {35, "quartic tetrahedron", "quartic tetrahedra", GmshShape::Tetrahedron}},
    {36, {16, "cubic quad", "cubic quads", GmshShape::Quad}},
    {37, {25, "quartic quad", "quartic quads", GmshShape::Quad}},
    {90, {40, "cubic prism", "cubic prisms", GmshShape::Prism}},
    {91, {75, "quartic prism", "quartic prisms", GmshShape::Prism}},
    {92, {64, "cubic hexahedron", "cubic hexahedra", GmshShape::Hexahedron}},
    {93, {125, "quartic hexahedron", "quartic hexahedra", GmshShape::Hexahedron}}};

}  // namespace subvol::detail
