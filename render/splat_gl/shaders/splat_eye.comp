#version 450
// SPDX-License-Identifier: Apache-2.0
// Converts kernels to eye space and counts the bins (tile, batch) that each one meets, as splat/eye_splats.cpp and
// splat/splat_frame.cpp do.
layout(local_size_x = 256) in;
struct Kernel {
    vec4 center;    // relative to the scene's middle; value
    vec4 frame;     // xx xy xz yy
    vec4 gradient;  // frame's yz, zz; gradient x, y
    vec4 rest;      // gradient z, moment, largest difference of the value from its middle over the support, unused
};
layout(std430, binding = 0) readonly buffer Kernels { Kernel kernel[]; };
layout(std430, binding = 1) readonly buffer KernelExtras { vec4 kernel_extras[]; };
layout(std430, binding = 2) writeonly buffer Splats { Splat splats[]; };
layout(std430, binding = 3) writeonly buffer SplatExtras { vec4 splat_extras[]; };
layout(std430, binding = 4) writeonly buffer Ranges { vec2 ranges[]; };
layout(std430, binding = 5) writeonly buffer Rects { uvec4 rects[]; };    // x, y, batch: first | count << 16
layout(std430, binding = 6) writeonly buffer Counts { uint counts[]; };
layout(std430, binding = 7) buffer Total { uint total[2]; };  // 64 bits

const uint kMostOfOne = 1u << 23;  // the most entries of one kernel

shared uint group_entries;

struct Section {
    double szz, cxx, cxy, cyy;
    dvec2 shear;
};

dvec3 to_eye(dvec3 v) { return dvec3(dot(right.xyz, v), dot(up.xyz, v), dot(forward.xyz, v)); }

dmat3 symmetric(vec4 a, vec2 b) { return dmat3(a.x, a.y, a.z, a.y, a.w, b.x, a.z, b.x, b.y); }

Section section_of(dmat3 frame) {
    dvec3 along = frame * forward.xyz, sx = frame * right.xyz, sy = frame * up.xyz;
    Section c;
    c.szz = dot(forward.xyz, along);
    double xz = dot(right.xyz, along), yz = dot(up.xyz, along);
    c.shear = dvec2(xz / c.szz, yz / c.szz);
    c.cxx = dot(right.xyz, sx) - xz * c.shear.x;
    c.cxy = dot(right.xyz, sy) - xz * c.shear.y;
    c.cyy = dot(up.xyz, sy) - yz * c.shear.y;
    return c;
}

#if BENT
void write_bend(uint to, uint from, double scale, Section c) {
    dmat3 h = symmetric(kernel_extras[from], kernel_extras[from + 1u].xy);
    double half_scale = 0.5lf * scale;
    dvec3 x = half_scale * to_eye(h * right.xyz), y = half_scale * to_eye(h * up.xyz), z = half_scale * to_eye(h * forward.xyz);
    dvec3 sheared = c.shear.x * x + c.shear.y * y + z;
    splat_extras[to] = vec4(dot(dvec3(c.shear, 1.0lf), sheared), 2.0lf * sheared.x, 2.0lf * sheared.y, x.x);
    splat_extras[to + 1u] = vec4(y.x, y.y, 0.0, 0.0);
}
#endif

void write_extras(uint id, Section c) {
    uint base = id * kExtras;
#if BENT
    write_bend(base + kBendAt, base + kBendAt, cells.x, c);
#endif
#if COLORED
    vec4 own = kernel_extras[base + kColorAt];
    dvec3 g = cells.z * to_eye(dvec3(own.yzw));
    splat_extras[base + kColorAt] =
        vec4(double(own.x) * cells.z + cells.w, g.x * c.shear.x + g.y * c.shear.y + g.z, g.x, g.y);
    splat_extras[base + kColorAt + 1u] = vec4(double(kernel_extras[base + kColorAt + 1u].x) * cells.z * kReach, 0.0, 0.0, 0.0);
#if BENT
    write_bend(base + kColorBendAt, base + kColorBendAt, cells.z, c);
#endif
#endif
#if SEPARABLE
    for (uint row = 0u; row < 3u; ++row) {
        dvec3 r = to_eye(dvec3(kernel_extras[base + kAxesAt + row].xyz));
        splat_extras[base + kAxesAt + row] = vec4(r.x, r.y, r.x * c.shear.x + r.y * c.shear.y + r.z, 0.0);
    }
#endif
}

Splat splat_of(Kernel k, Section c) {
    dvec3 center = to_eye(dvec3(k.center.xyz)), g = cells.x * to_eye(dvec3(k.gradient.zw, k.rest.x));
    double det = c.cxx * c.cyy - c.cxy * c.cxy;
    Splat s;
    s.place = vec4(right.w + center.x, up.w + center.y, center.z, 1.0lf / c.szz);
    s.shape = vec4(c.shear, sqrt(c.cyy / det), -c.cxy / sqrt(c.cyy * det));
    s.slope = vec4(1.0lf / sqrt(c.cyy), double(k.center.w) * cells.x + cells.y, g.xy);
    s.rest = vec4(g.x * c.shear.x + g.y * c.shear.y + g.z, double(k.rest.y) * cells.x * kReach, sqrt(max(c.cxx, 0.0lf)),
                  sqrt(max(c.cyy, 0.0lf)));
    return s;
}

// Bounds of a kernel's value over its support, in cells; widened by more than rounding.
vec2 range_of(Kernel k, Splat s) {
    float bow = s.rest.y, spread = k.rest.z * abs(float(cells.x)) * 1.001 + 1e-5 * (abs(s.slope.y) + abs(bow)) + 0.01;
    return vec2(s.slope.y - spread + min(bow, 0.0), s.slope.y + spread + max(bow, 0.0));
}

// Pixels from the middle of the picture that an interval of eye space spans between two depths.
vec2 pixels(float low, float high, float front, float back) {
    float per_pixel = 1.0 / pixel;
    if (!perspective) return vec2(low, high) * per_pixel;
    float a = per_pixel / (middle_depth + front), b = per_pixel / (middle_depth + back);
    return vec2(min(low * a, low * b), max(high * a, high * b));
}

// First and last tile; none if the last is before the first. With a pixel more on each side, so that rounding does not lose a
// kernel's rim.
ivec2 tile_range(vec2 reach, int count, int pixels) {
    if (!(reach.y > -1.0) || !(reach.x < float(pixels) + 1.0)) return ivec2(0, -1);
    return ivec2(clamp((reach + vec2(-1.0, 1.0)) / float(kTile), 0.0, float(count - 1)));
}

// First and last batch, with half a sheet more on each side; and one behind if there may be more sheets before that.
ivec2 batch_range(float depth, float reach) {
    vec2 sheet = clamp((vec2(depth - reach, depth + reach) - first_depth) * (1.0 / sheet_distance), -1.0, float(sheets));
    ivec2 of_sheet = ivec2(max(int(sheet.x - 0.5), 0), min(int(sheet.y + (finer ? 1.5 : 0.5)), sheets - 1));
    return ivec2(max(of_sheet.x / kBatch, first_batch), min(of_sheet.y / kBatch, end_batch - 1));
}

uint find_bins(uint id, Splat s) {
    rects[id] = uvec4(0u);
    float reach = 1.0 / sqrt(s.place.w);
    // Between the sheets of two passes rays may enter the volume, or more sheets lie: there both have all kernels.
    float front = max(s.place.z - reach, sheet_depth(first_batch * kBatch - (finer ? 1 : 0)));
    float back = min(s.place.z + reach, sheet_depth(min(end_batch * kBatch, sheets - 1)));
    if (!(front <= back + 1e-3 * sheet_distance)) return 0u;
    vec2 across = s.shape.xy * reach, half_size = sqrt(s.rest.zw * s.rest.zw + across * across);
    vec2 x_px = pixels(s.place.x - half_size.x, s.place.x + half_size.x, front, back);
    vec2 y_px = pixels(s.place.y - half_size.y, s.place.y + half_size.y, front, back);
    ivec2 x = tile_range(0.5 * float(size.x) + x_px, tiles.x, size.x);
    ivec2 y = tile_range(0.5 * float(size.y) - y_px.yx, tiles.y, size.y);
    ivec2 batch = batch_range(s.place.z, reach);
    if (x.y < x.x || y.y < y.x || batch.y < batch.x) return 0u;
    uvec3 count = uvec3(x.y - x.x, y.y - y.x, batch.y - batch.x) + 1u;
    rects[id] = uvec4(uvec3(x.x, y.x, batch.x) | count << 16, 0u);
    uint in_tiles = count.x * count.y;
    return in_tiles > kMostOfOne || in_tiles * count.z / count.z != in_tiles ? kMostOfOne + 1u : in_tiles * count.z;
}

void main() {
    uint id = group_number() * kThreads + gl_LocalInvocationIndex;
    if (gl_LocalInvocationIndex == 0u) group_entries = 0u;
    barrier();
    if (id < kernels) {
        Kernel k = kernel[id];
        Section c = section_of(double(kReach) * symmetric(k.frame, k.gradient.xy));
        Splat s = splat_of(k, c);
        splats[id] = s;
        write_extras(id, c);
#if CONVEX
        ranges[id] = range_of(k, s);
#endif
        uint bins = find_bins(id, s);
        counts[id] = bins;
        atomicAdd(group_entries, min(bins, kMostOfOne));
        if (bins > kMostOfOne) atomicAdd(total[1], 1u);  // too many, regardless of the other kernels
    }
    barrier();
    if (gl_LocalInvocationIndex != 0u || group_entries == 0u) return;
    uint before = atomicAdd(total[0], group_entries);
    if (before + group_entries < before) atomicAdd(total[1], 1u);
}
