// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Eigenvalues>

#include "fit_samples.h"
#include "fit_shapes.h"
#include "kernel_formulas.h"
#include "subvol/error.h"

namespace subvol {

using namespace detail;

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMostRounds = 500;
constexpr int kMaxTensorLevel = 6;  // 193³ values, 58 MB

/// The samples of an octant as a matrix with rows x and columns (y, z). Each entry is multiplied by the root of how many
/// samples are equal to it, so that least squares over the octant are those over all samples.
struct Octant {
    VectorXd roots;  // √1, √2, √2, …
    MatrixXd values;
};

Octant octant_of(const BasisFunction& basis) {
    if (basis.level > kMaxTensorLevel) {
        throw Error(ErrorCode::InvalidInput, "a table cannot be fitted at level " + std::to_string(basis.level), {}, "0 to 6");
    }
    const auto n = static_cast<Eigen::Index>(detail::fit_last(basis)) + 1;
    Octant octant{VectorXd::Constant(n, std::sqrt(2.0)), MatrixXd(n, n * n)};
    octant.roots[0] = 1;
    for (Eigen::Index z = 0; z < n; ++z) {
        for (Eigen::Index y = 0; y < n; ++y) {
            for (Eigen::Index x = 0; x < n; ++x) {
                const double value = basis.at(static_cast<int>(x), static_cast<int>(y), static_cast<int>(z));
                octant.values(x, y + n * z) = value * octant.roots[x] * octant.roots[y] * octant.roots[z];
            }
        }
    }
    return octant;
}

/// The symmetric tensor with two of its three axes projected onto the columns of the factors: x by rank².
MatrixXd project(const MatrixXd& values, const MatrixXd& factors) {
    const Eigen::Index n = factors.rows(), rank = factors.cols();
    const MatrixXd first = factors.transpose() * values;  // p by (y, z); by symmetry for any axis
    MatrixXd result(n, rank * rank);
    for (Eigen::Index z = 0; z < n; ++z) {
        const MatrixXd second = first.middleCols(n * z, n) * factors;  // p by q
        result.row(z) = Eigen::Map<const VectorXd>(second.data(), rank * rank);
    }
    return result;
}

/// The leading left singular vectors of a matrix.
MatrixXd leading(const MatrixXd& matrix, Eigen::Index rank) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix * matrix.transpose());
    return solver.eigenvectors().rightCols(rank).rowwise().reverse();
}

struct Decomposition {
    MatrixXd factors;  // orthonormal columns
    MatrixXd core;     // rank by rank²
    int rounds = 0;
    bool converged = false;
};

Decomposition decompose(const MatrixXd& values, Eigen::Index rank) {
    Decomposition result{leading(values, rank), {}, 0, false};
    double norm = 0;
    for (; result.rounds < kMostRounds && !result.converged; ++result.rounds) {
        const MatrixXd projected = project(values, result.factors);
        result.core = result.factors.transpose() * projected;
        result.converged = std::abs(result.core.norm() - norm) <= 1e-14 * norm;
        norm = result.core.norm();
        if (!result.converged) result.factors = leading(projected, rank);
    }
    return result;
}

std::vector<double> to_vector(const MatrixXd& matrix) {
    return {matrix.data(), matrix.data() + matrix.size()};
}

}  // namespace

TuckerFit fit_tucker(const BasisFunction& basis, int rank) {
    if (rank < 1 || rank > 16) {
        throw Error(ErrorCode::InvalidInput, "the rank is " + std::to_string(rank), {}, "1 to 16");
    }
    const Octant octant = octant_of(basis);
    if (rank > octant.roots.size()) throw Error(ErrorCode::InvalidInput, "the rank is above the number of samples");
    const Decomposition found = decompose(octant.values, rank);
    const MatrixXd factors = octant.roots.cwiseInverse().asDiagonal() * found.factors;
    const MatrixXd lines = found.core.transpose() * factors.transpose();  // (q, r) by x
    TuckerFit fit{.rank = rank, .factors = to_vector(factors), .core = to_vector(found.core), .report = {}};
    fit.report = {
        .errors = {}, .parameters = static_cast<int>(factors.size()), .iterations = found.rounds, .converged = found.converged};
    fit.report.errors = detail::wedge_errors(basis, [&](std::size_t i, std::size_t j, std::size_t k) {
        const VectorXd line = lines.col(static_cast<Eigen::Index>(i));
        const Eigen::Map<const MatrixXd> square(line.data(), rank, rank);
        return (factors.row(static_cast<Eigen::Index>(j)) * square * factors.row(static_cast<Eigen::Index>(k)).transpose())
            .value();
    });
    return fit;
}

KernelFit detail::fit_separable_gaussian(const BasisFunction& basis) {
    const std::size_t last = fit_last(basis);
    const auto residuals = [&](std::span<const double> p, std::span<double> to) {
        const Kernel kernel = SeparableGaussianKernel{.a = p[1], .b = p[2], .sigma = p[0]};
        auto formulas = formulas_of(kernel);
        std::vector<double> line;
        for (std::size_t i = 0; i <= last; ++i) {
            const double x = fit_step(basis) * static_cast<double>(i);
            line.push_back(formulas.kernel_factor(formulas.kind, formulas.parameters, x));
        }
        std::size_t entry = 0;
        each_in_wedge(last, [&](std::size_t i, std::size_t j, std::size_t k) {
            const double error = line[i] * line[j] * line[k] - basis_at(basis, i, j, k);
            to[entry++] = std::sqrt(wedge_multiplicity(i, j, k)) * error;
        });
    };
    const std::vector<Unknown> unknowns{length_from(0.6), {1, -10, 10}, {-0.5, -10, 10}};
    const Minimum minimum = minimize_squares(unknowns, wedge_size(last), residuals);
    const auto& p = minimum.parameters;
    return {SeparableGaussianKernel{.a = p[1], .b = p[2], .sigma = p[0]}, report_of(minimum, 3)};
}

KernelFit detail::fit_separable_table(const BasisFunction& basis) {
    TuckerFit tucker = fit_tucker(basis, 1);
    const double factor = std::cbrt(tucker.core[0]);
    for (double& value : tucker.factors) value *= factor;
    return {SeparableTableKernel{.radius = kFitReach, .values = tucker.factors}, tucker.report};
}

}  // namespace subvol
