// SPDX-License-Identifier: Apache-2.0
#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <numeric>

#include "brick_folder.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

/// Cuts a range of cells into bricks of about equal size, across the longest side of their box.
class Cutter {
public:
    Cutter(const HexMesh& mesh, bool slabs, std::vector<std::uint32_t>& bricks)
        : slabs_(slabs), centers_(mesh.cells.size()), bricks_(bricks) {
        parallel_each(centers_.size(), [&](std::size_t c) {
            Vec3 sum(0.0);
            for (const Index p : mesh.cells[c]) sum += mesh.points[p];
            centers_[c] = sum / 8.0;
        });
    }

    void run(std::size_t count) {
        std::vector<Index> cells(centers_.size());
        std::iota(cells.begin(), cells.end(), Index{0});
        axis_ = longest_side(cells);
        cut(cells, 0, count);
    }

private:
    [[nodiscard]] int longest_side(std::span<const Index> cells) const {
        Box box;
        for (const Index c : cells) box.add(centers_[c]);
        const Vec3 size = box.size();
        return size.x >= std::max(size.y, size.z) ? 0 : size.y >= size.z ? 1 : 2;
    }

    void cut(std::span<Index> cells, std::size_t first, std::size_t count) {
        if (count == 1) {
            for (const Index c : cells) bricks_[c] = static_cast<std::uint32_t>(first);
            return;
        }
        const std::size_t low = count / 2, middle = cells.size() * low / count;
        const int axis = slabs_ ? axis_ : longest_side(cells);
        std::nth_element(cells.begin(), cells.begin() + static_cast<std::ptrdiff_t>(middle), cells.end(),
                         [&](Index a, Index b) {
                             return centers_[a][axis] != centers_[b][axis] ? centers_[a][axis] < centers_[b][axis] : a < b;
                         });
        tbb::parallel_invoke([&] { cut(cells.first(middle), first, low); },
                             [&] { cut(cells.subspan(middle), first + low, count - low); });
    }

    bool slabs_;
    int axis_ = 0;
    std::vector<Vec3> centers_;
    std::vector<std::uint32_t>& bricks_;
};

std::uint64_t scattered(std::uint64_t number) {  // splitmix64
    number += 0x9e3779b97f4a7c15ULL;
    number = (number ^ number >> 30) * 0xbf58476d1ce4e5b9ULL;
    number = (number ^ number >> 27) * 0x94d049bb133111ebULL;
    return number ^ number >> 31;
}

}  // namespace

std::vector<std::uint32_t> bricks_of_cells(const HexMesh& mesh, const SplitOptions& options) {
    check_options(options);
    const std::size_t count = brick_count(mesh.cells.size(), options);
    if (count > mesh.cells.size()) {
        throw Error(ErrorCode::InvalidInput, std::to_string(count) + " bricks", {},
                    "the mesh has " + std::to_string(mesh.cells.size()) + " cells");
    }
    std::vector<std::uint32_t> bricks(mesh.cells.size());
    if (options.shape == BrickShape::Random) {
        parallel_each(bricks.size(), [&](std::size_t c) {
            bricks[c] = static_cast<std::uint32_t>(scattered(options.seed ^ scattered(c)) % count);
        });
    } else {
        Cutter(mesh, options.shape == BrickShape::Slabs, bricks).run(count);
    }
    return bricks;
}

}  // namespace subvol
