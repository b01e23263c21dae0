// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// What a field is at a place, as a function of other numbers there (`Attribute::function`).
struct PlaceFunction {
    std::size_t arguments = 0;  ///< how many numbers it takes at a place
    std::size_t channels = 1;   ///< how many it returns
    /// For each argument, the range of its field: what tolerances and the steps of differences are relative to; > 0
    std::vector<double> scales;
    /// From the arguments at some places, place after place, to the values there, which are finite. Several threads may call it
    std::function<void(std::span<const double> arguments, std::span<double> values)> evaluate;
};

// Rules for points are linear. So what is refined are the arguments of a function, as channels of a field like any other, and
// the function is evaluated where they have arrived:
//
//     mesh ── with_arguments ──► refined: 6 channels of a stress ── values_at_places ──► 1 channel, its von Mises stress

[[nodiscard]] bool has_functions(const HexMesh& mesh);

/// The mesh as it is refined: each field that is a function is replaced by its arguments, under its name and without bounds.
[[nodiscard]] HexMesh with_arguments(HexMesh mesh);

/// The reverse, where the points may be other ones: fields become functions again, with their values at the points.
///
/// fields: those of the mesh before `with_arguments`
void restore_functions(HexMesh& mesh, std::span<const Attribute> fields);

/// A field without its points: its name, channels, bounds and function.
[[nodiscard]] Attribute without_values(const Attribute& field);

/// Appends a point of one field to another, made by `without_values`.
void add_point(const Attribute& from, std::size_t point, Attribute& to);
/// Copies a point of one field to one of another.
void copy_point(const Attribute& from, std::size_t point, Attribute& to, std::size_t to_point);

/// Sets the values at the points to those of the function, if the field is one.
void evaluate_at_points(Attribute& field);

/// The fields as the limits of their values at the points, for rules that know no functions, and for files.
[[nodiscard]] std::vector<Attribute> without_functions(std::vector<Attribute> fields);

/// Changes the values of a field, here and at places; not its bounds.
///
/// change: of values at some places, called by several threads
void change_places(Attribute& field, const std::function<void(std::span<double> values)>& change);
/// The same value by value, and of the bounds. change: monotone
void change_values(Attribute& field, const std::function<double(double)>& change);

/// Whether what was refined differs from the values of the field at places: if it is a function or has bounds.
[[nodiscard]] bool changes_at_places(const Attribute& field);

/// The values of a field at places, within its bounds.
///
/// refined: the channels of the field in `with_arguments` at these places
/// memory:  of the values, if they differ from what was refined
[[nodiscard]] std::span<const double> values_at_places(const Attribute& field, std::span<const double> refined,
                                                       std::vector<double>& memory);

}  // namespace subvol::detail
