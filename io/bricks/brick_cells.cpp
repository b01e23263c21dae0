// SPDX-License-Identifier: Apache-2.0
#include "brick_cells.h"

#include <algorithm>
#include <array>
#include <iterator>

// Which cells each brick stores: its own, and a halo of layers about them, found from a file of corners without a topology.
//
//      . . 2 2 2 2 .        0  owned cells; their points are reached by the brick
//      . 2 1 1 1 2 .        1  cells with a reached point: the first layer, whose points are reached next
//      . 2 1 0 1 2 .        2  the second layer, and so on
//      . 2 1 1 1 2 .
//
// Each layer is one pass over the file of corners. Of each point the owner is kept, 4 bytes; only points near borders of bricks
// are reached by others too, and these pairs (point, brick) lie in a sorted list. Memory does not grow with the halos.

namespace subvol::detail {

namespace {

constexpr std::size_t kCellsAtOnce = std::size_t{1} << 16;  // cells that are read together
constexpr std::uint32_t kNobody = ~0U;

// The bricks that reach a point: its owner, and for few points others.
class Reach {
public:
    using Other = std::pair<Index, std::uint32_t>;  // a point, and a brick that does not own it

    explicit Reach(std::size_t points) : owners(points, kNobody), has_others_(points, false) {}

    std::vector<std::uint32_t> owners;

    [[nodiscard]] bool has(Index p, std::uint32_t brick) const {
        return owners[p] == brick || (has_others_[p] && std::ranges::binary_search(others_, Other{p, brick}));
    }
    template <class Call>
    void each(Index p, const Call& call) const {
        call(owners[p]);
        if (!has_others_[p]) return;
        for (auto at = std::ranges::lower_bound(others_, Other{p, 0}); at != others_.end() && at->first == p; ++at) {
            call(at->second);
        }
    }

    /// Additions become visible with settle() only, so that a pass adds one layer, although it looks at the cells one after the
    /// other.
    void add(Index p, std::uint32_t brick) {
        fresh_.emplace_back(p, brick);
        // The same pair is added by several cells. Sorting whenever the list has doubled keeps it short at a cost of O(n log n)
        // altogether.
        if (fresh_.size() >= kFresh + 2 * compacted_) compact();
    }
    void settle() {
        compact();
        const std::size_t before = others_.size();
        for (const Other& other : fresh_) has_others_[other.first] = true;
        others_.insert(others_.end(), fresh_.begin(), fresh_.end());
        std::inplace_merge(others_.begin(), others_.begin() + static_cast<std::ptrdiff_t>(before), others_.end());
        fresh_ = {};
        compacted_ = 0;
    }

private:
    static constexpr std::size_t kFresh = std::size_t{1} << 20;

    void compact() {
        std::ranges::sort(fresh_);
        fresh_.erase(std::unique(fresh_.begin(), fresh_.end()), fresh_.end());
        compacted_ = fresh_.size();
    }

    std::vector<bool> has_others_;
    std::vector<Other> others_, fresh_;
    std::size_t compacted_ = 0;
};

template <class Call>
void each_cell(const SpillFile& corners, std::size_t count, const Call& call) {
    std::vector<std::array<Index, 8>> cells;
    for (std::size_t begin = 0; begin < count; begin += kCellsAtOnce) {
        cells.resize(std::min(kCellsAtOnce, count - begin));
        corners.read(begin, records_of(cells));
        for (std::size_t i = 0; i < cells.size(); ++i) call(static_cast<Index>(begin + i), cells[i]);
    }
}

// The bricks that reach one of the corners: the cell's own, and in `others` those whose next layer it is in or that have it.
void bricks_at(const Reach& reach, const std::array<Index, 8>& cell, std::uint32_t own, std::vector<std::uint32_t>& others) {
    others.clear();
    for (const Index p : cell) {
        reach.each(p, [&](std::uint32_t brick) {
            if (brick != own && std::ranges::find(others, brick) == others.end()) others.push_back(brick);
        });
    }
}

}  // namespace

std::vector<Index> BrickCells::stored(std::size_t brick) const {
    const auto b = static_cast<std::uint32_t>(brick);
    // Owned cells and those of the halo are both sorted, so merging them gives the order of the whole mesh.
    const auto begin = std::ranges::lower_bound(halo, b, {}, &std::pair<std::uint32_t, Index>::first);
    const auto end = std::ranges::upper_bound(begin, halo.end(), b, {}, &std::pair<std::uint32_t, Index>::first);
    const std::span<const Index> of_brick = owned_by(brick);
    std::vector<Index> cells(of_brick.begin(), of_brick.end());
    cells.reserve(cells.size() + static_cast<std::size_t>(end - begin));
    std::transform(begin, end, std::back_inserter(cells), [](const auto& pair) { return pair.second; });
    std::ranges::inplace_merge(cells, cells.begin() + static_cast<std::ptrdiff_t>(of_brick.size()));
    return cells;
}

std::span<const Index> BrickCells::owned_by(std::size_t brick) const {
    return std::span(owned).subspan(first[brick], first[brick + 1] - first[brick]);
}

BrickCells cells_of_bricks(const SpillFile& corners, std::size_t points, std::vector<std::uint32_t> bricks, int layers) {
    const std::size_t cells = bricks.size();
    Reach reach(points);
    each_cell(corners, cells, [&](Index c, const std::array<Index, 8>& cell) {
        for (const Index p : cell) {
            // Cells come in the order of the whole mesh, so the first cell at a point decides who owns it, as in split_mesh.
            if (reach.owners[p] == kNobody) reach.owners[p] = bricks[c];
            if (reach.owners[p] != bricks[c]) reach.add(p, bricks[c]);
        }
    });
    reach.settle();
    std::vector<std::uint32_t> others;
    // After k of these passes a brick reaches the points of its first k layers. The last layer needs no pass: its cells are
    // found from the points that have been reached before.
    for (int layer = 1; layer < layers; ++layer) {
        each_cell(corners, cells, [&](Index c, const std::array<Index, 8>& cell) {
            bricks_at(reach, cell, bricks[c], others);
            for (const std::uint32_t brick : others) {
                for (const Index p : cell) {
                    if (!reach.has(p, brick)) reach.add(p, brick);
                }
            }
        });
        reach.settle();
    }
    BrickCells result;
    each_cell(corners, cells, [&](Index c, const std::array<Index, 8>& cell) {
        bricks_at(reach, cell, bricks[c], others);
        for (const std::uint32_t brick : others) result.halo.emplace_back(brick, c);
    });
    std::ranges::sort(result.halo);
    result.owners = std::move(reach.owners);
    const std::size_t count = std::size_t{std::ranges::max(bricks)} + 1;
    // A counting sort of the cells by brick, which keeps their order within each brick.
    result.first.assign(count + 1, 0);
    for (const std::uint32_t brick : bricks) ++result.first[brick + 1];
    for (std::size_t b = 0; b < count; ++b) result.first[b + 1] += result.first[b];
    std::vector<std::size_t> next(result.first.begin(), result.first.end() - 1);
    result.owned.resize(cells);
    for (std::size_t c = 0; c < cells; ++c) result.owned[next[bricks[c]]++] = static_cast<Index>(c);
    return result;
}

}  // namespace subvol::detail
