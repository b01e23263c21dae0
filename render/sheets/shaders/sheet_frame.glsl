// SPDX-License-Identifier: Apache-2.0
// Data that is the same for all sheets, with the names that splat_classify.glsl and splat_light.glsl use.
layout(location = 0) uniform vec4 unit;             // of the table's prefixes
layout(location = 1) uniform float half_weight;     // without a boundary: the volume ends where the sum of weights falls below it
layout(location = 2) uniform float least_gradient;  // at which shading has half its effect
layout(location = 3) uniform vec4 material;         // ambient, diffuse, specular, shininess
layout(location = 4) uniform vec4 key;              // towards the key light, of unit length; the part of the light at the eye
const bool perspective = PERSPECTIVE == 1;

vec2 ray;  // slope of the pixel's ray
