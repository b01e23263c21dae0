// SPDX-License-Identifier: Apache-2.0
// Points and quads between voxels of different materials, block by block. Block B has the cells, each between eight voxels,
// whose lowest voxel is in it: it needs the voxels of B and the next ones of its seven neighbours above.
//
//     voxel ●───┬───● next    a cell is dual to a voxel's corner; the point in it is drawn as ×
//           │ × │ × │         the quad between two voxels has the four × around their common face
//           ├───┼───┤
//     ●─────┴───┴───●
//
// Points are numbered by the bits of a mask of 512 cells, so that the point of a cell is found without a table of all cells.
#include "label_net.h"

#include <algorithm>
#include <bit>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kCells = LabelGrid::kSide, kWithNext = kCells + 1;
using Materials = std::array<std::uint32_t, kWithNext * kWithNext * kWithNext>;

/// The cells of a block that have a point.
struct CellBlock {
    LabelGrid::At at{};
    std::array<std::uint64_t, kCells> mask{};
    std::array<std::uint16_t, kCells> before{};
    Index first = 0;

    void add(std::size_t cell) { mask[cell / 64] |= std::uint64_t{1} << cell % 64; }
    [[nodiscard]] bool has(std::size_t cell) const { return (mask[cell / 64] >> cell % 64 & 1) != 0; }
    [[nodiscard]] Index point(std::size_t cell) const {
        const std::uint64_t lower = mask[cell / 64] & ((std::uint64_t{1} << cell % 64) - 1);
        return first + before[cell / 64] + static_cast<Index>(std::popcount(lower));
    }
};

class NetMaker {
public:
    NetMaker(const LabelGrid& grid, const std::function<std::uint32_t(std::int32_t)>& material)
        : grid_(grid), material_(material) {}

    LabelNet make() {
        find_blocks();
        for (CellBlock& block : blocks_) find_points(block);
        std::erase_if(blocks_, [](const CellBlock& block) {
            return std::ranges::all_of(block.mask, [](std::uint64_t bits) { return bits == 0; });
        });
        for (const CellBlock& block : blocks_) join(block);
        return std::move(net_);
    }

private:
    static std::size_t voxel(std::size_t x, std::size_t y, std::size_t z) { return x + kWithNext * (y + kWithNext * z); }

    static LabelGrid::At moved(LabelGrid::At at, int x, int y, int z) { return {at[0] + x, at[1] + y, at[2] + z}; }

    std::uint32_t material(std::int32_t label) {
        if (label != last_label_) {
            last_label_ = label;
            last_material_ = label == 0 ? 0 : material_(label);
        }
        return last_material_;
    }

    /// Blocks of cells that may not be of one material, in their order.
    void find_blocks() {
        std::vector<LabelGrid::At> found;
        for (const auto& [at, block] : grid_.blocks()) {
            for (int n = 0; n < 8; ++n) {
                const LabelGrid::At below = moved(at, -(n & 1), -(n >> 1 & 1), -(n >> 2));
                if (may_differ(below)) found.push_back(below);
            }
        }
        std::ranges::sort(found);
        found.erase(std::unique(found.begin(), found.end()), found.end());
        blocks_.resize(found.size());
        for (std::size_t b = 0; b < found.size(); ++b) blocks_[b].at = found[b];
    }

    bool may_differ(const LabelGrid::At& at) {
        std::uint32_t first = 0;
        for (int n = 0; n < 8; ++n) {
            const LabelGrid::Block* block = grid_.find(moved(at, n & 1, n >> 1 & 1, n >> 2));
            if (block != nullptr && block->voxels) return true;
            const std::uint32_t one = block == nullptr ? 0 : material(block->label);
            if (n == 0) first = one;
            if (one != first) return true;
        }
        return false;
    }

    /// The materials of a block's voxels and of the next ones above.
    void gather(const LabelGrid::At& at) {
        for (std::size_t n = 0; n < 8; ++n) {
            const std::array<std::size_t, 3> above{n & 1, n >> 1 & 1, n >> 2};
            const LabelGrid::Block* block =
                grid_.find(moved(at, static_cast<int>(above[0]), static_cast<int>(above[1]), static_cast<int>(above[2])));
            const auto end = [&](int axis) { return above[static_cast<std::size_t>(axis)] == 0 ? kCells : 1; };
            for (std::size_t z = 0; z < end(2); ++z) {
                for (std::size_t y = 0; y < end(1); ++y) {
                    for (std::size_t x = 0; x < end(0); ++x) {
                        materials_[voxel(x + kCells * above[0], y + kCells * above[1], z + kCells * above[2])] =
                            block == nullptr ? 0 : material(block->at(x + kCells * (y + kCells * z)));
                    }
                }
            }
        }
    }

    void find_points(CellBlock& block) {
        gather(block.at);
        block.first = static_cast<Index>(net_.points.size());
        for (std::size_t cell = 0; cell < LabelGrid::kVoxels; ++cell) {
            const std::size_t x = cell % kCells, y = cell / kCells % kCells, z = cell / (kCells * kCells);
            if (cell % 64 == 0) block.before[cell / 64] = static_cast<std::uint16_t>(net_.points.size() - block.first);
            const std::size_t lowest = voxel(x, y, z);
            bool differ = false;
            for (std::size_t n = 1; n < 8; ++n)
                differ |= materials_[lowest + voxel(n & 1, n >> 1 & 1, n >> 2)] != materials_[lowest];
            if (!differ) continue;
            block.add(cell);
            if (net_.points.size() + 1 >= kNone) {
                throw Error(ErrorCode::InvalidInput, "have more than 2^32 corners between labels", "voxels");
            }
            LabelNet::Point& point = net_.points.emplace_back();
            const std::array<std::size_t, 3> local{x, y, z};
            for (int axis = 0; axis < 3; ++axis) {
                const auto a = static_cast<std::size_t>(axis);
                point.middle[axis] = double{kCells} * block.at[a] + static_cast<double>(local[a]) + 0.5;
            }
            point.next.fill(kNone);
            for (std::size_t n = 0; n < 8; ++n) point.materials[n] = materials_[lowest + voxel(n & 1, n >> 1 & 1, n >> 2)];
        }
    }

    [[nodiscard]] const CellBlock* find(const LabelGrid::At& at) const {
        const auto found = std::ranges::lower_bound(blocks_, at, {}, &CellBlock::at);
        return found != blocks_.end() && found->at == at ? &*found : nullptr;
    }

    /// The edges and quads of a block's cells and voxels.
    void join(const CellBlock& block) {
        gather(block.at);
        std::array<const CellBlock*, 27> around;
        for (int n = 0; n < 27; ++n) {
            around[static_cast<std::size_t>(n)] = find(moved(block.at, n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1));
        }
        /// The point of a cell, from −1 to 8 along each axis.
        const auto point = [&](const std::array<int, 3>& cell) {
            std::size_t which = 0, local = 0;
            for (std::size_t axis = 3; axis-- > 0;) {
                const int shifted = cell[axis] + static_cast<int>(kCells);
                which = 3 * which + static_cast<std::size_t>(shifted) / kCells;
                local = kCells * local + static_cast<std::size_t>(shifted) % kCells;
            }
            return around[which]->point(local);
        };
        constexpr std::array<std::size_t, 3> kSteps{1, kWithNext, kWithNext * kWithNext};
        for (std::size_t cell = 0; cell < LabelGrid::kVoxels; ++cell) {
            if (!block.has(cell)) continue;
            const std::array<int, 3> here{static_cast<int>(cell % kCells), static_cast<int>(cell / kCells % kCells),
                                          static_cast<int>(cell / (kCells * kCells))};
            const Index own = block.point(cell);
            const std::size_t lowest = voxel(cell % kCells, cell / kCells % kCells, cell / (kCells * kCells));
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const std::size_t b = (axis + 1) % 3, c = (axis + 2) % 3;
                // The face between this cell and the next one along the axis.
                const std::size_t above = lowest + kSteps[axis];
                std::array<std::uint32_t, 4> face{materials_[above], materials_[above + kSteps[b]],
                                                  materials_[above + kSteps[c]], materials_[above + kSteps[b] + kSteps[c]]};
                std::ranges::sort(face);
                const auto kinds = std::unique(face.begin(), face.end()) - face.begin();
                if (kinds > 1) {
                    std::array<int, 3> to = here;
                    ++to[axis];
                    const Index other = point(to);
                    net_.points[own].next[2 * axis + 1] = other;
                    net_.points[other].next[2 * axis] = own;
                    if (kinds > 2) {
                        net_.points[own].lines |= static_cast<std::uint8_t>(1U << (2 * axis + 1));
                        net_.points[other].lines |= static_cast<std::uint8_t>(1U << (2 * axis));
                    }
                }
                if (materials_[lowest] == materials_[above]) continue;
                const auto at = [&](int in_b, int in_c) {
                    std::array<int, 3> to = here;
                    to[b] += in_b;
                    to[c] += in_c;
                    return point(to);
                };
                net_.quads.push_back({{at(-1, -1), at(0, -1), at(0, 0), at(-1, 0)}, {materials_[lowest], materials_[above]}});
            }
        }
    }

    const LabelGrid& grid_;
    const std::function<std::uint32_t(std::int32_t)>& material_;
    std::int32_t last_label_ = 0;
    std::uint32_t last_material_ = 0;
    std::vector<CellBlock> blocks_;
    Materials materials_{};
    LabelNet net_;
};

}  // namespace

LabelNet label_net(const LabelGrid& grid, const std::function<std::uint32_t(std::int32_t)>& material) {
    return NetMaker(grid, material).make();
}

}  // namespace subvol::detail
