// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "subvol/camera.h"
#include "subvol/index.h"
#include "subvol/progress.h"
#include "subvol/rbf_volume.h"

namespace subvol {

/// A complete binary tree over the kernels of a volume, in flat arrays. Node 0 is the root, node n has the children 2n+1 and
/// 2n+2; the nodes of the last level have at most 8 kernels each, which are in consecutive slots. Every node stands for all
/// kernels below it by one kernel.
///
/// The mass of a kernel is √det S, to which its integral is proportional. A node's kernel has the mass of its kernels, and the
/// shape of the cells of one sample interval that they stand for; so the sum of weights is on average what it was. Its value
/// and derivatives are the quadratic (of channels without Hessians: the linear function with a part along S⁻¹) that is nearest
/// to those of its children, in the mean of squares weighted with their masses.
struct KernelHierarchy {
    std::vector<Index> order;    ///< the kernel in each slot
    RbfVolume nodes;             ///< the kernels of the nodes; no boundary
    std::vector<double> masses;  ///< world³
    /// Covariances of the cells of one sample interval that the kernels stand for: world²; that of a kernel is S / 12R²
    std::vector<Symmetric3> covariances;
    std::vector<Box> boxes;     ///< boxes of the centres of a node's kernels
    std::vector<float> widths;  ///< world: the longest diameter of a node's ellipsoid, at least those of the nodes below it
    /// For each channel and node a bound of |its polynomial − the value of a kernel below it| at that kernel's centre
    std::vector<std::vector<float>> errors;

    [[nodiscard]] bool is_last(std::size_t node) const { return 2 * node + 1 >= nodes.size(); }

    /// The first slot of a node's kernels, and the one behind its last.
    [[nodiscard]] std::pair<std::size_t, std::size_t> slots(std::size_t node) const;
};

/// throws: Error(InvalidInput) as `validate`, or if there are 2³² kernels or more
/// cost:   O(n log n): about 1 µs of all cores per kernel, and 60 bytes; the same result for any number of threads
/// source: mm2001, wm2003; ours are the quadratics, and masses that keep the sum of weights
[[nodiscard]] KernelHierarchy build_kernel_hierarchy(const RbfVolume& volume, Progress* progress = nullptr);

struct LevelOptions {
    /// A node is drawn in place of its kernels if its ellipsoid is narrower than this in the picture; 0: never
    double pixels = 1;
    /// The error bound of that node in the channel must be at most this, in the field's unit
    double error = std::numeric_limits<double>::infinity();
    std::size_t channel = 0;  ///< channel whose error bounds count
};

/// The highest nodes that may be drawn, and the kernels that are below none of them. Each kernel is below one of the nodes or
/// in the list, once.
struct KernelCut {
    std::vector<Index> nodes;    ///< in the order of the tree
    std::vector<Index> kernels;  ///< ascending
    double error = 0;            ///< the largest error bound of the nodes

    [[nodiscard]] std::size_t size() const { return nodes.size() + kernels.size(); }
};

/// The cut for a view. Widths are measured at the ellipsoid's nearest depth; nodes that reach behind the eye are not taken.
///
/// throws: Error(InvalidInput) if an option is negative or not a number, or there is no such channel
[[nodiscard]] KernelCut choose_cut(const KernelHierarchy& hierarchy, const View& view, const LevelOptions& options = {});

/// The cut for no view in particular: the highest nodes whose error bound in the channel is at most `error`, in the field's
/// unit. Few kernels where the field is smooth.
///
/// throws: Error(InvalidInput) as for a view
[[nodiscard]] KernelCut choose_cut(const KernelHierarchy& hierarchy, double error, std::size_t channel = 0);

/// All nodes of one level of the tree: the lowest that has at most `most` nodes, or the root. Few kernels for a quick picture,
/// whatever the view and the field; the same for all views.
[[nodiscard]] KernelCut level_cut(const KernelHierarchy& hierarchy, std::size_t most);

/// The kernels of a cut, with the boundary of the volume: first those of the volume, in their order, then those of nodes. If
/// the cut has no nodes, this is the volume.
///
/// volume: of which the hierarchy was made
/// throws: Error(InvalidInput) if the volume has not as many kernels or channels as the hierarchy's
[[nodiscard]] RbfVolume kernels_of_cut(const KernelHierarchy& hierarchy, const RbfVolume& volume, const KernelCut& cut);

/// Both in one call: few kernels for a distant view, all of them close up.
[[nodiscard]] RbfVolume choose_level(const KernelHierarchy& hierarchy, const RbfVolume& volume, const View& view,
                                     const LevelOptions& options = {});

}  // namespace subvol
