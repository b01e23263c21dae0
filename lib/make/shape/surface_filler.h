// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cube_grid.h"
#include "layers.h"
#include "shape_fitter.h"
#include "sharp_paths.h"
#include "subvol/control_mesh.h"

namespace subvol::detail {

/// Draws the walls of cells to surfaces.
class SurfaceFiller {
public:
    /// All are referred to; report: gets rounds, errors and sharp edges
    SurfaceFiller(std::span<const WallTarget> targets, const SharpEdges& sharp, const ControlMeshOptions& options,
                  ControlMeshReport& report)
        : targets_(targets), sharp_(sharp), options_(options), report_(report) {}

    void fill(const SizedMesh& inside);

    /// Places of the boundary and the surface with a distance beyond `far`, and those of sharp edges that are missed.
    [[nodiscard]] std::vector<Vec3> places_beyond(double far) const;

    [[nodiscard]] const HexMesh& mesh() const { return mesh_; }
    /// Of the cells, as of `wall_of`, and what their walls are drawn to.
    [[nodiscard]] WallTargets walls() const { return {materials_, targets_}; }
    /// Where the points were as cubes with layers.
    [[nodiscard]] const std::vector<Vec3>& start() const { return start_; }

private:
    void draw(Scheme kind, int first, int end);
    void relax(int round);
    void straighten();
    [[nodiscard]] std::vector<std::uint8_t> bad_cells(const std::vector<std::uint8_t>& near) const;

    void put_layers(LayeredMesh layered, std::span<const double> sides, std::span<const Index> materials);

    std::span<const WallTarget> targets_;
    const SharpEdges& sharp_;
    const ControlMeshOptions& options_;
    ControlMeshReport& report_;
    HexMesh mesh_;
    std::vector<Index> materials_;
    CellAims aims_;
    std::vector<Vec3> start_;
    SharpPaths paths_;
    std::optional<ShapeFitter> fitter_;  // of the last rounds
};

}  // namespace subvol::detail
