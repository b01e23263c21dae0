// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lib/test_meshes.h"
#include "subvol/cell.h"
#include "subvol/hex_mesh.h"

namespace subvol::test {

/// The means of a field over straight cells, as finite volumes have them, by Gauss' rule of four points along each axis.
template <class Field>
std::vector<double> straight_means(const HexMesh& mesh, const Field& field) {
    constexpr std::array<double, 4> kAt{.06943184420297371, .33000947820757187, .6699905217924281, .9305681557970263};
    constexpr std::array<double, 4> kWeight{.17392742256872692, .3260725774312731, .3260725774312731, .17392742256872692};
    std::vector<double> means;
    for (const auto& cell : mesh.cells) {
        double sum = 0, volume = 0;
        for (std::size_t g = 0; g < 64; ++g) {
            const Vec3 at(kAt[g % 4], kAt[g / 4 % 4], kAt[g / 16]);
            Vec3 x(0.0);
            Mat3 jacobian(0.0);
            for (std::size_t k = 0; k < 8; ++k) {
                Vec3 f, slope(1.0);
                for (int a = 0; a < 3; ++a) f[a] = kCornerParameters[k][static_cast<std::size_t>(a)] == 1 ? at[a] : 1 - at[a];
                for (int a = 0; a < 3; ++a) {
                    for (int b = 0; b < 3; ++b) {
                        const double sign = kCornerParameters[k][static_cast<std::size_t>(a)] == 1 ? 1 : -1;
                        slope[a] *= a == b ? sign : f[b];
                    }
                }
                x += f.x * f.y * f.z * mesh.points[cell[k]];
                jacobian += glm::outerProduct(mesh.points[cell[k]], slope);
            }
            const double weight = kWeight[g % 4] * kWeight[g / 4 % 4] * kWeight[g / 16] * glm::determinant(jacobian);
            sum += weight * field(x);
            volume += weight;
        }
        means.push_back(sum / volume);
    }
    return means;
}

/// The box [0,1]³ in n³ cells, whose points are moved by up to a part of a cell, those of the boundary along it.
inline HexMesh distorted_box(Index n, double part) {
    HexMesh mesh = make_box(n, n, n);
    HexMesh moved = mesh;
    jitter(moved, part, 5);
    for (std::size_t p = 0; p < mesh.points.size(); ++p) {
        for (int a = 0; a < 3; ++a) {
            double& x = mesh.points[p][a];
            if (x > 0 && x < static_cast<double>(n)) x = moved.points[p][a];
        }
        mesh.points[p] /= static_cast<double>(n);
    }
    return mesh;
}

}  // namespace subvol::test
