// SPDX-License-Identifier: Apache-2.0
#include "brick_shapes.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <limits>
#include <numeric>

#include "brick_folder.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/word_hash.h"
#include "subvol/error.h"
#include "subvol/option.h"

// Compact bricks by halving: the cells, sorted by the coordinate of their centres along the longest side of their box, are cut
// where so many lie below that each brick gets the same number, to one cell:
//
//      +---------+----+        5 bricks: 2/5 of the cells to the left, 3/5 to the right; these are cut again, along the
//      |    0    | 2  |        longest side of their own box. Slabs are cut along one axis only.
//      |         +----+
//      +---------+ 3  |        Only the numbers of cells and the coordinates along one axis are in memory; the centres may lie
//      |    1    +----+        in files. Cells with the coordinate of the cut are taken in the order of their numbers: the
//      bricks |         | 4  |        depend on nothing else.
//      +---------+----+

namespace subvol {

using namespace detail;

namespace {

constexpr std::size_t kCentersOfChunk = std::size_t{1} << 16;  // cells whose centres are looked at together

/// Cuts a range of cells into bricks of about equal size, across the longest side of their box.
class Cutter {
public:
    Cutter(const CellCenters& centers, bool slabs, std::vector<std::uint32_t>& bricks)
        : slabs_(slabs), centers_(centers), bricks_(bricks) {}

    void run(std::size_t count) {
        std::vector<Index> cells(centers_.count());
        std::iota(cells.begin(), cells.end(), Index{0});
        if (count > 1) axis_ = longest_side(cells);
        cut(std::move(cells), 0, count);
    }

private:
    /// Calls call(cell, coordinate) for all cells in their order.
    template <class Call>
    void each_center(int axis, std::span<const Index> cells, const Call& call) const {
        // Centres are read in chunks, because they may lie in a file that is larger than memory.
        std::vector<double> values(std::min(cells.size(), kCentersOfChunk));
        for (std::size_t begin = 0; begin < cells.size(); begin += kCentersOfChunk) {
            const auto some = cells.subspan(begin, std::min(kCentersOfChunk, cells.size() - begin));
            centers_.read(axis, some, std::span(values).first(some.size()));
            for (std::size_t i = 0; i < some.size(); ++i) call(some[i], values[i]);
        }
    }

    [[nodiscard]] int longest_side(std::span<const Index> cells) const {
        Vec3 size;
        for (int axis = 0; axis < 3; ++axis) {
            double low = std::numeric_limits<double>::infinity(), high = -low;
            each_center(axis, cells, [&](Index, double x) {
                low = std::min(low, x);
                high = std::max(high, x);
            });
            size[axis] = low <= high ? high - low : 0;
        }
        return size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    }

    void cut(std::vector<Index> cells, std::size_t first, std::size_t count) {
        if (count == 1) {
            for (const Index c : cells) bricks_[c] = static_cast<std::uint32_t>(first);
            return;
        }
        // Cells are divided in proportion, also for an odd number of bricks; the product stays far below 2⁶⁴.
        const std::size_t low = count / 2, middle = cells.size() * low / count;
        const int axis = slabs_ ? axis_ : longest_side(cells);
        const Border border = border_of(axis, cells, middle);
        std::vector<Index> below, above;
        below.reserve(middle);
        above.reserve(cells.size() - middle);
        std::size_t equal = 0;
        each_center(axis, cells, [&](Index c, double x) {
            const bool is_below = x < border.at || (x == border.at && equal++ < border.equal_below);
            (is_below ? below : above).push_back(c);
        });
        // Freed before the halves are cut, as otherwise each level of the recursion would keep a list of all its cells.
        cells = {};
        tbb::parallel_invoke([&] { cut(std::move(below), first, low); },
                             [&] { cut(std::move(above), first + low, count - low); });
    }

    /// Cells are below with smaller coordinates, and so many of those with this one, the first ones.
    struct Border {
        double at;
        std::size_t equal_below;
    };

    [[nodiscard]] Border border_of(int axis, std::span<const Index> cells, std::size_t place) const {
        std::vector<double> centers;
        centers.reserve(cells.size());
        each_center(axis, cells, [&](Index, double x) { centers.push_back(x); });
        const auto border = centers.begin() + static_cast<std::ptrdiff_t>(place);
        // A full sort is not needed: the element that would be at the place of the cut, in O(n).
        std::nth_element(centers.begin(), border, centers.end());
        const auto smaller = std::count_if(centers.begin(), border, [&](double x) { return x < *border; });
        return {*border, place - static_cast<std::size_t>(smaller)};
    }

    bool slabs_;
    int axis_ = 0;
    const CellCenters& centers_;
    std::vector<std::uint32_t>& bricks_;
};

class CentersOfMesh : public CellCenters {
public:
    explicit CentersOfMesh(const HexMesh& mesh) : mesh_(mesh) {}
    [[nodiscard]] std::size_t count() const override { return mesh_.cells.size(); }
    void read(int axis, std::span<const Index> cells, std::span<double> values) const override {
        for (std::size_t i = 0; i < cells.size(); ++i) {
            double sum = 0;
            for (const Index p : mesh_.cells[cells[i]]) sum += mesh_.points[p][axis];
            values[i] = sum / 8.0;
        }
    }

private:
    const HexMesh& mesh_;
};

}  // namespace

std::vector<std::uint32_t> detail::bricks_of_cells(const CellCenters& centers, const SplitOptions& options) {
    check_options(options);
    const std::size_t cells = centers.count(), count = brick_count(cells, options);
    if (count > cells) {
        throw Error(ErrorCode::InvalidInput, std::to_string(count) + " bricks", {},
                    "the mesh has " + std::to_string(cells) + " cells");
    }
    std::vector<std::uint32_t> bricks(cells);
    if (options.shape == BrickShape::Random) {
        parallel_each(bricks.size(), [&](std::size_t c) {
            // The brick of a cell depends on its number and the seed alone, not on the threads.
            bricks[c] = static_cast<std::uint32_t>(mixed((options.seed ^ mixed(c + kGoldenWord)) + kGoldenWord) % count);
        });
    } else {
        Cutter(centers, options.shape == BrickShape::Slabs, bricks).run(count);
    }
    return bricks;
}

std::vector<std::uint32_t> bricks_of_cells(const HexMesh& mesh, const SplitOptions& options) {
    return bricks_of_cells(CentersOfMesh(mesh), options);
}

}  // namespace subvol
