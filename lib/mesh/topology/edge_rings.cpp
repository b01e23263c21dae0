// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/topology_parts.h"

#include <algorithm>

#include "subvol/detail/bucket_sort.h"

namespace subvol::detail {

namespace {

/// A walk over the faces around one edge, from cell to cell.
class RingWalk {
public:
    /// faces: kept by reference
    RingWalk(const Topology& topology, std::span<const Index> faces)
        : topology_(topology), all_(faces), more_taken_(faces.size() / 64) {
        if (faces.size() < 64) return;
        for (std::size_t i = 0; i < faces.size(); ++i) sorted_.emplace_back(faces[i], i);
        std::ranges::sort(sorted_);
    }

    /// Walks fans from hull face to hull face, then closed rings; appends to `faces` and `cells`. Returns the number of closed
    /// rings.
    int run(std::vector<Index>& faces, std::vector<Index>& cells) {
        while (const auto start = next_start(true)) walk(*start, topology_.face_cells[*start][0], faces, cells);
        int rings = 0;
        while (const auto start = next_start(false)) {
            walk(*start, first_cell(*start), faces, cells);
            ++rings;
        }
        return rings;
    }

private:
    /// The place of a face, or the number of all if it is not at the edge. Long rings are searched by halves.
    [[nodiscard]] std::size_t place_of(Index face) const {
        if (sorted_.empty()) return static_cast<std::size_t>(std::find(all_.begin(), all_.end(), face) - all_.begin());
        const auto found = std::ranges::lower_bound(sorted_, face, {}, &std::pair<Index, std::size_t>::first);
        return found != sorted_.end() && found->first == face ? found->second : all_.size();
    }

    [[nodiscard]] std::optional<Index> next_start(bool on_hull) {
        for (std::size_t i = 0; i < all_.size(); ++i) {
            if ((word(i) >> i % 64 & 1) == 0 && topology_.face_on_hull(all_[i]) == on_hull) return all_[i];
        }
        return std::nullopt;
    }

    /// The other face of `cell` at this edge; a cell has exactly two.
    [[nodiscard]] Index other_face(Index cell, Index face) const {
        for (const Index f : topology_.cell_faces[cell]) {
            if (f != face && place_of(f) != all_.size()) return f;
        }
        return kNone;
    }

    /// The first cell of a closed ring: the one towards the smaller of the two neighbours of the face `start`.
    [[nodiscard]] Index first_cell(Index start) const {
        const auto [c0, c1] = topology_.face_cells[start];
        const Index f0 = other_face(c0, start), f1 = other_face(c1, start);
        return f0 <= f1 ? c0 : c1;
    }

    [[nodiscard]] std::uint64_t& word(std::size_t face) { return face < 64 ? taken_ : more_taken_[face / 64 - 1]; }

    void take(Index face) {
        const std::size_t i = place_of(face);
        word(i) |= std::uint64_t{1} << i % 64;
    }

    void walk(Index start, Index cell, std::vector<Index>& faces, std::vector<Index>& cells) {
        Index face = start;
        while (true) {
            faces.push_back(face);
            take(face);
            if (cell == kNone) return;
            cells.push_back(cell);
            face = other_face(cell, face);
            if (face == start) return;
            const auto [c0, c1] = topology_.face_cells[face];
            cell = c0 == cell ? c1 : c0;
        }
    }

    const Topology& topology_;
    std::span<const Index> all_;
    std::uint64_t taken_ = 0;                // a bit for each face; no memory is allocated for an edge of less than 64 faces
    std::vector<std::uint64_t> more_taken_;  // of the faces beyond
    std::vector<std::pair<Index, std::size_t>> sorted_;  // the faces of a long ring with their places
};

}  // namespace

int walk_edge_ring(const Topology& topology, std::span<const Index> edge_faces, std::vector<Index>& ring_faces,
                   std::vector<Index>& ring_cells) {
    ring_faces.clear();
    ring_cells.clear();
    return RingWalk(topology, edge_faces).run(ring_faces, ring_cells);
}

void order_edge_rings(Topology& topology) {
    const std::size_t count = topology.edges.size();
    auto& cells = topology.edge_cells;
    cells.offsets.assign(count + 1, 0);
    parallel_each(count, [&](std::size_t e) {
        std::size_t sides = 0;  // each cell at the edge has two of its faces
        for (const Index f : topology.edge_faces[e]) sides += topology.face_on_hull(f) ? 1 : 2;
        cells.offsets[e + 1] = sides / 2;
    });
    for (std::size_t e = 0; e < count; ++e) cells.offsets[e + 1] += cells.offsets[e];
    cells.values.resize(cells.offsets.back());
    topology.edge_has_ring.assign(count, 0);

    parallel_each(count, [&](std::size_t e) {
        thread_local std::vector<Index> ring_faces, ring_cells;
        const int rings = walk_edge_ring(topology, topology.edge_faces[e], ring_faces, ring_cells);
        topology.edge_has_ring[e] = !topology.edge_on_boundary[e] && rings == 1 && ring_cells.size() >= 3;
        const auto face_offset = static_cast<std::ptrdiff_t>(topology.edge_faces.offsets[e]);
        std::copy(ring_faces.begin(), ring_faces.end(), topology.edge_faces.values.begin() + face_offset);
        std::copy(ring_cells.begin(), ring_cells.end(), cells.values.begin() + static_cast<std::ptrdiff_t>(cells.offsets[e]));
    });
}

}  // namespace subvol::detail
