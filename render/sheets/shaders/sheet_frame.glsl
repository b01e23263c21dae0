// SPDX-License-Identifier: Apache-2.0
// Data that is the same for all sheets, with the names that splat_classify.glsl and splat_light.glsl use.
uniform vec4 unit;            // of the table's prefixes
uniform float half_weight;    // without a boundary: the volume ends where the sum of weights falls below it
uniform float least_gradient; // at which shading has half its effect
uniform vec4 material;        // ambient, diffuse, specular, shininess
uniform vec4 key;             // towards the key light, of unit length
const bool perspective = PERSPECTIVE == 1;

vec2 ray;  // slope of the pixel's ray
