// SPDX-License-Identifier: Apache-2.0
#include "subvol/vdb_sample.h"

#include <tbb/parallel_for.h>
#include "openvdb_grids.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "coarse_voxels.h"
#include "subvol/error.h"
#include "vdb_data.h"

namespace subvol {

using namespace detail;

namespace {

using Tree = openvdb::FloatTree;
using Leaf = Tree::LeafNodeType;
using openvdb::Coord;

constexpr int kMostVoxelsASide = 1 << 20;
constexpr std::uint64_t kMostPoints = std::uint64_t{1} << 31;

const std::array<Coord, 3> kAxes{Coord(1, 0, 0), Coord(0, 1, 0), Coord(0, 0, 1)};

/// Derivatives by differences; the unit of length is a voxel.
class Differences {
public:
    explicit Differences(const Tree& tree) : voxels_(tree) {}

    void move_to(const Coord& voxel) {
        voxel_ = voxel;
        probe(voxel, value_);
        for (std::size_t a = 0; a < 3; ++a) {
            has_after_[a] = probe(voxel + kAxes[a], after_[a]);
            has_before_[a] = probe(voxel - kAxes[a], before_[a]);
        }
    }

    [[nodiscard]] double value() const { return value_; }

    [[nodiscard]] Vec3 gradient() const {
        Vec3 g(0.0);
        for (std::size_t a = 0; a < 3; ++a) {
            const double after = has_after_[a] ? after_[a] : value_, before = has_before_[a] ? before_[a] : value_;
            const int steps = int(has_after_[a]) + int(has_before_[a]);
            if (steps > 0) g[static_cast<int>(a)] = (after - before) / steps;
        }
        return g;
    }

    /// with_mixed: mixed derivatives too, not only those along the axes
    [[nodiscard]] Mat3 hessian(bool with_mixed) {
        Mat3 h(0.0);
        for (int a = 0; a < 3; ++a) {
            const auto i = static_cast<std::size_t>(a);
            if (has_after_[i] && has_before_[i]) h[a][a] = after_[i] - 2 * value_ + before_[i];
            for (int b = 0; with_mixed && b < a; ++b) h[a][b] = h[b][a] = mixed(i, static_cast<std::size_t>(b));
        }
        return h;
    }

private:
    bool probe(const Coord& voxel, double& value) {
        float found = 0;
        const bool active = voxels_.probeValue(voxel, found);
        value = static_cast<double>(found);
        return active;
    }

    double mixed(std::size_t a, std::size_t b) {
        double pp = 0, pm = 0, mp = 0, mm = 0;
        const Coord &p = kAxes[a], &q = kAxes[b];
        const bool all =
            probe(voxel_ + p + q, pp) && probe(voxel_ + p - q, pm) && probe(voxel_ - p + q, mp) && probe(voxel_ - p - q, mm);
        return all ? (pp - pm - mp + mm) / 4 : 0;
    }

    // Not registered with the tree, hence cheap to make; safe in many threads as long as the tree does not change.
    openvdb::FloatGrid::ConstUnsafeAccessor voxels_;
    Coord voxel_;
    double value_ = 0;
    std::array<double, 3> after_{}, before_{};
    std::array<bool, 3> has_after_{}, has_before_{};
};

/// The positions and the shape of the kernels: world = to_world · ijk + origin.
struct Lattice {
    Mat3 to_world;
    Vec3 origin;
};

class Writer {
public:
    Writer(const Lattice& lattice, Correction correction, RbfVolume& volume)
        : lattice_(lattice),
          inverse_(glm::inverse(lattice.to_world)),
          radius_(support_radius(volume.kernel)),
          frame_(symmetric3(radius_ * radius_ * lattice.to_world * glm::transpose(lattice.to_world))),
          correction_(correction),
          volume_(volume) {}

    void write(std::size_t point, const Coord& voxel, Differences& differences) const {
        RbfChannel& channel = volume_.channels.front();
        volume_.centers[point] = lattice_.to_world * Vec3(voxel[0], voxel[1], voxel[2]) + lattice_.origin;
        volume_.frames[point] = frame_;
        differences.move_to(voxel);
        channel.values[point] = static_cast<float>(differences.value());
        if (correction_ == Correction::None) return;
        const Vec3 g = differences.gradient() * inverse_;
        channel.gradients[point] = {static_cast<float>(g.x), static_cast<float>(g.y), static_cast<float>(g.z)};
        if (correction_ == Correction::Gradient) return;
        Mat3 hessian = differences.hessian(correction_ == Correction::Full);
        const double trace = hessian[0][0] + hessian[1][1] + hessian[2][2];
        channel.moments[point] = static_cast<float>(radius_ * radius_ * trace / 6);
        if (correction_ == Correction::Second) return;
        hessian -= Mat3(trace / 3);
        channel.hessians[point] = symmetric3(glm::transpose(inverse_) * hessian * inverse_);
    }

private:
    Lattice lattice_;
    Mat3 inverse_;
    double radius_;
    Symmetric3 frame_;
    Correction correction_;
    RbfVolume& volume_;
};

int voxels_a_side(double spacing_world, double voxel_world) {
    if (!std::isfinite(spacing_world) || spacing_world < 0) {
        throw Error(ErrorCode::InvalidInput, "the spacing is negative or not finite");
    }
    return static_cast<int>(std::clamp(std::round(spacing_world / voxel_world), 1.0, double(kMostVoxelsASide)));
}

RbfVolume empty_volume(const std::string& name, std::size_t count, const VoxelSampleOptions& options) {
    RbfVolume volume;
    volume.kernel = options.kernel;
    volume.centers.resize(count);
    volume.frames.resize(count);
    RbfChannel channel{.name = name.empty() ? "density" : name};
    channel.values.resize(count);
    channel.gradients.resize(count);
    channel.moments.resize(count);
    if (options.correction == Correction::Full) channel.hessians.resize(count);
    volume.channels.push_back(std::move(channel));
    return volume;
}

/// For each leaf the number of the point that its first active voxel becomes; last, the number of all points.
std::vector<std::size_t> first_points(const std::vector<const Leaf*>& leaves) {
    std::vector<std::size_t> first{0};
    for (const Leaf* leaf : leaves) first.push_back(first.back() + leaf->onVoxelCount());
    return first;
}

}  // namespace

VoxelSampleResult sample_rbf_points(const VdbGrid& grid, const VoxelSampleOptions& options) {
    const std::string where = "grid \"" + grid.report().name + "\"";
    const openvdb::FloatGrid::ConstPtr floats = VdbData::of(grid).floats;
    if (!floats) throw Error(ErrorCode::InvalidInput, "its voxels are not floats", where);
    validate(options.kernel);
    if (!is_radial(options.kernel)) throw Error(ErrorCode::InvalidInput, "the kernel is not radial");
    const auto voxels = grid.voxels();
    const Mat3 to_world = voxels->to_world();
    const double voxel_world = std::cbrt(std::abs(glm::determinant(to_world)));
    const int n = voxels_a_side(options.spacing_world, voxel_world);
    report_progress(options.progress, "sample voxels", 0);
    const detail::CoarseVoxels coarse = detail::coarse_voxels(floats->constTreePtr(), n);

    std::vector<const Leaf*> leaves;
    coarse.tree->getNodes(leaves);
    const std::vector<std::size_t> first = first_points(leaves);
    const std::size_t count = first.back();
    if (count == 0)
        throw Error(ErrorCode::InvalidInput, n == 1 ? "has no active voxels" : "no block of voxels is at least half active",
                    where);
    if (count > kMostPoints) throw Error(ErrorCode::InvalidInput, std::to_string(count) + " points are too many", where, "2³¹");
    report_progress(options.progress, "sample voxels", 0.5);

    VoxelSampleResult result{
        empty_volume(grid.report().name, count, options),
        {.points = count, .voxels_a_side = n, .spacing_world = n * voxel_world, .left_out = coarse.left_out}};
    const Lattice lattice{double(n) * to_world, voxels->origin() + to_world * Vec3(0.5 * (n - 1))};
    const Writer writer(lattice, options.correction, result.volume);
    tbb::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t k) {
        Differences differences(*coarse.tree);
        std::size_t point = first[k];
        for (auto voxel = leaves[k]->cbeginValueOn(); voxel; ++voxel) writer.write(point++, voxel.getCoord(), differences);
    });
    result.volume.bounds = box_of(result.volume);
    validate(result.volume);
    report_progress(options.progress, "sample voxels", 1);
    return result;
}

}  // namespace subvol
