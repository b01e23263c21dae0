// SPDX-License-Identifier: Apache-2.0
// A point of a boundary lies on a corner, an edge or a side of a cell, which its place in the cell tells: parameters of 0 and 1
// are on it. The cell's corners of that entity carry the point. A triangle lies on a side if the points that carry its three
// corners are all corners of the side, whichever of the cells around a point its place was found in.
#include <algorithm>
#include <array>
#include <unordered_map>

#include "subvol/cell.h"
#include "surface_shape.h"

namespace subvol::detail {

namespace {

using SideCorners = std::array<Index, 4>;

void add_carriers(const HexMesh& mesh, const LimitQuery& place, std::vector<Index>& carriers) {
    constexpr double kOnSide = 1e-9;
    for (std::size_t k = 0; k < 8; ++k) {
        bool near = true;
        for (int a = 0; a < 3; ++a) {
            const double from = kCornerParameters[k][static_cast<std::size_t>(a)];
            near = near && std::abs(place.uvw[a] - from) < 1 - kOnSide;
        }
        if (near) carriers.push_back(mesh.cells[place.cell][k]);
    }
}

template <class Values>
void keep(Values& values, std::span<const Index> kept, std::size_t channels = 1) {
    for (std::size_t i = 0; i < kept.size(); ++i) {
        for (std::size_t c = 0; c < channels; ++c) values[i * channels + c] = values[kept[i] * channels + c];
    }
    values.resize(kept.size() * channels);
}

}  // namespace

void keep_sides(LimitSurface& surface, const HexMesh& mesh, std::span<const CellSide> sides) {
    std::unordered_map<Index, std::vector<SideCorners>> at_point;
    for (const CellSide& side : sides) {
        SideCorners corners;
        for (std::size_t k = 0; k < 4; ++k) corners[k] = mesh.cells[side.cell][kCellFaces[side.side][k]];
        for (const Index p : corners) at_point[p].push_back(corners);
    }
    std::vector<Index> carriers;
    const auto lies_on_a_side = [&](const std::array<Index, 3>& triangle) {
        carriers.clear();
        for (const Index p : triangle) add_carriers(mesh, surface.places[p], carriers);
        const auto sides_there = at_point.find(carriers.front());
        if (sides_there == at_point.end()) return false;
        return std::ranges::any_of(sides_there->second, [&](const SideCorners& corners) {
            return std::ranges::all_of(carriers, [&](Index p) { return std::ranges::find(corners, p) != corners.end(); });
        });
    };
    std::erase_if(surface.surface.triangles, [&](const auto& triangle) { return !lies_on_a_side(triangle); });
    std::vector<Index> numbers(surface.surface.points.size(), kNone), kept;
    for (const auto& triangle : surface.surface.triangles) {
        for (const Index p : triangle) numbers[p] = 0;
    }
    for (Index p = 0; p < numbers.size(); ++p) {
        if (numbers[p] == kNone) continue;
        numbers[p] = static_cast<Index>(kept.size());
        kept.push_back(p);
    }
    for (auto& triangle : surface.surface.triangles) {
        for (Index& p : triangle) p = numbers[p];
    }
    keep(surface.surface.points, kept);
    keep(surface.normals, kept);
    keep(surface.places, kept);
    for (ProbedField& field : surface.fields) {
        keep(field.values, kept, field.channels);
        keep(field.gradients, kept, field.channels);
    }
    measure_surface(surface.surface, surface.report);
}

}  // namespace subvol::detail
