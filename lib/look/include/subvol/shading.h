// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "subvol/transfer_function.h"
#include "subvol/vec.h"

namespace subvol {

/// Light on surfaces, the same for every renderer, the window and the page: a light at the eye, which fills in, and a key light
/// that turns with the camera, so that no view is darker than another one. Colours carry values, so by default nothing gleams
/// (specular is 0), and no direction of a surface gets more light than there is: white is white where a surface faces halfway
/// between the two lights, .9 of it where it faces the eye, and nothing is cut off. Where all values have one colour, light
/// alone shows the shape: `shading_for` then gives less light from all around, and more of it to the key light.
///
/// Inside the volume surfaces are those of equal value, lit on either side; where the value hardly changes there is no surface,
/// and colours are not changed. Where the volume is opaque already at its boundary, that is the surface: it is lit by its own
/// normals, which are smooth except at creases. With the eye inside such a solid one sees the material at the eye, in the
/// colour of its value there and without light, for there is no surface before it; every method draws that.
struct Shading {
    double ambient = 0.3;  ///< part of the light from all around, ≥ 0
    double diffuse = 0.8;  ///< part of the light by the cosines to the eye and to the key light, ≥ 0
    double head = 0.5;     ///< the part of the diffuse light that is at the eye, 0 to 1; the rest is the key light's
    /// Gloss of Blinn and Phong as a part of the light, half of it from each of the two lights, added in white; ≥ 0
    double specular = 0;
    double shininess = 32;
    Vec3 key{-0.5, 0.7, -0.5};  ///< towards the key light, in eye space (right, up, away from the eye)
};

/// The light on surfaces of one colour: .08 of it comes from all around, and three quarters of the rest are the key light's.
[[nodiscard]] Shading plain_shading();

/// The light of a lit picture in the colours of a map: `plain_shading` if the map has a single colour, else `Shading{}`.
[[nodiscard]] Shading shading_for(const TransferFunction& map);

namespace detail {

/// The effect of light on a colour: a factor, and white that is added.
struct SurfaceLight {
    float diffuse = 1, specular = 0;
};

/// The light on a surface. normal, to_eye: of unit length, in eye space
/// arrives: the part of the key light, and of that from all around
[[nodiscard]] SurfaceLight surface_light(const Shading& shading, const Vec3& normal, const Vec3& to_eye,
                                         const std::array<float, 2>& arrives = {1, 1});

}  // namespace detail

}  // namespace subvol
