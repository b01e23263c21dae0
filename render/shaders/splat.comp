#version 430
// One work group a tile, one invocation a pixel; batches of sheets front to back, sums in registers: no atomics, so the image is
// bitwise repeatable. Step for step what the CPU backend does; kLeastWeight and the like are put in by the host.
layout(local_size_x = 16, local_size_y = 16) in;

struct Splat {
    vec4 place;  // center x, y, depth, 1/S_zz
    vec4 shape;  // shear x, y, conic xx, xy
    vec4 slope;  // conic yy, value, gradient x, y
    vec4 rest;   // value slope, bend zz, extent x, y
    vec4 bend;   // bend zx, zy, xx, xy
    vec4 last;   // bend yy
};
layout(std430, binding = 0) readonly buffer Splats { Splat splats[]; };
layout(std430, binding = 1) readonly buffer BinOffsets { uint bin_offsets[]; };
layout(std430, binding = 2) readonly buffer BinSplats { uint bin_splats[]; };
layout(std430, binding = 3) readonly buffer IntervalOffsets { uint interval_offsets[]; };
layout(std430, binding = 4) readonly buffer IntervalDepths { vec2 intervals[]; };  // enter, exit
layout(std430, binding = 5) readonly buffer Prefixes { vec4 prefixes[]; };  // integrals of extinction, emission
layout(std430, binding = 6) readonly buffer Points { vec4 points[]; };      // extinction, colour
layout(std430, binding = 7) writeonly buffer Picture { vec4 picture[]; };

uniform ivec2 size;
uniform ivec2 tiles;
uniform int first_tile;
uniform int sheets;
uniform int batches;
uniform float first_depth;
uniform float sheet_distance;
uniform float pixel;
uniform bool perspective;
uniform vec2 table_range;

const int kBatch = SPLAT_BATCH;
const float kLeastWeight = SPLAT_LEAST_WEIGHT;
const float kLeastDifference = SPLAT_LEAST_DIFFERENCE;
const float kOpaque = SPLAT_OPAQUE;

// Table rows about a value: the lower row's number, and how far the value lies from it towards the next.
vec2 place(float f) {
    float at = clamp((f - table_range.x) * float(prefixes.length() - 1) / (table_range.y - table_range.x), 0.0,
                     float(prefixes.length() - 1));
    float cell = min(floor(at), float(prefixes.length() - 2));
    return vec2(cell, at - cell);
}

vec4 point(float f) {
    vec2 p = place(f);
    vec4 low = points[int(p.x)];
    return low + p.y * (points[int(p.x) + 1] - low);
}

// Beyond the table's ends extinction and colour are constant and the integrals go on with them.
vec4 prefix(float f) {
    vec2 p = place(f);
    vec4 low = prefixes[int(p.x)];
    float beyond = f - clamp(f, table_range.x, table_range.y);
    vec4 end = points[beyond < 0.0 ? 0 : points.length() - 1];
    return low + p.y * (prefixes[int(p.x) + 1] - low) + beyond * vec4(end.x, end.x * end.yzw);
}

// Optical depth (x) and emitted colour (yzw) of a stretch from value f0 to f1.
vec4 interval(float f0, float f1, float len) {
    if (abs(f1 - f0) < kLeastDifference * (table_range.y - table_range.x)) {
        vec4 middle = point(0.5 * (f0 + f1));
        float depth = len * max(middle.x, 0.0);
        return vec4(depth, (1.0 - exp(-depth)) * middle.yzw);
    }
    vec4 difference = prefix(f1) - prefix(f0);
    float depth = max(len * difference.x / (f1 - f0), 0.0);
    float emission = difference.x != 0.0 ? 1.0 / difference.x : 0.0;
    return vec4(depth, (1.0 - exp(-depth)) * difference.yzw * emission);
}

void main() {
    int tile = first_tile + int(gl_WorkGroupID.x);
    ivec2 at = ivec2(tile % tiles.x, tile / tiles.x) * 16 + ivec2(gl_LocalInvocationID.xy);
    if (at.x >= size.x || at.y >= size.y) return;
    uint id = uint(at.y) * uint(size.x) + uint(at.x);
    vec2 slopes = vec2((float(at.x) + 0.5 - 0.5 * float(size.x)) * pixel, (0.5 * float(size.y) - float(at.y) - 0.5) * pixel);
    float ray_length = perspective ? sqrt(1.0 + dot(slopes, slopes)) : 1.0;
    uint next = interval_offsets[id], end = interval_offsets[id + 1u];

    vec3 color = vec3(0.0);
    float transmittance = 1.0, last_value = 0.0;
    bool last_known = false;
    for (int batch = 0; batch < batches && next < end && transmittance >= kOpaque; ++batch) {
        float weight[kBatch], weighted[kBatch];
        for (int k = 0; k < kBatch; ++k) weight[k] = weighted[k] = 0.0;
        int first = batch * kBatch, count = min(kBatch, sheets - first);
        uint bin = uint(tile * batches + batch);
        for (uint i = bin_offsets[bin]; i < bin_offsets[bin + 1u]; ++i) {
            Splat s = splats[bin_splats[i]];
            for (int k = 0; k < count; ++k) {
                float depth = first_depth + float(first + k) * sheet_distance;
                float zs = depth - s.place.z, e0 = zs * zs * s.place.w;
                if (e0 >= 1.0) continue;
                vec2 d = slopes * (perspective ? depth : 1.0) - (s.place.xy + s.shape.xy * zs);
                float e = e0 + s.slope.x * d.y * d.y + d.x * (2.0 * s.shape.w * d.y + s.shape.z * d.x);
                float left = max(1.0 - e, 0.0), w = left * left * left;
                weight[k] += w;
                float row = s.slope.y + zs * (s.rest.x + s.rest.y * zs) + d.y * (s.slope.w + s.bend.y * zs + s.last.x * d.y);
                weighted[k] += w * (row + d.x * (s.slope.z + s.bend.x * zs + 2.0 * s.bend.w * d.y + s.bend.z * d.x));
            }
        }
        for (int k = 0; k < count && next < end && transmittance >= kOpaque; ++k) {
            bool known = weight[k] > kLeastWeight;
            float value = known ? weighted[k] / weight[k] : 0.0;
            float far = first_depth + float(first + k) * sheet_distance;
            float near = first_depth + float(first + k - 1) * sheet_distance;
            while (first + k > 0 && next < end && intervals[next].x < far) {
                float enter = max(intervals[next].x, near), leave = min(intervals[next].y, far);
                if (leave > enter && (known || last_known)) {
                    float front = last_known ? last_value : value, back = known ? value : last_value;
                    float f0 = front + (back - front) * (enter - near) / (far - near);
                    float f1 = front + (back - front) * (leave - near) / (far - near);
                    vec4 light = interval(f0, f1, (leave - enter) * ray_length);
                    color += transmittance * light.yzw;
                    transmittance *= exp(-light.x);
                }
                if (intervals[next].y > far) break;
                ++next;
            }
            last_value = value;
            last_known = known;
        }
    }
    picture[id] = vec4(color, 1.0 - transmittance);
}
