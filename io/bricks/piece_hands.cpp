// SPDX-License-Identifier: Apache-2.0
// `orient_cells` of a mesh in tables. Which hand a cell has depends on all cells that it is connected with by faces, which may
// lie in any bricks:
//
//     cells ──▶ faces, in buckets by their smallest point ──▶ two cells at a face are of one hand or of two: joined in a forest
//     cells ──▶ volume, with the sign that its hand relative to the root gives, added to that of the part
//     cells ──▶ those whose hand makes the volume of their part negative are turned
//
// Faces wait on disk, some 144 bytes a cell; the forest takes five bytes a cell in memory.
#include <algorithm>
#include <array>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "brick_cells.h"
#include "piece_tables.h"
#include "subvol/detail/handed_face.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/hex_mesh.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kCellsToTurn = std::size_t{1} << 16;
constexpr std::size_t kFacesOfBucket = std::size_t{1} << 19;  // that are sorted together, about

/// Cells joined into parts. Each knows its hand relative to the root of its part: whether it is the other one.
class Hands {
public:
    explicit Hands(std::size_t cells) : parents_(cells), differs_(cells, 0) {
        for (Index c = 0; c < cells; ++c) parents_[c] = c;
    }

    /// The root of a cell's part, and whether the cell's hand differs from that of the root.
    [[nodiscard]] std::pair<Index, bool> root_of(Index cell) {
        Index root = cell;
        bool differs = false;
        for (; parents_[root] != root; root = parents_[root]) differs ^= differs_[root] != 0;
        const bool of_cell = differs;
        while (parents_[cell] != root && cell != root) {  // so that the next way is short
            const Index next = parents_[cell];
            const bool after = differs ^ (differs_[cell] != 0);
            parents_[cell] = root;
            differs_[cell] = differs ? 1 : 0;
            cell = next;
            differs = after;
        }
        return {root, of_cell};
    }

    void join(Index a, Index b, bool differ) {
        const auto [root_a, a_differs] = root_of(a);
        const auto [root_b, b_differs] = root_of(b);
        if (root_a == root_b) return;
        const Index first = std::min(root_a, root_b), other = std::max(root_a, root_b);
        parents_[other] = first;
        differs_[other] = (a_differs ^ b_differs ^ differ) ? 1 : 0;
    }

private:
    std::vector<Index> parents_;
    std::vector<std::uint8_t> differs_;
};

/// Calls call(first cell, cells) for all cells of the tables, some at a time.
template <class Call>
void each_chunk(const PieceTables& tables, Progress* progress, const Call& call) {
    std::vector<std::array<Index, 8>> cells;
    for (std::uint64_t begin = 0; begin < tables.cells; begin += kCellsToTurn) {
        report_progress(progress, "hands", begin, tables.cells);
        cells.resize(std::min<std::uint64_t>(kCellsToTurn, tables.cells - begin));
        tables.corners.read(begin, records_of(cells));
        call(static_cast<Index>(begin), cells);
    }
}

void join_neighbours(const PieceTables& tables, const std::filesystem::path& folder, Progress* progress, Hands& hands) {
    const std::uint64_t buckets = kCellFaces.size() * tables.cells / kFacesOfBucket + 1;
    SpillBuckets<HandedFace> faces(folder, buckets);
    each_chunk(tables, progress, [&](Index first, const auto& cells) {
        for (std::size_t c = 0; c < cells.size(); ++c) {
            for (std::size_t side = 0; side < kCellFaces.size(); ++side) {
                const HandedFace face(cells[c], first + static_cast<Index>(c), side);
                faces.add(std::uint64_t{face.points[0]} * buckets / tables.points, face);
            }
        }
    });
    for (std::size_t b = 0; b < buckets; ++b) {
        std::vector<HandedFace> some = faces.take(b);
        std::ranges::sort(some);
        for (std::size_t i = 0; i + 1 < some.size(); ++i) {
            const HandedFace &one = some[i], &next = some[i + 1];
            if (one.points == next.points && one.cell != next.cell) {
                hands.join(one.cell, next.cell, one.reversed == next.reversed);
            }
        }
    }
}

/// The signed volumes of some cells.
std::vector<double> volumes_of(const PieceTables& tables, const std::vector<std::array<Index, 8>>& cells) {
    const CornersOfCells corners(cells);
    std::vector<Vec3> points(corners.points().size());
    tables.coordinates.read_some(corners.points(), records_of(points));
    std::vector<double> volumes(cells.size());
    parallel_each(cells.size(), [&](std::size_t c) {
        std::array<Vec3, 8> x;
        for (std::size_t k = 0; k < 8; ++k) x[k] = points[corners.place(cells[c][k])];
        volumes[c] = cell_volume(x);
    });
    return volumes;
}

}  // namespace

std::size_t orient_tables(PieceTables& tables, const std::filesystem::path& folder, Progress* progress) {
    if (tables.turned) return 0;
    tables.turned = true;
    std::uint64_t negative = 0;
    each_chunk(tables, progress, [&](Index, const auto& cells) {
        for (const double volume : volumes_of(tables, cells)) negative += volume < 0 ? 1 : 0;
    });
    if (negative == 0) return 0;
    Hands hands(negative == tables.cells ? 0 : tables.cells);
    std::unordered_map<Index, double> volume_of_part;  // by its root, as if that were right-handed
    if (negative < tables.cells) {
        join_neighbours(tables, folder, progress, hands);
        each_chunk(tables, progress, [&](Index first, const auto& cells) {
            const std::vector<double> volumes = volumes_of(tables, cells);
            for (std::size_t c = 0; c < cells.size(); ++c) {
                const auto [root, differs] = hands.root_of(first + static_cast<Index>(c));
                volume_of_part[root] += differs ? -volumes[c] : volumes[c];
            }
        });
    }
    std::size_t turned = 0;
    each_chunk(tables, progress, [&](Index first, auto& cells) {
        const std::size_t before = turned;
        for (std::size_t c = 0; c < cells.size(); ++c) {
            bool is_left = true;
            if (negative < tables.cells) {
                const auto [root, differs] = hands.root_of(first + static_cast<Index>(c));
                is_left = differs != (volume_of_part.at(root) < 0);
            }
            if (!is_left) continue;
            std::swap_ranges(cells[c].begin(), cells[c].begin() + 4, cells[c].begin() + 4);
            ++turned;
        }
        if (turned > before) tables.corners.write(first, records_of(std::as_const(cells)));
    });
    return turned;
}

}  // namespace subvol::detail
