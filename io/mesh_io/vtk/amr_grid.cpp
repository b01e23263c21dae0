// SPDX-License-Identifier: Apache-2.0
// A mesh of the finest cells of adaptive mesh refinement. A level is a lattice of equal cells, of which the file has boxes; the
// next level divides each cell by whole numbers:
//
//     level 0  +-------+-------+-------+      level 1      +---+---+      mesh  +-------+---+---+-------+
//              |       |   x   |       |                   |   |   |            |       |   |   |       |
//              |       |       |       |                   +---+---+            |       h---+---h       |
//              |       |       |       |                   |   |   |            |       |   |   |       |
//              +-------+-------+-------+                   +---+---+            +-------+---+---+-------+
//
// The cell x is covered by a box of level 1 and left out. All points are counted on the lattice of the finest level, so those
// of different blocks and levels are the same if their numbers are, without a tolerance. The points h hang.
//
// The boxes of a level are in a tree, which finds those that meet a box.
#include "amr_grid.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <unordered_map>
#include <utility>

#include "assemble.h"
#include "join_pieces.h"
#include "mesh_arrays.h"
#include "subvol/detail/median_tree.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/word_hash.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr std::size_t kMostAmrLevels = 64;
constexpr std::int64_t kFarthestCell = std::int64_t{1} << 31;
constexpr std::int64_t kFinest = std::int64_t{1} << 20;  // so that numbers on the finest lattice are exact as reals

using AmrScale = std::array<std::int64_t, 3>;

std::string axis_name(std::size_t axis) {
    return std::string(1, static_cast<char>('x' + axis));
}

std::string block_name(std::size_t level, std::size_t block) {
    return "block " + std::to_string(block) + " of level " + std::to_string(level);
}

std::int64_t floor_of(std::int64_t a, std::int64_t b) {
    return a / b - (a % b != 0 && a < 0 ? 1 : 0);
}

AmrBox coarsened(const AmrBox& box, const AmrScale& ratio) {
    AmrBox coarse;
    for (std::size_t a = 0; a < 3; ++a) {
        coarse.low[a] = floor_of(box.low[a], ratio[a]);
        coarse.high[a] = floor_of(box.high[a], ratio[a]);
    }
    return coarse;
}

std::size_t cells_of_box(const AmrBox& box) {
    return box.grid().cell_count();
}

// The boxes of a level that meet another box.
class AmrBoxes {
public:
    explicit AmrBoxes(const AmrLevel& level) : level_(level) {
        std::vector<Vec3> centers;
        for (const AmrBlock& block : level.blocks) {
            Vec3& center = centers.emplace_back();
            for (std::size_t a = 0; a < 3; ++a) {
                center[static_cast<int>(a)] = .5 * static_cast<double>(block.box.low[a] + block.box.high[a]);
            }
        }
        if (!centers.empty()) tree_.emplace(centers, 8, [&](Index block) { return level.blocks[block].box; });
    }

    /// Calls take(block) for these.
    template <class Take>
    void each_meeting(const AmrBox& box, const Take& take) const {
        if (!tree_) return;
        tree_->visit_leaves([&](const AmrBox& of_node) { return of_node.meets(box); },
                            [&](std::size_t first, std::size_t end) {
                                for (std::size_t slot = first; slot < end; ++slot) {
                                    const Index block = tree_->item(slot);
                                    if (level_.blocks[block].box.meets(box)) take(std::size_t{block});
                                }
                                return false;
                            });
    }

private:
    const AmrLevel& level_;
    std::optional<MedianTree<AmrBox>> tree_;
};

// By how much each level is finer than the one before.
std::vector<AmrScale> ratios_of(const AmrGrid& grid, std::string_view file) {
    std::vector<AmrScale> ratios;
    const auto fail = [&](std::size_t level, const std::string& message, const std::string& allowed) {
        throw Error(ErrorCode::InvalidInput, "level " + std::to_string(level) + ": " + message, std::string(file), allowed);
    };
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        for (std::size_t a = 0; a < 3; ++a) {
            const double spacing = grid.levels[l].spacing[a];
            if (!(spacing > 0) || !std::isfinite(spacing)) {
                fail(l, "its spacing along " + axis_name(a) + " is " + number_text(spacing), "a length above 0");
            }
        }
        if (l == 0) continue;
        AmrScale& ratio = ratios.emplace_back();
        for (std::size_t a = 0; a < 3; ++a) {
            const double coarse = grid.levels[l - 1].spacing[a], fine = grid.levels[l].spacing[a];
            const double times = coarse / fine, whole = std::round(times);
            constexpr double kOfSinglePrecision = 1e-4;  // of a ratio up to a thousand
            if (!(whole >= 1) || whole > static_cast<double>(kFinest) || std::abs(times - whole) > kOfSinglePrecision * whole) {
                fail(l,
                     "its spacing along " + axis_name(a) + ", " + number_text(fine) + ", does not divide that of level " +
                         std::to_string(l - 1) + ", " + number_text(coarse),
                     "the cells of a level are divided by a whole number");
            }
            ratio[a] = static_cast<std::int64_t>(whole);
        }
    }
    return ratios;
}

// By how much the finest level is finer than each.
std::vector<AmrScale> scales_of(const std::vector<AmrScale>& ratios, std::string_view file) {
    std::vector<AmrScale> scales(ratios.size() + 1, AmrScale{1, 1, 1});
    for (std::size_t l = ratios.size(); l-- > 0;) {
        for (std::size_t a = 0; a < 3; ++a) {
            if (ratios[l][a] > kFinest / scales[l + 1][a]) {
                throw Error(ErrorCode::InvalidInput, "the cells of level " + std::to_string(l) + " are divided too often",
                            std::string(file), "in all into at most " + std::to_string(kFinest) + " along an axis");
            }
            scales[l][a] = ratios[l][a] * scales[l + 1][a];
        }
    }
    return scales;
}

[[noreturn]] void fail_at(const AmrGrid& grid, std::size_t level, std::size_t block, const std::string& message,
                          const std::string& allowed = {}) {
    throw Error(ErrorCode::InvalidInput, block_name(level, block) + message, grid.levels[level].blocks[block].place, allowed);
}

std::string text_of_box(const AmrBox& box) {
    std::string text;
    for (std::size_t a = 0; a < 3; ++a) {
        text += (a > 0 ? " " : "") + std::to_string(box.low[a]) + " " + std::to_string(box.high[a]);
    }
    return text;
}

void check_sizes(const AmrGrid& grid, std::string_view file) {
    std::size_t points = 0;
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        for (std::size_t b = 0; b < grid.levels[l].blocks.size(); ++b) {
            const AmrBox& box = grid.levels[l].blocks[b].box;
            for (std::size_t a = 0; a < 3; ++a) {
                if (box.low[a] < -kFarthestCell || box.high[a] > kFarthestCell) {
                    fail_at(grid, l, b, ": its box " + text_of_box(box) + " is out of range", "32 bits");
                }
                if (box.high[a] < box.low[a]) {
                    fail_at(grid, l, b, ": its box " + text_of_box(box) + " has no cells along " + axis_name(a),
                            "hexahedra need three dimensions");
                }
            }
            const std::size_t of_block = box.grid().point_count();
            if (of_block >= kNone - points) {
                throw Error(ErrorCode::InvalidInput, "the boxes have too many points", std::string(file));
            }
            points += of_block;
        }
    }
}

void check_overlaps(const AmrGrid& grid, std::size_t level, const AmrBoxes& boxes) {
    const auto& blocks = grid.levels[level].blocks;
    for (std::size_t b = 0; b < blocks.size(); ++b) {
        boxes.each_meeting(blocks[b].box, [&](std::size_t other) {
            if (other != b) {
                fail_at(grid, level, std::max(b, other), " overlaps " + block_name(level, std::min(b, other)),
                        "the blocks of a level have no cell twice");
            }
        });
    }
}

// coarser: the boxes of the level before
void check_nesting(const AmrGrid& grid, std::size_t level, const AmrScale& ratio, const AmrBoxes& coarser) {
    for (std::size_t b = 0; b < grid.levels[level].blocks.size(); ++b) {
        const AmrBox& box = grid.levels[level].blocks[b].box;
        const AmrBox parents = coarsened(box, ratio);
        for (std::size_t a = 0; a < 3; ++a) {
            if (parents.low[a] * ratio[a] != box.low[a] || (parents.high[a] + 1) * ratio[a] != box.high[a] + 1) {
                fail_at(grid, level, b,
                        ": its box " + text_of_box(box) + " divides cells of level " + std::to_string(level - 1) + " along " +
                            axis_name(a) + " in part",
                        "it begins and ends between them, at each " + std::to_string(ratio[a]) + " cells");
            }
        }
        std::size_t covered = 0;
        coarser.each_meeting(parents, [&](std::size_t other) {
            covered += cells_of_box(grid.levels[level - 1].blocks[other].box.common(parents));
        });
        if (covered != cells_of_box(parents)) {
            fail_at(grid, level, b, " lies outside of the blocks of level " + std::to_string(level - 1));
        }
    }
}

struct AmrPointHash {
    std::size_t operator()(const Vec3& x) const { return static_cast<std::size_t>(hash_of_place(x)); }
};

class AmrMesh {
public:
    AmrMesh(const AmrGrid& grid, std::string_view file)
        : grid_(grid), file_(file), ratios_(ratios_of(grid, file)), scales_(scales_of(ratios_, file)) {}

    MeshFile run() {
        check_values();
        for (std::size_t l = 0; l < grid_.levels.size(); ++l) find_hidden(l);
        choose_arrays();
        for (std::size_t l = 0; l < grid_.levels.size(); ++l) add_level(l);
        say();
        take_set_arrays(found_);
        return std::move(found_);
    }

private:
    // Values may be missing altogether; then there are few points.
    void check_values() const {
        std::size_t points = 0, values = 0;
        for (const AmrLevel& level : grid_.levels) {
            for (const AmrBlock& block : level.blocks) points += block.box.grid().point_count();
            for (const FileArray& array : level.arrays) values += array.values.size();
        }
        if (points > most_points(values)) {
            throw Error(ErrorCode::InvalidInput,
                        "its boxes have " + std::to_string(points) + " points, and " + std::to_string(values) + " values",
                        std::string(file_), "a value for each");
        }
    }

    void find_hidden(std::size_t l) {
        const AmrLevel& level = grid_.levels[l];
        std::vector<std::uint8_t>& hidden = hidden_.emplace_back();
        auto& [first_points, first_cells] = firsts_.emplace_back();
        std::size_t points = 0, cells = 0;
        for (const AmrBlock& block : level.blocks) {
            first_points.push_back(points);
            first_cells.push_back(cells);
            points += block.box.grid().point_count();
            cells += cells_of_box(block.box);
        }
        hidden.assign(cells, 0);
        if (l + 1 < grid_.levels.size()) {
            const AmrBoxes boxes(level);
            for (const AmrBlock& finer : grid_.levels[l + 1].blocks) {
                const AmrBox parents = coarsened(finer.box, ratios_[l]);
                boxes.each_meeting(parents, [&](std::size_t b) { cover(l, b, level.blocks[b].box.common(parents)); });
            }
        }
        covered_ += static_cast<std::size_t>(std::ranges::count(hidden, 1));
        hide_ghosts(level, hidden);
        for (std::size_t b = 0; b < level.blocks.size(); ++b) {
            if (level.blocks[b].has_values) continue;
            const auto begin = hidden.begin() + static_cast<std::ptrdiff_t>(first_cells[b]);
            if (std::find(begin, begin + static_cast<std::ptrdiff_t>(cells_of_box(level.blocks[b].box)), 0) !=
                begin + static_cast<std::ptrdiff_t>(cells_of_box(level.blocks[b].box))) {
                fail_at(grid_, l, b, " has no file, and finer blocks do not cover it");
            }
        }
        visible_.push_back(static_cast<std::size_t>(std::ranges::count(hidden, 0)));
    }

    void cover(std::size_t l, std::size_t b, const AmrBox& cells) {
        const AmrBox& box = grid_.levels[l].blocks[b].box;
        const StructuredGrid grid = box.grid();
        const auto row = static_cast<std::size_t>(cells.high[0] - cells.low[0] + 1);
        for (std::int64_t k = cells.low[2]; k <= cells.high[2]; ++k) {
            for (std::int64_t j = cells.low[1]; j <= cells.high[1]; ++j) {
                const std::size_t first = (static_cast<std::size_t>(k - box.low[2]) * (grid.points[1] - 1) +
                                           static_cast<std::size_t>(j - box.low[1])) *
                                              (grid.points[0] - 1) +
                                          static_cast<std::size_t>(cells.low[0] - box.low[0]);
                std::fill_n(hidden_[l].data() + firsts_[l].cells[b] + first, row, std::uint8_t{1});
            }
        }
    }

    // Cells that are marked as refined, as duplicates or as hidden: boxes decide what is covered, marks leave out more.
    void hide_ghosts(const AmrLevel& level, std::vector<std::uint8_t>& hidden) {
        for (const FileArray& array : level.arrays) {
            if (array.name != kGhostArray || !array.at_cells || array.components != 1) continue;
            std::size_t first = 0;
            for (const AmrBlock& block : level.blocks) {
                const std::size_t end = first + cells_of_box(block.box);
                const auto ghosts = std::span(array.values).subspan(first, end - first);
                const bool marks_refined = std::ranges::any_of(ghosts, [](double ghost) { return is_refined(ghost); });
                for (std::size_t c = first; c < end; ++c) {
                    const double ghost = array.values[c];
                    if (marks_refined && hidden[c] == 1 && !leaves_out_cell(ghost)) ++unmarked_;
                    if (hidden[c] != 0 || !leaves_out_cell(ghost)) continue;
                    hidden[c] = 2;
                    ++(is_refined(ghost) ? marked_ : ghosts_);
                }
                first = end;
            }
        }
    }

    [[nodiscard]] static bool is_refined(double ghost) {
        return ghost >= 0 && ghost < 256 && (static_cast<unsigned>(ghost) & kRefinedCell) != 0;
    }

    // The arrays that all levels with cells have. Their values come later.
    void choose_arrays() {
        arrays_.resize(grid_.levels.size());
        std::vector<std::string> left_out;
        const auto first = std::ranges::find_if(visible_, [](std::size_t cells) { return cells > 0; });
        for (std::size_t l = 0; l < grid_.levels.size(); ++l) {
            if (visible_[l] == 0) continue;
            for (const FileArray& array : grid_.levels[l].arrays) {
                if (array.name == kGhostArray) continue;
                std::vector<const FileArray*> of_levels(grid_.levels.size(), nullptr);
                bool everywhere = true;
                for (std::size_t other = 0; other < grid_.levels.size(); ++other) {
                    if (visible_[other] == 0) continue;
                    const auto& arrays = grid_.levels[other].arrays;
                    const auto same = std::ranges::find_if(arrays, [&](const FileArray& a) {
                        return a.name == array.name && a.at_cells == array.at_cells && a.components == array.components;
                    });
                    everywhere = everywhere && same != arrays.end();
                    of_levels[other] = same != arrays.end() ? &*same : nullptr;
                }
                const bool is_first = static_cast<std::ptrdiff_t>(l) == first - visible_.begin();
                if (everywhere && is_first) {
                    FileArray& taken = found_.arrays.emplace_back();
                    taken.name = array.name;
                    taken.components = array.components;
                    taken.at_cells = array.at_cells;
                    taken.integers = array.integers;
                    for (std::size_t other = 0; other < of_levels.size(); ++other) arrays_[other].push_back(of_levels[other]);
                } else if (!everywhere && std::ranges::find(left_out, array.name) == left_out.end()) {
                    left_out.push_back(array.name);
                }
            }
        }
        for (const std::string& name : left_out) found_.ignore(not_everywhere(name, "level"));
    }

    void add_level(std::size_t l) {
        for (std::size_t b = 0; b < grid_.levels[l].blocks.size() && visible_[l] > 0; ++b) add_block(l, b);
    }

    void add_block(std::size_t l, std::size_t b) {
        const AmrBox& box = grid_.levels[l].blocks[b].box;
        const StructuredGrid grid = box.grid();
        const std::array<std::size_t, 3> n{grid.points[0] - 1, grid.points[1] - 1, grid.points[2] - 1};
        const std::uint8_t* hidden = hidden_[l].data() + firsts_[l].cells[b];
        std::vector<Index> points(grid.point_count(), kNone);
        // Points inside the block whose cells are all there are those of no other block.
        const auto may_be_shared = [&](const std::array<std::size_t, 3>& at) {
            for (std::size_t a = 0; a < 3; ++a) {
                if (at[a] == 0 || at[a] == n[a]) return true;
            }
            for (std::size_t corner = 0; corner < 8; ++corner) {
                const std::size_t i = at[0] - (corner & 1), j = at[1] - (corner >> 1 & 1), k = at[2] - (corner >> 2);
                if (hidden[(k * n[1] + j) * n[0] + i] != 0) return true;
            }
            return false;
        };
        const auto point = [&](std::size_t i, std::size_t j, std::size_t k) {
            const std::size_t place = (k * grid.points[1] + j) * grid.points[0] + i;
            if (points[place] == kNone) {
                const std::array<std::size_t, 3> at{i, j, k};
                points[place] = add_amr_point(l, box, at, firsts_[l].points[b] + place, may_be_shared(at));
            }
            return points[place];
        };
        std::size_t c = 0;
        for (std::size_t k = 0; k < n[2]; ++k) {
            for (std::size_t j = 0; j < n[1]; ++j) {
                for (std::size_t i = 0; i < n[0]; ++i, ++c) {
                    if (hidden[c] != 0) continue;
                    found_.hexes.numbers.push_back(static_cast<Index>(found_.hexes.corners.size()));
                    found_.hexes.corners.push_back({point(i, j, k), point(i + 1, j, k), point(i + 1, j + 1, k),
                                                    point(i, j + 1, k), point(i, j, k + 1), point(i + 1, j, k + 1),
                                                    point(i + 1, j + 1, k + 1), point(i, j + 1, k + 1)});
                    add_values(l, true, firsts_[l].cells[b] + c);
                }
            }
        }
    }

    // tuple: of its values in the arrays of the level
    Index add_amr_point(std::size_t l, const AmrBox& box, const std::array<std::size_t, 3>& at, std::size_t tuple,
                        bool shared) {
        Vec3 place, number;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::int64_t i = box.low[a] + static_cast<std::int64_t>(at[a]);
            place[static_cast<int>(a)] = grid_.origin[a] + grid_.levels[l].spacing[a] * static_cast<double>(i);
            number[static_cast<int>(a)] = static_cast<double>(i * scales_[l][a]);
        }
        const auto next = static_cast<Index>(found_.points.size());
        if (shared) {
            const auto [known, is_new] = known_.try_emplace(number, next);
            if (!is_new) {
                const Index p = known->second;
                set_values(l, tuple, p, l > levels_[p]);
                levels_[p] = std::max(levels_[p], static_cast<std::uint8_t>(l));
                return p;
            }
        }
        add_point(found_, place, 0);
        levels_.push_back(static_cast<std::uint8_t>(l));
        add_values(l, false, tuple);
        return next;
    }

    void add_values(std::size_t l, bool at_cells, std::size_t tuple) {
        for (std::size_t k = 0; k < found_.arrays.size(); ++k) {
            FileArray& array = found_.arrays[k];
            if (array.at_cells != at_cells) continue;
            const auto components = static_cast<std::size_t>(array.components);
            const double* from = arrays_[l][k]->values.data() + tuple * components;
            array.values.insert(array.values.end(), from, from + components);
        }
    }

    // The values of the finest level stay; a point is in a set if any block says so. finer: than those that it has
    void set_values(std::size_t l, std::size_t tuple, Index p, bool finer) {
        for (std::size_t k = 0; k < found_.arrays.size(); ++k) {
            FileArray& array = found_.arrays[k];
            if (array.at_cells) continue;
            const auto components = static_cast<std::size_t>(array.components);
            const double* from = arrays_[l][k]->values.data() + tuple * components;
            if (is_node_set_array(array.name, components)) {
                array.values[p] = std::max(array.values[p], *from);
            } else if (finer) {
                std::copy_n(from, components, array.values.data() + p * components);
            }
        }
    }

    void say() {
        std::vector<std::string> said;
        const std::size_t levels = grid_.levels.size();
        if (levels > 1) {
            said.push_back(std::to_string(levels) + " levels of refinement put together; " +
                           counted(covered_, "cell", "cells") + " that finer ones cover left out");
        }
        if (ghosts_ > 0) said.push_back(ghosts_left_out(ghosts_));
        if (marked_ > 0) {
            said.push_back(counted(marked_, "cell", "cells") + " left out, which " + std::string(kGhostArray) +
                           " marks as refined where no finer block is");
        }
        if (unmarked_ > 0) {
            said.push_back(counted(unmarked_, "cell", "cells") + " left out, which finer blocks cover and " +
                           std::string(kGhostArray) + " does not mark as refined");
        }
        for (std::size_t l = 0; l + 1 < levels; ++l) {
            if (visible_[l] == 0) continue;
            const bool halved = std::ranges::all_of(ratios_[l], [](std::int64_t r) { return (r & (r - 1)) == 0; });
            if (halved) continue;
            said.push_back("the cells of level " + std::to_string(l) + " are not halved by level " + std::to_string(l + 1) +
                           ": where they meet, the mesh stays open, also with --weld");
        }
        found_.warnings.insert(found_.warnings.begin(), said.begin(), said.end());
    }

    // Where the values of each block of a level begin.
    struct Firsts {
        std::vector<std::size_t> points, cells;
    };

    const AmrGrid& grid_;
    std::string_view file_;
    std::vector<AmrScale> ratios_, scales_;
    MeshFile found_;
    std::vector<std::vector<std::uint8_t>> hidden_;  // of each level: 1: covered, 2: left out by a mark
    std::vector<Firsts> firsts_;
    std::vector<std::size_t> visible_;
    std::vector<std::vector<const FileArray*>> arrays_;  // of each level: in the order of those of the mesh
    std::unordered_map<Vec3, Index, AmrPointHash> known_;
    std::vector<std::uint8_t> levels_;  // whose values each point has
    std::size_t covered_ = 0, ghosts_ = 0, marked_ = 0, unmarked_ = 0;
};

}  // namespace

void AmrBox::add(const AmrBox& other) {
    for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], other.low[a]);
        high[a] = std::max(high[a], other.high[a]);
    }
}

bool AmrBox::meets(const AmrBox& other) const {
    for (std::size_t a = 0; a < 3; ++a) {
        if (low[a] > other.high[a] || high[a] < other.low[a]) return false;
    }
    return true;
}

AmrBox AmrBox::common(const AmrBox& other) const {
    AmrBox both;
    for (std::size_t a = 0; a < 3; ++a) {
        both.low[a] = std::max(low[a], other.low[a]);
        both.high[a] = std::min(high[a], other.high[a]);
    }
    return both;
}

StructuredGrid AmrBox::grid() const {
    StructuredGrid grid;
    for (std::size_t a = 0; a < 3; ++a) grid.points[a] = high[a] < low[a] ? 0 : static_cast<std::size_t>(high[a] - low[a]) + 2;
    return grid;
}

void check_amr(const AmrGrid& grid, std::string_view file) {
    if (grid.levels.empty()) throw Error(ErrorCode::InvalidInput, "there is no level of refinement", std::string(file));
    if (grid.levels.size() > kMostAmrLevels) {
        throw Error(ErrorCode::InvalidInput, "there are too many levels", std::string(file),
                    "at most " + std::to_string(kMostAmrLevels));
    }
    for (const double x : grid.origin) {
        if (!std::isfinite(x)) throw Error(ErrorCode::InvalidInput, "the origin is not finite", std::string(file));
    }
    const std::vector<AmrScale> ratios = ratios_of(grid, file);
    static_cast<void>(scales_of(ratios, file));
    check_sizes(grid, file);
    std::unique_ptr<AmrBoxes> coarser;
    for (std::size_t l = 0; l < grid.levels.size(); ++l) {
        auto boxes = std::make_unique<AmrBoxes>(grid.levels[l]);
        check_overlaps(grid, l, *boxes);
        if (l > 0) check_nesting(grid, l, ratios[l - 1], *coarser);
        coarser = std::move(boxes);
    }
}

MeshFile mesh_of_amr(const AmrGrid& grid, std::string_view file) {
    return AmrMesh(grid, file).run();
}

}  // namespace subvol::detail
