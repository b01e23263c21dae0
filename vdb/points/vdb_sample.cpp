// SPDX-License-Identifier: Apache-2.0
// Active voxels of a grid of floats become kernels, one for each block of n³ voxels, in these steps:
//
//     1. tiles become voxels
//     2. n > 1: a coarse tree of means over the active voxels of blocks that are at least half active; leaves of the fine tree
//        are sorted by the coarse leaf that they lie in, and coarse leaves are summed in parallel
//     3. each active voxel ijk becomes the point number that a sum over leaves gives it, at to_world · ijk + origin
//
// All kernels have one frame, r² A Aᵀ, A the matrix of the lattice and r the kernel's radius. Derivatives are differences of
// neighbours in units of voxels: central, or one-sided where one neighbour is inactive; second ones are 0 unless all voxels
// that they need are active. The inverse of A takes them to world space. The trace of the Hessian gives the moment, r² tr / 6;
// the Hessian keeps the rest. A level set takes another way: the body within its surface becomes kernels.
#include "subvol/vdb_sample.h"

#include <tbb/parallel_for.h>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "level_set_body.h"
#include "openvdb_grids.h"
#include "subvol/error.h"
#include "vdb_data.h"
#include "voxel_faces.h"

namespace subvol::detail {

namespace {

/// A tree without tiles. left_out: active voxels of the fine tree that no coarse voxel includes
struct CoarseVoxels {
    openvdb::FloatTree::ConstPtr tree;
    std::size_t left_out = 0;
};

using Tree = openvdb::FloatTree;

using Leaf = Tree::LeafNodeType;

constexpr std::uint64_t kMostVoxels = std::uint64_t{1} << 31;

std::int32_t floor_division(std::int32_t a, std::int32_t n) {
    return a / n - (a % n < 0 ? 1 : 0);
}

openvdb::Coord block_of(const openvdb::Coord& voxel, std::int32_t n) {
    return {floor_division(voxel[0], n), floor_division(voxel[1], n), floor_division(voxel[2], n)};
}

Tree::ConstPtr without_tiles(const Tree::ConstPtr& tree) {
    if (tree->activeTileCount() == 0) return tree;
    if (tree->activeVoxelCount() > kMostVoxels) {
        throw Error(ErrorCode::InvalidInput, std::to_string(tree->activeVoxelCount()) + " active voxels are too many", {},
                    "at most 2³¹");
    }
    const Tree::Ptr dense(new Tree(*tree));
    dense->voxelizeActiveTiles();
    return dense;
}

/// Sums over the blocks of one coarse leaf, in the order of the added leaves.
class BlockSums {
public:
    void add(const Leaf& leaf, std::int32_t n) {
        for (auto voxel = leaf.cbeginValueOn(); voxel; ++voxel) {
            const auto block = Leaf::coordToOffset(block_of(voxel.getCoord(), n));
            sums_[block] += static_cast<double>(*voxel);
            ++counts_[block];
        }
    }

    /// Null if no block is at least half active.
    std::unique_ptr<Leaf> leaf(const openvdb::Coord& origin, std::int32_t n, std::size_t& left_out) const {
        auto made = std::make_unique<Leaf>(origin, 0.0f, false);
        const std::int64_t whole = static_cast<std::int64_t>(n) * n * n;
        for (openvdb::Index i = 0; i < Leaf::SIZE; ++i) {
            if (counts_[i] > 0 && 2 * counts_[i] >= whole) {
                made->setValueOn(i, static_cast<float>(sums_[i] / static_cast<double>(counts_[i])));
            } else {
                left_out += static_cast<std::size_t>(counts_[i]);
            }
        }
        return made->isEmpty() ? nullptr : std::move(made);
    }

private:
    std::vector<double> sums_ = std::vector<double>(Leaf::SIZE);
    std::vector<std::int64_t> counts_ = std::vector<std::int64_t>(Leaf::SIZE);
};

/// A leaf of the fine tree. Leaves begin at multiples of eight, so each lies in one leaf of the coarse tree.
struct SourceLeaf {
    openvdb::Coord origin;  // of the coarse leaf
    const Leaf* leaf;
};

std::vector<SourceLeaf> parts_of(const Tree& tree, std::int32_t n) {
    std::vector<SourceLeaf> parts;
    parts.reserve(tree.leafCount());
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        openvdb::Coord origin = block_of(leaf->origin(), n);
        parts.push_back({origin & ~static_cast<openvdb::Int32>(Leaf::DIM - 1), leaf.getLeaf()});
    }
    std::stable_sort(parts.begin(), parts.end(), [](const SourceLeaf& a, const SourceLeaf& b) { return a.origin < b.origin; });
    return parts;
}

/// Means of blocks of n³ voxels: coarse voxel ijk is the mean of the active voxels n·ijk … n·ijk + n−1, active where at least
/// half of these are active.
///
/// n:      1 (the tree itself, without tiles) to 2²⁰
/// throws: Error(InvalidInput) if there are tiles and more than 2³¹ active voxels
CoarseVoxels coarse_voxels(const Tree::ConstPtr& tree, int n) {
    const Tree::ConstPtr fine = without_tiles(tree);
    if (n == 1) return {fine, 0};
    const std::vector<SourceLeaf> parts = parts_of(*fine, n);
    std::vector<std::size_t> begins;
    for (std::size_t i = 0; i < parts.size(); ++i) {
        if (i == 0 || parts[i].origin != parts[i - 1].origin) begins.push_back(i);
    }
    const std::size_t count = begins.size();
    begins.push_back(parts.size());
    std::vector<std::unique_ptr<Leaf>> leaves(count);
    std::vector<std::size_t> left_out(count);
    tbb::parallel_for(std::size_t{0}, count, [&](std::size_t k) {
        BlockSums sums;
        for (std::size_t i = begins[k]; i < begins[k + 1]; ++i) sums.add(*parts[i].leaf, n);
        leaves[k] = sums.leaf(parts[begins[k]].origin, n, left_out[k]);
    });
    const Tree::Ptr coarse(new Tree(0.0f));
    CoarseVoxels result{coarse, 0};
    for (std::size_t k = 0; k < count; ++k) {
        if (leaves[k]) coarse->addLeaf(leaves[k].release());
        result.left_out += left_out[k];
    }
    return result;
}

}  // namespace

}  // namespace subvol::detail

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
    if (grid.report().level_set) {
        const detail::LevelSetBody body = detail::body_of_level_set(grid, options.spacing_world > 0 ? n : 0, options.kernel);
        return {body.volume,
                {.points = body.volume.size(),
                 .voxels_a_side = body.voxels_a_side,
                 .spacing_world = body.voxels_a_side * voxel_world}};
    }
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
        if (options.progress && options.progress->cancelled()) return;
        Differences differences(*coarse.tree);
        std::size_t point = first[k];
        for (auto voxel = leaves[k]->cbeginValueOn(); voxel; ++voxel) writer.write(point++, voxel.getCoord(), differences);
    });
    if (options.faces) result.faces = voxel_faces(*coarse.tree, lattice.to_world, lattice.origin);
    report_progress(options.progress, "sample voxels", 1);
    result.volume.bounds = box_of(result.volume);
    validate(result.volume);
    return result;
}

}  // namespace subvol
