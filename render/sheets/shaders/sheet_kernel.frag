#version 450
// SPDX-License-Identifier: Apache-2.0
// The contribution of a kernel to the sums of a sheet.
layout(location = 0) uniform vec2 middle_px;
layout(location = 3) uniform float across;
layout(location = 5) uniform float pixel;

layout(location = 0) flat in uint splat;
layout(location = 1) flat in vec4 place;
layout(location = 2) flat in vec4 shape;
layout(location = 3) flat in vec4 values;
layout(location = 4) flat in vec3 depths;

layout(location = 0) out vec2 sums;  // w, w·v
#if SHADED || COLORED
layout(location = 1) out vec4 more_sums;  // w·∇v, and w·v of the colour's channel
#endif

void main() {
    vec2 slope = (gl_FragCoord.xy - middle_px) * vec2(pixel, -pixel);
    vec2 d = slope * across - place.xy;
    float zs = place.z;
    vec2 scaled = vec2(shape.x * d.x + shape.y * d.y, shape.z * d.y);
    float e = dot(scaled, scaled) + place.w;
    float w = kernel_weight(splat, d, zs, e);
    float v = shape.w * e + (values.y * d.x + (values.z * d.y + values.x));
#if BENT
    v += bend_value(bends[splat], d, zs);
#endif
    sums = vec2(w, w * v);
#if SHADED || COLORED
    vec4 more = vec4(0.0);
#if SHADED
    float twice = 2.0 * shape.w;
    more.xyz = vec3(twice * (shape.x * scaled.x) + values.y, twice * (shape.y * scaled.x + shape.z * scaled.y) + values.z,
                    twice * depths.z * zs + values.w);
#if BENT
    more.xyz += bend_gradient(bends[splat], d, zs);
#endif
    more.z -= dot(depths.xy, more.xy);  // offsets are relative to the section's middle, which moves with the depth
#endif
#if COLORED
    EyeColor c = colors[splat];
    more.w = c.moment * e + (c.gradient.x * d.x + (c.gradient.y * d.y + (c.value_slope * zs + c.value)));
#if BENT
    more.w += bend_value(color_bends[splat], d, zs);
#endif
#endif
    more_sums = w * more;
#endif
}
