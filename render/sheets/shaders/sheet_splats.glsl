// SPDX-License-Identifier: Apache-2.0
// Kernels in eye space, as eye_splats.h lays them out, and what they add to a place on a sheet. Places are told by their
// offset from the middle of the kernel's section, z_s, and e.
struct EyeSplat {
    vec2 center;
    float depth, inv_szz;
    vec2 shear;
    float root_xx, root_xy, root_yy, value;
    vec2 gradient;
    float value_slope, moment;
    vec2 extent;
};
struct EyeBend {
    float zz, zx, zy, xx, xy, yy, unused0, unused1;
};
struct EyeColor {
    float value, value_slope;
    vec2 gradient;
    float moment, unused0, unused1, unused2;
};
layout(std430, binding = 0) readonly buffer Splats { EyeSplat splats[]; };
layout(std430, binding = 1) readonly buffer Bends { EyeBend bends[]; };
layout(std430, binding = 2) readonly buffer Colors { EyeColor colors[]; };
layout(std430, binding = 3) readonly buffer ColorBends { EyeBend color_bends[]; };
layout(std430, binding = 4) readonly buffer Axes { vec4 axes[][3]; };
layout(std430, binding = 5) readonly buffer KernelTable { float kernel_table[]; };

// Linear between the table's entries; 0 beyond.
float kernel_profile(float t) {
    float last = float(KERNEL_STEPS), at = min(t * last, last), cell = min(floor(at), last - 1.0);
    float low = kernel_table[int(cell)], high = kernel_table[int(cell) + 1];
    return (at - cell) * (high - low) + low;
}

float kernel_weight(uint id, vec2 offset, float zs, float e) {
#if KERNEL_SHAPE == 0
    float left = max(1.0 - e, 0.0);
    return left * left * left;
#elif KERNEL_SHAPE == 1
    return kernel_profile(e);
#else
    float product = 1.0;
    for (int a = 0; a < 3; ++a) product *= kernel_profile(abs(dot(axes[id][a].xyz, vec3(offset, zs))));
    return product;
#endif
}

float bend_value(EyeBend b, vec2 d, float zs) {
    return zs * (b.zz * zs + b.zx * d.x + b.zy * d.y) + d.x * (b.xx * d.x + 2.0 * b.xy * d.y) + b.yy * d.y * d.y;
}

// The gradient of that: in the picture's plane, and along the section's middle.
vec3 bend_gradient(EyeBend b, vec2 d, float zs) {
    return vec3(b.zx * zs + 2.0 * (b.xx * d.x + b.xy * d.y), b.zy * zs + 2.0 * (b.xy * d.x + b.yy * d.y),
                2.0 * b.zz * zs + b.zx * d.x + b.zy * d.y);
}
