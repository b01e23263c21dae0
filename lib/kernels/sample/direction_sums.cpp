// SPDX-License-Identifier: Apache-2.0
#include "direction_sums.h"

#include <tbb/task_group.h>

#include <algorithm>

#include "subvol/error.h"

namespace subvol::detail {

namespace {

constexpr double kFlat = 1e-9;       // of the determinant of a cube of the same trace
constexpr double kThickness = 1e-3;  // added to a flat metric, of its mean square extent
constexpr double kSpeck = 1e-3;      // the extent of a point whose cells have none, of the mesh's diagonal
constexpr double kNoExtent = 1e-12;  // extents below this part of the diagonal are rounding

}  // namespace

DirectionSums::DirectionSums(const SampleOptions& options, double diagonal, RbfVolume& volume)
    : options_(options),
      volume_(volume),
      diagonal_(diagonal),
      radius2_(support_radius(options.kernel) * support_radius(options.kernel)),
      metric_gradient_(volume.channels.size()),
      laplacian_(volume.channels.size()) {
}

void DirectionSums::begin(std::size_t point) {
    point_ = point;
    metric_ = Mat3(0.0);
    bend_ = Vec3(0.0);
    std::fill(metric_gradient_.begin(), metric_gradient_.end(), Vec3(0.0));
    std::fill(laplacian_.begin(), laplacian_.end(), 0.0);
}

void DirectionSums::add(double weight, const Vec3& step, const Vec3& bend, const double* d_f, const double* dd_f) {
    const Vec3 weighted = weight * step;
    metric_ += glm::outerProduct(weighted, step);
    bend_ += weight * bend;
    for (std::size_t c = 0; c < laplacian_.size(); ++c) {
        metric_gradient_[c] += weighted * d_f[c];
        laplacian_[c] += weight * dd_f[c];
    }
}

bool DirectionSums::finish(double cells) {
    const double scale = (metric_[0][0] + metric_[1][1] + metric_[2][2]) / 3;
    const bool flat = !(glm::determinant(metric_) > kFlat * scale * scale * scale);
    if (flat && scale > kNoExtent * kNoExtent * diagonal_ * diagonal_) {
        metric_ += Mat3(kThickness * scale);
    } else if (flat) {
        const double speck = diagonal_ > 0 ? kSpeck * diagonal_ : 1;  // any length, if the mesh is a point
        metric_ = Mat3(cells * speck * speck);
    }
    volume_.frames[point_] = symmetric3(metric_ * (radius2_ / cells));
    const Mat3 inverse = glm::inverse(metric_);
    for (std::size_t c = 0; c < laplacian_.size(); ++c) {
        const bool corrected = options_.correction != Correction::None && !flat;
        const Vec3 g = corrected ? inverse * metric_gradient_[c] : Vec3(0.0);
        volume_.channels[c].gradients[point_] = {static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)};
        // The mean over the cells of Σ ∂²f − g·Σ ∂²x is H : J Jᵀ in any neighbourhood: axes of different cells need no pairing.
        const bool second = corrected && options_.correction != Correction::Gradient;
        const double moment = second ? radius2_ / 6 * (laplacian_[c] - glm::dot(g, bend_)) / cells : 0.0;
        volume_.channels[c].moments[point_] = static_cast<float>(moment);
    }
    return flat;
}

Symmetric3 without_moment(const Mat3& hessian, const Symmetric3& frame) {
    const Mat3 s = matrix(frame);
    double along = 0;  // H : S
    for (int a = 0; a < 3; ++a) along += glm::dot(hessian[a], s[a]);
    return symmetric3(hessian - along / 3 * glm::inverse(s));
}

RbfVolume empty_volume(const HexMesh& mesh, std::size_t count, const SampleOptions& options) {
    if (count >= kNone)
        throw Error(ErrorCode::InvalidInput, std::to_string(count) + " samples are too many", {}, "fewer than 2³²");
    RbfVolume volume;
    volume.kernel = options.kernel;
    std::vector<RbfChannel>& channels = volume.channels;
    for (const auto& attribute : mesh.attributes) {
        for (int c = 0; c < attribute.channels; ++c) {
            channels.emplace_back().name = attribute.channels == 1 ? attribute.name : attribute.name + "." + std::to_string(c);
        }
    }
    // Clearing new memory takes a while, so several threads do it. This one gets it, to reuse the memory that it has freed:
    // each thread frees and gets memory in an arena of its own.
    tbb::task_group arrays;
    const auto make = [&](auto& array) {
        array.reserve(count);
        arrays.run([&array, count] { array.resize(count); });
    };
    make(volume.frames);
    for (RbfChannel& channel : channels) {
        make(channel.values);
        make(channel.gradients);
        make(channel.moments);
        if (options.correction == Correction::Full) make(channel.hessians);
    }
    arrays.wait();
    return volume;
}

}  // namespace subvol::detail
