// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "cube_grid.h"
#include "material_bodies.h"
#include "subvol/control_mesh.h"

namespace subvol::detail {

/// Cells inside of bodies: cubes of a grid, some of them divided.
class CellsInside {
public:
    /// bodies, options: referred to; side: of a cube
    ///
    /// throws: Error(InvalidInput) if the grid would have too many cubes, if there would be more than `max_cells` cells, or
    /// none, also of one material
    CellsInside(const MaterialBodies& bodies, const ControlMeshOptions& options, double side);

    /// The smallest cubes at some places are divided, as often as the options allow.
    void divide_at(const std::vector<Vec3>& places) { cubes_.divide_at(places, options_.refine); }
    [[nodiscard]] std::size_t divided() const { return cubes_.count(); }

    /// The cells whose middles are inside. added: gets how many more were needed for the walls of materials to be surfaces
    [[nodiscard]] SizedMesh cells(std::size_t& added) const;

private:
    void check_count(std::size_t cells) const;
    [[nodiscard]] std::vector<std::uint8_t> near() const;
    [[nodiscard]] std::vector<Index> materials_of(const SizedMesh& all, std::size_t& added) const;

    const ControlMeshOptions& options_;
    const MaterialBodies& bodies_;
    CubeGrid grid_;
    DividedCubes cubes_;
    std::vector<std::uint8_t> inside_;
};

}  // namespace subvol::detail
