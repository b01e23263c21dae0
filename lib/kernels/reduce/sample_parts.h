// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "subvol/reduce.h"

namespace subvol::detail {

/// The weighted sums over samples that a linear fit needs.
struct LinearSums {
    double w = 0, f = 0, ff = 0;
    Vec3 x{0.0}, fx{0.0};
    Mat3 xx{0.0};

    void add(double weight, const Vec3& d, double value);
    [[nodiscard]] LinearSums operator-(const LinearSums& other) const;
};

/// The best linear function of samples: value at their mean, slope, and the remaining squared error.
struct LinearFit {
    Vec3 mean{0.0};
    Mat3 covariance{0.0};
    double value = 0;
    Vec3 slope{0.0};
    double error = 0;
};
[[nodiscard]] LinearFit fit_linear(const LinearSums& sums);

/// Samples that share a kernel: a range of `SampleParts::order()`.
struct SamplePart {
    std::size_t begin = 0, end = 0;
    LinearFit fit;
    Vec3 normal{0.0};
    /// By how much fit.error (Σ weight error²) falls if the part is halved by the plane through its mean across `normal`
    double gain = 0;
};

/// A partition of samples that is refined part by part.
class SampleParts {
public:
    explicit SampleParts(const FieldSamples& samples);

    [[nodiscard]] const std::vector<SamplePart>& parts() const { return parts_; }
    [[nodiscard]] const std::vector<Index>& order() const { return order_; }

    /// Halves the parts with these numbers: one half keeps the number, the other gets a new one at the end.
    void split(const std::vector<std::size_t>& numbers);

private:
    void analyse(SamplePart& part) const;
    std::size_t partition(const SamplePart& part);

    const FieldSamples& samples_;
    std::vector<Index> order_;
    std::vector<SamplePart> parts_;
};

/// Samples in groups: group g is order[starts[g] .. starts[g+1]).
struct SampleGroups {
    std::vector<Index> order;
    std::vector<std::size_t> starts;
};

/// Groups samples by the kernel whose centre is nearest in its own frame (least e); samples outside all kernels are the last
/// group.
[[nodiscard]] SampleGroups group_by_kernel(const RbfVolume& volume, const FieldSamples& samples);

/// At most `most` samples of each group, evenly chosen, with the total weight of the group; groups keep their order.
struct ThinSamples {
    FieldSamples samples;
    std::vector<std::size_t> starts;
};
[[nodiscard]] ThinSamples thin_samples(const FieldSamples& samples, std::span<const Index> order,
                                       std::span<const std::size_t> starts, std::size_t most);

}  // namespace subvol::detail
