// SPDX-License-Identifier: Apache-2.0
#include "castle.h"

#include <algorithm>
#include <cmath>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

// The eight cubes about a corner are numbered as octants, i + 2j + 4k. Two of them share a face if their numbers differ in one
// bit.

/// Whether the octants of a set are joined by their faces.
bool joined(std::uint8_t set) {
    if (set == 0) return true;
    std::uint8_t reached = static_cast<std::uint8_t>(set & (~set + 1u));  // the lowest one
    for (std::uint8_t before = 0; before != reached;) {
        before = reached;
        const unsigned r = reached;
        const unsigned neighbors = ((r & 0x55u) << 1) | ((r & 0xAAu) >> 1) | ((r & 0x33u) << 2) | ((r & 0xCCu) >> 2) |
                                   ((r & 0x0Fu) << 4) | ((r & 0xF0u) >> 4);
        reached = static_cast<std::uint8_t>(r | (neighbors & set));
    }
    return reached == set;
}

/// The octants about an edge of which two, one from the other across it, are chosen alone; 0 if there is none.
std::uint8_t crossed_edge(std::uint8_t set) {
    for (unsigned axis = 0; axis < 3; ++axis) {
        const unsigned one = 1u << ((axis + 1) % 3), two = 1u << ((axis + 2) % 3);
        for (unsigned end = 0; end < 2; ++end) {
            const unsigned base = end << axis;
            const std::array<unsigned, 4> ring{base, base | one, base | one | two, base | two};
            unsigned all = 0;
            for (const unsigned octant : ring) all |= 1u << octant;
            const unsigned here = set & all;
            const unsigned a = (1u << ring[0]) | (1u << ring[2]), b = (1u << ring[1]) | (1u << ring[3]);
            if (here == a) return static_cast<std::uint8_t>(b);
            if (here == b) return static_cast<std::uint8_t>(a);
        }
    }
    return 0;
}

}  // namespace

CubeGrid::CubeGrid(const Box& box, double side) : side_(side) {
    constexpr int kRim = 2;
    std::size_t size = 1;
    for (int a = 0; a < 3; ++a) {
        const int count = std::max(1, static_cast<int>(std::ceil(box.size()[a] / side)));
        counts_[static_cast<std::size_t>(a)] = count + kRim;
        lower_[a] = box.center()[a] - 0.5 * side * (count + kRim);
        size *= static_cast<std::size_t>(count + kRim);
    }
    chosen_.assign(size, 0);
}

std::size_t CubeGrid::number(int i, int j, int k) const {
    return static_cast<std::size_t>(i) +
           static_cast<std::size_t>(counts_[0]) *
               (static_cast<std::size_t>(j) + static_cast<std::size_t>(counts_[1]) * static_cast<std::size_t>(k));
}

Vec3 CubeGrid::center(std::size_t cube) const {
    const auto nx = static_cast<std::size_t>(counts_[0]), ny = static_cast<std::size_t>(counts_[1]);
    return lower_ + side_ * (Vec3(cube % nx, cube / nx % ny, cube / (nx * ny)) + 0.5);
}

void CubeGrid::choose(std::vector<float> likeness) {
    likeness_ = std::move(likeness);
    constexpr float kHalf = 0.5F;
    for (std::size_t c = 0; c < chosen_.size(); ++c) chosen_[c] = likeness_[c] > kHalf ? 1 : 0;
}

std::array<std::size_t, 8> CubeGrid::around(int i, int j, int k) const {
    std::array<std::size_t, 8> cubes;
    for (int o = 0; o < 8; ++o)
        cubes[static_cast<std::size_t>(o)] = number(i - 1 + (o & 1), j - 1 + (o >> 1 & 1), k - 1 + (o >> 2));
    return cubes;
}

bool CubeGrid::add_likeliest(const std::array<std::size_t, 8>& cubes, std::uint8_t among) {
    std::size_t best = chosen_.size();
    for (std::size_t o = 0; o < 8; ++o) {
        if ((among >> o & 1) == 0 || chosen_[cubes[o]] != 0) continue;
        if (best == chosen_.size() || likeness_[cubes[o]] > likeness_[best]) best = cubes[o];
    }
    if (best == chosen_.size()) return false;
    chosen_[best] = 1;
    return true;
}

void CubeGrid::make_manifold() {
    // Cubes are only ever added, so this ends.
    for (bool changed = true; changed;) {
        changed = false;
        for (int k = 1; k < counts_[2]; ++k) {
            for (int j = 1; j < counts_[1]; ++j) {
                for (int i = 1; i < counts_[0]; ++i) {
                    const auto cubes = around(i, j, k);
                    for (;;) {
                        std::uint8_t set = 0;
                        for (std::size_t o = 0; o < 8; ++o) set |= static_cast<std::uint8_t>(chosen_[cubes[o]] << o);
                        std::uint8_t among = crossed_edge(set);
                        const auto others = static_cast<std::uint8_t>(~set);
                        if (among == 0 && !(joined(set) && joined(others))) among = others;
                        if (among == 0 || !add_likeliest(cubes, among)) break;
                        changed = true;
                    }
                }
            }
        }
    }
}

HexMesh CubeGrid::cells() const {
    HexMesh mesh;
    std::vector<Index> points(static_cast<std::size_t>(counts_[0] + 1) * static_cast<std::size_t>(counts_[1] + 1) *
                                  static_cast<std::size_t>(counts_[2] + 1),
                              kNone);
    const auto point = [&](int i, int j, int k) {
        const std::size_t at =
            static_cast<std::size_t>(i) +
            static_cast<std::size_t>(counts_[0] + 1) *
                (static_cast<std::size_t>(j) + static_cast<std::size_t>(counts_[1] + 1) * static_cast<std::size_t>(k));
        if (points[at] == kNone) {
            points[at] = static_cast<Index>(mesh.points.size());
            mesh.points.push_back(lower_ + side_ * Vec3(i, j, k));
        }
        return points[at];
    };
    for (int k = 0; k < counts_[2]; ++k) {
        for (int j = 0; j < counts_[1]; ++j) {
            for (int i = 0; i < counts_[0]; ++i) {
                if (chosen_[number(i, j, k)] == 0) continue;
                auto& cell = mesh.cells.emplace_back();
                for (std::size_t c = 0; c < 8; ++c) {
                    const auto& at = kCornerParameters[c];
                    cell[c] = point(i + at[0], j + at[1], k + at[2]);
                }
            }
        }
    }
    return mesh;
}

}  // namespace subvol::detail
