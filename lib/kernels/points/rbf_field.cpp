// SPDX-License-Identifier: Apache-2.0
#include "subvol/rbf_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <limits>

#include "kernel_tree.h"
#include "kernel_weight.h"
#include "subvol/detail/number_text.h"
#include "subvol/detail/space_order.h"
#include "subvol/error.h"

namespace subvol {

using detail::KernelTree;

struct RbfField::Kernels {
    /// The contribution of a kernel: value + gradient·d + moment·e + ½ dᵀHd.
    struct Terms {
        float value;
        std::array<float, 3> gradient;
        float moment;
        Symmetric3 hessian;

        [[nodiscard]] Vec3 bend(const Vec3& d) const { return matrix(hessian) * d; }
        [[nodiscard]] Vec3 slope() const { return {gradient[0], gradient[1], gradient[2]}; }
        [[nodiscard]] double at(const Vec3& d, double e) const {
            return double(value) + glm::dot(slope() + .5 * bend(d), d) + double(moment) * e;
        }
    };

    KernelTree tree;
    std::vector<Terms> terms;  // in the tree's order
    Kernel kernel;
    double least_weight;

    Kernels(const RbfVolume& volume, const RbfFieldOptions& options)
        : tree(volume.centers, volume.frames), terms(volume.size()), kernel(volume.kernel), least_weight(options.least_weight) {
        const RbfChannel& channel = volume.channels[options.channel];
        for (std::size_t slot = 0; slot < terms.size(); ++slot) {
            const std::size_t i = tree.kernel(slot);
            terms[slot] = {channel.values[i], channel.gradients[i], channel.moments[i],
                           channel.hessians.empty() ? Symmetric3{} : channel.hessians[i]};
        }
    }

    template <class Weight>
    [[nodiscard]] double value(const Vec3& x, const Weight& weight) const {
        double sum = 0, weighted = 0;
        tree.visit_at(x, [&](std::size_t slot, const Vec3& d, const Vec3&, double e) {
            const double w = weight(e);
            sum += w;
            weighted += w * terms[slot].at(d, e);
        });
        return sum > least_weight ? weighted / sum : std::numeric_limits<double>::quiet_NaN();
    }

    template <class Weight>
    [[nodiscard]] std::optional<FieldJet> jet(const Vec3& x, const Weight& weight) const {
        double sum = 0, weighted = 0;
        Vec3 d_sum(0.0), d_weighted(0.0);
        tree.visit_at(x, [&](std::size_t slot, const Vec3& d, const Vec3& scaled, double e) {
            const Terms& t = terms[slot];
            const double w = weight(e), v = t.at(d, e);
            const Vec3 d_e = 2.0 * tree.root(slot).transposed_times(scaled);
            const Vec3 d_w = weight.derivative(e) * d_e;
            sum += w;
            weighted += w * v;
            d_sum += d_w;
            d_weighted += d_w * v + w * (t.slope() + t.bend(d) + double(t.moment) * d_e);
        });
        if (!(sum > least_weight)) return std::nullopt;
        const double f = weighted / sum;
        return FieldJet{f, (d_weighted - f * d_sum) / sum};
    }
};

RbfField::RbfField(const RbfVolume& volume, const RbfFieldOptions& options) {
    detail::check_rbf_volume(volume);
    if (options.channel >= volume.channels.size()) {
        throw Error(ErrorCode::InvalidInput, "the volume has no channel " + std::to_string(options.channel), {},
                    "it has " + std::to_string(volume.channels.size()) + ", counted from 0");
    }
    if (!(options.least_weight >= 0)) {
        throw Error(ErrorCode::InvalidInput, "the least weight is " + detail::number_text(options.least_weight), {},
                    "0 or more");
    }
    kernels_ = std::make_unique<Kernels>(volume, options);
}

RbfField::~RbfField() = default;
RbfField::RbfField(RbfField&&) noexcept = default;
RbfField& RbfField::operator=(RbfField&&) noexcept = default;

std::optional<double> RbfField::value(const Vec3& x) const {
    const double f = detail::with_weight(kernels_->kernel, [&](const auto& w) { return kernels_->value(x, w); });
    return std::isnan(f) ? std::nullopt : std::optional(f);
}

std::optional<FieldJet> RbfField::value_and_gradient(const Vec3& x) const {
    return detail::with_weight(kernels_->kernel, [&](const auto& w) { return kernels_->jet(x, w); });
}

std::vector<double> RbfField::evaluate(std::span<const Vec3> points) const {
    std::vector<double> values(points.size());
    const std::vector<Index> order = detail::space_order(points);
    detail::with_weight(kernels_->kernel, [&](const auto& weight) {
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, points.size(), 256), [&](const auto& range) {
            for (std::size_t k = range.begin(); k != range.end(); ++k) {
                const Index i = order[k];
                values[i] = kernels_->value(points[i], weight);
            }
        });
    });
    return values;
}

}  // namespace subvol
