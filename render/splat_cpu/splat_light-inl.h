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

/// gradient: in cells for each world length, in eye space
/// to_eye:   of unit length
/// least:    the gradient at which shading has half its effect
HWY_ATTR inline Light light(const Shading& shading, const Vector& gradient, const Vector& to_eye, float least) {
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
    const auto half = hn::Set(d, 0.5f);
    const auto lit = hn::MulAdd(set(shading.diffuse), hn::Mul(half, hn::Add(head, side)), set(shading.ambient));
    const auto shine =
        hn::Mul(set(shading.specular), hn::Mul(half, hn::Add(gloss(head), gloss(hn::Abs(dot(normal, halfway))))));
    // Where the value hardly changes there is no surface to light.
    const auto square = dot(gradient, gradient);
    const auto surface = hn::Div(square, hn::Add(square, hn::Set(d, least * least)));
    const auto one = hn::Set(d, 1.0f);
    return {hn::MulAdd(surface, hn::Sub(lit, one), one), hn::Mul(surface, shine)};
}

}  // namespace subvol::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
