// SPDX-License-Identifier: Apache-2.0
// What a value looks like: splat_classify-inl.h.
struct Row {
    ivec4 prefix;
    vec4 mean, bend;
};
struct ColorRow {
    vec4 color, step_to_next;
};
layout(std430, binding = 7) readonly buffer Rows { Row rows[]; };
layout(std430, binding = 8) readonly buffer Visible { int visible[]; };
layout(std430, binding = 9) readonly buffer ColorRows { ColorRow color_rows[]; };

// A value's place in the table, and the four integrals from its cell's lower end.
struct Place {
    float x;
    ivec4 prefix;
    vec4 within;
};

int row_of(float x) { return int(clamp(floor(x), -1.0, float(kCells))) + 1; }

// How far a value lies in its row.
float part_of(float x) { return x - clamp(floor(x), -1.0, float(kCells)); }

Place place_of(float x) {
    Row row = rows[row_of(x)];
    precise float s = part_of(x);
    precise vec4 within = s * fma(vec4(s - 1.0), row.bend, row.mean);
    return Place(x, row.prefix, within);
}

// Mean extinction and emission of a stretch of ray between two values.
vec4 means(Place front, Place back) {
    precise float dx = back.x - front.x;
    precise vec4 mean;
    if (abs(dx) < kNearValues) {
        precise float x = 0.5 * (front.x + back.x);
        Row row = rows[row_of(x)];
        mean = fma(vec4(fma(2.0, part_of(x), -1.0)), row.bend, row.mean);
    } else {
        precise float inverse = 1.0 / dx;
        mean = max(fma(unit, vec4(back.prefix - front.prefix), back.within - front.within) * inverse, 0.0);
    }
    return mean;
}

vec3 color_at(float x) {
    ColorRow row = color_rows[row_of(x)];
    precise vec3 color = fma(vec3(part_of(x)), row.step_to_next.xyz, row.color.xyz);
    return color;
}

// Whether no value between two ends can be seen.
bool transparent(float x0, float x1) { return visible[row_of(max(x0, x1)) + 1] == visible[row_of(min(x0, x1))]; }
