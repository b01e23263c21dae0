// SPDX-License-Identifier: Apache-2.0
#include "piece_cutter.h"

#include <algorithm>
#include <cmath>

#include "subvol/cell.h"

namespace subvol::detail {

namespace {

constexpr double kLeft = 0.25;  // the next step is this part of the last one, where the field is smooth
constexpr std::size_t kPieceNodes = 27;

/// The steps of a child's nodes, in a block of five nodes along each axis.
Step largest_in(std::size_t child, const std::vector<Step>& steps) {
    const auto& at = kCornerParameters[child];
    Step most;
    for (int w = 0; w < 3; ++w) {
        for (int v = 0; v < 3; ++v) {
            for (int u = 0; u < 3; ++u) {
                const int n = u + 2 * at[0] + 5 * (v + 2 * at[1] + 5 * (w + 2 * at[2]));
                most = larger(most, steps[static_cast<std::size_t>(n)]);
            }
        }
    }
    return most;
}

Step quarter(const Step& step) {
    return {kLeft * step.position, kLeft * step.value};
}

}  // namespace

void PieceList::truncate(std::size_t pieces) {
    if (pieces == size()) return;
    if (has_nodes) {
        nodes.resize(nodes.size() / size() * pieces);
        origins.resize(pieces);
    }
    cells.resize(pieces);
    levels.resize(pieces);
    lowest.resize(pieces);
    left.resize(pieces);
    trilinear.resize(pieces);
}

void PieceList::drop_nodes() {
    has_nodes = false;
    origins = {};
    nodes = {};
}

PieceCutter::PieceCutter(std::vector<double> scales, const LimitCellsOptions& options)
    : scales_(std::move(scales)), position_(options.position_world), value_(options.value_of_range) {
}

bool PieceCutter::is_near(const Step& left) const {
    return left.position <= position_ && left.value <= value_;
}

void PieceCutter::gather(const DenseCell& grid, const Part& part, std::size_t side) {
    nodes_.gather(grid, part.first, part.width / (side - 1), side);
}

void PieceCutter::add(const DenseCell& grid, const Part& part, const Step& left, PieceList& list) {
    gather(grid, part, 3);
    add_gathered(grid, part, left, nodes_.largest_step(Prediction::Trilinear, scales_).position, list);
}

void PieceCutter::add_gathered(const DenseCell& grid, const Part& part, const Step& left, double step, PieceList& list) {
    list.cells.push_back(grid.cell);
    list.levels.push_back(static_cast<std::uint8_t>(part.level));
    list.lowest.push_back(part.lowest);
    list.left.push_back(left);
    list.trilinear.push_back(static_cast<float>(std::max(0.0, part.level + levels_between(position_, step))));
    if (!list.has_nodes) return;
    list.origins.push_back(nodes_.origin());
    const std::size_t count = kPieceNodes * nodes_.channels(), first = list.nodes.size();
    list.nodes.resize(first + count);
    std::transform(nodes_.node(0), nodes_.node(0) + count, &list.nodes[first], [](double x) { return static_cast<float>(x); });
}

bool PieceCutter::cut_cell(const DenseCell& grid, bool last, PieceList& list) {
    const Part whole{.level = 0, .lowest = {}, .first = {}, .width = 2};
    gather(grid, whole, 3);
    const Step step = nodes_.largest_step(Prediction::Trilinear, scales_);
    if (!last && !is_near(quarter(step))) return false;
    add_gathered(grid, whole, quarter(step), step.position, list);
    return true;
}

std::uint8_t PieceCutter::cut(const DenseCell& grid, int level, const std::array<std::uint8_t, 3>& lowest, bool last,
                              PieceList& list) {
    return cut_part(grid, {.level = level, .lowest = lowest, .first = {}, .width = grid.side - 1}, {HUGE_VAL, HUGE_VAL}, last,
                    list);
}

std::uint8_t PieceCutter::cut_part(const DenseCell& grid, const Part& part, Step left, bool last, PieceList& list) {
    if (part.width < 4) {
        if (last) add(grid, part, left, list);
        return last ? 0 : 0xff;
    }
    gather(grid, part, 5);
    std::vector<Step> steps;
    nodes_.steps(Prediction::Triquadratic, scales_, steps);
    Step most;
    for (const Step& step : steps) most = larger(most, step);
    left = smaller(left, most);
    if (is_near(left)) {
        add(grid, part, left, list);
        return 0;
    }
    std::uint8_t open = 0;
    for (std::size_t child = 0; child < 8; ++child) {
        Part of_child{.level = part.level + 1, .lowest = {}, .first = {}, .width = part.width / 2};
        for (std::size_t d = 0; d < 3; ++d) {
            const bool upper = kCornerParameters[child][d] == 1;
            of_child.first[d] = part.first[d] + (upper ? of_child.width : 0);
            of_child.lowest[d] = static_cast<std::uint8_t>(2 * part.lowest[d] + (upper ? 1 : 0));
        }
        gather(grid, of_child, 3);
        const Step of_next = quarter(smaller(largest_in(child, steps), nodes_.largest_step(Prediction::Trilinear, scales_)));
        if (is_near(of_next)) {
            add(grid, of_child, of_next, list);
        } else if (cut_part(grid, of_child, of_next, last, list) != 0) {
            open |= static_cast<std::uint8_t>(1U << child);
        }
    }
    return open;
}

}  // namespace subvol::detail
