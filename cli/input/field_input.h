// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "common_options.h"
#include "refine_arguments.h"
#include "subvol/facts.h"
#include "subvol/field.h"
#include "subvol/mesh_sets.h"

namespace subvol::cli {

/// A field from a file or a model, with what is known about it.
struct FieldInput {
    FieldView view;
    std::shared_ptr<const void> owner;    // keeps what the view refers to
    std::shared_ptr<const HexMesh> mesh;  // if it is of a mesh: the control mesh, the field as its first attribute
    std::string field;
    std::shared_ptr<const HexMesh> read{};  // if it is of a mesh and this was asked for: the mesh with all its fields
    MeshSets sets{};                        // with that
};

/// Whether the mesh of a field is needed with all its fields.
enum class KeepMesh { No, Yes };

/// Reads the field that the options select. A mesh is refined as the arguments say, without --levels to a level that is within
/// tolerance of the limit. All facts but seconds, warnings and notes are in the group `key`.
///
/// throws: Error(InvalidInput) if it is a picture
[[nodiscard]] WithFacts<FieldInput> load_field(const std::string& input, const CommonOptions& options,
                                               const RefineArguments& refine, const char* key, Progress* progress,
                                               KeepMesh keep = KeepMesh::No);

}  // namespace subvol::cli
