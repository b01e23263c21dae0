// SPDX-License-Identifier: Apache-2.0
// Light on the surfaces of equal value (Shading). Included once for every instruction set: see splat_cpu.cpp.
#if defined(SUBVOL_SPLAT_LIGHT_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef SUBVOL_SPLAT_LIGHT_INL_H
#undef SUBVOL_SPLAT_LIGHT_INL_H
#else
#define SUBVOL_SPLAT_LIGHT_INL_H
#endif

#include <hwy/contrib/math/math-inl.h>
#include <hwy/highway.h>

#include "splat_sums-inl.h"

HWY_BEFORE_NAMESPACE();
namespace subvol::detail::HWY_NAMESPACE {

/// The effect of light on a colour: a factor, and white that is added.
struct Light {
    Floats diffuse, specular;
};

struct Vector {
    Floats x, y, z;
};

HWY_ATTR inline Floats dot(const Vector& a, const Vector& b) {
    return hn::MulAdd(a.x, b.x, hn::MulAdd(a.y, b.y, hn::Mul(a.z, b.z)));
}

HWY_ATTR inline Vector normalize(const Vector& v) {
    const Lanes d;
    const auto scale = hn::Div(hn::Set(d, 1.0f), hn::Sqrt(hn::Max(dot(v, v), hn::Set(d, 1e-30f))));
    return {hn::Mul(v.x, scale), hn::Mul(v.y, scale), hn::Mul(v.z, scale)};
}

/// The part of the key light that arrives, and of that from all around.
struct Arrival {
    Floats key, open;
};

/// The light that arrives at places in eye space, with relative depths.
HWY_ATTR inline Arrival arrival_at(const LightVolume& light, const EyeToNodes& rows, const Vector& eye) {
    const Lanes d;
    const IntLanes di;
    Floats part[3];
    Ints cell[3];
    for (std::size_t k = 0; k < 3; ++k) {
        const auto set = [&](std::size_t c) HWY_ATTR { return hn::Set(d, rows[k][c]); };
        auto x = hn::MulAdd(set(0), eye.x, hn::MulAdd(set(1), eye.y, hn::MulAdd(set(2), eye.z, set(3))));
        x = hn::Min(hn::Max(x, hn::Zero(d)), hn::Set(d, static_cast<float>(light.size[k] - 1)));
        const auto low = hn::Min(hn::Floor(x), hn::Set(d, static_cast<float>(light.size[k] - 2)));
        part[k] = hn::Sub(x, low);
        cell[k] = hn::ConvertTo(di, low);
    }
    const auto width = hn::Set(di, light.size[0]), height = hn::Set(di, light.size[1]);
    const auto first = hn::Add(hn::Mul(hn::Add(hn::Mul(cell[2], height), cell[1]), width), cell[0]);
    const float* nodes = light.nodes.front().data();
    const auto one = hn::Set(d, 1.0f);
    Arrival sum{hn::Zero(d), hn::Zero(d)};
    for (int corner = 0; corner < 8; ++corner) {
        const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
        const auto weight = hn::Mul(x ? part[0] : hn::Sub(one, part[0]),
                                    hn::Mul(y ? part[1] : hn::Sub(one, part[1]), z ? part[2] : hn::Sub(one, part[2])));
        const auto node = hn::Add(first, hn::Set(di, (z * light.size[1] + y) * light.size[0] + x));
        const auto at = hn::Add(node, node);
        sum.key = hn::MulAdd(weight, hn::GatherIndex(d, nodes, at), sum.key);
        sum.open = hn::MulAdd(weight, hn::GatherIndex(d, nodes, hn::Add(at, hn::Set(di, 1))), sum.open);
    }
    return sum;
}

/// Where there is no surface.
HWY_ATTR inline Light unlit(const Shading& shading, const Arrival& arrives) {
    const Lanes d;
    const auto one = hn::Set(d, 1.0f), shadow = hn::Set(d, static_cast<float>(1 - shading.ambient));
    return {hn::Mul(arrives.open, hn::NegMulAdd(shadow, hn::Sub(one, arrives.key), one)), hn::Zero(d)};
}

/// gradient: in cells for each world length, in eye space
/// to_eye:   of unit length
/// least:    the gradient at which shading has half its effect
HWY_ATTR inline Light light(const Shading& shading, const Vector& gradient, const Vector& to_eye, float least,
                            const Arrival& arrives) {
    const Lanes d;
    const auto set = [&](double v) HWY_ATTR { return hn::Set(d, static_cast<float>(v)); };
    const Vec3 key = glm::normalize(shading.key);
    const Vector to_key{set(key.x), set(key.y), set(key.z)};
    const Vector halfway = normalize({hn::Add(to_key.x, to_eye.x), hn::Add(to_key.y, to_eye.y), hn::Add(to_key.z, to_eye.z)});
    const Vector normal = normalize(gradient);
    const auto head = hn::Abs(dot(normal, to_eye)), side = hn::Abs(dot(normal, to_key));
    const auto gloss = [&](Floats cosine) HWY_ATTR {
        return hn::Exp(d, hn::Mul(set(shading.shininess), hn::Log(d, hn::Max(cosine, hn::Set(d, 1e-3f)))));
    };
    const auto half = hn::Set(d, 0.5f), from_eye = set(shading.head);
    const auto from_key = hn::Mul(hn::Sub(hn::Set(d, 1.0f), from_eye), side);
    const auto directed = hn::MulAdd(from_key, arrives.key, hn::Mul(from_eye, head));
    const auto lit = hn::MulAdd(set(shading.diffuse), directed, set(shading.ambient));
    const auto shine = hn::Mul(set(shading.specular),
                               hn::Mul(half, hn::MulAdd(gloss(hn::Abs(dot(normal, halfway))), arrives.key, gloss(head))));
    // Where the value hardly changes there is no surface to light.
    const auto square = dot(gradient, gradient);
    const auto surface = hn::Div(square, hn::Add(square, hn::Set(d, least * least)));
    const auto base = unlit(shading, arrives).diffuse;
    return {hn::MulAdd(surface, hn::Sub(hn::Mul(arrives.open, lit), base), base),
            hn::Mul(arrives.open, hn::Mul(surface, shine))};
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
