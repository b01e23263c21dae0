// SPDX-License-Identifier: Apache-2.0
// Both programs have hundreds of types of elements, and each release adds some: for stress, heat, sound, fluids, gaskets. The
// name of a solid element has "3D" and then the number of its nodes: C3D8R, DCC3D8, COH3D8, AC3D20. These few families have it
// too, and are something else: membranes, surfaces, trusses, rigid faces, infinite elements, particles.
#include "inp_types.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <span>

namespace subvol::detail {

using namespace std::string_view_literals;

namespace {

constexpr std::array kNoSolids{"M"sv,    "SFM"sv,  "MCL"sv, "T"sv,  "R"sv,      "RB"sv,    "CIN"sv,
                               "ACIN"sv, "CONN"sv, "PC"sv,  "PD"sv, "SPRING"sv, "GAPUNI"sv};
// Shells, membranes and surfaces of four nodes, with or without a suffix for the integration; not those of axisymmetric parts.
constexpr std::array kQuads{"S4"sv, "DS4"sv, "M3D4"sv, "SFM3D4"sv, "R3D4"sv};
// Beams, trusses and rigid links of two nodes, in space.
constexpr std::array kLines{"B31"sv, "B33"sv, "T3D2"sv, "DC1D2"sv, "RB3D2"sv, "PIPE31"sv};
// Shells with a top and a bottom: solids by their nodes.
constexpr std::array kThickPrisms{"SC6"sv};
constexpr std::array kThickHexes{"SC8"sv, "CSS8"sv};

bool is_one_of(std::string_view type, std::span<const std::string_view> kinds) {
    return std::ranges::any_of(kinds, [&](std::string_view kind) {
        // A digit behind it is another type: S4R5 is an S4, S43 is not.
        return type.starts_with(kind) && (type.size() == kind.size() || type[kind.size()] < '0' || type[kind.size()] > '9');
    });
}

// F3D4 is a tetrahedron to CalculiX and a surface to Abaqus, so it is neither here.
InpShape solid_of(std::size_t nodes, bool fluid) {
    if (nodes == 8 || nodes == 18 || nodes == 20 || nodes == 27) return InpShape::Hex;
    if (nodes == 6 || nodes == 12 || nodes == 15) return InpShape::Prism;
    if (nodes == 5 || nodes == 13) return InpShape::Pyramid;
    return (nodes == 4 && !fluid) || nodes == 10 ? InpShape::Tet : InpShape::Other;
}

const CornersOfSides kInpHexSides{{0, 1, 2, 3}, {4, 7, 6, 5}, {0, 4, 5, 1}, {1, 5, 6, 2}, {2, 6, 7, 3}, {3, 7, 4, 0}};
const CornersOfSides kInpTetSides{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
const CornersOfSides kInpPrismSides{{0, 1, 2}, {3, 5, 4}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}};
const CornersOfSides kInpPyramidSides{{0, 1, 2, 3}, {0, 4, 1}, {1, 4, 2}, {2, 4, 3}, {3, 4, 0}};

}  // namespace

InpType inp_type(std::string_view name) {
    const auto made = [&](InpShape shape, std::size_t nodes) { return InpType{std::string(name), shape, nodes}; };
    if (is_one_of(name, kQuads)) return made(InpShape::Quad, 4);
    if (is_one_of(name, kLines)) return made(InpShape::Line, 2);
    if (is_one_of(name, kThickPrisms)) return made(InpShape::Prism, 6);
    if (is_one_of(name, kThickHexes)) return made(InpShape::Hex, 8);
    const std::size_t at = name.find("3D");
    if (at == std::string_view::npos) return made(InpShape::Other, 0);
    const std::string_view family = name.substr(0, at);
    std::size_t nodes = 0;
    std::from_chars(name.data() + at + 2, name.data() + name.size(), nodes);
    const bool solid = std::ranges::find(kNoSolids, family) == kNoSolids.end();
    const InpShape shape = solid ? solid_of(nodes, family == "F") : InpShape::Other;
    return made(shape, shape == InpShape::Other ? 0 : nodes);
}

const CornersOfSides& inp_sides(InpShape shape) {
    static const CornersOfSides none;
    switch (shape) {
        case InpShape::Hex:
            return kInpHexSides;
        case InpShape::Tet:
            return kInpTetSides;
        case InpShape::Prism:
            return kInpPrismSides;
        case InpShape::Pyramid:
            return kInpPyramidSides;
        default:
            return none;
    }
}

}  // namespace subvol::detail
