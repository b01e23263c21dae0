// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "common_options.h"
#include "grid_fields.h"
#include "subvol/facts.h"
#include "subvol/hex_mesh.h"
#include "subvol/vdb_grid.h"
#include "vdb_arguments.h"

namespace subvol::cli {

/// The name of the grid of velocities, as renderers know it.
inline constexpr const char* kVelocity = "vel";

/// The fields of a mesh that become grids, as --fields, --remap, --clamp and --prune of `subvol vdb` say.
class WrittenFields {
public:
    /// throws: Error(InvalidInput) for --fields or --remap that cannot be read
    explicit WrittenFields(const VdbArguments& asked);

    /// What --fields asks for; empty: the field that --field or --density select.
    [[nodiscard]] const std::vector<GridField>& asked() const { return fields_; }

    /// The mesh with only these fields, their values mapped.
    ///
    /// throws: Error(InvalidInput) if there is no such field
    [[nodiscard]] WithFacts<HexMesh> chosen(HexMesh mesh, const CommonOptions& options) const;

    /// Keeps the grids of fields within what --clamp and --remap say, and prunes them.
    void clamp(const HexMesh& mesh, std::vector<VdbGrid>& grids) const;

    /// Leaves out what --prune says, of these grids of fields.
    void prune(std::vector<VdbGrid>& grids) const;
    /// throws: Error(InvalidInput) if no voxel is left, by --prune
    void refuse_nothing_left(const std::vector<VdbGrid>& grids) const;

    /// Notes on the fields that have voxels beyond the values of the mesh; warnings, if it is of a file, where they are far
    /// beyond.
    [[nodiscard]] Facts overshoot(const HexMesh& mesh, const std::vector<VdbGrid>& grids, bool of_file) const;

private:
    [[nodiscard]] static bool maps(const Remap& remap, const Attribute& field, const HexMesh& mesh);

    std::vector<GridField> fields_;
    std::vector<Remap> remaps_;
    bool clamp_ = false;
    std::optional<double> prune_;
};

}  // namespace subvol::cli
