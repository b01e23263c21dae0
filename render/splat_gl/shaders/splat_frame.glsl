// SPDX-License-Identifier: Apache-2.0
// The data of a frame for the splatter's shaders; the same as in gl_splat_frame.h. The host defines the constants kReach,
// kBatch, kTile and so on, the features of the scene (BENT, COLORED …), and the places of a kernel's extras.
layout(std140, binding = 0) uniform Frame {
    dvec4 right, up, forward;  // rotation to eye space; the last components: x, y of the middle there
    dvec4 cells;               // value · x + y is in cells of the table; z, w for the second channel
    vec4 unit;                 // of the table's prefixes
    vec4 key;                  // towards the key light, of unit length; the part of the light at the eye
    vec4 material;             // ambient, diffuse, specular, shininess
    ivec2 size, tiles;
    int sheets, batches, first_batch, end_batch;  // the batches of this pass
    uint kernels, most_entries;
    bool perspective, all_visible;
    float first_depth, sheet_distance, middle_depth, near_depth;
    float pixel, value_offset, color_offset, half_weight;
    float least_gradient, kernel_cells;
    float unlit_ambient;
    bool finer;                // whether cells of pixels and sheets have more sheets
    vec4 to_light[3];  // from eye space to the nodes of the light volume
    ivec4 light_nodes;
};

const float kNever = 3e38;

// Whether rays have intervals: there is a boundary, or a clip. A slice is an interval without length.
#define INTERVALS (!UNBOUNDED || CLIPPED)

// Ellipsoids in eye space: splat/eye_splats.h explains the numbers.
struct Splat {
    vec4 place;   // center x, y, depth, 1 / S_zz
    vec4 shape;   // shear x, y, root xx, xy
    vec4 slope;   // root yy, value, gradient x, y
    vec4 rest;    // value slope, moment, extent x, y
};

// place: between two sheets, too
float depth_at(float place) { return fma(place, sheet_distance, first_depth); }
float sheet_depth(int sheet) { return depth_at(float(sheet)); }
