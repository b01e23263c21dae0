// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "subvol/hex_mesh.h"
#include "subvol/progress.h"
#include "subvol/shells.h"

namespace subvol {

/// The scalar that is shown, exported or splatted.
struct SelectedField {
    Attribute scalar;     // one channel
    std::string warning;  // how the field was chosen or converted; empty if it is simply the named or the first scalar
};

/// Chooses a scalar: `name`, else the most sensible one by its name and values (docs/quantities.md), else density 1 everywhere.
///
/// name:    a field, or a quantity as for `field_of`. Of a vector the length is taken; of a symmetric tensor that is called a
///          stress the von Mises stress, which becomes its name, of other tensors the norm
/// progress: of derivatives
/// throws:  Error(InvalidInput) as `field_of`; Error(Cancelled)
[[nodiscard]] SelectedField select_field(const HexMesh& mesh, const std::optional<std::string>& name,
                                         Progress* progress = nullptr);

/// A quantity of a mesh: a field by its name, or what is computed from fields. What is not linear, such as a length or a
/// product, has its values at the points and is a function elsewhere (`Attribute::function`): of the limit of the fields at
/// the place.
///
///     T   `von Mises`   U.x   S.xy   U.0          fields, in quotes (` or ') unless their names are words; components
///     length(U)  mises(S)  principal1(S)  …       functions of vectors and tensors
///     grad(T)  grad(U)  div(U)  curl(U)           derivatives of the limit of the scheme MCQ by places, at the points
///     vector(ux,uy,uz)  tensor(sxx,syy,…)         fields of scalars
///     quality  aspect                             of each cell: the least scaled Jacobian at its corners, and the longest edge
///                                                 over the shortest; also scaled_jacobian and aspect_ratio
///     (T-293)/620 + 2*length(U)*(z>0)             arithmetic and functions of muParser, of scalars; a vector stands for its
///     length x  y  z  time  pi                           coordinates, and the time of the mesh's step
///
/// The components of a vector are x, y, z; of a symmetric tensor, with six channels, xx, yy, zz, xy, yz, xz; of a tensor, with
/// nine, xx, xy, xz, yx and so on. grad(U).xy is the derivative of U.x by y. A name that is no
/// field stands for the vector or tensor of the scalars that are called as its components (disp for disp_x, disp_y, disp_z),
/// mises and other functions of tensors alone for that of the one stress that the mesh has. Coordinates come before fields of
/// the same name, but for a quantity that is a name alone.
///
/// name:   of the result
/// progress: of derivatives
/// throws: Error(InvalidInput) with the position if the quantity is wrong, or if a value is not finite; lists the fields
/// cost:   a few nanoseconds a point and operation; derivatives 15 to 150 µs a cell
[[nodiscard]] Attribute field_of(const HexMesh& mesh, const std::string& name, const std::string& source,
                                 Progress* progress = nullptr);

/// A quantity that is a vector, such as U or grad(T), whose flow is asked for.
///
/// returns: a field of three channels with that name
/// throws:  Error(InvalidInput) as `field_of`, or if it has another number of components
[[nodiscard]] Attribute vector_field_of(const HexMesh& mesh, const std::string& source, Progress* progress = nullptr);
/// The same at the points alone: x, y, z at each.
[[nodiscard]] std::vector<double> vectors_of(const HexMesh& mesh, const std::string& source, Progress* progress = nullptr);

/// The shells with the fields that the mesh has, which were selected from the same ones.
///
/// throws: Error(InvalidInput) as `select_field`
[[nodiscard]] Shells with_fields_of(Shells shells, const HexMesh& mesh);

/// Whether a quantity needs more than the values at a point: the cells around it.
[[nodiscard]] bool has_derivatives(std::string_view source);

/// How components of a field are called: x, y, z; xx, yy, …; numbers for other fields; nothing for scalars.
[[nodiscard]] std::vector<std::string> component_names(int channels);

}  // namespace subvol
