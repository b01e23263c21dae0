// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "picture_arguments.h"
#include "report.h"
#include "subvol/limit_surface.h"

namespace subvol::cli {

/// How a surface is written, and what the error says if there is none.
struct SurfaceOutput {
    SurfaceFileOptions file{};
    std::string field{};   ///< the field that isosurfaces are of
    Range range{};         ///< the range of the field's control values
    std::size_t isos = 0;  ///< how many isovalues were asked for
};

/// For the note of a share.
[[nodiscard]] Json json_of(const SurfaceOutput& output);

/// file: with the note, named in the error
/// throws: Error(InvalidInput) unless `json_of` has written it
[[nodiscard]] SurfaceOutput surface_output_from(const Json& json, const std::string& file);

/// throws: Error(InvalidInput) if the surface has no triangle
void check_not_empty(const LimitSurface& surface, const SurfaceOutput& output);

/// Writes a surface. returns: its figures
[[nodiscard]] Facts write_reported(const std::string& path, const LimitSurface& surface, const SurfaceOutput& output,
                                   Progress* progress);

}  // namespace subvol::cli
