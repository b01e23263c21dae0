// SPDX-License-Identifier: Apache-2.0
// One step of a walk through tetrahedra (tet_walk.cpp) for sixteen rays at once, one in each lane of the vectors. It does what
// walk() does, with masks instead of branches, as the face by which a ray leaves is unpredictable:
//
//        c                  The ray came in through the face abc, drawn as the ray sees it: the ray is the point *.
//       / \                 d is the fourth corner (the apex). The three edges a-d, b-d, c-d divide the face, and
//      / * \                the signs of the areas (*,a,d), (*,b,d), (*,c,d) say which part contains *:
//     /  d  \                  left of a-d, not left of c-d:  b is dropped, the ray leaves through c a d
//    a-------b                 left of b-d, not left of a-d:  c is dropped, the ray leaves through a b d
//                              else:                          a is dropped, the ray leaves through b c d
//
// The dropped corner is replaced by d, and the rank of its id among the four selects the link to the next tetrahedron. Areas
// are rounded as in the scalar code (no fused operations), so both give the same bits. Lanes whose areas are too close to zero
// are reported as undecided, and the caller traces those rays one by one with exact signs. docs/adr/0013 gives the reasons.
// The walk from cell to cell is that of [garrity1990].
//
// Highway compiles this file once for every instruction set; the best one is chosen at run time.
#include "tet_packet.h"

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tet_packet.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Lanes = hn::CappedTag<double, 8>;
using IntLanes = hn::RebindToSigned<Lanes>;
using Doubles = hn::Vec<Lanes>;
using Ints = hn::Vec<IntLanes>;
using Mask = hn::Mask<Lanes>;

/// As EdgeSide, and whether the sign is certain.
struct Sides {
    Doubles area;
    Mask left, certain;
};

HWY_ATTR inline Sides side_of(Doubles ax, Doubles ay, Doubles bx, Doubles by) {
    const Lanes d;
    const auto left = hn::Mul(ax, by), right = hn::Mul(bx, ay);
    const auto area = hn::Sub(left, right);
    const auto bound = hn::Mul(hn::Set(d, kSideError), hn::Add(hn::Abs(left), hn::Abs(right)));
    return {area, hn::Gt(area, hn::Zero(d)), hn::Gt(hn::Abs(area), bound)};
}

HWY_ATTR inline Ints load(const TetPacket::LaneArray<std::int64_t>& row, std::size_t i) {
    return hn::Load(IntLanes(), row.data() + i);
}
HWY_ATTR inline Doubles load(const TetPacket::LaneArray<double>& row, std::size_t i) {
    return hn::Load(Lanes(), row.data() + i);
}
HWY_ATTR inline void store(Ints v, TetPacket::LaneArray<std::int64_t>& row, std::size_t i) {
    hn::Store(v, IntLanes(), row.data() + i);
}
HWY_ATTR inline void store(Doubles v, TetPacket::LaneArray<double>& row, std::size_t i) {
    hn::Store(v, Lanes(), row.data() + i);
}

/// Does the step for the lanes of one vector, from lane i on.
class VectorStep {
public:
    HWY_ATTR VectorStep(const TetMesh& mesh, TetPacket& packet, std::size_t i)
        : points_(&mesh.points.front().position.x), links_(mesh.links.data()), packet_(packet), i_(i) {}

    HWY_ATTR TetPacketEnds run() {
        const IntLanes di;
        apex_ = load(packet_.apex, i_);
        see_apex();
        decide();
        replace_corner();
        cross_face();
        const auto walking = hn::Ne(load(packet_.walking, i_), hn::Zero(di));
        const auto outside = enter_next(walking);
        return {bits(hn::And(walking, outside)), bits(hn::AndNot(hn::RebindMask(di, certain_), walking))};
    }

private:
    HWY_ATTR std::uint32_t bits(hn::Mask<IntLanes> mask) const {
        std::uint8_t bytes[8] = {};
        hn::StoreMaskBits(IntLanes(), mask, bytes);
        return std::uint32_t{bytes[0]} << i_;
    }

    HWY_ATTR void see_apex() {
        const Lanes d;
        const auto at = hn::ShiftLeft<2>(apex_);  // a point has four numbers
        const auto p = [&](std::size_t k) HWY_ATTR {
            const auto number = hn::GatherIndex(d, points_, hn::Add(at, load(packet_.axis[k], i_)));
            return hn::Sub(number, load(packet_.origin[k], i_));
        };
        const auto depth = p(2);
        x_ = hn::Sub(p(0), hn::Mul(load(packet_.slope_x, i_), depth));
        y_ = hn::Sub(p(1), hn::Mul(load(packet_.slope_y, i_), depth));
        t_ = hn::Mul(depth, load(packet_.per_depth, i_));
        value_ = hn::GatherIndex(d, points_, hn::Add(at, hn::Set(IntLanes(), 3)));
    }

    /// Finds which corner of a, b, c the apex replaces.
    HWY_ATTR void decide() {
        const auto side = [&](std::size_t k)
                              HWY_ATTR { return side_of(load(packet_.x[k], i_), load(packet_.y[k], i_), x_, y_); };
        const Sides a = side(0), b = side(1), c = side(2);
        certain_ = hn::And(a.certain, hn::And(b.certain, c.certain));
        drop_[1] = hn::AndNot(c.left, a.left);
        drop_[2] = hn::AndNot(a.left, b.left);
        drop_[0] = hn::Not(hn::Or(drop_[1], drop_[2]));
        const Doubles area[3] = {a.area, b.area, c.area};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t next = (k + 1) % 3;  // edge k → next
            auto edge = load(packet_.side[k], i_);
            edge = hn::IfThenElse(drop_[k], hn::Neg(area[next]), edge);
            side_[k] = hn::IfThenElse(drop_[next], area[k], edge);
        }
    }

    HWY_ATTR void replace_corner() {
        const IntLanes di;
        dropped_ = load(packet_.id[2], i_);
        auto less = hn::Zero(di);
        Ints id[3];
        for (std::size_t k = 0; k < 3; ++k) id[k] = load(packet_.id[k], i_);
        for (std::size_t k = 0; k < 2; ++k) dropped_ = hn::IfThenElse(hn::RebindMask(di, drop_[k]), id[k], dropped_);
        for (std::size_t k = 0; k < 3; ++k) {
            less = hn::Add(less, hn::VecFromMask(di, hn::Lt(id[k], dropped_)));
            store(hn::IfThenElse(hn::RebindMask(di, drop_[k]), apex_, id[k]), packet_.id[k], i_);
            replace(drop_[k], x_, packet_.x[k]);
            replace(drop_[k], y_, packet_.y[k]);
            store(side_[k], packet_.side[k], i_);
            corner_t_[k] = replace(drop_[k], t_, packet_.t[k]);
            corner_value_[k] = replace(drop_[k], value_, packet_.value[k]);
        }
        rank_ = hn::Neg(hn::Add(less, hn::VecFromMask(di, hn::Lt(apex_, dropped_))));
        store(dropped_, packet_.dropped, i_);
    }
    HWY_ATTR Doubles replace(Mask where, Doubles by, TetPacket::LaneArray<double>& row) {
        const auto v = hn::IfThenElse(where, by, load(row, i_));
        store(v, row, i_);
        return v;
    }

    /// As CrossedFace::crossing, and the stretch of ray that RayWalker would integrate.
    HWY_ATTR void cross_face() {
        const Lanes d;
        const auto zero = hn::Zero(d), one = hn::Set(d, 1.0);
        auto w0 = hn::Max(zero, side_[1]), w1 = hn::Max(zero, side_[2]), w2 = hn::Max(zero, side_[0]);
        const auto edge_on = hn::Not(hn::Gt(hn::Add(hn::Add(w0, w1), w2), zero));
        w0 = hn::IfThenElse(edge_on, one, w0);
        w1 = hn::IfThenElse(edge_on, one, w1);
        w2 = hn::IfThenElse(edge_on, one, w2);
        const auto scale = hn::Div(one, hn::Add(hn::Add(w0, w1), w2));
        const auto mean = [&](const Doubles(&v)[3]) HWY_ATTR {
            return hn::Mul(scale, hn::Add(hn::Add(hn::Mul(w0, v[0]), hn::Mul(w1, v[1])), hn::Mul(w2, v[2])));
        };
        const auto t = mean(corner_t_), value = mean(corner_value_);
        const auto last_t = load(packet_.here_t, i_), last_value = load(packet_.here_value, i_);
        const auto lit_t = load(packet_.lit_t, i_);
        const auto from = hn::Max(last_t, lit_t);
        const auto counts = hn::Gt(t, from);
        auto front = last_value;
        const auto late = hn::And(counts, hn::Gt(lit_t, last_t));
        if (HWY_UNLIKELY(!hn::AllFalse(d, late))) {  // folded mesh: depths up to lit_t have been integrated already
            const auto slope = hn::Div(hn::Sub(value, last_value), hn::Sub(t, last_t));
            front = hn::IfThenElse(late, hn::Add(last_value, hn::Mul(hn::Sub(from, last_t), slope)), front);
        }
        store(front, packet_.front, i_);
        store(value, packet_.back, i_);
        store(hn::IfThenElseZero(counts, hn::Mul(hn::Sub(t, from), load(packet_.speed, i_))), packet_.length, i_);
        store(hn::IfThenElse(counts, t, lit_t), packet_.lit_t, i_);
        store(hn::IfThenElse(counts, t, load(packet_.reached, i_)), packet_.reached, i_);
        store(t, packet_.here_t, i_);
        store(value, packet_.here_value, i_);
    }

    /// returns: the lanes that have no next tetrahedron
    HWY_ATTR hn::Mask<IntLanes> enter_next(hn::Mask<IntLanes> walking) {
        const IntLanes di;
        const auto low = hn::Set(di, 0xffffffff);
        const auto tet = load(packet_.tet, i_);
        static_assert(sizeof(TetLink) == sizeof(std::int64_t));
        const auto* const links = reinterpret_cast<const std::int64_t*>(links_);
        const auto link = hn::GatherIndex(di, links, hn::Add(hn::ShiftLeft<2>(tet), rank_));
        const auto next = hn::And(link, low);
        const auto outside = hn::Eq(next, low);
        const auto on = hn::AndNot(outside, walking);
        store(hn::IfThenElse(on, next, tet), packet_.tet, i_);
        store(hn::IfThenElse(on, hn::And(hn::ShiftRight<32>(link), low), apex_), packet_.apex, i_);
        return outside;
    }

    const double* points_;
    const std::array<TetLink, 4>* links_;
    TetPacket& packet_;
    std::size_t i_;
    Ints apex_, dropped_, rank_;
    Doubles x_, y_, t_, value_;
    Mask drop_[3], certain_;
    Doubles side_[3], corner_t_[3], corner_value_[3];
};

TetPacketEnds step_packet(const TetMesh& mesh, TetPacket& packet) {
    static_assert(sizeof(TetMesh::Point) == 4 * sizeof(double));
    TetPacketEnds ends;
    for (std::size_t i = 0; i < TetPacket::kLanes; i += hn::Lanes(Lanes())) {
        const TetPacketEnds some = VectorStep(mesh, packet, i).run();
        ends.boundary |= some.boundary;
        ends.undecided |= some.undecided;
    }
    return ends;
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace subvol::detail {

HWY_EXPORT(step_packet);

TetPacketEnds step(const TetMesh& mesh, TetPacket& packet) {
    return HWY_DYNAMIC_DISPATCH(step_packet)(mesh, packet);
}

}  // namespace subvol::detail
#endif
