// SPDX-License-Identifier: Apache-2.0
// Sharp edges along the axes of the voxels, such as the rims of a scan's box or of a cylinder that stands upright. A step of a
// smooth wall has a tread or a riser of one voxel; an edge is sharp if both of its sides are flat for some voxels:
//
//     ─────────┐ sharp           ────┐ step
//              │                     └───┐
//              │                         └────
#include "label_net.h"
#include "subvol/detail/parallel_each.h"

namespace subvol::detail {

namespace {

constexpr int kFlat = 3;  // voxels

using Mask = std::uint8_t;  // of the eight voxels around a point, x fastest

Mask mask_of(const LabelNet::Point& point, std::uint32_t material) {
    Mask mask = 0;
    for (unsigned n = 0; n < 8; ++n) mask |= static_cast<Mask>((point.materials[n] == material ? 1U : 0U) << n);
    return mask;
}

/// The four voxels on a side of an axis; side: 0 below, 1 above.
Mask half_of(unsigned axis, unsigned side) {
    Mask mask = 0;
    for (unsigned n = 0; n < 8; ++n) mask |= static_cast<Mask>(((n >> axis & 1) == side ? 1U : 0U) << n);
    return mask;
}

/// Whether the points that follow in a direction have this mask.
bool is_flat(const LabelNet& net, Index at, unsigned direction, std::uint32_t material, Mask mask) {
    for (int step = 0; step < kFlat; ++step) {
        at = net.points[at].next[direction];
        if (at == kNone || mask_of(net.points[at], material) != mask) return false;
    }
    return true;
}

/// Whether a material, or what is around it, has a sharp edge along an axis.
bool is_sharp(const LabelNet& net, Index p, unsigned axis, std::uint32_t material) {
    const unsigned b = (axis + 1) % 3, c = (axis + 2) % 3;
    const Mask mask = mask_of(net.points[p], material);
    for (unsigned sides = 0; sides < 4; ++sides) {
        const unsigned in_b = sides & 1, in_c = sides >> 1;
        const Mask half_b = half_of(b, in_b), half_c = half_of(c, in_c), quarter = half_b & half_c;
        const auto other = [](Mask of_eight) { return static_cast<Mask>(~of_eight); };
        if (mask == quarter) {
            return is_flat(net, p, 2 * c + in_c, material, half_b) && is_flat(net, p, 2 * b + in_b, material, half_c);
        }
        if (mask == other(quarter)) {
            return is_flat(net, p, 2 * c + in_c, material, other(half_b)) &&
                   is_flat(net, p, 2 * b + in_b, material, other(half_c));
        }
    }
    return false;
}

}  // namespace

void mark_sharp_edges(LabelNet& net) {
    std::vector<std::uint8_t> sharp(net.points.size(), 0);  // bits: the axes of edges
    parallel_each(net.points.size(), [&](std::size_t p) {
        const LabelNet::Point& point = net.points[p];
        for (unsigned axis = 0; axis < 3; ++axis) {
            for (unsigned n = 0; n < 8 && (sharp[p] >> axis & 1) == 0; ++n) {
                if (is_sharp(net, static_cast<Index>(p), axis, point.materials[n]))
                    sharp[p] |= static_cast<std::uint8_t>(1U << axis);
            }
        }
    });
    for (std::size_t p = 0; p < net.points.size(); ++p) {
        for (unsigned d = 0; d < 6; ++d) {
            const Index next = net.points[p].next[d];
            if ((sharp[p] >> d / 2 & 1) == 0 || next == kNone) continue;
            net.points[p].lines |= static_cast<std::uint8_t>(1U << d);
            net.points[next].lines |= static_cast<std::uint8_t>(1U << (d ^ 1));
        }
    }
}

}  // namespace subvol::detail
