// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "kernel_tree.h"
#include "subvol/detail/flat_array.h"
#include "subvol/kernel.h"
#include "subvol/rbf_volume.h"
#include "subvol/reduce.h"

namespace subvol::detail {

/// A kernel's value, slope and moment in its own frame, (v, h, m): the field near it is v + h·(A d) + m·e. All are in units of
/// the field.
using KernelTerms = std::array<double, 5>;

/// A world-space slope g in a kernel's frame: h with g·d = h·(A d), h = A⁻ᵀ g = A S g.
[[nodiscard]] inline Vec3 to_frame(const Symmetric3& frame, const Vec3& g) {
    return inverse_root(frame).times(matrix(frame) * g);
}

/// Converts a channel to terms in the kernels' frames, and back.
[[nodiscard]] std::vector<KernelTerms> terms_of(const RbfVolume& volume, const RbfChannel& channel);
void set_terms(RbfChannel& channel, std::span<const Symmetric3> frames, std::span<const KernelTerms> terms);

/// The linear least-squares problem of an RBF volume with fixed kernels: Σ weight (f(x) − value)² over samples.
class FieldFit {
public:
    FieldFit(std::span<const Vec3> centers, std::span<const Symmetric3> frames, const Kernel& kernel,
             const FieldSamples& samples);

    /// Improves `terms` by steps of preconditioned conjugate gradients on the normal equations. A ridge holds them near `prior`
    /// where samples do not determine them.
    ///
    /// ridge:   as a part of a kernel's mean weight
    /// returns: the steps taken; fewer than `steps` once the gain is negligible
    int solve(std::vector<KernelTerms>& terms, std::span<const KernelTerms> prior, int steps, double ridge = 1e-4) const;

    /// Field minus sample; 0 where no kernel reaches the sample.
    [[nodiscard]] std::vector<double> residuals(std::span<const KernelTerms> terms) const;

    [[nodiscard]] bool covered(std::size_t sample) const { return row_starts_[sample] < row_starts_[sample + 1]; }
    [[nodiscard]] std::size_t bytes() const;

private:
    /// One kernel at one sample: its share φ = w/Σw, the place A d of the sample in its frame, and e.
    struct Entry {
        Index kernel = 0;
        float share = 0;
        std::array<float, 3> place{};
        float e = 0;

        [[nodiscard]] double value(const KernelTerms& t) const;
        void add_to(KernelTerms& sum, double factor) const;
    };
    using Vector = std::vector<KernelTerms>;

    void fill_rows(std::span<const Vec3> centers, std::span<const Symmetric3> frames, const Kernel& kernel);
    void fill_columns(std::size_t kernels);
    [[nodiscard]] double row_value(std::size_t sample, std::span<const KernelTerms> terms) const;
    [[nodiscard]] Vector transposed_times(std::span<const double> rows) const;
    [[nodiscard]] std::vector<std::array<double, 25>> inverse_blocks(double ridge) const;
    [[nodiscard]] double mean_weight() const;

    const FieldSamples& samples_;
    std::vector<std::size_t> row_starts_;
    std::vector<Entry> entries_;
    struct Place {
        Index sample;
        std::uint32_t offset;  // of the entry in its row
    };
    Rows<Place> columns_;  // of each kernel
};

/// Fits centres, sizes and the terms of the volume's first channel to the samples: a nonlinear problem.
struct MovingFitReport {
    int iterations = 0;
    std::size_t bytes = 0;
};
MovingFitReport fit_moving(RbfVolume& volume, const FieldSamples& samples, const RbfRefineOptions& options);

}  // namespace subvol::detail
