#version 450
// SPDX-License-Identifier: Apache-2.0
// The section of a kernel with a sheet: a rectangle around it, as two triangles.
layout(std430, binding = 6) readonly buffer Listed { uint listed[]; };
layout(location = 0) uniform vec2 middle_px;
layout(location = 1) uniform vec2 size_px;
layout(location = 2) uniform float sheet_z;
layout(location = 3) uniform float across;  // world length of a unit of slope
layout(location = 4) uniform float to_pixels;

layout(location = 0) flat out uint splat;
layout(location = 1) flat out vec4 place;   // middle of the section, z_s, the least e
layout(location = 2) flat out vec4 shape;   // the root's xx, xy, yy; the moment
layout(location = 3) flat out vec4 values;  // at the middle, and its gradient; its slope along the middle
layout(location = 4) flat out vec3 depths;  // shear, 1 / S_zz

const float kMargin_px = 0.05;  // rasterisers round places to 1/256 px

void main() {
    uint id = listed[gl_VertexID / 6];
    EyeSplat s = splats[id];
    float zs = sheet_z - s.depth, e = zs * zs * s.inv_szz;
    vec2 middle = s.center + s.shear * zs;
    splat = id;
    place = vec4(middle, zs, e);
    shape = vec4(s.root_xx, s.root_xy, s.root_yy, s.moment);
    values = vec4(s.value + zs * s.value_slope, s.gradient, s.value_slope);
    depths = vec3(s.shear, s.inv_szz);

    int turn = gl_VertexID % 6, at = turn < 3 ? turn : turn - 2;  // corners 0 1 2, 1 2 3
    vec2 corner = vec2(at & 1, at >> 1) * 2.0 - 1.0;
    vec2 half_px = s.extent * sqrt(max(1.0 - e, 0.0)) * to_pixels + kMargin_px;
    // Rows run downwards, in the target too.
    vec2 at_px = middle_px + vec2(middle.x, -middle.y) * to_pixels + corner * half_px;
    gl_Position = vec4(clamp(at_px, vec2(-1.0), size_px + 1.0) / size_px * 2.0 - 1.0, 0.0, 1.0);
}
