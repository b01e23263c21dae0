// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common_options.h"
#include "refine_arguments.h"
#include "report.h"
#include "subvol/field.h"

namespace subvol::cli {

enum class InputKind { Picture, Mesh, Points, Grid };

/// What an input is, as every verb takes it: "model:…" and the extensions of meshes; points by their extensions; a .vdb file by
/// what it holds. Anything else should be a picture.
[[nodiscard]] InputKind kind_of(const std::string& input);

/// A field from a file or a model, and what was found out about it.
struct FieldInput {
    FieldView view;
    std::shared_ptr<const void> owner;    // of what the view refers to
    std::shared_ptr<const HexMesh> mesh;  // of a mesh: as it came, its first attribute the field
    std::string field;
};

/// Reads the field that the options select. A mesh is refined as the arguments say; without --levels to the level that stands
/// for the limit. What the report is told goes under `key`.
///
/// throws: Error(InvalidInput) if it is a picture
[[nodiscard]] FieldInput load_field(const std::string& input, const CommonOptions& options, const RefineArguments& refine,
                                    const char* key, Report& report);

}  // namespace subvol::cli
