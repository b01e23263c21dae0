// SPDX-License-Identifier: Apache-2.0
#include "subvol/part_places.h"

#include <algorithm>
#include <array>
#include <vector>

#include "subvol/cell.h"
#include "subvol/detail/counted_rows.h"

namespace subvol {

namespace {

/// Of cells' parameters: a place this near to a face is on it, as near as the search for a place ends.
constexpr double kOnFace = 1e-6;

/// The trilinear weights of the corners of a cell at a place, exactly 0 for those that the face, edge or corner which the place
/// is on does not have.
std::array<double, 8> weights_at(const Vec3& uvw) {
    std::array<double, 8> weights;
    for (std::size_t k = 0; k < 8; ++k) {
        weights[k] = 1;
        for (int axis = 0; axis < 3; ++axis) {
            const double t = uvw[axis] < kOnFace ? 0 : uvw[axis] > 1 - kOnFace ? 1 : uvw[axis];
            weights[k] *= kCornerParameters[k][static_cast<std::size_t>(axis)] == 1 ? t : 1 - t;
        }
    }
    return weights;
}

/// Finds the cells of a part at the points of a mesh.
class PartCells {
public:
    PartCells(const HexMesh& mesh, std::span<const std::uint8_t> cells)
        : mesh_(mesh), at_points_(detail::counted_rows<Index>(mesh.points.size(), [&](const auto& put) {
              for (Index c = 0; c < cells.size(); ++c) {
                  if (cells[c] == 0) continue;
                  for (const Index p : mesh.cells[c]) put(p, c);
              }
          })) {}

    /// The first cell of the part that has all corners with a weight, and the place in it. Nothing changes if there is none.
    ///
    /// returns: whether there is one
    bool move(Index& cell, Vec3& uvw) const {
        const auto weights = weights_at(uvw);
        const auto& corners = mesh_.cells[cell];
        const auto heaviest = static_cast<std::size_t>(std::ranges::max_element(weights) - weights.begin());
        for (const Index other : at_points_[corners[heaviest]]) {
            const auto& others = mesh_.cells[other];
            Vec3 there(0.0);
            bool all = true;
            for (std::size_t k = 0; k < 8 && all; ++k) {
                if (weights[k] == 0) continue;
                const auto at = static_cast<std::size_t>(std::ranges::find(others, corners[k]) - others.begin());
                all = at < others.size();
                for (int axis = 0; all && axis < 3; ++axis)
                    there[axis] += weights[k] * kCornerParameters[at][static_cast<std::size_t>(axis)];
            }
            if (!all) continue;
            cell = other;
            uvw = there;
            return true;
        }
        return false;
    }

private:
    const HexMesh& mesh_;
    IndexRows at_points_;
};

}  // namespace

void keep_places_in(const HexMesh& mesh, std::span<const std::uint8_t> cells, ProbeResult& found) {
    const PartCells part(mesh, cells);
    for (std::size_t p = 0; p < found.cells.size(); ++p) {
        if (!found.inside(p) || cells[found.cells[p]] != 0) continue;
        if (part.move(found.cells[p], found.parameters[p])) continue;
        found.cells[p] = kNone;
        found.parameters[p] = Vec3(0.0);
        found.distances[p] = 0;
        for (ProbedField& field : found.fields) {
            const auto first = static_cast<std::ptrdiff_t>(p * field.channels),
                       count = static_cast<std::ptrdiff_t>(field.channels);
            std::fill_n(field.values.begin() + first, count, 0.0);
            std::fill_n(field.gradients.begin() + first, count, Vec3(0.0));
        }
    }
}

}  // namespace subvol
