// SPDX-License-Identifier: Apache-2.0
#include "subvol/detail/piece_tree.h"

#include <algorithm>
#include <cmath>

#include <glm/vector_relational.hpp>

#include "subvol/detail/limit_of_part.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr double kStartTolerance = 1e-3;  // of `tolerance_length`: Newton's method needs two or three steps from there
constexpr int kStartLevels = 4;
constexpr std::size_t kMostBytes = std::size_t{2} << 30;
constexpr std::size_t kLeafSize = 4;
constexpr std::size_t kMostCandidates = 8;
constexpr int kMostSteps = 12;
constexpr double kNearEnough = 1e-3;  // of a piece's side; the step that follows would be about its square
constexpr double kFarOutside = 0.5;   // of a piece's side

HexMesh bare(const HexMesh& mesh) {
    HexMesh copy = mesh;
    copy.attributes.clear();
    return copy;
}

LimitCells start_pieces(const HexMesh& mesh, const SchemeOptions& scheme, Progress* progress) {
    const HexMesh geometry = bare(mesh);
    LimitCellsOptions options{.position_world = kStartTolerance * std::max(tolerance_length(mesh), 1e-300),
                              .max_levels = kStartLevels,
                              .max_bytes = kMostBytes};
    for (int again = 0; again < 4; ++again) {
        LimitCells limit = find_limit_cells(geometry, {.scheme = scheme, .levels = 0, .progress = progress}, options);
        if (limit.pieces) return limit;
        options.position_world *= 8;
    }
    throw Error(ErrorCode::MissingCapability, "the pieces of the limit take more than 2 GB", "probe", "a smaller mesh");
}

}  // namespace

PieceTree::PieceTree(const HexMesh& mesh, const SchemeOptions& scheme, double reach, Progress* progress) {
    const LimitCells limit = start_pieces(mesh, scheme, progress);
    *this = PieceTree(limit.pieces, 2 * limit.position_world + 1e-6 * tolerance_length(mesh), reach);
}

PieceTree::PieceTree(std::shared_ptr<const LimitPieces> pieces, double distance, double reach)
    : pieces_(std::move(pieces)), distance_(distance), reach_(reach + distance) {
    std::vector<Vec3> centers(pieces_->cells.size());
    parallel_each(centers.size(), [&](std::size_t p) { centers[p] = pieces_->position(p, LimitPieces::kNodes / 2); });
    boxes_.resize(pieces_->cells.size());
    parallel_each(boxes_.size(), [&](std::size_t p) { boxes_[p] = box_of(p); });
    make_frames();
    tree_.emplace(centers, kLeafSize, [this](Index piece) { return boxes_[piece]; });
}

/// Returns the control points of the piece, relative to its origin: found along one axis after the other.
std::array<Vec3, PieceTree::kControls> PieceTree::controls_of(std::size_t piece) const {
    std::array<Vec3, kControls> x;
    for (std::size_t n = 0; n < x.size(); ++n) {
        const float* const node = pieces_->node(piece, n);
        x[n] = Vec3(node[0], node[1], node[2]);
    }
    for (const std::size_t stride : {1u, 3u, 9u}) {
        for (std::size_t n = 0; n < x.size(); ++n) {
            if (n / stride % 3 == 1) x[n] = 2.0 * x[n] - 0.5 * (x[n - stride] + x[n + stride]);
        }
    }
    return x;
}

/// Returns the bounds of the control points of the piece.
Box PieceTree::box_of(std::size_t piece) const {
    Box box;
    for (const Vec3& x : controls_of(piece)) box.add(x);
    return {pieces_->origins[piece] + box.lower - reach_, pieces_->origins[piece] + box.upper + reach_};
}

/// Thin pieces that lie across the axes share their boxes with many others, as the wedges around an axis of many cells do: each
/// place would be sought in hundreds of them. Those have a second bound along their own axes.
std::optional<PieceTree::Frame> PieceTree::frame_of(std::size_t piece) const {
    constexpr double kThin = 8;  // boxes that are larger than their piece by this
    const auto x = controls_of(piece);
    const Mat3 sides(x[14] - x[12], x[16] - x[10], x[22] - x[4]);  // between the middles of opposite sides
    const double volume = std::abs(glm::determinant(sides));
    const Vec3 size = boxes_[piece].size() - 2 * reach_;
    if (!(volume > 0) || size.x * size.y * size.z < kThin * volume) return std::nullopt;
    Frame frame{glm::inverse(sides), x[13], Vec3(0.0)};
    for (const Vec3& control : x) frame.half = glm::max(frame.half, glm::abs(frame.inverse * (control - frame.center)));
    const Mat3 rows = glm::transpose(frame.inverse);
    for (int d = 0; d < 3; ++d) frame.half[d] += reach_ * glm::length(rows[d]);
    frame.half *= 1 + 1e-6;
    if (!glm::all(glm::lessThan(frame.half, Vec3(1e6)))) return std::nullopt;
    frame.center += pieces_->origins[piece];
    return frame;
}

void PieceTree::make_frames() {
    frame_numbers_.assign(boxes_.size(), kNone);
    parallel_each(boxes_.size(), [&](std::size_t p) { frame_numbers_[p] = frame_of(p) ? 0 : kNone; });
    std::vector<Index> thin;
    for (Index p = 0; p < frame_numbers_.size(); ++p) {
        if (frame_numbers_[p] == kNone) continue;
        frame_numbers_[p] = static_cast<Index>(thin.size());
        thin.push_back(p);
    }
    frames_.resize(thin.size());
    parallel_each(thin.size(), [&](std::size_t i) { frames_[i] = *frame_of(thin[i]); });
}

bool PieceTree::may_contain(std::size_t piece, const Vec3& x) const {
    const Index number = frame_numbers_[piece];
    if (number == kNone) return true;
    const Frame& frame = frames_[number];
    return glm::all(glm::lessThanEqual(glm::abs(frame.inverse * (x - frame.center)), frame.half));
}

std::optional<NearPlace> PieceTree::invert(std::size_t piece, const Vec3& x) const {
    const Vec3 offset = x - pieces_->origins[piece];
    const float* const nodes = pieces_->node(piece, 0);
    const std::size_t row = pieces_->node_size;
    Vec3 t(0.5);
    for (int step = 0; step < kMostSteps; ++step) {
        const QuadraticWeights u(t.x), v(t.y), w(t.z);
        Vec3 at(0.0);
        Mat3 jacobian(0.0);
        const float* node = nodes;
        for (std::size_t k = 0; k < 3; ++k) {
            Vec3 plane(0.0), plane_u(0.0), plane_v(0.0);
            for (std::size_t j = 0; j < 3; ++j, node += 3 * row) {
                const Vec3 a(node[0], node[1], node[2]), b(node[row], node[row + 1], node[row + 2]),
                    c(node[2 * row], node[2 * row + 1], node[2 * row + 2]);
                const Vec3 line = u.values[0] * a + u.values[1] * b + u.values[2] * c;
                plane += v.values[j] * line;
                plane_u += v.values[j] * (u.slopes[0] * a + u.slopes[1] * b + u.slopes[2] * c);
                plane_v += v.slopes[j] * line;
            }
            at += w.values[k] * plane;
            jacobian[0] += w.values[k] * plane_u;
            jacobian[1] += w.values[k] * plane_v;
            jacobian[2] += w.slopes[k] * plane;
        }
        const double determinant = glm::determinant(jacobian);
        if (!(std::abs(determinant) > 0)) return std::nullopt;
        Vec3 by = glm::inverse(jacobian) * (offset - at);
        const double longest = std::max({std::abs(by.x), std::abs(by.y), std::abs(by.z)});
        if (!(longest < 1e6)) return std::nullopt;
        if (longest > 1) by /= longest;
        t = glm::clamp(t + by, Vec3(-1.0), Vec3(2.0));
        if (longest < kNearEnough) break;
    }
    const Vec3 beyond = glm::max(glm::max(-t, t - Vec3(1.0)), Vec3(0.0));
    const double excess = std::max({beyond.x, beyond.y, beyond.z});
    if (excess > kFarOutside) return std::nullopt;
    const auto& lowest = pieces_->lowest[piece];
    const double size = std::ldexp(1.0, -pieces_->levels[piece]);
    const Vec3 at = glm::clamp(t, Vec3(0.0), Vec3(1.0));
    return NearPlace{{pieces_->cells[piece], size * (Vec3(lowest[0], lowest[1], lowest[2]) + at)}, excess * size, piece, at};
}

void PieceTree::find(const Vec3& x, std::vector<NearPlace>& found) const {
    found.clear();
    struct Candidate {
        double distance;  // from the middle of its box, 0 to 1 in it
        Index piece;
        auto operator<=>(const Candidate&) const = default;
    };
    thread_local std::vector<Candidate> candidates;
    candidates.clear();
    const auto contains = [&](const Box& box) {
        return glm::all(glm::lessThanEqual(box.lower, x)) && glm::all(glm::lessThanEqual(x, box.upper));
    };
    tree_->visit_leaves(contains, [&](std::size_t first, std::size_t last) {
        for (std::size_t slot = first; slot < last; ++slot) {
            const Index piece = tree_->item(slot);
            const Box& box = boxes_[piece];
            if (!contains(box) || !may_contain(piece, x)) continue;
            const Vec3 from = glm::abs(2.0 * x - box.lower - box.upper) / (box.upper - box.lower);
            candidates.push_back({std::max({from.x, from.y, from.z}), piece});
        }
        return false;
    });
    std::ranges::sort(candidates);
    for (const Candidate& candidate : candidates) {
        if (const auto near = invert(candidate.piece, x)) found.push_back(*near);
        if (!found.empty() && found.back().excess == 0) {
            std::swap(found.front(), found.back());
            found.resize(1);
            return;
        }
    }
    std::ranges::stable_sort(found, {}, &NearPlace::excess);
    if (found.size() > kMostCandidates) found.resize(kMostCandidates);
}

LimitCells pieces_within(const HexMesh& mesh, const RefineOptions& refinement, LimitCellsOptions cells) {
    constexpr int kMostRounds = 8;  // at one level; a tolerance of 0 cannot be enlarged
    cells.max_levels = std::max(cells.max_levels, 1);
    for (int round = 1;; ++round) {
        LimitCells limit = find_limit_cells(mesh, refinement, cells);
        if (limit.pieces) return limit;
        if (cells.max_levels == 1) {  // no coarser pieces exist
            cells.max_bytes *= 2;
            continue;
        }
        // About as many times fewer pieces as the tolerance is larger.
        constexpr double kPieceBytes = LimitPieces::kNodes * 4 * sizeof(float);
        const double too_many = static_cast<double>(limit.piece_count) * kPieceBytes / static_cast<double>(cells.max_bytes);
        const double factor = std::max(2.0, too_many);
        cells.position_world *= factor;
        cells.value_of_range *= factor;
        if (cells.value_of_range > 1 || round % kMostRounds == 0) --cells.max_levels;
    }
}

}  // namespace subvol::detail
