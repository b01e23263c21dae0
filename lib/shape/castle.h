// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// Cubes of a grid, chosen or not.
class CubeGrid {
public:
    /// So many cubes along each axis that the box and a rim of one cube around it are covered.
    CubeGrid(const Box& box, double side);

    [[nodiscard]] std::size_t size() const { return chosen_.size(); }
    [[nodiscard]] Vec3 center(std::size_t cube) const;
    [[nodiscard]] const std::vector<std::uint8_t>& chosen() const { return chosen_; }

    /// Chooses the cubes for which likeness is above ½.
    void choose(std::vector<float> likeness);

    /// Chooses more cubes, the likeliest first, until the boundary of the chosen ones is a surface at every edge and corner.
    void make_manifold();

    /// The chosen cubes as cells.
    [[nodiscard]] HexMesh cells() const;

private:
    [[nodiscard]] std::size_t number(int i, int j, int k) const;
    [[nodiscard]] std::array<std::size_t, 8> around(int i, int j, int k) const;
    [[nodiscard]] bool add_likeliest(const std::array<std::size_t, 8>& cubes, std::uint8_t among);

    Vec3 lower_;
    double side_;
    std::array<int, 3> counts_;
    std::vector<std::uint8_t> chosen_;
    std::vector<float> likeness_;
};

}  // namespace subvol::detail
