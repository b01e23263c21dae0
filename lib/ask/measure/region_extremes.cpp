// SPDX-License-Identifier: Apache-2.0
// The largest value of the limit in regions of space, by branch and bound over boxes in pieces; the least one by the sign. A
// heap gives the box with the highest bound:
//
//     pieces with a bound beyond the best value → boxes, narrowed to the regions → bound lowered, places tried → two halves → …
//
// In a box the value f and the depths d_k behind the faces that cut it are polynomials. f + Σ g_k d_k with gains g_k ≥ 0 is
// nowhere below f in the regions, as d_k ≥ 0 there: its largest Bézier coefficient is a bound. The gains come from a linear
// program, f and d_k made linear at a place: it is solved by trying all corners of three planes. Its solution is the next
// place, and is tried as the best one. The box is halved along the axis along which the polynomial of the best bound bends
// most. What is left when the number of boxes is used up goes into the bound of the result.
#include "region_extremes.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <queue>

namespace subvol::detail {

namespace {

constexpr std::size_t kMostBoxes = 4096;     // that are halved
constexpr std::size_t kMostBegun = 1 << 14;  // pieces to begin with
constexpr std::size_t kMostFaces = 8;        // of a linear program: without the others it is a bound, too
constexpr std::size_t kPiecesAtOnce = 256;   // fixed, so that results do not depend on the number of threads

/// A part of a piece. bound: no value of it in the regions is larger
struct BoundedBox {
    std::size_t piece;
    PieceBox box;
    double bound;
};

/// normal·x + offset ≥ 0
struct LinearConstraint {
    Vec3 normal;
    double offset;
};

/// Where slope·x is largest in [0,1]³ behind the faces, and what moving a face by 1 would gain.
struct LinearSolution {
    Vec3 at{0.5};
    std::array<double, kMostFaces> gains{};
};

/// Tries all corners, each of which lies on three planes: there are few. One is the best if no way along its planes gains.
std::optional<LinearSolution> solve(const Vec3& slope, std::span<const LinearConstraint> faces) {
    std::array<LinearConstraint, 6 + kMostFaces> all;
    std::array<double, kMostFaces> lengths{};
    std::size_t count = 0;
    for (int a = 0; a < 3; ++a) {
        Vec3 normal(0.0);
        normal[a] = 1;
        all[count++] = {normal, 0};
        all[count++] = {-normal, 1};
    }
    for (const LinearConstraint& face : faces) {
        const double length = glm::length(face.normal);
        lengths[count - 6] = length;
        all[count++] =
            length > 0 ? LinearConstraint{face.normal / length, face.offset / length} : LinearConstraint{Vec3(0.0), 1};
    }
    constexpr double kRounding = 1e-11;
    std::optional<LinearSolution> best;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = i + 1; j < count; ++j) {
            const Vec3 ij = glm::cross(all[i].normal, all[j].normal);
            if (glm::dot(ij, ij) < kRounding) continue;
            for (std::size_t k = j + 1; k < count; ++k) {
                const double volume = glm::dot(ij, all[k].normal);
                if (std::abs(volume) < kRounding) continue;
                const Vec3 jk = glm::cross(all[j].normal, all[k].normal), ki = glm::cross(all[k].normal, all[i].normal);
                const Vec3 at = -(all[i].offset * jk + all[j].offset * ki + all[k].offset * ij) / volume;
                const bool is_inside = std::all_of(
                    all.begin(), all.begin() + static_cast<std::ptrdiff_t>(count),
                    [&](const LinearConstraint& one) { return glm::dot(one.normal, at) + one.offset >= -kRounding; });
                if (!is_inside) continue;
                // The slope and the normals times their gains sum up to 0.
                const Vec3 gains = -Vec3(glm::dot(slope, jk), glm::dot(slope, ki), glm::dot(slope, ij)) / volume;
                const bool is_best = std::min({gains.x, gains.y, gains.z}) >= -kRounding * glm::length(slope);
                if (!is_best && best && glm::dot(slope, at) <= glm::dot(slope, best->at)) continue;
                best = LinearSolution{glm::clamp(at, Vec3(0.0), Vec3(1.0)), {}};
                const std::array<std::size_t, 3> planes{i, j, k};
                for (int a = 0; a < 3; ++a) {
                    const std::size_t n = planes[static_cast<std::size_t>(a)];
                    if (n >= 6 && gains[a] > 0) best->gains[n - 6] = gains[a] / lengths[n - 6];
                }
                if (is_best) return best;
            }
        }
    }
    return best;
}

/// Works on boxes for one extreme.
class ExtremeFinder {
public:
    ExtremeFinder(const LimitPieces& pieces, std::span<const Region> regions, std::span<const Index> groups, double tolerance,
                  RegionExtreme& extreme)
        : pieces_(pieces), regions_(regions), groups_(groups), tolerance_(tolerance), extreme_(extreme) {}

    void find() {
        std::vector<BoundedBox> boxes = begin();
        const auto is_lower = [](const BoundedBox& a, const BoundedBox& b) { return a.bound < b.bound; };
        std::ranges::make_heap(boxes, is_lower);
        CutPiece piece(regions_);
        std::size_t taken = pieces_.cells.size();
        for (std::size_t halved = 0; !boxes.empty(); ++halved) {
            if (!is_open(boxes.front().bound)) break;
            if (halved == kMostBoxes) break;
            std::ranges::pop_heap(boxes, is_lower);
            const BoundedBox box = boxes.back();
            boxes.pop_back();
            if (box.piece != taken) piece.take(pieces_, box.piece);
            taken = box.piece;
            for (const BoundedBox& half : halves(piece, box)) {
                boxes.push_back(half);
                std::ranges::push_heap(boxes, is_lower);
            }
        }
        extreme_.open = std::max({left_, value(extreme_.best), boxes.empty() ? -HUGE_VAL : boxes.front().bound});
        note_slope();
    }

private:
    [[nodiscard]] double value(const LimitExtreme& one) const { return extreme_.sign * one.value; }
    [[nodiscard]] bool is_open(double bound) const { return bound > value(extreme_.best) + tolerance_; }

    [[nodiscard]] BoxPolynomial values_of(std::size_t piece) const {
        BoxPolynomial values;
        for (std::size_t n = 0; n < values.size(); ++n) {
            values[n] = extreme_.sign * pieces_.value(piece, n, extreme_.channel);
        }
        return polynomial_through(values);
    }

    /// The pieces in which there may be a better value than the best one, as boxes.
    [[nodiscard]] std::vector<BoundedBox> begin() {
        struct Found {
            std::vector<BoundedBox> boxes;
            double left = -HUGE_VAL;
        };
        const auto keep_few = [](Found& found) {
            if (found.boxes.size() <= kMostBegun) return;
            std::ranges::stable_sort(found.boxes, std::ranges::greater{}, &BoundedBox::bound);
            found.left = std::max(found.left, found.boxes[kMostBegun].bound);
            found.boxes.erase(found.boxes.begin() + kMostBegun, found.boxes.end());
        };
        Found found = tbb::parallel_deterministic_reduce(
            tbb::blocked_range<std::size_t>(0, pieces_.cells.size(), kPiecesAtOnce), Found{},
            [&](const auto& some, Found so_far) {
                CutPiece piece(regions_);
                for (std::size_t p = some.begin(); p < some.end(); ++p) {
                    if (extreme_.part && groups_[pieces_.cells[p]] != *extreme_.part) continue;
                    const double bound = std::min(std::ranges::max(values_of(p)), extreme_.limit);
                    if (!is_open(bound)) continue;
                    piece.take(pieces_, p);
                    PieceBox box;
                    if (piece.narrow(box) != CutPiece::Place::Outside) so_far.boxes.push_back({p, box, bound});
                }
                keep_few(so_far);
                return so_far;
            },
            [&](Found a, const Found& b) {
                a.boxes.insert(a.boxes.end(), b.boxes.begin(), b.boxes.end());
                a.left = std::max(a.left, b.left);
                keep_few(a);
                return a;
            });
        left_ = found.left;
        return std::move(found.boxes);
    }

    void try_place(const CutPiece& piece, const BoundedBox& box, const BoxPolynomial& values, const Vec3& in_box) {
        const double found = std::min(value_at(values, in_box), extreme_.limit);
        if (found <= value(extreme_.best)) return;
        const Vec3 at = box.box.at(in_box), place = piece.place_at(at);
        constexpr double kRounding = 1e-13;  // of the place, where it lies on a face
        const double near = kRounding * (1 + glm::length(place) + glm::length(place - pieces_.origins[box.piece]));
        if (depth(regions_, place) < -near) return;
        const auto& lowest = pieces_.lowest[box.piece];
        const Vec3 uvw = (Vec3(lowest[0], lowest[1], lowest[2]) + at) * std::ldexp(1, -pieces_.levels[box.piece]);
        extreme_.best = {extreme_.sign * found + 0.0, place, pieces_.cells[box.piece], uvw};
    }

    /// Looks for better values in a box, lowers its bound, and returns the halves that may have one.
    [[nodiscard]] std::vector<BoundedBox> halves(const CutPiece& piece, BoundedBox box) {
        if (piece.narrow(box.box) == CutPiece::Place::Outside) return {};
        const BoxPolynomial values = restricted(values_of(box.piece), box.box.lower, box.box.upper);
        box.bound = std::min(box.bound, std::ranges::max(values));
        BoxPolynomial bounding = values;
        for (std::size_t n = 0; n < 27; ++n) try_place(piece, box, values, Vec3(n % 3, n / 3 % 3, n / 9) / 2.0);
        Vec3 at(0.5);
        constexpr int kSteps = 5;
        for (int step = 0; step < kSteps && is_open(box.bound); ++step) {
            std::vector<FaceInBox> faces = piece.faces_in(box.box, at);
            if (faces.size() > kMostFaces) faces.resize(kMostFaces);
            const Vec3 slope = slope_at(values, at);
            std::vector<LinearConstraint> linear;
            for (const FaceInBox& face : faces) {
                const Vec3 normal = slope_at(face.depth, at);
                linear.push_back({normal, value_at(face.depth, at) - glm::dot(normal, at)});
            }
            const auto solution = solve(slope, linear);
            if (!solution) {
                at = Vec3(0.5);
                break;
            }
            BoxPolynomial sum = values;
            for (std::size_t f = 0; f < faces.size(); ++f) {
                for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += solution->gains[f] * faces[f].depth[n];
            }
            if (std::ranges::max(sum) < box.bound) {
                box.bound = std::ranges::max(sum);
                bounding = sum;
            }
            try_place(piece, box, values, solution->at);
            if (glm::distance(solution->at, at) == 0) break;
            at = solution->at;
        }
        if (!is_open(box.bound)) {
            left_ = std::max(left_, box.bound);
            return {};
        }
        const int axis = axis_to_halve(box.box, bounding);
        std::vector<BoundedBox> both(2, box);
        both[0].box.upper[axis] = both[1].box.lower[axis] = (box.box.lower[axis] + box.box.upper[axis]) / 2;
        std::erase_if(both, [&](const BoundedBox& half) { return half.box.upper[axis] <= half.box.lower[axis]; });
        return both;
    }

    /// The axis along which the polynomial bends most: a straight one has its largest value at a corner.
    [[nodiscard]] static int axis_to_halve(const PieceBox& box, const BoxPolynomial& f) {
        Vec3 bends(0.0);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (std::size_t n = 0; n < f.size(); ++n) {
                const std::size_t step = kCoefficientSteps[axis], other = kCoefficientSteps[(axis + 1) % 3],
                                  third = kCoefficientSteps[(axis + 2) % 3];
                double& bend = bends[static_cast<int>(axis)];
                if (n / step % 3 == 0) bend = std::max(bend, std::abs(f[n] - 2 * f[n + step] + f[n + 2 * step]));
                if (n / step % 3 == 2) continue;
                for (const std::size_t to : {other, third}) {
                    if (n / to % 3 == 2) continue;
                    bend = std::max(bend, std::abs(f[n] - f[n + step] - f[n + to] + f[n + step + to]) / 2);
                }
            }
        }
        const double most = std::max({bends.x, bends.y, bends.z});
        const Vec3 size = box.upper - box.lower;
        int best = size.y > size.x ? (size.z > size.y ? 2 : 1) : (size.z > size.x ? 2 : 0);
        constexpr double kAlike = 0.5;  // of the bends: then the longer axis
        for (int axis = 0; axis < 3; ++axis) {
            if (bends[axis] > bends[best] && bends[best] < kAlike * most) best = axis;
        }
        return best;
    }

    void note_slope() {
        const auto [first, end] = std::equal_range(pieces_.cells.begin(), pieces_.cells.end(), extreme_.best.cell);
        for (auto at = first; at != end; ++at) {
            const auto p = static_cast<std::size_t>(at - pieces_.cells.begin());
            const auto& lowest = pieces_.lowest[p];
            const Vec3 in_piece = extreme_.best.uvw * std::ldexp(1, pieces_.levels[p]) - Vec3(lowest[0], lowest[1], lowest[2]);
            if (glm::distance(in_piece, glm::clamp(in_piece, Vec3(0.0), Vec3(1.0))) > 1e-9) continue;
            CutPiece piece(regions_);
            piece.take(pieces_, p);
            const double slope = glm::length(slope_at(values_of(p), in_piece) * glm::inverse(piece.jacobian_at(in_piece)));
            if (std::isfinite(slope)) extreme_.slope = std::max(extreme_.slope, slope);
        }
    }

    const LimitPieces& pieces_;
    std::span<const Region> regions_;
    std::span<const Index> groups_;
    double tolerance_;
    RegionExtreme& extreme_;
    double left_ = -HUGE_VAL;  // the largest bound of boxes that were left
};

}  // namespace

void find_extreme(const LimitPieces& pieces, std::span<const Region> regions, std::span<const Index> groups, double tolerance,
                  RegionExtreme& extreme) {
    ExtremeFinder(pieces, regions, groups, tolerance, extreme).find();
}

}  // namespace subvol::detail
