// SPDX-License-Identifier: Apache-2.0
#include "edge_modes.h"

#include <cmath>
#include <complex>
#include <numbers>

namespace subvol::detail {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Row = Eigen::Index;

/// Vectors of a frequency: with ω = exp(2πi frequency / m), points (s, i, 0) have ω^s times a real number, points (s, i, i)
/// ω^(s + 1/2) times one, (s, 2, 1) and (s, 1, 2) have ω^s c and ω^(s + 1) c̄.
class Frequency {
public:
    static constexpr Row kUnknowns = 6;  // of (1, 0), (2, 0), (1, 1), (2, 2), and the parts of c
    using Numbers = Eigen::Matrix<double, kUnknowns, 1>;

    Frequency(const WindowPlan& plan, int frequency)
        : plan_(plan), turn_(2 * std::numbers::pi * frequency / static_cast<double>(plan.star().cells)) {}

    // The vector with these numbers on a layer.
    [[nodiscard]] Eigen::VectorXcd spread(const Numbers& x) const {
        Eigen::VectorXcd z = Eigen::VectorXcd::Zero(plan_.across());
        plan_.each([&](Row p, std::size_t s, int i, int j) {
            const auto at = static_cast<double>(s);
            if (i > 0 && j == 0) z(p) = x(i - 1) * turned(at);
            if (i > 0 && j == i) z(p) = x(1 + i) * turned(at + 0.5);
            if (i == 2 && j == 1) z(p) = std::complex(x(4), x(5)) * turned(at);
            if (i == 1 && j == 2) z(p) = std::complex(x(4), -x(5)) * turned(at + 1);
        });
        return z;
    }

    // The numbers of the real part of such a vector.
    [[nodiscard]] Numbers read(const VectorXd& x) const {
        const auto at = [&](std::size_t s, int i, int j) { return x(plan_.number(s, i, j)); };
        const double c = at(0, 2, 1);
        Numbers numbers;
        numbers << at(0, 1, 0), at(0, 2, 0), at(0, 1, 1) / std::cos(turn_ / 2), at(0, 2, 2) / std::cos(turn_ / 2), c,
            (c * std::cos(turn_) - at(1, 2, 1)) / std::sin(turn_);
        return numbers;
    }

private:
    [[nodiscard]] std::complex<double> turned(double sectors) const { return std::polar(1.0, sectors * turn_); }

    const WindowPlan& plan_;
    double turn_;
};

}  // namespace

// For y near the solution and X near the inverse of F' at y, F the equations and |F''| ≤ 2, a solution is within r of y if
// |X F(y)| + |1 − X F'(y)| r + |X| r² ≤ r.
std::optional<EdgeMode> edge_mode(const EdgeRules& rules, const WindowPlan& plan, int frequency) {
    const Frequency vectors(plan, frequency);
    const Row n = plan.across();
    MatrixXd layer = MatrixXd::Zero(n, n);
    for (Row l = 0; l < 4; ++l) layer += rules.halves[0].block(n, l * n, n, n);
    Eigen::Matrix<double, 6, 6> step;
    for (Row k = 0; k < 6; ++k) step.col(k) = vectors.read(layer * vectors.spread(Frequency::Numbers::Unit(k)).real());
    constexpr double kOfSteps = 0x1p-45;  // row sums of `step`: some 27 products in a row, and what `read` divides by
    Frequency::Numbers x = vectors.read(vectors.spread((Frequency::Numbers() << 1, 2, 1, 2, 2, 1).finished()).real());
    constexpr int kPowers = 100, kCorrections = 4;
    for (int k = 0; k < kPowers; ++k) {
        x = step * x;
        x /= x(0);
    }
    double rate = (step * x)(0);
    using Square = Eigen::Matrix<double, 6, 6>;
    const auto slope = [&] {
        Square f = step - rate * Square::Identity();
        f.col(0) = -x;  // the unknown in place of the first number is the rate
        return f;
    };
    for (int k = 0; k < kCorrections; ++k) {
        const Frequency::Numbers change = slope().fullPivLu().solve(Frequency::Numbers(rate * x - step * x));
        rate += change(0);
        x.tail<5>() += change.tail<5>();
    }
    const auto most = [](const auto& matrix) { return matrix.cwiseAbs().rowwise().sum().maxCoeff(); };
    const Square f = slope(), inverse = f.fullPivLu().inverse();
    const double size = most(inverse), largest = x.cwiseAbs().maxCoeff();
    const double residual = size * (most(Frequency::Numbers(step * x - rate * x)) + 2 * kOfSteps * largest);
    const double slack = most(Square(Square::Identity() - inverse * f)) + 2 * size * kOfSteps;
    const double radius = 2 * residual;
    if (!(residual + slack * radius + size * radius * radius <= 0.99 * radius) || !(radius < 1e-10) || !(rate < 0.7)) {
        return std::nullopt;
    }
    return EdgeMode{rate, 2 * radius + 0x1p-48 * largest, vectors.spread(x)};
}

MatrixXd EdgeMode::values() const {
    const Row n = layer.size(), layers = static_cast<Row>(EdgeWindow::kLayers);
    MatrixXd all(layers * n, 2);
    for (Row l = 0; l < layers; ++l) all.middleRows(l * n, n) << layer.real(), layer.imag();
    return all;
}

}  // namespace subvol::detail
