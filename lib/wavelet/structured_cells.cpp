// SPDX-License-Identifier: Apache-2.0
#include "structured_cells.h"

#include <algorithm>

#include "corner_bits.h"
#include "incident.h"
#include "subvol/cell.h"

namespace subvol::detail {

std::optional<StructuredCells> structured_cells(const Topology& t) {
    const std::size_t n = t.cells.size();
    using Place = std::array<std::int64_t, 3>;
    std::vector<std::array<CornerNumber, 8>> corners(n);
    std::vector<Place> place(n);
    std::vector<std::uint8_t> seen(n, 0);
    std::vector<Index> order{0};
    seen[0] = 1;
    for (CornerNumber k = 0; k < 8; ++k) corners[0][k] = k;
    for (std::size_t next = 0; next < order.size(); ++next) {
        const Index c = order[next];
        for (std::size_t a = 0; a < 3; ++a) {
            for (std::size_t side = 0; side < 2; ++side) {
                // The corners of this side, in the grid's orientation, are those of the other side of the next cell.
                std::array<Index, 4> quad;
                std::array<std::size_t, 4> on_side;
                std::size_t count = 0;
                for (std::size_t k = 0; k < 8; ++k) {
                    if (side_of(k, a) != side) continue;
                    on_side[count] = k;
                    quad[count++] = t.cells[c][corners[c][k]];
                }
                Index other = kNone;
                for (const Index f : t.cell_faces[c]) {
                    const auto& face = t.faces[f];
                    const bool same = std::all_of(quad.begin(), quad.end(), [&](Index p) {
                        return std::find(face.begin(), face.end(), p) != face.end();
                    });
                    if (same) other = t.face_cells[f][0] == c ? t.face_cells[f][1] : t.face_cells[f][0];
                }
                if (other == kNone) continue;
                std::array<CornerNumber, 8> turned{};
                for (std::size_t i = 0; i < 4; ++i) {
                    const std::size_t near = slot_of(t.cells[other], quad[i]);
                    turned[flip(on_side[i], a)] = static_cast<CornerNumber>(near);
                    for (std::size_t b = 0; b < 3; ++b) {  // its neighbour that is not on the face
                        const Index p = t.cells[other][flip(near, b)];
                        if (std::find(quad.begin(), quad.end(), p) == quad.end()) {
                            turned[on_side[i]] = static_cast<CornerNumber>(flip(near, b));
                        }
                    }
                }
                Place at = place[c];
                at[a] += side == 1 ? 1 : -1;
                if (seen[other] != 0) {
                    if (place[other] != at || corners[other] != turned) return std::nullopt;
                    continue;
                }
                seen[other] = 1;
                place[other] = at;
                corners[other] = turned;
                order.push_back(other);
            }
        }
    }
    if (order.size() != n) return std::nullopt;
    Place low = place[0], high = place[0];
    for (const Place& p : place) {
        for (std::size_t a = 0; a < 3; ++a) {
            low[a] = std::min(low[a], p[a]);
            high[a] = std::max(high[a], p[a]);
        }
    }
    StructuredCells grid;
    std::size_t total = 1;
    for (std::size_t a = 0; a < 3; ++a) {
        grid.counts[a] = static_cast<std::size_t>(high[a] - low[a]) + 1;
        if (grid.counts[a] > n / total) return std::nullopt;  // gaps
        total *= grid.counts[a];
    }
    if (total != n) return std::nullopt;
    grid.cells.assign(n, kNone);
    grid.corners.resize(n);
    for (std::size_t c = 0; c < n; ++c) {
        const auto at = [&](std::size_t a) { return static_cast<std::size_t>(place[c][a] - low[a]); };
        const std::size_t i = at(0) + grid.counts[0] * (at(1) + grid.counts[1] * at(2));
        if (grid.cells[i] != kNone) return std::nullopt;
        grid.cells[i] = static_cast<Index>(c);
        grid.corners[i] = corners[c];
    }
    return grid;
}

}  // namespace subvol::detail
