// SPDX-License-Identifier: Apache-2.0
#include "subvol/sample_mixed.h"

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>

#include "subvol/detail/mixed_levels.h"
#include "subvol/detail/mixed_shapes.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/detail/point_quadratics.h"
#include "subvol/error.h"

namespace subvol {

namespace {

/// A regular lattice has JJᵀ = 2.2 to 3 times the mean of d dᵀ over its edges: body-centred 2.2, face-centred 2.4, cubic 3.
constexpr double kMomentToSpacing = 2.4;
constexpr double kFlatTol = 1e-3;  // a frame that is thinner than this part of its longest axis is thickened

class Fitter {
public:
    Fitter(const MixedMesh& mesh, const MixedSampleOptions& options, RbfVolume& volume)
        : mesh_(mesh), neighbors_(mesh), options_(options), volume_(volume), radius_(support_radius(options.kernel)) {}

    /// returns: whether the frame was flat
    bool fit(Index p) const {
        bool flat = false;
        const Eigen::Matrix3d frame = frame_of(p, flat);
        Symmetric3& s = volume_.frames[p];
        s = {static_cast<float>(frame(0, 0)), static_cast<float>(frame(0, 1)), static_cast<float>(frame(0, 2)),
             static_cast<float>(frame(1, 1)), static_cast<float>(frame(1, 2)), static_cast<float>(frame(2, 2))};
        if (options_.correction != Correction::None) fit_values(p, frame);
        return flat;
    }

private:
    Eigen::Matrix3d frame_of(Index p, bool& flat) const {
        Eigen::Matrix3d moment = Eigen::Matrix3d::Zero();
        double count = 0;
        neighbors_.each(p, [&](Index q) {
            const Vec3 d = mesh_.points[q] - mesh_.points[p];
            const Eigen::Vector3d v(d.x, d.y, d.z);
            moment += v * v.transpose();
            ++count;
        });
        moment *= kMomentToSpacing * radius_ * radius_ / count;
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moment);
        const double least = kFlatTol * std::max(axes.eigenvalues()[2], 1e-300);
        flat = axes.eigenvalues()[0] < least;
        if (!flat) return moment;
        return axes.eigenvectors() * axes.eigenvalues().cwiseMax(least).asDiagonal() * axes.eigenvectors().transpose();
    }

    void fit_values(Index p, const Eigen::Matrix3d& frame) const {
        std::vector<detail::PointQuadratic> found;
        detail::fit_quadratics(mesh_, neighbors_, p, found);
        const Eigen::Matrix3d inverse = frame.inverse();
        for (std::size_t c = 0; c < found.size(); ++c) {
            RbfChannel& channel = volume_.channels[c];
            for (int k = 0; k < 3; ++k)
                channel.gradients[p][static_cast<std::size_t>(k)] = static_cast<float>(found[c].gradient[k]);
            if (options_.correction == Correction::Gradient) continue;
            const auto& x = found[c].second;
            Eigen::Matrix3d hessian;
            hessian << x[0], x[1], x[2], x[1], x[3], x[4], x[2], x[4], x[5];
            const double moment = (hessian * frame).trace() / 6;
            channel.moments[p] = static_cast<float>(moment);
            if (options_.correction != Correction::Full) continue;
            const Eigen::Matrix3d rest = hessian - 2 * moment * inverse;
            channel.hessians[p] = {static_cast<float>(rest(0, 0)), static_cast<float>(rest(0, 1)),
                                   static_cast<float>(rest(0, 2)), static_cast<float>(rest(1, 1)),
                                   static_cast<float>(rest(1, 2)), static_cast<float>(rest(2, 2))};
        }
    }

    const MixedMesh& mesh_;
    detail::PointNeighbors neighbors_;
    const MixedSampleOptions& options_;
    RbfVolume& volume_;
    double radius_;
};

/// The boundary's triangles over the points that they use.
Surface surface_of(const MixedMesh& mesh) {
    const auto faces = detail::find_boundary(mesh, {}).faces;
    Surface surface;
    std::vector<Index> number(mesh.points.size(), kNone);
    const auto corner = [&](Index p) {
        if (number[p] == kNone) {
            number[p] = static_cast<Index>(surface.points.size());
            surface.points.push_back(mesh.points[p]);
        }
        return number[p];
    };
    for (auto face : faces) {
        if (face[3] == kNone) {
            surface.triangles.push_back({corner(face[0]), corner(face[1]), corner(face[2])});
            continue;
        }
        std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
        surface.triangles.push_back({corner(face[0]), corner(face[1]), corner(face[2])});
        surface.triangles.push_back({corner(face[0]), corner(face[2]), corner(face[3])});
    }
    return surface;
}

}  // namespace

SampleResult sample_rbf_points(const MixedMesh& mesh, const MixedSampleOptions& options) {
    validate(mesh);
    validate(options.kernel);
    if (!is_radial(options.kernel)) {
        throw Error(ErrorCode::InvalidInput, "the kernel is not radial: frames define no axes for it", {}, "a radial kernel");
    }
    report_progress(options.progress, "sample", 0);
    SampleResult result;
    RbfVolume& volume = result.volume;
    const std::size_t points = mesh.points.size();
    volume.centers = mesh.points;
    volume.frames.resize(points);
    volume.kernel = options.kernel;
    for (const Attribute& attribute : mesh.attributes) {
        if (attribute.channels != 1) {
            throw Error(ErrorCode::InvalidInput, "kernels carry scalars", "attribute \"" + attribute.name + "\"",
                        "one channel");
        }
        RbfChannel channel{.name = attribute.name};
        channel.values.assign(attribute.values.begin(), attribute.values.end());
        channel.gradients.resize(points);
        channel.moments.resize(points);
        if (options.correction == Correction::Full) channel.hessians.resize(points);
        volume.channels.push_back(std::move(channel));
    }
    const Fitter fitter(mesh, options, volume);
    std::atomic<std::size_t> flat = 0;
    detail::parallel_each(points, [&](std::size_t p) { flat += fitter.fit(static_cast<Index>(p)) ? 1 : 0; });
    volume.boundary = surface_of(mesh);
    for (const Vec3& p : mesh.points) volume.bounds.add(p);
    result.report.points = result.report.at_vertices = points;
    result.report.flat_frames = flat;
    return result;
}

}  // namespace subvol
