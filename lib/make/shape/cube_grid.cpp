// SPDX-License-Identifier: Apache-2.0
#include "cube_grid.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "layers.h"
#include "subvol/cell.h"

namespace subvol::detail {

Vec3 middle_of(const HexMesh& mesh, Index cell) {
    Vec3 middle(0.0);
    for (const Index p : mesh.cells[cell]) middle += mesh.points[p] / 8.0;
    return middle;
}

CubeGrid::CubeGrid(const Box& box, double side) : side_(side) {
    constexpr int kRim = 2;
    for (int a = 0; a < 3; ++a) {
        const int count = std::max(1, static_cast<int>(std::ceil(box.size()[a] / side)));
        counts_[static_cast<std::size_t>(a)] = count + kRim;
        lower_[a] = box.center()[a] - 0.5 * side * (count + kRim);
    }
}

std::size_t CubeGrid::size() const {
    return static_cast<std::size_t>(counts_[0]) * static_cast<std::size_t>(counts_[1]) * static_cast<std::size_t>(counts_[2]);
}

std::array<Index, 3> CubeGrid::steps_to(std::size_t cube) const {
    const auto nx = static_cast<std::size_t>(counts_[0]), ny = static_cast<std::size_t>(counts_[1]);
    return {static_cast<Index>(cube % nx), static_cast<Index>(cube / nx % ny), static_cast<Index>(cube / (nx * ny))};
}

Vec3 CubeGrid::center(std::size_t cube) const {
    const auto [i, j, k] = steps_to(cube);
    return lower_ + side_ * (Vec3(i, j, k) + 0.5);
}

std::size_t CubeGrid::cube_at(const Vec3& place) const {
    std::size_t cube = 0;
    for (std::size_t a = 3; a-- > 0;) {
        const auto axis = static_cast<int>(a);
        const double steps = std::clamp((place[axis] - lower_[axis]) / side_, 0.0, counts_[a] - 1.0);
        cube = cube * static_cast<std::size_t>(counts_[a]) + static_cast<std::size_t>(steps);
    }
    return cube;
}

std::vector<std::size_t> CubeGrid::around(std::size_t cube, int steps) const {
    std::array<int, 3> from, to;
    const auto at = steps_to(cube);
    for (std::size_t a = 0; a < 3; ++a) {
        from[a] = std::max(0, static_cast<int>(at[a]) - steps);
        to[a] = std::min(counts_[a] - 1, static_cast<int>(at[a]) + steps);
    }
    std::vector<std::size_t> cubes;
    for (int k = from[2]; k <= to[2]; ++k) {
        for (int j = from[1]; j <= to[1]; ++j) {
            for (int i = from[0]; i <= to[0]; ++i) {
                const auto row =
                    static_cast<std::size_t>(j) + static_cast<std::size_t>(counts_[1]) * static_cast<std::size_t>(k);
                cubes.push_back(static_cast<std::size_t>(i) + static_cast<std::size_t>(counts_[0]) * row);
            }
        }
    }
    return cubes;
}

CubeGrid CubeGrid::thirds() const {
    CubeGrid finer = *this;
    finer.side_ /= 3;
    for (int& count : finer.counts_) count *= 3;
    return finer;
}

HexMesh CubeGrid::cells(std::span<const std::uint8_t> chosen) const {
    HexMesh mesh;
    const auto width = static_cast<std::size_t>(counts_[0] + 1), depth = static_cast<std::size_t>(counts_[1] + 1);
    std::vector<Index> points(width * depth * static_cast<std::size_t>(counts_[2] + 1), kNone);
    for (std::size_t cube = 0; cube < chosen.size(); ++cube) {
        if (chosen[cube] == 0) continue;
        const auto at = steps_to(cube);
        auto& cell = mesh.cells.emplace_back();
        for (std::size_t c = 0; c < 8; ++c) {
            std::array<std::size_t, 3> corner;
            for (std::size_t a = 0; a < 3; ++a) corner[a] = at[a] + static_cast<std::size_t>(kCornerParameters[c][a]);
            Index& point = points[corner[0] + width * (corner[1] + depth * corner[2])];
            if (point == kNone) {
                point = static_cast<Index>(mesh.points.size());
                mesh.points.push_back(lower_ + side_ * Vec3(corner[0], corner[1], corner[2]));
            }
            cell[c] = point;
        }
    }
    return mesh;
}

void DividedCubes::divide(std::size_t level, std::size_t cube) {
    const CubeGrid& grid = grids_[level];
    for (const std::size_t next : grid.around(cube, 1)) {
        if (!divided_[level].insert(next).second || level == 0) continue;
        divide(level - 1, grids_[level - 1].cube_at(grid.center(next)));
    }
}

void DividedCubes::divide_at(const std::vector<Vec3>& places, int most) {
    const std::vector<std::set<std::size_t>> before = divided_;
    for (const Vec3& place : places) {
        std::size_t level = 0;
        while (level < before.size() && before[level].contains(grids_[level].cube_at(place))) ++level;
        if (level >= static_cast<std::size_t>(most)) continue;
        if (level == divided_.size()) {
            divided_.emplace_back();
            grids_.push_back(grids_.back().thirds());
        }
        divide(level, grids_[level].cube_at(place));
    }
}

std::size_t DividedCubes::count() const {
    std::size_t count = 0;
    for (const auto& cubes : divided_) count += cubes.size();
    return count;
}

SizedMesh DividedCubes::cells(std::span<const std::uint8_t> chosen) const {
    SizedMesh made;
    made.mesh = grids_.front().cells(chosen);
    made.sides.assign(made.mesh.cells.size(), grids_.front().side());
    std::vector<std::uint8_t> levels(made.sides.size(), 0);
    for (std::size_t level = 0; level < divided_.size(); ++level) {
        // Layers between the cubes that follow each other along an axis make three cells of one; along all axes 27.
        std::vector<std::optional<std::array<Index, 3>>> at(made.sides.size());
        std::vector<Index> from(made.sides.size());
        for (Index c = 0; c < at.size(); ++c) {
            from[c] = c;
            if (levels[c] < level) continue;
            const std::size_t cube = grids_[level].cube_at(middle_of(made.mesh, c));
            if (divided_[level].contains(cube)) at[c] = grids_[level].steps_to(cube);
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::vector<Index> parts(from.size());
            for (std::size_t c = 0; c < parts.size(); ++c) parts[c] = at[from[c]] ? (*at[from[c]])[axis] : kNone;
            constexpr double kThird = 2.0 / 3;  // of the way to the middle
            LayeredMesh next = with_layers(made.mesh, {.parts = parts, .inwards = kThird});
            for (Index& parent : next.from) parent = from[parent];
            from = std::move(next.from);
            made.mesh = std::move(next.mesh);
        }
        std::vector<double> counts(at.size(), 0);
        for (const Index parent : from) ++counts[parent];
        std::vector<double> sides(from.size());
        std::vector<std::uint8_t> next(from.size());
        for (std::size_t c = 0; c < from.size(); ++c) {
            const Index parent = from[c];
            sides[c] = made.sides[parent] / std::cbrt(counts[parent]);
            next[c] = static_cast<std::uint8_t>(levels[parent] + (at[parent] ? 1 : 0));
        }
        made.sides = std::move(sides);
        levels = std::move(next);
    }
    return made;
}

}  // namespace subvol::detail
