// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// The length of a vector, or the norm of a tensor, under the same name.
[[nodiscard]] Attribute length_of(const Attribute& attribute);

/// A field by its name, or the vector or tensor of the scalars whose names say that they are its components: "disp" of disp_x,
/// disp_y and disp_z, "stress" of stress_xx and so on.
[[nodiscard]] std::optional<Attribute> named_field(const HexMesh& mesh, std::string_view name);

/// Whether a field is a symmetric tensor that is called a stress: `STRESS`, `CauchyStress`, `S`, `sigma`.
[[nodiscard]] bool is_stress(const Attribute& attribute);

/// A name as expressions have it: in backquotes unless it is a word.
[[nodiscard]] std::string quoted_name(const std::string& name);

/// The names of all fields, with commas between.
[[nodiscard]] std::string list_of(const HexMesh& mesh);

}  // namespace subvol::detail
