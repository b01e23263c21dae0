// SPDX-License-Identifier: Apache-2.0
// The way down from a cell of a class, one place or several at a time.
//
// The rows of a neighbourhood (one row of channels for each of its points) are kept for each level in values_[level]. A step
// makes the rows of the child that has the place from those of its parent:
//
//     rows of the parent ──near──► the points that the child's jet is evaluated from: 8 corners, or up to 64 of a grid
//                        └─rest──► the other points of the child's neighbourhood, only if a place goes on from there
//
// In the regular class MCQ needs no table. Its masks refine blocks of a grid (mcq_block.h). Along one axis:
//
//     points of a level       0───1───2━━━3───4───5      the cell is 2━━━3; six points are read on each axis
//     points of the next      0─1─2═3═4─5─6              seven points: its children are 2═3 and 3═4. Child c begins at point c,
//                                                        so that it has two points before it, as its parent has
//
// and so the step repeats. A child's jet is evaluated from the same six points on each axis.
//
// All arithmetic is along the axes of the walk that gave the class its numbers; `turn` maps them to those of the control cell.
// It is applied to the place before an evaluation and to the derivatives after it, never to the points.
#include "descent_worker.h"

#include <cmath>

namespace subvol::detail {

namespace {

constexpr std::size_t kMostLevels = 24;
constexpr std::size_t kManyPlaces = 6;  // in one cell of a grid: two levels of all its children cost less than those of each
constexpr int kTargetLevels = 6, kTargetSteps = 3;           // on each of the levels that is a cubic near the place
constexpr double kNearTarget = 3e-6, kFarFromTarget = 0.25;  // steps towards a target, in parameters of the control cell
constexpr std::array<Index, 8> kFirstEight{0, 1, 2, 3, 4, 5, 6, 7};

std::array<std::size_t, 3> bits_of(std::size_t octant) {
    return {octant & 1, octant >> 1 & 1, octant >> 2};
}

std::array<std::size_t, 3> plus(const std::array<std::size_t, 3>& a, const std::array<std::size_t, 3>& b) {
    return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

}  // namespace

std::size_t walk_octant(std::uint8_t turn, std::size_t octant) {
    if (turn == kIdentityTurn) return octant;
    const auto& octants = cell_turns()[turn].octants;
    return static_cast<std::size_t>(std::find(octants.begin(), octants.end(), octant) - octants.begin());
}

DescentWorker::DescentWorker(const DescentTask& task)
    : task_(task),
      stride_(task.channels.stride()),
      settling_(task.options, task.scales, stride_, task.samples),
      jets_(task.options.scheme.kind, stride_),
      values_(kMostLevels),
      jet_(4 * stride_),
      turned_(4 * stride_),
      child_(6 * 6 * 6 * stride_) {
}

std::span<OpenPlace> DescentWorker::open(const CellPlaces& in) {
    const std::size_t size = 4 * stride_, count = in.last - in.first;
    places_.resize(count);
    if (lasts_.size() < count * size) lasts_.resize(count * size);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t query = task_.order[in.first + i];
        settling_.prefetch(query);
        places_[i] = {.query = query, .uvw = task_.queries[query].uvw, .last = &lasts_[i * size]};
    }
    return places_;
}

double* DescentWorker::values(int level, std::size_t rows) {
    auto& values = values_[static_cast<std::size_t>(level)];
    if (values.size() < rows * stride_) values.resize(rows * stride_);
    return values.data();
}

/// The jet at a place of the loaded cell, along the axes of the control cell: the parameters go along the axes of the walk, a
/// reversed axis as 1 − t, and the derivatives come back, with the opposite sign for a reversed axis.
const double* DescentWorker::jet_at(const Vec3& uvw, std::uint8_t turn, double scale) {
    if (turn == kIdentityTurn) {
        jets_.evaluate(uvw, scale, jet_.data());
        return jet_.data();
    }
    const auto& sides = cell_turns()[turn].sides;
    Vec3 turned;
    for (std::size_t a = 0; a < 3; ++a) {
        const double t = uvw[static_cast<int>(sides[2 * a] / 2)];
        turned[static_cast<int>(a)] = (sides[2 * a] & 1) != 0 ? 1 - t : t;
    }
    jets_.evaluate(turned, scale, jet_.data());
    std::copy_n(jet_.data(), stride_, turned_.data());
    for (std::size_t a = 0; a < 3; ++a) {
        const double sign = (sides[2 * a] & 1) != 0 ? -1 : 1;
        const double* from = &jet_[(1 + a) * stride_];
        double* to = &turned_[(1 + static_cast<std::size_t>(sides[2 * a] / 2)) * stride_];
        for (std::size_t c = 0; c < stride_; ++c) to[c] = sign * from[c];
    }
    return turned_.data();
}

/// A step of Newton's method towards the place's target, as far as the loaded cell goes. False if it does not move.
bool DescentWorker::step_to_target(OpenPlace& at, const double* jet, double scale) const {
    const auto row = [&](std::size_t r) { return Vec3(jet[r * stride_], jet[r * stride_ + 1], jet[r * stride_ + 2]); };
    const Vec3 offset = task_.targets[at.query] - row(0), du = row(1), dv = row(2), dw = row(3);
    // Cramer's rule for (du dv dw) step = offset: the determinant is the volume of the cell in world space.
    const Vec3 normal = glm::cross(dv, dw);
    const double determinant = glm::dot(du, normal);
    const Vec3 step =
        scale / determinant *
        Vec3(glm::dot(normal, offset), glm::dot(glm::cross(dw, du), offset), glm::dot(glm::cross(du, dv), offset));
    const double longest = std::max({std::abs(step.x), std::abs(step.y), std::abs(step.z)}) / scale;
    // Too short to matter, or so long that the cubic near the place says nothing about the target; NaN fails, too.
    if (!(longest > kNearTarget && longest < kFarFromTarget)) return false;
    const Vec3 to = glm::clamp(at.uvw + step, Vec3(0.0), Vec3(1.0)), by = (to - at.uvw) / scale;
    at.uvw = to;
    at.moved += by;
    if (scale == 1) return true;
    for (std::size_t c = 0; c < stride_; ++c) {  // the jet before, where the place is now
        for (std::size_t d = 0; d < 3; ++d) at.last[c] += at.last[(1 + d) * stride_ + c] * by[static_cast<int>(d)];
    }
    return true;
}

void DescentWorker::approach(std::span<OpenPlace> places, std::uint8_t turn, int level) {
    if (task_.targets.empty()) return;
    const double scale = std::ldexp(1.0, level);
    for (OpenPlace& at : places) {
        for (int step = 0; step < kTargetSteps && step_to_target(at, jet_at(at.uvw, turn, scale), scale); ++step) {
        }
    }
}

std::span<OpenPlace> DescentWorker::evaluate(std::span<OpenPlace> places, std::uint8_t turn, int level, bool on_grid) {
    settling_.report().deepest_level = std::max(settling_.report().deepest_level, level);
    const bool exact = task_.options.scheme.kind == Scheme::Linear || (on_grid && task_.is_spline());
    const double scale = std::ldexp(1.0, level);
    if (on_grid && level >= 1 && level <= kTargetLevels) approach(places, turn, level);
    std::size_t kept = 0;
    for (OpenPlace& at : places) {
        const double* jet = jet_at(at.uvw, turn, scale);
        if (settling_.settle(at, jet, level, on_grid, exact)) {
            if (!task_.targets.empty()) task_.moved[at.query] = at.moved;
            continue;
        }
        if (&places[kept] != &at) places[kept] = at;
        ++kept;
    }
    return places.first(kept);
}

void DescentWorker::leave(std::span<const OpenPlace> places, int level) {
    for (const OpenPlace& at : places) left_.push_back({at.query, level});
}

void DescentWorker::begin(const DescentClass& is, std::uint8_t turn, int level, std::span<OpenPlace> places,
                          ClassGraph& classes) {
    const double* rows = values_[static_cast<std::size_t>(level)].data();
    const bool is_regular = level == 0 && &is == &classes.regular();
    // There levels 1 and 2 decide, as the descendants of the cell are on a grid too.
    if (is_regular && task_.targets.empty()) return descend(is, turn, level, places, classes);
    load(is, rows);
    if (is_regular) approach(places, turn, level);
    places = evaluate(places, turn, level, is.on_grid);
    if (!places.empty()) descend(is, turn, level, places, classes);
}

void DescentWorker::load(const DescentClass& is, const double* rows) {
    is.on_grid ? jets_.load_grid(rows, is.grid) : jets_.load_corners(rows, kFirstEight);
}

/// One level down in a class. Only the points that a place is evaluated from are computed at first; the rest of the child's
/// neighbourhood follows if a place is still open there.
void DescentWorker::descend(const DescentClass& is, std::uint8_t turn, int level, std::span<OpenPlace> places,
                            ClassGraph& classes) {
    const double* from = values_[static_cast<std::size_t>(level)].data();
    if (&is == &classes.regular() && task_.options.scheme.kind == Scheme::Mcq) {
        return descend_grid({from, 6, stride_}, turn, level, places);
    }
    const ClassChildren& of_class = classes.children(is);
    each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
        const ClassChildren::Child& child = of_class.children[walk_octant(turn, octant)];
        if (child.to == nullptr) return leave(inside, level + 1);
        double* to = values(level + 1, child.to->point_count());
        child.near.apply(stride_, from, to);
        load(*child.to, to);
        const std::uint8_t child_turn = composed(child.turn, turn);
        inside = evaluate(inside, child_turn, level + 1, child.to->on_grid);
        if (inside.empty()) return;
        child.rest.apply(stride_, from, to);
        descend(*child.to, child_turn, level + 1, inside, classes);
    });
}

/// Below a cell in the middle of a grid, by the masks of MCQ. about: begins two points before the cell
void DescentWorker::descend_grid(const GridRows& about, std::uint8_t turn, int level, std::span<OpenPlace> places) {
    if (places.size() >= kManyPlaces) return descend_twice(about, turn, level, places);
    const double tension = task_.options.scheme.tension;
    GridRows block{};  // of all children, once a place goes on from one of them
    each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
        const std::size_t in_grid = walk_octant(turn, octant);
        refine_mcq_child(tension, about, in_grid, child_.data());
        jets_.load_block({child_.data(), 6, stride_});
        inside = evaluate(inside, turn, level + 1, true);
        if (inside.empty()) return;
        if (block.rows == nullptr) {
            double* to = values(level + 1, 7 * 7 * 7);
            refine_mcq_cell(tension, about, to);
            block = {to, 7, stride_};
        }
        descend_grid(block.from(bits_of(in_grid)), turn, level + 1, inside);
    });
}

/// The same, with two levels of all descendants at once: 7³ and 9³ points by two passes over contiguous blocks cost less than
/// those around the descendants of six places one after the other.
void DescentWorker::descend_twice(const GridRows& about, std::uint8_t turn, int level, std::span<OpenPlace> places) {
    const double tension = task_.options.scheme.tension;
    const GridRows first{values(level + 1, 7 * 7 * 7), 7, stride_}, second{values(level + 2, 9 * 9 * 9), 9, stride_};
    refine_mcq_cell(tension, about, values(level + 1, 0));
    refine_mcq_cells(tension, first, values(level + 2, 0));
    each_octant(places, [&](std::size_t octant, std::span<OpenPlace> inside) {
        const auto child = bits_of(walk_octant(turn, octant));
        jets_.load_block(first.from(child));
        inside = evaluate(inside, turn, level + 1, true);
        each_octant(inside, [&](std::size_t next, std::span<OpenPlace> deeper) {
            const auto at = plus(plus(child, child), bits_of(walk_octant(turn, next)));
            jets_.load_block(second.from(at));
            deeper = evaluate(deeper, turn, level + 2, true);
            if (!deeper.empty()) descend_grid(second.from(at), turn, level + 2, deeper);
        });
    });
}

}  // namespace subvol::detail
