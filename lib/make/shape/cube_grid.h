// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "subvol/hex_mesh.h"

namespace subvol::detail {

/// A mesh and how large its cells should be: the side of a cube with as much room as a cell has.
struct SizedMesh {
    HexMesh mesh;
    std::vector<double> sides;
    std::vector<Index> materials = {};  ///< of each cell; none if there is one alone
};

[[nodiscard]] Vec3 middle_of(const HexMesh& mesh, Index cell);

/// The cubes of a grid.
class CubeGrid {
public:
    /// So many cubes along each axis that the box and a rim of one cube around it are covered.
    CubeGrid(const Box& box, double side);

    [[nodiscard]] std::size_t size() const;
    [[nodiscard]] double side() const { return side_; }
    [[nodiscard]] Vec3 center(std::size_t cube) const;
    [[nodiscard]] std::array<Index, 3> steps_to(std::size_t cube) const;
    /// The cube in which a place lies, or the nearest one.
    [[nodiscard]] std::size_t cube_at(const Vec3& place) const;
    /// A cube and those around it, up to `steps` away.
    [[nodiscard]] std::vector<std::size_t> around(std::size_t cube, int steps) const;
    /// The grid of the 27 cubes in each.
    [[nodiscard]] CubeGrid thirds() const;

    /// Cubes as cells. chosen: a flag for each cube
    [[nodiscard]] HexMesh cells(std::span<const std::uint8_t> chosen) const;

private:
    Vec3 lower_;
    double side_;
    std::array<int, 3> counts_;
};

/// Which cubes of a grid are divided into 27, and which of these again.
///
/// A divided cube has a layer of cells at each side where the next cube is not divided, so that the cells fit together.
class DividedCubes {
public:
    explicit DividedCubes(const CubeGrid& grid) : grids_{grid} {}

    /// The smallest cubes at some places are divided, and those around them, unless they have been divided `most` times.
    void divide_at(const std::vector<Vec3>& places, int most);

    [[nodiscard]] bool divided(std::size_t cube) const { return !divided_.empty() && divided_.front().contains(cube); }
    /// How many cubes of any size are divided.
    [[nodiscard]] std::size_t count() const;

    /// The cells in some cubes of the grid. chosen: a flag for each cube
    [[nodiscard]] SizedMesh cells(std::span<const std::uint8_t> chosen) const;

private:
    void divide(std::size_t level, std::size_t cube);

    std::vector<CubeGrid> grids_;                 // of each level, and the next
    std::vector<std::set<std::size_t>> divided_;  // of each level
};

}  // namespace subvol::detail
