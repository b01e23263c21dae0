// SPDX-License-Identifier: Apache-2.0
// Which part of a piece of the limit lies in regions of space. The position in a piece is a polynomial of degree 2 in each of
// u, v and w, with 27 Bézier coefficients, and so is the depth behind a plane. As it lies between its coefficients, a box is
// inside if none is negative; the quadratic of the largest coefficients at each step along an axis is never less, so what lies
// beyond its roots is outside. The box shrinks along all axes, again and again, while that gains enough. A sphere stands for
// planes that touch it: their depths are never less than its own, and nothing that is inside is cut off.
//
//     box → narrowed → outside, inside or cut → points and weights of Gauss in what is left
//
// Integrals over a cut box go axis by axis; the inner one is that which crosses the faces most directly. Each interval is
// broken where faces cross it, with three points of Gauss between two breaks. Of the inner parts, only those in the regions
// count.
#include "cut_piece.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace subvol::detail {

namespace {

/// The part of [0,1] outside of which a quadratic with these Bézier coefficients is negative; none if it is everywhere.
std::optional<std::array<double, 2>> where_not_negative(const std::array<double, 3>& b) {
    if (b[0] < 0 && b[1] < 0 && b[2] < 0) return std::nullopt;
    if (b[0] >= 0 && b[2] >= 0) return std::array{0.0, 1.0};
    std::vector<double> roots;
    add_roots(b, roots);
    if (roots.empty()) {  // it is at an end
        if (b[0] < 0 && b[2] < 0) return std::nullopt;
        return b[0] < 0 ? std::array{1.0, 1.0} : std::array{0.0, 0.0};
    }
    return std::array{b[0] < 0 ? roots.front() : 0.0, b[2] < 0 ? roots.back() : 1.0};
}

/// The largest coefficients at each of the three steps along an axis: of a quadratic that is never less than the polynomial.
std::array<double, 3> largest_along(const BoxPolynomial& f, std::size_t axis) {
    std::array<double, 3> largest{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
    for (std::size_t n = 0; n < f.size(); ++n) {
        double& one = largest[n / kCoefficientSteps[axis] % 3];
        one = std::max(one, f[n]);
    }
    return largest;
}

Vec3 control_point(const std::array<BoxPolynomial, 3>& position, std::size_t n) {
    return {position[0][n], position[1][n], position[2][n]};
}

}  // namespace

void CutPiece::take(const LimitPieces& pieces, std::size_t piece) {
    origin_ = pieces.origins[piece];
    for (std::size_t axis = 0; axis < 3; ++axis) {
        BoxPolynomial values;
        for (std::size_t n = 0; n < values.size(); ++n) values[n] = static_cast<double>(pieces.node(piece, n)[axis]);
        position_[axis] = polynomial_through(values);
    }
}

Vec3 CutPiece::place_at(const Vec3& at) const {
    return origin_ + Vec3(value_at(position_[0], at), value_at(position_[1], at), value_at(position_[2], at));
}

Mat3 CutPiece::jacobian_at(const Vec3& at) const {
    Mat3 rows;
    for (std::size_t axis = 0; axis < 3; ++axis) rows[static_cast<int>(axis)] = slope_at(position_[axis], at);
    return glm::transpose(rows);
}

std::array<BoxPolynomial, 3> CutPiece::position_in(const PieceBox& box) const {
    std::array<BoxPolynomial, 3> position;
    for (std::size_t axis = 0; axis < 3; ++axis) position[axis] = restricted(position_[axis], box.lower, box.upper);
    return position;
}

/// The depth behind a plane is linear in the place, so that its coefficients are the depths of those of the position.
BoxPolynomial CutPiece::depth_in(const std::array<BoxPolynomial, 3>& position, const Region& region, std::size_t face) const {
    BoxPolynomial depth;
    for (std::size_t n = 0; n < depth.size(); ++n) depth[n] = region.depth(origin_ + control_point(position, n), face);
    return depth;
}

CutPiece::Place CutPiece::narrow(PieceBox& box) const {
    constexpr int kRounds = 8;
    constexpr double kWorth = 0.8;         // a part that is not shorter than this gains nothing
    constexpr double kLeastWidth = 1e-13;  // in parameters: only roundings are left
    constexpr double kRounding = 1e-14;    // of the roots
    for (int round = 0; round < kRounds; ++round) {
        const std::array<BoxPolynomial, 3> position = position_in(box);
        bool is_inside = true;
        Vec3 lower(0.0), upper(1.0);
        const auto cut = [&](const BoxPolynomial& depth) {
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const auto part = where_not_negative(largest_along(depth, axis));
                if (!part) return false;
                const int a = static_cast<int>(axis);
                lower[a] = std::max(lower[a], (*part)[0] - kRounding);
                upper[a] = std::min(upper[a], (*part)[1] + kRounding);
            }
            return true;
        };
        for (const Region& region : regions_) {
            if (region.kind() == Region::Kind::Sphere) {
                const Vec3 from = origin_ - region.point();
                Vec3 middle(0.0);
                bool is_in_sphere = true;
                for (std::size_t n = 0; n < 27; ++n) {
                    const Vec3 x = from + control_point(position, n);
                    middle += x;
                    is_in_sphere = is_in_sphere && glm::length(x) <= region.radius();  // the ball is convex
                }
                if (is_in_sphere) continue;
                is_inside = false;
                // The planes around the sphere that touch it at its six poles and where the box is.
                std::array<Vec3, 7> normals{Vec3(1, 0, 0), Vec3(-1, 0, 0), Vec3(0, 1, 0), Vec3(0, -1, 0),
                                            Vec3(0, 0, 1), Vec3(0, 0, -1), middle};
                const double length = glm::length(middle);
                normals[6] = length > 0 ? middle / length : normals[0];
                for (const Vec3& normal : normals) {
                    BoxPolynomial depth;
                    for (std::size_t n = 0; n < depth.size(); ++n) {
                        depth[n] = region.radius() - glm::dot(normal, from + control_point(position, n));
                    }
                    if (!cut(depth)) return Place::Outside;
                }
                continue;
            }
            for (std::size_t face = 0; face < region.faces(); ++face) {
                const BoxPolynomial depth = depth_in(position, region, face);
                if (std::ranges::min(depth) >= 0) continue;
                is_inside = false;
                if (!cut(depth)) return Place::Outside;
            }
        }
        if (is_inside) return Place::Inside;
        bool is_worth = false;
        for (int a = 0; a < 3; ++a) {
            if (upper[a] < lower[a]) return Place::Outside;
            is_worth = is_worth || upper[a] - lower[a] < kWorth;
        }
        box = {box.at(glm::max(lower, Vec3(0.0))), box.at(glm::min(upper, Vec3(1.0)))};
        for (int a = 0; a < 3; ++a) {
            if (box.upper[a] - box.lower[a] < kLeastWidth) return Place::Outside;
        }
        if (!is_worth) break;
    }
    return Place::Cut;
}

std::vector<FaceInBox> CutPiece::faces_in(const PieceBox& box, const Vec3& touching) const {
    std::vector<FaceInBox> faces;
    const std::array<BoxPolynomial, 3> position = position_in(box);
    for (const Region& region : regions_) {
        if (region.kind() != Region::Kind::Sphere) {
            for (std::size_t face = 0; face < region.faces(); ++face) {
                const BoxPolynomial depth = depth_in(position, region, face);
                if (std::ranges::min(depth) < 0) faces.push_back({depth, nullptr});
            }
            continue;
        }
        const Vec3 from = origin_ - region.point(), away = place_at(box.at(touching)) - region.point();
        const double length = glm::length(away);
        const Vec3 normal = length > 0 ? away / length : Vec3(1, 0, 0);
        BoxPolynomial depth;
        double furthest = 0;
        for (std::size_t n = 0; n < depth.size(); ++n) {
            const Vec3 x = from + control_point(position, n);
            furthest = std::max(furthest, glm::length(x));
            depth[n] = region.radius() - glm::dot(normal, x);
        }
        if (furthest > region.radius()) faces.push_back({depth, &region});
    }
    return faces;
}

/// What lines along the axes of a box meet.
struct CutPiece::Lines {
    const CutPiece& piece;
    PieceBox box;
    std::array<BoxPolynomial, 3> position;
    std::vector<FaceInBox> faces;

    /// The ends and where faces cross a line.
    void add_breaks(int axis, const Vec3& at, std::vector<double>& breaks) const {
        for (const FaceInBox& face : faces) {
            if (face.sphere == nullptr) {
                add_roots(on_line(face.depth, axis, at), breaks);
                continue;
            }
            std::array<double, 5> inside;
            inside.fill(face.sphere->radius() * face.sphere->radius());
            for (int a = 0; a < 3; ++a) {
                std::array<double, 3> x = on_line(position[static_cast<std::size_t>(a)], axis, at);
                for (double& one : x) one += piece.origin_[a] - face.sphere->point()[a];
                const std::array<double, 5> square = product(x, x);
                for (std::size_t k = 0; k < square.size(); ++k) inside[k] -= square[k];
            }
            add_roots(inside, breaks);
        }
    }

    /// Calls call(place, weight) for three points of Gauss between each two breaks.
    template <class Call>
    static void each_point(std::vector<double>& breaks, const Call& call) {
        breaks.push_back(1);
        std::ranges::sort(breaks);
        double from = 0;
        for (const double to : breaks) {
            if (to > from) call(from, to);
            from = to;
        }
    }
};

double CutPiece::add_nodes(const PieceBox& box, std::vector<PieceNode>& nodes) const {
    static const std::array<double, 3> places{0.5 - std::sqrt(3.0 / 20), 0.5, 0.5 + std::sqrt(3.0 / 20)};
    constexpr std::array<double, 3> weights{5.0 / 18, 8.0 / 18, 5.0 / 18};
    const Lines lines{*this, box, position_in(box), faces_in(box, Vec3(0.5))};
    // Lines go along the axis that crosses the faces most directly, planes along that and the next one.
    Vec3 across(0.0);
    for (const FaceInBox& face : lines.faces) {
        const Vec3 slope = slope_at(face.depth, Vec3(0.5));
        const double length = glm::length(slope);
        if (length > 0) across += glm::abs(slope) / length;
    }
    std::array<int, 3> axes{0, 1, 2};
    std::ranges::stable_sort(axes, std::ranges::greater{}, [&](int axis) { return across[axis]; });
    const int in = axes[0], mid = axes[1], out = axes[2];
    std::vector<double> of_outer, of_middle, of_inner;
    const auto each_point = [&](std::vector<double>& breaks, const auto& call) {
        Lines::each_point(breaks, [&](double from, double to) {
            for (std::size_t k = 0; k < 3; ++k) call(from + places[k] * (to - from), weights[k] * (to - from));
        });
    };
    Vec3 at(0.0);
    for (const double u : {0.0, 1.0}) {
        for (const double v : {0.0, 1.0}) {
            at[in] = u;
            at[mid] = v;
            lines.add_breaks(out, at, of_outer);
        }
    }
    double met = 0;
    const double volume = box.volume();
    each_point(of_outer, [&](double w, double of_w) {
        at[out] = w;
        of_middle.clear();
        for (const double u : {0.0, 1.0}) {
            at[in] = u;
            lines.add_breaks(mid, at, of_middle);
        }
        each_point(of_middle, [&](double v, double of_v) {
            at[mid] = v;
            of_inner.clear();
            lines.add_breaks(in, at, of_inner);
            bool meets = false;
            Lines::each_point(of_inner, [&](double from, double to) {
                at[in] = (from + to) / 2;
                if (depth_at(box.at(at)) < 0) return;
                meets = true;
                for (std::size_t k = 0; k < 3; ++k) {
                    at[in] = from + places[k] * (to - from);
                    nodes.push_back({box.at(at), volume * of_w * of_v * weights[k] * (to - from)});
                }
            });
            if (meets) met += of_w * of_v;
        });
    });
    return met;
}

}  // namespace subvol::detail
