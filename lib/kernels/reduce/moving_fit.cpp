// SPDX-License-Identifier: Apache-2.0
#include <ceres/ceres.h>

#include <algorithm>
#include <cmath>

#include "field_fit.h"
#include "kernel_weight.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/error.h"
#include "subvol/rbf_field.h"

namespace subvol::detail {
namespace {

// A kernel's unknowns: its 5 terms, its shift in its frame (in units of its reach), and the logarithm of its growth.
constexpr int kUnknowns = 9;
using Unknowns = std::array<double, kUnknowns>;

constexpr double kMargin = 1.15;          // a sample sees the kernels that reach it after growing by this factor
constexpr double kShape = 0.1;            // the ridge of shifts and growths, of that of terms
constexpr int kMostCholesky = 200;        // with more kernels the factors fill up and conjugate gradients are faster
constexpr std::size_t kBlockBytes = 180;  // of one kernel at one sample: 9 derivatives, and the lists of Ceres and ours

struct Neighbour {
    Index kernel;
    Vec3 place;  // A (x − center), before any move
};

/// √weight · (field − sample), with its derivatives by the unknowns of all kernels about the sample.
template <class Weight>
class SampleCost : public ceres::CostFunction {
public:
    SampleCost(std::vector<Neighbour> row, double value, double factor, Weight weight)
        : row_(std::move(row)), value_(value), factor_(factor), weight_(weight) {
        set_num_residuals(1);
        mutable_parameter_block_sizes()->assign(row_.size(), kUnknowns);
    }

    bool Evaluate(const double* const* unknowns, double* residual, double** jacobians) const override {
        double sum = 0, weighted = 0;
        for (std::size_t k = 0; k < row_.size(); ++k) {
            const Term t = term(k, unknowns[k]);
            sum += t.w;
            weighted += t.w * t.v;
        }
        if (!(sum > kLeastWeight)) return false;  // a hole: Ceres rejects the step
        const double f = weighted / sum;
        residual[0] = factor_ * (f - value_);
        if (!jacobians) return true;
        for (std::size_t k = 0; k < row_.size(); ++k) {
            if (jacobians[k]) differentiate(term(k, unknowns[k]), unknowns[k], f, factor_ / sum, jacobians[k]);
        }
        return true;
    }

private:
    struct Term {
        double w = 0, d_w = 0, v = 0, e = 0, shrink = 1;
        Vec3 place{0.0};
    };

    Term term(std::size_t k, const double* u) const {
        Term t;
        t.shrink = std::exp(-u[8]);
        t.place = t.shrink * (row_[k].place - Vec3(u[5], u[6], u[7]));
        t.e = glm::dot(t.place, t.place);
        if (!(t.e < 1)) return t;
        t.w = weight_(t.e);
        t.d_w = weight_.derivative(t.e);
        t.v = u[0] + u[1] * t.place.x + u[2] * t.place.y + u[3] * t.place.z + u[4] * t.e;
        return t;
    }

    static void differentiate(const Term& t, const double* u, double f, double scale, double* d) {
        const double by_value = scale * t.w, by_e = scale * (t.d_w * (t.v - f) + t.w * u[4]);
        d[0] = by_value;
        for (int a = 0; a < 3; ++a) {
            d[1 + a] = by_value * t.place[a];
            d[5 + a] = -t.shrink * (by_value * u[1 + a] + 2 * by_e * t.place[a]);
        }
        d[4] = by_value * t.e;
        d[8] = -by_value * (u[1] * t.place.x + u[2] * t.place.y + u[3] * t.place.z) - 2 * by_e * t.e;
    }

    std::vector<Neighbour> row_;
    double value_, factor_;
    Weight weight_;
};

/// The ridge: holds a kernel's unknowns near their start.
class Hold : public ceres::SizedCostFunction<kUnknowns, kUnknowns> {
public:
    Hold(const Unknowns& start, double terms, double shape) : start_(start), terms_(terms), shape_(shape) {}

    bool Evaluate(const double* const* unknowns, double* residuals, double** jacobians) const override {
        for (int k = 0; k < kUnknowns; ++k) {
            const double factor = k < 5 ? terms_ : shape_;
            residuals[k] = factor * (unknowns[0][k] - start_[static_cast<std::size_t>(k)]);
            if (!jacobians || !jacobians[0]) continue;
            for (int j = 0; j < kUnknowns; ++j) jacobians[0][kUnknowns * k + j] = j == k ? factor : 0;
        }
        return true;
    }

private:
    Unknowns start_;
    double terms_, shape_;
};

class Listener : public ceres::IterationCallback {
public:
    Listener(Progress* progress, int iterations) : progress_(progress), iterations_(iterations) {}

    ceres::CallbackReturnType operator()(const ceres::IterationSummary& summary) override {
        if (!progress_) return ceres::SOLVER_CONTINUE;
        if (progress_->cancelled()) return ceres::SOLVER_ABORT;
        progress_->report("refine kernels", std::min(1.0, double(summary.iteration) / iterations_));
        return ceres::SOLVER_CONTINUE;
    }

private:
    Progress* progress_;
    int iterations_;
};

std::vector<std::vector<Neighbour>> neighbours(const RbfVolume& volume, const FieldSamples& samples) {
    auto wider = volume.frames;
    for (auto& frame : wider) {
        for (float& s : frame) s *= static_cast<float>(kMargin * kMargin);
    }
    const KernelTree tree(volume.centers, wider);
    std::vector<std::vector<Neighbour>> rows(samples.size());
    parallel_each(samples.size(), [&](std::size_t i) {
        tree.visit_at(samples.points[i], [&](std::size_t slot, const Vec3&, const Vec3& place, double) {
            rows[i].push_back({static_cast<Index>(tree.kernel(slot)), kMargin * place});
        });
    });
    return rows;
}

void write_back(RbfVolume& volume, std::span<const Unknowns> unknowns) {
    std::vector<KernelTerms> terms(volume.size());
    for (std::size_t i = 0; i < volume.size(); ++i) {
        const Unknowns& u = unknowns[i];
        std::copy_n(u.begin(), 5, terms[i].begin());
        // A Δ = shift: Δ = A⁻¹ shift = S Aᵀ shift.
        const InverseRoot root = inverse_root(volume.frames[i]);
        volume.centers[i] += matrix(volume.frames[i]) * root.transposed_times({u[5], u[6], u[7]});
        for (float& s : volume.frames[i]) s = static_cast<float>(double(s) * std::exp(2 * u[8]));
    }
    set_terms(volume.channels[0], volume.frames, terms);
}

ceres::Solver::Options solver_options(std::size_t kernels, int iterations) {
    ceres::Solver::Options options;
    // One thread and no BLAS: with several, Ceres sums in the order in which threads finish.
    options.num_threads = 1;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    const bool direct = kernels <= kMostCholesky && ceres::IsSparseLinearAlgebraLibraryTypeAvailable(ceres::EIGEN_SPARSE);
    options.linear_solver_type = direct ? ceres::SPARSE_NORMAL_CHOLESKY : ceres::CGNR;
    options.preconditioner_type = ceres::JACOBI;
    options.max_num_iterations = iterations;
    options.max_linear_solver_iterations = 60;
    options.function_tolerance = 1e-4;
    options.logging_type = ceres::SILENT;
    return options;
}

}  // namespace

MovingFitReport fit_moving(RbfVolume& volume, const FieldSamples& samples, const RbfRefineOptions& options) {
    const auto terms = terms_of(volume, volume.channels[0]);
    std::vector<Unknowns> unknowns(volume.size(), Unknowns{});
    for (std::size_t i = 0; i < terms.size(); ++i) std::copy(terms[i].begin(), terms[i].end(), unknowns[i].begin());
    double total = 0;
    for (const double w : samples.weights) total += w;
    const double per_kernel = static_cast<double>(volume.size()) / total;  // a kernel's mean weight becomes 1

    ceres::Problem::Options problem_options;
    problem_options.disable_all_safety_checks = true;
    ceres::Problem problem(problem_options);
    MovingFitReport report;
    auto rows = neighbours(volume, samples);
    with_weight(volume.kernel, [&](const auto& weight) {
        using Weight = std::decay_t<decltype(weight)>;
        std::vector<double*> blocks;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            if (rows[i].empty() || samples.weights[i] == 0) continue;
            blocks.clear();
            for (const Neighbour& n : rows[i]) blocks.push_back(unknowns[n.kernel].data());
            report.bytes += kBlockBytes * rows[i].size();
            const double factor = std::sqrt(samples.weights[i] * per_kernel);
            problem.AddResidualBlock(new SampleCost<Weight>(std::move(rows[i]), samples.values[i], factor, weight), nullptr,
                                     blocks);
        }
    });
    const double hold = std::sqrt(options.ridge);
    double range = 0;
    for (const auto& t : terms) range = std::max(range, std::abs(t[0]));
    for (auto& u : unknowns) problem.AddResidualBlock(new Hold(u, hold, kShape * hold * range), nullptr, u.data());

    Listener listener(options.progress, options.iterations);
    auto solver = solver_options(volume.size(), options.iterations);
    solver.callbacks.push_back(&listener);
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    if (options.progress && options.progress->cancelled()) throw Error(ErrorCode::Cancelled, "stopped in refine kernels");
    if (summary.IsSolutionUsable()) write_back(volume, unknowns);
    report.iterations = static_cast<int>(summary.iterations.size()) - 1;
    return report;
}

}  // namespace subvol::detail
