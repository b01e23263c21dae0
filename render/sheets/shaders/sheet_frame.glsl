// SPDX-License-Identifier: Apache-2.0
// What does not change from sheet to sheet, under the names of splat_classify.glsl and splat_light.glsl.
uniform vec4 unit;            // of the table's prefixes
uniform float half_weight;    // where there is no boundary: the volume ends where weights fall below
uniform float least_gradient; // at which half of a surface is seen
uniform vec4 material;        // ambient, diffuse, specular, shininess
uniform vec4 key;             // towards the key light, of unit length
const bool perspective = PERSPECTIVE == 1;

vec2 ray;  // slope of the pixel's
