// SPDX-License-Identifier: Apache-2.0
#include "subvol/sample_mixed.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <Eigen/Dense>
#include <algorithm>
#include <atomic>

#include "mixed_boundary.h"
#include "mixed_shapes.h"
#include "subvol/detail/parallel_each.h"
#include "subvol/error.h"

namespace subvol {

namespace {

/// The points at the other ends of the edges, and of the shortest diagonals of octahedra, of each point.
struct Neighbors {
    std::vector<std::size_t> offsets;
    std::vector<std::array<Index, 2>> pairs;  // of a point and a neighbour, sorted

    explicit Neighbors(const MixedMesh& mesh) {
        const auto add = [&](Index a, Index b) {
            pairs.push_back({a, b});
            pairs.push_back({b, a});
        };
        detail::each_kind_of(mesh, [&](detail::CellKind kind, const auto& cells) {
            for (const auto& cell : cells) {
                for (const auto& ends : detail::table_of(kind).edges) add(detail::at(cell, ends[0]), detail::at(cell, ends[1]));
            }
        });
        tbb::parallel_sort(pairs.begin(), pairs.end());
        pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
        offsets.assign(mesh.points.size() + 1, 0);
        for (const auto& pair : pairs) ++offsets[pair[0] + 1];
        for (std::size_t p = 0; p < mesh.points.size(); ++p) offsets[p + 1] += offsets[p];
    }

    template <class Call>
    void each(Index p, const Call& call) const {
        for (std::size_t i = offsets[p]; i < offsets[p + 1]; ++i) call(pairs[i][1]);
    }
};

/// A regular lattice has JJᵀ = 2.2 to 3 times the mean of d dᵀ over its edges: body-centred 2.2, face-centred 2.4, cubic 3.
constexpr double kMomentToSpacing = 2.4;
constexpr double kFlatTol = 1e-3;             // a frame that is thinner than this part of its longest axis is thickened
constexpr std::size_t kEnoughNeighbors = 14;  // as in the lattice of the box spline: nine unknowns and some to spare

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

    /// The quadratic f + g·d + ½ dᵀHd with the least sum of squares, each neighbour weighted by 1/|d|²; in units of the mean
    /// |d|.
    void fit_values(Index p, const Eigen::Matrix3d& frame) const {
        std::vector<Index> around;
        neighbors_.each(p, [&](Index q) { around.push_back(q); });
        if (around.size() < kEnoughNeighbors) {
            const std::size_t own = around.size();
            for (std::size_t i = 0; i < own; ++i) neighbors_.each(around[i], [&](Index q) { around.push_back(q); });
            std::sort(around.begin(), around.end());
            around.erase(std::unique(around.begin(), around.end()), around.end());
            std::erase(around, p);
        }
        const auto rows = static_cast<Eigen::Index>(around.size());
        double unit = 0;
        for (const Index q : around) unit += glm::length(mesh_.points[q] - mesh_.points[p]);
        unit /= static_cast<double>(around.size());
        if (!(unit > 0)) return;
        Eigen::Matrix<double, Eigen::Dynamic, 9> design(rows, 9);
        Eigen::VectorXd weights(rows);
        for (Eigen::Index r = 0; r < rows; ++r) {
            const Vec3 d = (mesh_.points[around[static_cast<std::size_t>(r)]] - mesh_.points[p]) / unit;
            weights[r] = 1 / std::max(glm::dot(d, d), 1e-12);
            design.row(r) << d.x, d.y, d.z, d.x * d.x / 2, d.x * d.y, d.x * d.z, d.y * d.y / 2, d.y * d.z, d.z * d.z / 2;
            design.row(r) *= weights[r];
        }
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> solver;
        solver.setThreshold(1e-6);
        solver.compute(design);
        const Eigen::Matrix3d inverse = frame.inverse();
        for (std::size_t c = 0; c < mesh_.attributes.size(); ++c) {
            const auto& values = mesh_.attributes[c].values;
            Eigen::VectorXd right(rows);
            for (Eigen::Index r = 0; r < rows; ++r) {
                right[r] = weights[r] * (values[around[static_cast<std::size_t>(r)]] - values[p]);
            }
            const Eigen::VectorXd x = solver.solve(right);
            RbfChannel& channel = volume_.channels[c];
            for (std::size_t k = 0; k < 3; ++k) {
                channel.gradients[p][k] = static_cast<float>(x[static_cast<Eigen::Index>(k)] / unit);
            }
            if (options_.correction == Correction::Gradient) continue;
            Eigen::Matrix3d hessian;
            hessian << x[3], x[4], x[5], x[4], x[6], x[7], x[5], x[7], x[8];
            hessian /= unit * unit;
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
    Neighbors neighbors_;
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
