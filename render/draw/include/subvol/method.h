// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "subvol/flow_surface.h"
#include "subvol/names.h"
#include "subvol/option_needs.h"

namespace subvol {

/// What a picture is drawn with.
enum class Method { Splat, Sheets, Footprints, Tets, Projected, Dense, Grid };

template <>
struct NameTable<Method> {
    static constexpr Name<Method> rows[] = {{Method::Splat, "splat", "kernels"},
                                            {Method::Sheets, "sheets", "kernels in OpenGL sheet buffers"},
                                            {Method::Footprints, "footprints", "kernels that are coloured first"},
                                            {Method::Tets, "tets", "rays through tetrahedra"},
                                            {Method::Projected, "pt", "the same tetrahedra projected by OpenGL"},
                                            {Method::Dense, "dense", "rays through the limit's cells"},
                                            {Method::Grid, "grid", "rays through the voxels of a grid"}};
};

[[nodiscard]] constexpr bool draws_kernels(Method method) {
    return method == Method::Splat || method == Method::Sheets || method == Method::Footprints;
}

/// Whether the method can draw some rows of a picture alone.
[[nodiscard]] constexpr bool draws_rows(Method method) {
    return method == Method::Splat || method == Method::Sheets || method == Method::Tets;
}

/// The level of a scheme of tetrahedra that is drawn unless another one is asked for: kernels show the limit, cells do not.
[[nodiscard]] constexpr int default_tet_level(Method method) {
    return draws_kernels(method) ? 1 : 2;
}

/// What kinds of bodies pictures can show.
///
/// Mesh:       hexahedra, whose limit is shown
/// Tets:       a level of a scheme of tetrahedra on its limit
/// Kernels:    kernels in memory; KernelFile: kernels in a file, of which each view reads what it needs
/// Voxels:     a grid
/// Bricks:     a mesh in a folder of bricks
enum class BodyKind { Mesh, Tets, Kernels, KernelFile, Voxels, Bricks };

/// Sets of methods and of kinds of bodies, as bits.
using Methods = unsigned;
using Bodies = unsigned;
[[nodiscard]] constexpr unsigned bit(Method method) {
    return 1U << static_cast<unsigned>(method);
}
[[nodiscard]] constexpr unsigned bit(BodyKind body) {
    return 1U << static_cast<unsigned>(body);
}

/// Which methods and bodies read an option, and why the others do not.
struct OptionUse {
    std::string_view name;     ///< the name in the command, without dashes
    std::string_view keyword;  ///< the keyword in Python; empty: Python does not have it
    Methods methods;
    Bodies bodies;
    std::string_view reason;  ///< why other methods do not read it
    Methods bricks = ~0U;     ///< the methods that read it from a folder of bricks, if `bodies` contains these
};

/// All options of pictures. This is the only place that knows which method reads which of them: the errors of the command and
/// of Python, the table in docs/pictures.md and the tests of each cell are made from it.
[[nodiscard]] std::span<const OptionUse> option_uses();

/// Whether a method reads an option from a body; true for options that are not in the table, as all methods do.
///
/// option: without dashes
[[nodiscard]] bool reads(Method method, BodyKind body, std::string_view option);

/// Refuses every option that was given and that the method or the body does not read.
///
/// methods: the one that is used, or all that may be used: then an option has an effect if one of them reads it
/// given:   called with the `name` of each option
/// throws:  Error(InvalidInput) that names the option and the method or the body
void check_options(Methods methods, BodyKind body, const GivenOptions& given, OptionNames names = OptionNames::Flags);

/// throws: Error(InvalidInput) where streamlines and arrows cannot be drawn
///
/// whole: all of the body is drawn, as one: neither patches alone nor parts with opacities of their own
void check_flow(const FlowChoices& flow, Method method, BodyKind body, bool whole, OptionNames names);

/// Refuses every option that was given and that only volumes read: shells and patches alone are drawn.
///
/// throws: Error(InvalidInput) that names the option
void check_options_of_shells(const GivenOptions& given, OptionNames names = OptionNames::Flags);

/// The table as Markdown: for each option the methods and the bodies that read it, and what else it needs.
///
/// described: all options of pictures
[[nodiscard]] std::string option_table(std::span<const Option> described);

/// The methods that can draw a body.
[[nodiscard]] Methods methods_of(BodyKind body);

/// throws: Error(InvalidInput) if the method cannot draw the body
void check_method(Method method, BodyKind body, OptionNames names = OptionNames::Flags);

/// The names of some methods, in the order of the table: "splat, sheets or pt".
[[nodiscard]] std::string names_of(Methods methods);

}  // namespace subvol
