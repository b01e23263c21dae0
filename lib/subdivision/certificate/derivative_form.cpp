// SPDX-License-Identifier: Apache-2.0
// The matrices of a derivative on one type of cells, and the proof of a bound κ of what they leave out. Symbols as in the
// header.
//
//     rules of the type ──► D_s ──► φ at the corners, by powers of D_sᵀ ──► φ at 9×9×9 nodes, by the children's values
//     reproduced polynomials, found by trying the rules ──► V, their differences, in integers
//     B: nearest to φ at the nodes; 3 B rounded to multiples of 2⁻²⁴, made exact on V by differences at a base, then
//        made as symmetric as the type is
//     W: nearest element of V, by least squares
//
// What is made for a type is kept. The proof walks down the tree of children from the cell, with the product D of the way and
// the polynomial λ restricted to the part. From the third level on a part is done if Σ|γ| + ρ κ' ≤ κ; else its children are
// visited, and the proof fails beyond the eighth level or some thousand parts. Halves that are mirror images of others are left
// out. Matrices are doubles with a bound of how far their row sums may be off, so Σ|γ| and ρ are upper bounds.
#include "derivative_form.h"

#include <Eigen/Sparse>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <vector>

#include "enclosure.h"
#include "kept.h"

namespace subvol::detail {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Exponents = std::array<int, 3>;

constexpr int kNodes = 9;  // of level 3 along an axis, for the fit

Eigen::Index index(std::size_t i) {
    return static_cast<Eigen::Index>(i);
}

std::size_t size_of(const BoxType& type, std::size_t axis) {
    return type[axis].points() - (axis == 0 ? 1 : 0);
}

std::size_t differences_of(const BoxType& type) {
    return size_of(type, 0) * size_of(type, 1) * size_of(type, 2);
}

// Calls call(number, {i, j, k}) for each entry of a window of points, or of differences along the first axis.
template <class Call>
void each_entry(const std::array<std::size_t, 3>& size, const Call& call) {
    std::size_t number = 0;
    for (std::size_t i = 0; i < size[0]; ++i) {
        for (std::size_t j = 0; j < size[1]; ++j) {
            for (std::size_t k = 0; k < size[2]; ++k) call(number++, std::array{i, j, k});
        }
    }
}

std::array<std::size_t, 3> points_along(const BoxType& type) {
    return {type[0].points(), type[1].points(), type[2].points()};
}

std::array<std::size_t, 3> differences_along(const BoxType& type) {
    return {size_of(type, 0), size_of(type, 1), size_of(type, 2)};
}

// D_s = 2 Δ' A_s Σ: points are sums of differences (Σ), and a child has steps of half the length.
std::array<MatrixXd, 8> make_steps(const BoxType& type) {
    const BoxRules rules = box_rules(type);
    const std::size_t across = type[1].points() * type[2].points();
    std::array<MatrixXd, 8> steps;
    for (std::size_t s = 0; s < 8; ++s) {
        const MatrixXd& a = rules.children[s];
        const BoxType child = child_type(type, s);
        const std::size_t across_child = child[1].points() * child[2].points();
        MatrixXd sums = MatrixXd::Zero(a.rows(), index(differences_of(type)));
        for (std::size_t d = 0; d < differences_of(type); ++d) {
            for (std::size_t p = d + across; p < window_points(type); p += across) sums.col(index(d)) += a.col(index(p));
        }
        steps[s] = 2 * (sums.bottomRows(a.rows() - index(across_child)) - sums.topRows(a.rows() - index(across_child)));
    }
    return steps;
}

const std::array<MatrixXd, 8>& steps_of(const BoxType& type) {
    static Kept<BoxType, std::array<MatrixXd, 8>> kept;
    return kept.get(type, [&] { return make_steps(type); });
}

// Polynomials are in steps from a point of the window that has two points after it, or one.
std::array<int, 3> base_of(const BoxType& type) {
    std::array<int, 3> base{};
    for (std::size_t axis = 0; axis < 3; ++axis) base[axis] = std::max(0, static_cast<int>(size_of(type, axis)) / 2 - 1);
    return base;
}

double power(double x, int exponent) {
    double result = 1;
    for (int k = 0; k < exponent; ++k) result *= x;
    return result;
}

// Whether A_s takes the values of a polynomial at the points of a window to those at the points of its children.
bool reproduces(const BoxType& type, const BoxRules& rules, const Exponents& exponents) {
    const auto values = [&](const BoxType& of_type, const std::array<double, 3>& corner, double step) {
        VectorXd all(index(window_points(of_type)));
        each_entry(points_along(of_type), [&](std::size_t number, const std::array<std::size_t, 3>& at) {
            double value = 1;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double layers = static_cast<double>(at[axis]) - of_type[axis].low;
                value *= power(corner[axis] + step * layers, exponents[axis]);
            }
            all(index(number)) = value;
        });
        return all;
    };
    const VectorXd coarse = values(type, {0, 0, 0}, 1);
    for (std::size_t s = 0; s < 8; ++s) {
        const auto half_of = [&](std::size_t bit) { return (s >> bit & 1) != 0 ? 0.5 : 0.0; };
        const std::array<double, 3> corner{half_of(2), half_of(1), half_of(0)};
        if (rules.children[s] * coarse != values(child_type(type, s), corner, 0.5)) return false;
    }
    return true;
}

// The degree up to which all polynomials stay what they are, on the window and on those of all descendants.
int reproduced_degree(const BoxType& type) {
    static Kept<BoxType, int> kept;
    return kept.get(type, [&] {
        const BoxRules rules = box_rules(type);
        int degree = 0;
        const auto all_of_degree = [&](int total) {
            for (int a = 0; a <= total; ++a) {
                for (int b = 0; a + b <= total; ++b) {
                    if (!reproduces(type, rules, {a, b, total - a - b})) return false;
                }
            }
            return true;
        };
        while (degree < 3 && all_of_degree(degree + 1)) ++degree;
        for (std::size_t s = 0; s < 8; ++s) {
            if (child_type(type, s) != type) degree = std::min(degree, reproduced_degree(child_type(type, s)));
        }
        return degree;
    });
}

// Exponents of the polynomials whose differences are a basis of V; those of lower degree come first.
std::vector<Exponents> exponents_of(const BoxType& type) {
    std::vector<Exponents> all;
    for (int total = 1; total <= reproduced_degree(type); ++total) {
        for (int a = 1; a <= total; ++a) {
            for (int b = 0; a + b <= total; ++b) all.push_back({a, b, total - a - b});
        }
    }
    return all;
}

MatrixXd kept_of(const BoxType& type, const std::vector<Exponents>& exponents) {
    const auto base = base_of(type);
    MatrixXd kept(index(differences_of(type)), index(exponents.size()));
    each_entry(differences_along(type), [&](std::size_t number, const std::array<std::size_t, 3>& at) {
        for (std::size_t m = 0; m < exponents.size(); ++m) {
            const auto from = [&](std::size_t axis) { return static_cast<double>(at[axis]) - base[axis]; };
            const auto& [a, b, c] = exponents[m];
            kept(index(number), index(m)) = (power(from(0) + 1, a) - power(from(0), a)) * power(from(1), b) * power(from(2), c);
        }
    });
    return kept;
}

// Three times the Bernstein coefficients of the derivatives of these polynomials along the first axis.
MatrixXd three_targets(const BoxType& type, const std::vector<Exponents>& exponents) {
    const auto base = base_of(type);
    const auto coefficient = [&](std::size_t axis, int exponent, int k) {
        const double from = type[axis].low - base[axis];
        return exponent == 0 ? 1.0 : exponent == 1 ? from + 0.5 * k : k == 1 ? from * (from + 1) : power(from + 0.5 * k, 2);
    };
    MatrixXd targets(27, index(exponents.size()));
    for (std::size_t m = 0; m < exponents.size(); ++m) {
        const auto& [a, b, c] = exponents[m];
        for (int k = 0; k < 27; ++k) {
            targets(k, index(m)) =
                3 * a * coefficient(0, a - 1, k / 9) * coefficient(1, b, k / 3 % 3) * coefficient(2, c, k % 3);
        }
    }
    return targets;
}

// The difference of the orders a − 1, b, c at the base, as weights of a window: it takes the m-th polynomial to a whole number
// and all before it and others of its degree to 0.
VectorXd difference_at_base(const BoxType& type, const Exponents& exponents) {
    const auto base = base_of(type);
    VectorXd weights = VectorXd::Zero(index(differences_of(type)));
    constexpr std::array<std::array<double, 3>, 3> kRows{{{1, 0, 0}, {-1, 1, 0}, {1, -2, 1}}};
    each_entry(differences_along(type), [&](std::size_t number, const std::array<std::size_t, 3>& at) {
        double weight = 1;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto order = static_cast<std::size_t>(exponents[axis] - (axis == 0 ? 1 : 0));
            const int from = static_cast<int>(at[axis]) - base[axis];
            weight *= from < 0 || from > 2 ? 0 : kRows[order][static_cast<std::size_t>(from)];
        }
        weights(index(number)) = weight;
    });
    return weights;
}

// Rounds three times a matrix to dyadic numbers that reproduce V exactly: what is lacking is added by differences at the base.
// Those of first order leave what was exact before, and so on; the sixth that a second difference needs is dyadic as 3 B is a
// multiple of three on constants.
MatrixXd exact_three(const BoxType& type, const MatrixXd& rough, const std::vector<Exponents>& exponents,
                     const MatrixXd& kept) {
    constexpr double kUnit = 1.0 / (1 << 24);
    MatrixXd three = (rough * (3 / kUnit)).array().round() * kUnit;
    const MatrixXd targets = three_targets(type, exponents);
    for (std::size_t m = 0; m < exponents.size(); ++m) {
        const VectorXd weights = difference_at_base(type, exponents[m]);
        const double unit = weights.dot(kept.col(index(m)));
        const VectorXd lacking = targets.col(index(m)) - three * kept.col(index(m));
        three += (lacking / unit) * weights.transpose();
    }
    return three;
}

// The matrix with the cell mirrored along an axis. The derivative along the first axis changes its sign, and so do differences.
MatrixXd mirrored(const MatrixXd& rows, const BoxType& type, std::size_t axis) {
    MatrixXd result(rows.rows(), rows.cols());
    const auto size = differences_along(type);
    each_entry({3, 3, 3}, [&](std::size_t k, std::array<std::size_t, 3> from_row) {
        from_row[axis] = 2 - from_row[axis];
        const std::size_t row = (from_row[0] * 3 + from_row[1]) * 3 + from_row[2];
        each_entry(size, [&](std::size_t d, std::array<std::size_t, 3> from) {
            from[axis] = size[axis] - 1 - from[axis];
            result(index(k), index(d)) = rows(index(row), index((from[0] * size[1] + from[1]) * size[2] + from[2]));
        });
    });
    return result;
}

// Exchanges the last two axes: the number of an entry, if these have `before` and `last` entries.
std::size_t exchanged(std::size_t number, std::size_t before, std::size_t last) {
    return (number / (before * last) * last + number % last) * before + number / last % before;
}

// The rows of the type with its last two axes exchanged.
MatrixXd with_exchanged_axes(const MatrixXd& rows, const BoxType& type) {
    const std::size_t n = size_of(type, 1), m = size_of(type, 2);
    MatrixXd result(rows.rows(), rows.cols());
    for (std::size_t d = 0; d < differences_of(type); ++d) {
        for (std::size_t k = 0; k < 27; ++k) {
            result(index(exchanged(k, 3, 3)), index(exchanged(d, n, m))) = rows(index(k), index(d));
        }
    }
    return result;
}

// Makes a matrix as symmetric as its type is: means of dyadic numbers are dyadic, and still reproduce V.
MatrixXd symmetric(MatrixXd rows, const BoxType& type) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        if (type[axis].low == type[axis].high) rows = (rows + mirrored(rows, type, axis)).eval() / 2;
    }
    if (type[1] == type[2]) rows = (rows + with_exchanged_axes(rows, type)).eval() / 2;
    return rows;
}

// Powers of Dᵀ have a limit, as its only eigenvalue of magnitude 1 or more is 1.
VectorXd corner_of(const BoxType& type, std::size_t corner) {
    const MatrixXd& step = steps_of(type)[corner];
    const BoxType child = child_type(type, corner);
    if (child != type) return step.transpose() * corner_of(child, corner);
    VectorXd weights = VectorXd::Constant(step.cols(), 1.0 / static_cast<double>(step.cols()));
    constexpr int kPowers = 120;
    for (int k = 0; k < kPowers; ++k) weights = step.transpose() * weights;
    return weights / weights.sum();
}

// φ at the points of a level, 2^level + 1 along each axis.
MatrixXd make_values(const BoxType& type, int level);

const MatrixXd& values_at(const BoxType& type, int level) {
    static Kept<std::pair<BoxType, int>, MatrixXd> kept;
    return kept.get({type, level}, [&] { return make_values(type, level); });
}

MatrixXd make_values(const BoxType& type, int level) {
    MatrixXd values;
    if (level == 0) {
        values.resize(8, index(differences_of(type)));
        for (std::size_t k = 0; k < 8; ++k) values.row(index(k)) = corner_of(type, k);
        return values;
    }
    const auto& steps = steps_of(type);
    const std::size_t part = (std::size_t{1} << (level - 1)) + 1, side = 2 * part - 1;
    values.resize(index(side * side * side), index(differences_of(type)));
    for (std::size_t s = 0; s < 8; ++s) {
        const BoxType child = child_type(type, s);
        const MatrixXd rows = values_at(child, level - 1) * steps[s];
        each_entry({part, part, part}, [&](std::size_t number, const std::array<std::size_t, 3>& at) {
            const std::size_t i = at[0] + (s >> 2 & 1) * (part - 1), j = at[1] + (s >> 1 & 1) * (part - 1),
                              k = at[2] + (s & 1) * (part - 1);
            values.row(index((i * side + j) * side + k)) = rows.row(index(number));
        });
    }
    return values;
}

// The Bernstein coefficients of degree 2 that are nearest to values at the nodes of an axis, the ends weighing more.
MatrixXd fit_along_axis() {
    MatrixXd basis(kNodes, 3);
    VectorXd weights(kNodes);
    constexpr double kStep = 1.0 / (kNodes - 1);
    for (int i = 0; i < kNodes; ++i) {
        const double t = i * kStep;
        basis.row(i) << (1 - t) * (1 - t), 2 * t * (1 - t), t * t;
        weights(i) = 1 / std::sqrt(std::max(t * (1 - t), kStep / 2 * (1 - kStep / 2)));
    }
    const MatrixXd weighted = weights.asDiagonal() * basis;
    return (basis.transpose() * weighted).ldlt().solve(weighted.transpose());
}

MatrixXd fitted(const BoxType& type) {
    const MatrixXd axis = fit_along_axis();
    MatrixXd all(27, kNodes * kNodes * kNodes);
    for (int k = 0; k < 27; ++k) {
        for (int n = 0; n < all.cols(); ++n) {
            all(k, n) = axis(k / 9, n / (kNodes * kNodes)) * axis(k / 3 % 3, n / kNodes % kNodes) * axis(k % 3, n % kNodes);
        }
    }
    return all * values_at(type, 3);
}

// The coefficients of the nearest element of V, places near the cell weighing more. width: of the weights, in cells; 0: all
// alike
MatrixXd nearest(const BoxType& type, const MatrixXd& kept, double width) {
    VectorXd weights(kept.rows());
    each_entry(differences_along(type), [&](std::size_t number, const std::array<std::size_t, 3>& at) {
        double square = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double x = static_cast<double>(at[axis]) + (axis == 0 ? 0.5 : 0) - type[axis].low - 0.5;
            square += x * x;
        }
        weights(index(number)) = width > 0 ? std::exp(-square / (2 * width * width)) : 1;
    });
    const MatrixXd weighted = weights.asDiagonal() * kept;
    return (kept.transpose() * weighted).ldlt().solve(weighted.transpose());
}

DerivativeForm make_form(const BoxType& type) {
    const std::vector<Exponents> exponents = exponents_of(type);
    DerivativeForm form{type, steps_of(type), {}, {}, {}, kept_of(type, exponents), {}, values_at(type, 1)};
    form.corners.resize(8, form.kept.rows());
    for (std::size_t k = 0; k < 8; ++k) form.corners.row(index(k)) = corner_of(type, k);
    form.three_bernstein = symmetric(exact_three(type, fitted(type), exponents, form.kept), type);
    form.bernstein = form.three_bernstein / 3;
    form.weights = nearest(type, form.kept, 0);  // what is largest decides, and that is far from the cell
    return form;
}

// Whether all entries are multiples of 2⁻ᵇⁱᵗˢ below a limit.
bool is_dyadic(const MatrixXd& matrix, int bits, double limit) {
    const MatrixXd scaled = matrix * std::ldexp(1.0, bits);
    return scaled == MatrixXd(scaled.array().round()) && matrix.cwiseAbs().maxCoeff() < limit;
}

// What a proof needs of a type, in which the last two axes may have any order: 3 B and V, which are exact, and W, which is as
// it is.
struct ProofForm {
    struct Step {
        Eigen::SparseMatrix<double> matrix;
        double norm = 0;
        Eigen::Index terms = 0;  // in its fullest row
    };
    MatrixXd three_bernstein, kept, weights;
    std::array<Step, 8> steps;
    double kappa = 0;
    bool exact = false;  // the steps are dyadic, and 3 B takes V to three times the derivatives
};

BoxType in_order(BoxType type) {
    if (type[1] < type[2]) std::swap(type[1], type[2]);
    return type;
}

ProofForm proof_form(const BoxType& type, const BoxType& root, double kappa) {
    const BoxType sorted = in_order(type);
    const DerivativeForm& form = derivative_form(sorted);
    ProofForm proof{
        form.three_bernstein, form.kept, {}, {}, sorted == root ? kappa : derivative_bound(sorted).value_or(HUGE_VAL)};
    const auto& steps = steps_of(type);
    constexpr int kBitsOfSteps = 10;
    proof.exact = is_exact(form);
    for (std::size_t s = 0; s < 8; ++s) {
        proof.exact = proof.exact && is_dyadic(steps[s], kBitsOfSteps, 16);
        const auto terms = (steps[s].array() != 0).rowwise().count().maxCoeff();
        proof.steps[s] = {steps[s].sparseView(), norm(steps[s]), static_cast<Eigen::Index>(terms)};
    }
    if (sorted != type) {
        proof.three_bernstein = with_exchanged_axes(form.three_bernstein, sorted);
        const std::size_t n = size_of(sorted, 1), m = size_of(sorted, 2);
        for (std::size_t d = 0; d < differences_of(type); ++d) {
            proof.kept.row(index(exchanged(d, n, m))) = form.kept.row(index(d));
        }
    }
    constexpr double kWidth = 1.8;
    proof.weights = nearest(type, proof.kept, kWidth);
    return proof;
}

// The restriction of Bernstein coefficients of degree 2 to a child, along all axes.
MatrixXd restriction(std::size_t child) {
    MatrixXd lower(3, 3), upper(3, 3);
    lower << 1, 0, 0, 0.5, 0.5, 0, 0.25, 0.5, 0.25;
    upper << 0.25, 0.5, 0.25, 0, 0.5, 0.5, 0, 0, 1;
    const auto along = [&](int axis) -> const MatrixXd& { return (child >> (2 - axis) & 1) != 0 ? upper : lower; };
    MatrixXd all(27, 27);
    for (int k = 0; k < 27; ++k) {
        for (int n = 0; n < 27; ++n) {
            all(k, n) = along(0)(k / 9, n / 9) * along(1)(k / 3 % 3, n / 3 % 3) * along(2)(k % 3, n % 3);
        }
    }
    return all;
}

class Prover {
public:
    Prover(const BoxType& root, double kappa) : root_(root), kappa_(kappa) {
        for (std::size_t s = 0; s < 8; ++s) restrictions_[s] = restriction(s);
    }

    bool run(std::size_t& parts) {
        const ProofForm& form = of(root_);
        const Eigen::Index count = form.three_bernstein.cols();
        const bool proved = visit({MatrixXd::Identity(count, count)}, {form.three_bernstein}, root_, 0);
        parts = parts_;
        return proved;
    }

private:
    const ProofForm& of(const BoxType& type) {
        const auto found = forms_.find(type);
        return found != forms_.end() ? found->second : forms_.emplace(type, proof_form(type, root_, kappa_)).first->second;
    }

    // product:    D of the way from the root
    // restricted: three times the root's polynomial on this part
    bool visit(const Enclosure& product, const Enclosure& restricted, const BoxType& type, int level) {
        constexpr int kFirstLevel = 3, kLastLevel = 8;
        constexpr std::size_t kMostParts = 8000;
        const ProofForm& form = of(type);
        if (!form.exact) return false;
        if (level >= kFirstLevel) {
            if (++parts_ > kMostParts) return false;
            const auto dense = [](const MatrixXd& by, const Enclosure& with) { return times(by, norm(by), by.cols(), with); };
            const double gamma = up(minus(dense(form.three_bernstein, product), restricted).most() / 3);
            if (gamma <= kappa_) {
                const double rho = minus(product, dense(form.kept, dense(form.weights, product))).most();
                if (rho < 1 && up(gamma + rho * form.kappa) <= kappa_) return true;
            }
            if (level == kLastLevel) return false;
        }
        for (std::size_t s = 0; s < 8; ++s) {
            if (is_mirror_image(s, level)) continue;
            const ProofForm::Step& step = form.steps[s];
            constexpr double kNormOfRestriction = 1;  // its rows are convex weights
            if (!visit(times(step.matrix, step.norm, step.terms, product),
                       times(restrictions_[s], kNormOfRestriction, restrictions_[s].cols(), restricted), child_type(type, s),
                       level + 1)) {
                return false;
            }
        }
        return true;
    }

    // The upper half of a symmetric axis is as the lower one, and of two axes of one type the first may go first.
    [[nodiscard]] bool is_mirror_image(std::size_t child, int level) const {
        const auto upper = [&](std::size_t axis) { return (child >> (2 - axis) & 1) != 0; };
        const auto symmetric = [&](std::size_t axis) { return root_[axis].low == root_[axis].high; };
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (level == 0 && symmetric(axis) && upper(axis)) return true;
        }
        return root_[1] == root_[2] && level == (symmetric(1) ? 1 : 0) && !upper(1) && upper(2);
    }

    BoxType root_;
    double kappa_;
    std::array<MatrixXd, 8> restrictions_;
    std::map<BoxType, ProofForm> forms_;
    std::size_t parts_ = 0;
};

}  // namespace

const DerivativeForm& derivative_form(const BoxType& type) {
    static Kept<BoxType, DerivativeForm> kept;
    return kept.get(type, [&] { return make_form(type); });
}

// 3 B was halved at most four times since it was a multiple of 2⁻²⁴. With 32 bits, 6 of V and 8 for the number of terms, the
// sums are exact in doubles.
bool is_exact(const DerivativeForm& form) {
    constexpr int kBits = 28;
    return is_dyadic(form.three_bernstein, kBits, 16) && is_dyadic(form.kept, 0, 64) && form.kept.rows() <= 256 &&
           form.three_bernstein * form.kept == three_targets(form.type, exponents_of(form.type));
}

bool proves(const BoxType& type, double kappa, std::size_t& parts) {
    return Prover(type, kappa).run(parts);
}

}  // namespace subvol::detail
