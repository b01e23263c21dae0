// SPDX-License-Identifier: Apache-2.0
// With centres and frames fixed, the field of an RBF volume is linear in the terms of its kernels:
//
//    f(x) = Σ φ_i (v_i + h_i·place_i + m_i e_i)      φ_i = w_i(x) / Σ w,  place_i = A_i (x − μ_i),  e_i = |place_i|²
//
// So the terms with the least Σ weight (f(x) − value)² + ridge |terms − prior|² solve a sparse linear least-squares problem
// with five unknowns for each kernel. Each sample is a row with an entry (φ, place, e) for each kernel that reaches it;
// columns_ lists the entries of each kernel. Conjugate gradients solve the normal equations, preconditioned by the inverse 5×5
// block of each kernel. The matrix of the normal equations is never formed: each step multiplies with the rows, then with the
// columns. Both are sums in a fixed order, so the result does not depend on the number of threads.
#include "field_fit.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "kernel_weight.h"
#include "subvol/detail/bucket_sort.h"
#include "subvol/detail/conjugate_gradients.h"
#include "subvol/detail/counted_rows.h"
#include "subvol/rbf_field.h"

namespace subvol::detail {
namespace {

constexpr double kLeastGain = 1e-10;  // the solver ends at this part of the first step's gain

/// Sums of fixed pieces, added in a fixed tree: the same bits for any number of threads.
double dot(std::span<const KernelTerms> a, std::span<const KernelTerms> b) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, a.size(), 512), 0.0,
        [&](const auto& range, double sum) {
            for (std::size_t i = range.begin(); i != range.end(); ++i) {
                for (std::size_t k = 0; k < 5; ++k) sum += a[i][k] * b[i][k];
            }
            return sum;
        },
        std::plus<>());
}

/// Inverts a symmetric positive definite 5×5 matrix in place.
void invert(std::array<double, 25>& numbers) {
    using Matrix5 = Eigen::Matrix<double, 5, 5>;
    Eigen::Map<Matrix5> m(numbers.data());
    m = Matrix5(m).ldlt().solve(Matrix5::Identity());
}

}  // namespace

std::vector<KernelTerms> terms_of(const RbfVolume& volume, const RbfChannel& channel) {
    std::vector<KernelTerms> terms(volume.size());
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const auto& g = channel.gradients[i];
        const Vec3 h = to_frame(volume.frames[i], Vec3(g[0], g[1], g[2]));
        terms[i] = {double(channel.values[i]), h.x, h.y, h.z, double(channel.moments[i])};
    }
    return terms;
}

void set_terms(RbfChannel& channel, std::span<const Symmetric3> frames, std::span<const KernelTerms> terms) {
    channel.values.resize(terms.size());
    channel.gradients.resize(terms.size());
    channel.moments.resize(terms.size());
    for (std::size_t i = 0; i < terms.size(); ++i) {
        const KernelTerms& t = terms[i];
        const Vec3 g = inverse_root(frames[i]).transposed_times({t[1], t[2], t[3]});
        channel.values[i] = static_cast<float>(t[0]);
        channel.gradients[i] = {static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)};
        channel.moments[i] = static_cast<float>(t[4]);
    }
}

double FieldFit::Entry::value(const KernelTerms& t) const {
    return double(share) *
           (t[0] + double(place[0]) * t[1] + double(place[1]) * t[2] + double(place[2]) * t[3] + double(e) * t[4]);
}

void FieldFit::Entry::add_to(KernelTerms& sum, double factor) const {
    const double f = factor * double(share);
    sum[0] += f;
    for (std::size_t k = 0; k < 3; ++k) sum[k + 1] += f * double(place[k]);
    sum[4] += f * double(e);
}

FieldFit::FieldFit(std::span<const Vec3> centers, std::span<const Symmetric3> frames, const Kernel& kernel,
                   const FieldSamples& samples)
    : samples_(samples), row_starts_(samples.size() + 1) {
    fill_rows(centers, frames, kernel);
    fill_columns(centers.size());
}

void FieldFit::fill_rows(std::span<const Vec3> centers, std::span<const Symmetric3> frames, const Kernel& kernel) {
    const KernelTree tree(centers, frames);
    std::vector<std::uint32_t> counts(samples_.size());
    with_weight(kernel, [&](const auto& weight) {
        // Two passes: the first counts the entries, the second writes them.
        for (const bool write : {false, true}) {
            parallel_each(samples_.size(), [&](std::size_t i) {
                double sum = 0;
                std::size_t next = row_starts_[i];
                const std::size_t first = next;
                tree.visit_at(samples_.points[i], [&](std::size_t slot, const Vec3&, const Vec3& place, double e) {
                    const double w = weight(e);
                    sum += w;
                    if (write && next < row_starts_[i + 1]) {
                        entries_[next] = {
                            static_cast<Index>(tree.kernel(slot)),
                            static_cast<float>(w),
                            {static_cast<float>(place.x), static_cast<float>(place.y), static_cast<float>(place.z)},
                            static_cast<float>(e)};
                    }
                    ++next;
                });
                if (write) {
                    for (std::size_t k = first; k < row_starts_[i + 1]; ++k)
                        entries_[k].share = static_cast<float>(double(entries_[k].share) / sum);
                } else {
                    counts[i] = sum > kLeastWeight ? static_cast<std::uint32_t>(next - first) : 0;
                }
            });
            if (write) break;
            for (std::size_t i = 0; i < samples_.size(); ++i) row_starts_[i + 1] = row_starts_[i] + counts[i];
            entries_.resize(row_starts_.back());
        }
    });
}

void FieldFit::fill_columns(std::size_t kernels) {
    columns_ = counted_rows<Place>(kernels, [&](const auto& put) {
        for (std::size_t i = 0; i < samples_.size(); ++i) {
            for (std::size_t k = row_starts_[i]; k < row_starts_[i + 1]; ++k)
                put(entries_[k].kernel, {static_cast<Index>(i), static_cast<std::uint32_t>(k - row_starts_[i])});
        }
    });
}

double FieldFit::row_value(std::size_t sample, std::span<const KernelTerms> terms) const {
    double sum = 0;
    for (std::size_t k = row_starts_[sample]; k < row_starts_[sample + 1]; ++k)
        sum += entries_[k].value(terms[entries_[k].kernel]);
    return sum;
}

std::vector<double> FieldFit::residuals(std::span<const KernelTerms> terms) const {
    std::vector<double> result(samples_.size());
    parallel_each(samples_.size(),
                  [&](std::size_t i) { result[i] = covered(i) ? row_value(i, terms) - samples_.values[i] : 0; });
    return result;
}

FieldFit::Vector FieldFit::transposed_times(std::span<const double> rows) const {
    Vector result(columns_.size());
    parallel_each(result.size(), [&](std::size_t kernel) {
        KernelTerms sum{};
        for (const Place& p : columns_[kernel]) {
            entries_[row_starts_[p.sample] + p.offset].add_to(sum, samples_.weights[p.sample] * rows[p.sample]);
        }
        result[kernel] = sum;
    });
    return result;
}

double FieldFit::mean_weight() const {
    double total = 0;
    for (std::size_t i = 0; i < samples_.size(); ++i) total += samples_.weights[i];
    return total / static_cast<double>(std::max<std::size_t>(columns_.size(), 1));
}

std::vector<std::array<double, 25>> FieldFit::inverse_blocks(double ridge) const {
    std::vector<std::array<double, 25>> blocks(columns_.size());
    parallel_each(blocks.size(), [&](std::size_t kernel) {
        auto& block = blocks[kernel];
        for (const Place& p : columns_[kernel]) {
            KernelTerms row{};
            entries_[row_starts_[p.sample] + p.offset].add_to(row, 1);
            for (std::size_t k = 0; k < 25; ++k) block[k] += samples_.weights[p.sample] * row[k / 5] * row[k % 5];
        }
        for (std::size_t k = 0; k < 5; ++k) block[6 * k] += ridge;
        invert(block);
    });
    return blocks;
}

int FieldFit::solve(std::vector<KernelTerms>& terms, std::span<const KernelTerms> prior, int steps, double ridge) const {
    const double pull = ridge * mean_weight();
    const auto blocks = inverse_blocks(pull);
    const std::size_t count = terms.size();
    // gradient = −Jᵀ W residual − ridge (terms − prior)
    Vector gradient = transposed_times(residuals(terms));
    parallel_each(count, [&](std::size_t i) {
        for (std::size_t k = 0; k < 5; ++k) gradient[i][k] = -gradient[i][k] - pull * (terms[i][k] - prior[i][k]);
    });
    std::vector<double> rows(samples_.size());
    double first = 0;
    return conjugate_gradients(
        terms, gradient,
        [&](Vector& preconditioned) {
            parallel_each(count, [&](std::size_t i) {
                for (std::size_t k = 0; k < 5; ++k) {
                    double sum = 0;
                    for (std::size_t j = 0; j < 5; ++j) sum += blocks[i][5 * k + j] * gradient[i][j];
                    preconditioned[i][k] = sum;
                }
            });
            return dot(gradient, preconditioned);
        },
        [&](const Vector& direction, Vector& image) {
            parallel_each(samples_.size(), [&](std::size_t i) { rows[i] = row_value(i, direction); });
            image = transposed_times(rows);
            parallel_each(count, [&](std::size_t i) { add_times(image[i], pull, direction[i]); });
        },
        dot,
        [&](int step, double gain) {
            if (step == 0) first = gain;
            return step < steps && gain > kLeastGain * first;
        });
}

std::size_t FieldFit::bytes() const {
    return entries_.size() * (sizeof(Entry) + sizeof(Place)) +
           (row_starts_.size() + columns_.offsets.size()) * sizeof(std::size_t);
}

}  // namespace subvol::detail
