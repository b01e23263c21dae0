// SPDX-License-Identifier: Apache-2.0
#include "subvol/limit_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "subvol/detail/limit_place.h"
#include "subvol/detail/piece_tree.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

constexpr double kInside = 1e-3;  // of a cell's side

/// Each cell has room for a piece, and a quarter of them for more: with less, all would be looked for several times.
LimitCellsOptions default_options(const HexMesh& mesh) {
    constexpr std::size_t kPieceBytes = LimitPieces::kNodes * 4 * sizeof(float);
    return {.position_world = 3e-4 * bounds(mesh).diagonal(),
            .value_of_range = 5e-4,
            .max_levels = 3,
            .max_bytes = std::max(std::size_t{256} << 20, mesh.cells.size() * kPieceBytes / 4 * 5)};
}

}  // namespace

struct LimitField::State {
    LimitCells limit;
    PieceTree tree;
    std::array<double, 2> bounds{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};

    State(LimitCells found, const HexMesh& mesh)
        : limit(std::move(found)), tree(limit.pieces, 1e-9 * subvol::bounds(mesh).diagonal(), 0) {
        if (!mesh.attributes.front().bounds.empty()) bounds = mesh.attributes.front().bounds.front();
    }

    /// The piece that x lies in, and where.
    [[nodiscard]] std::optional<NearPlace> find(const Vec3& x) const {
        thread_local std::vector<NearPlace> found;
        tree.find(x, found);
        return !found.empty() && found.front().excess <= kInside ? std::optional(found.front()) : std::nullopt;
    }

    /// Calls add(u, v, w, n) for the 27 nodes of a piece: the indices of their weights along each axis.
    template <class Add>
    static void each_node(const Add& add) {
        std::size_t n = 0;
        for (std::size_t k = 0; k < 3; ++k) {
            for (std::size_t j = 0; j < 3; ++j) {
                for (std::size_t i = 0; i < 3; ++i) add(i, j, k, n++);
            }
        }
    }
    [[nodiscard]] double node_value(std::size_t piece, std::size_t n) const { return limit.pieces->value(piece, n, 0); }
};

LimitField::LimitField(const HexMesh& mesh, std::string_view field, const RefineOptions& refinement,
                       std::optional<LimitCellsOptions> options) {
    const HexMesh shown = with_scalar_field(mesh, field);
    state_ = std::make_unique<const State>(pieces_within(shown, refinement, options.value_or(default_options(shown))), shown);
}
LimitField::~LimitField() = default;
LimitField::LimitField(LimitField&&) noexcept = default;
LimitField& LimitField::operator=(LimitField&&) noexcept = default;

std::optional<double> LimitField::value(const Vec3& x) const {
    const auto place = state_->find(x);
    if (!place) return std::nullopt;
    const QuadraticWeights u(place->at.x), v(place->at.y), w(place->at.z);
    double sum = 0;
    State::each_node([&](std::size_t i, std::size_t j, std::size_t k, std::size_t n) {
        sum += u.values[i] * v.values[j] * w.values[k] * state_->node_value(place->piece, n);
    });
    return std::clamp(sum, state_->bounds[0], state_->bounds[1]);
}

std::optional<Vec3> LimitField::gradient(const Vec3& x) const {
    const auto place = state_->find(x);
    if (!place) return std::nullopt;
    const QuadraticWeights u(place->at.x), v(place->at.y), w(place->at.z);
    Mat3 jacobian(0.0);
    Vec3 slopes(0.0);
    State::each_node([&](std::size_t i, std::size_t j, std::size_t k, std::size_t n) {
        const Vec3 by(u.slopes[i] * v.values[j] * w.values[k], u.values[i] * v.slopes[j] * w.values[k],
                      u.values[i] * v.values[j] * w.slopes[k]);
        const Vec3 point = state_->limit.pieces->position(place->piece, n) - state_->limit.pieces->origins[place->piece];
        for (int axis = 0; axis < 3; ++axis) jacobian[axis] += by[axis] * point;
        slopes += state_->node_value(place->piece, n) * by;
    });
    return world_gradient(jacobian, slopes);
}

Box LimitField::box() const {
    return state_->tree.box();
}

const LimitCells& LimitField::limit() const {
    return state_->limit;
}

}  // namespace subvol
