// SPDX-License-Identifier: Apache-2.0
#include <ceres/ceres.h>
#include <Eigen/QR>

#include "fit_shapes.h"

namespace subvol::detail {

namespace {

struct Evaluate {
    const Residuals& function;
    std::size_t parameters, residuals;

    bool operator()(double const* const* blocks, double* to) const {
        function({blocks[0], parameters}, {to, residuals});
        return true;
    }
};

ceres::Solver::Options options() {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-14;
    options.gradient_tolerance = 1e-14;
    options.parameter_tolerance = 1e-11;
    options.logging_type = ceres::SILENT;
    options.minimizer_progress_to_stdout = false;
    return options;
}

}  // namespace

Minimum minimize_squares(std::span<const Unknown> unknowns, std::size_t residuals, const Residuals& function) {
    std::vector<double> at;
    for (const Unknown& unknown : unknowns) at.push_back(unknown.start);
    auto* cost =
        new ceres::DynamicNumericDiffCostFunction<Evaluate, ceres::CENTRAL>(new Evaluate{function, at.size(), residuals});
    cost->AddParameterBlock(static_cast<int>(at.size()));
    cost->SetNumResiduals(static_cast<int>(residuals));
    ceres::Problem problem;
    problem.AddResidualBlock(cost, nullptr, at.data());  // takes ownership of the cost function
    for (std::size_t i = 0; i < at.size(); ++i) {
        problem.SetParameterLowerBound(at.data(), static_cast<int>(i), unknowns[i].lower);
        problem.SetParameterUpperBound(at.data(), static_cast<int>(i), unknowns[i].upper);
    }
    ceres::Solver::Summary summary;
    ceres::Solve(options(), &problem, &summary);
    return {at, static_cast<int>(summary.iterations.size()) - 1, summary.termination_type == ceres::CONVERGENCE};
}

std::vector<double> linear_fit(std::span<const double> weights, std::span<const double> target,
                               std::span<const std::vector<double>> columns) {
    const auto rows = static_cast<Eigen::Index>(target.size());
    const auto count = static_cast<Eigen::Index>(columns.size());
    Eigen::MatrixXd matrix(rows, count);
    Eigen::VectorXd right(rows);
    for (Eigen::Index r = 0; r < rows; ++r) {
        const auto row = static_cast<std::size_t>(r);
        const double root = std::sqrt(weights[row]);
        right[r] = root * target[row];
        for (Eigen::Index c = 0; c < count; ++c) matrix(r, c) = root * columns[static_cast<std::size_t>(c)][row];
    }
    // By QR, not by the normal equations: Gaussians of similar widths are nearly dependent.
    const Eigen::VectorXd factors = matrix.colPivHouseholderQr().solve(right);
    return {factors.begin(), factors.end()};
}

}  // namespace subvol::detail
