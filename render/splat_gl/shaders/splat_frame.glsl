// SPDX-License-Identifier: Apache-2.0
// What the splatter's shaders know of a frame; gl_splat_frame.h has the same. The host puts in the constants: kReach, kBatch,
// kTile and so on, what the scene has (BENT, COLORED …), and where a kernel's extras are.
layout(std140, binding = 0) uniform Frame {
    dvec4 right, up, forward;  // rotation to eye space; the last parts: x, y of the middle there
    dvec4 cells;               // value · x + y are cells of the table; z, w for the second channel
    vec4 unit;                 // of the table's prefixes
    vec4 key;                  // towards the key light, of unit length
    vec4 material;             // ambient, diffuse, specular, shininess
    ivec2 size, tiles;
    int sheets, batches, first_batch, end_batch;  // the batches of this pass
    uint kernels, most_entries;
    bool perspective, all_visible;
    float first_depth, sheet_distance, middle_depth, near_depth;
    float pixel, value_offset, color_offset, half_weight;
    float least_gradient, kernel_cells;
};

const float kNever = 3e38;

// Ellipsoids in eye space: eye_splats.h says what the numbers are.
struct Splat {
    vec4 place;   // center x, y, depth, 1 / S_zz
    vec4 shape;   // shear x, y, root xx, xy
    vec4 slope;   // root yy, value, gradient x, y
    vec4 rest;    // value slope, moment, extent x, y
};

float sheet_depth(int sheet) { return fma(float(sheet), sheet_distance, first_depth); }
