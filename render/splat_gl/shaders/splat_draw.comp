#version 450
// SPDX-License-Identifier: Apache-2.0
// A work group for each tile, a thread for each pixel; batches of sheets from front to back, with sums in registers. Every
// order is fixed, and no number depends on where tiles and batches begin: pictures are bitwise reproducible.
layout(local_size_x = kTile, local_size_y = kTile) in;
layout(std430, binding = 2) readonly buffer Ranges { vec2 ranges[]; };
layout(std430, binding = 11) writeonly buffer Picture { vec4 picture[]; };
layout(std430, binding = 12) writeonly buffer Depths { float depths[]; };
struct State {
    vec4 color;    // transmittance in the last component
    vec4 going;    // depth, enter, exit; the number of the interval
    vec4 on_last;  // x, known, weight, color
    vec4 light;
};
layout(std430, binding = 13) buffer States { State states[]; };  // of the pixels, between passes

const int kNone = 0x7fffffff;

// Three of each: one is read, one is written and one is cleared between two barriers.
shared int next_batch[3];
shared int range_low[3];
shared int range_high[3];

uint pixel_id;
bool in_picture;
uint step_number = 0u;
uint next_end = 0u, last_end = 0u;  // the ends of the pixel's intervals that have no values yet
int ranged = -2;  // the batch to which `range` belongs
vec2 range;

int ordered(float f) {
    int bits = floatBitsToInt(f);
    return bits ^ ((bits >> 31) & 0x7fffffff);
}
float from_ordered(int i) { return intBitsToFloat(i ^ ((i >> 31) & 0x7fffffff)); }

void start_pixel(uint tile) {
    // Blocks of 8×4 pixels, so that the threads of a warp are neighbours.
    uint thread = gl_LocalInvocationIndex, lane = thread % 32u;
    block = thread / 32u;
    tile_px = ivec2(int(tile) % tiles.x, int(tile) / tiles.x) * kTile;
    ivec2 at = tile_px + ivec2(int(block) % kBlocksX * 8 + int(lane % 8u), int(block) / kBlocksX * 4 + int(lane / 8u));
    in_picture = at.x < size.x && at.y < size.y;
    pixel_id = in_picture ? uint(at.y) * uint(size.x) + uint(at.x) : 0u;
    precise vec2 slopes = vec2(float(at.x) + 0.5 - 0.5 * float(size.x), 0.5 * float(size.y) - (float(at.y) + 0.5)) * pixel;
    ray = slopes;
    precise float square = 1.0 + slopes.x * slopes.x + slopes.y * slopes.y;
    ray_length = perspective ? sqrt(square) : 1.0;

    beam = Beam(vec3(0.0), 1.0, 0.0);
    last = Sheet(0.0, false, 0.0, 0.0, vec2(0.0));
    enter_z = exit_z = kNever;
    interval = intervals_end = 0u;
    if (!in_picture) return;
#if !INTERVALS
    enter_z = near_depth;
#else
    interval = interval_ranges[pixel_id].x;
    intervals_end = interval_ranges[pixel_id].y;
    take_interval();
    next_end = 2u * interval;
    last_end = 2u * intervals_end;
    if (first_batch == 0) {
        for (uint i = next_end; i < last_end; ++i) ends[i].x = 3e38;
    }
#endif
}

void load_state() {
    if (!in_picture || first_batch == 0) return;
    State s = states[pixel_id];
    beam = Beam(s.color.rgb, s.color.w, s.going.x);
    enter_z = s.going.y;
    exit_z = s.going.z;
    interval = floatBitsToUint(s.going.w);
    last = Sheet(s.on_last.x, s.on_last.y > 0.0, s.on_last.z, s.on_last.w, s.light.xy);
}

void store() {
    if (!in_picture) return;
    if (end_batch < batches) {
        states[pixel_id] = State(vec4(beam.color, beam.transmittance), vec4(beam.depth, enter_z, exit_z, uintBitsToFloat(interval)),
                                 vec4(last.x, last.known ? 1.0 : 0.0, last.weight, last.color), vec4(last.light, 0.0, 0.0));
        return;
    }
    precise float opacity = 1.0 - beam.transmittance;
    precise float mean_depth = middle_depth + beam.depth / (opacity > 0.0 ? opacity : 1.0);
    picture[pixel_id] = vec4(beam.color, opacity);
    depths[pixel_id] = opacity > 0.0 ? mean_depth : uintBitsToFloat(0x7f800000u);
}

// The first batch of which the pixel needs a sheet: with the sheet before its interval, and a little for rounding.
int wanted_batch(int from) {
    if (enter_z == kNever) return kNone;
    float sheet = clamp((enter_z - first_depth) / sheet_distance - 1.01, 0.0, float(sheets - 1));
    return max(int(sheet) / kBatch, from);
}

// The first batch from `from` on that any pixel needs.
int vote(int from) {
    uint slot = ++step_number % 3u, ready = (step_number + 1u) % 3u;
    int wanted = wanted_batch(from);
    if (wanted < next_batch[slot]) atomicMin(next_batch[slot], wanted);
    if (gl_LocalInvocationIndex == 0u) {
        next_batch[ready] = range_low[ready] = kNone;
        range_high[ready] = -kNone;
    }
    barrier();
    return next_batch[slot];
}

// Bounds of the values of a bin's kernels.
vec2 range_of(uint bin) {
    uint slot = step_number % 3u;
    vec2 own = vec2(kNever, -kNever);
    for (uint i = bin_offsets[bin] + gl_LocalInvocationIndex; i < bin_offsets[bin + 1u]; i += kPixels) {
        vec2 r = ranges[bin_splats[i]];
        own = vec2(min(own.x, r.x), max(own.y, r.y));
    }
    if (own.x <= own.y) {
        atomicMin(range_low[slot], ordered(own.x));
        atomicMax(range_high[slot], ordered(own.y));
    }
    barrier();
    bool empty = range_low[slot] == kNone;
    return empty ? vec2(kNever, -kNever) : vec2(from_ordered(range_low[slot]), from_ordered(range_high[slot]));
}

// Whether all values between the sheets of a batch, and between it and the sheet before, are invisible. False for the first
// batch of a pass, as the kernels of the sheet before are not there, and for the last one, as the next pass needs its values.
bool invisible(int batch, uint bin) {
#if CONVEX
    if (all_visible || (batch == first_batch && batch > 0) || (batch + 1 == end_batch && end_batch < batches)) return false;
    vec2 own = range_of(bin), both = own;
    if (ranged == batch - 1) both = vec2(min(own.x, range.x), max(own.y, range.y));
    range = own;
    ranged = batch;
    return both.x > both.y || transparent(both.x, both.y);
#else
    return false;
#endif
}

Sheet here_on(float weight, float value, float color, vec3 gradient) {
    Sheet here = Sheet(value, true, weight, color, vec2(1.0, 0.0));
#if NORMALIZED
    here.known = weight > kLeastWeight;
    precise float x = here.known ? value / weight : 0.0, c = here.known ? color / weight : 0.0;
    float per_weight = 1.0 / (here.known ? weight : 1.0);
#else
    precise float x = value + value_offset, c = color + color_offset;
    const float per_weight = 1.0;
#endif
    here.x = clamp(x, -kFarCells, kFarCells);
    here.color = clamp(c, -kFarCells, kFarCells);
#if SHADED
    here.light = light_on(gradient * per_weight);
#endif
    return here;
}

Sheet first_sum() {
    float color = 0.0;
    vec3 gradient = vec3(0.0);
#if COLORED
    color = colors[0];
#endif
#if SHADED
    gradient = gradient_sums[0];
#endif
    return here_on(weights[0], values[0], color, gradient);
}

// Moves the next sheet's sums to the front, as registers cannot be indexed.
void shift_sums() {
    for (int k = 0; k + 1 < kBatch; ++k) {
        weights[k] = weights[k + 1];
        values[k] = values[k + 1];
#if COLORED
        colors[k] = colors[k + 1];
#endif
#if SHADED
        gradient_sums[k] = gradient_sums[k + 1];
#endif
    }
}

#if INTERVALS
// Whether any thread says so.
bool any_of(bool mine) {
    uint slot = ++step_number % 3u, ready = (step_number + 1u) % 3u;
    if (mine) atomicMin(next_batch[slot], 0);
    if (gl_LocalInvocationIndex == 0u) {
        next_batch[ready] = range_low[ready] = kNone;
        range_high[ready] = -kNone;
    }
    barrier();
    return next_batch[slot] == 0;
}

// The depth of the next end, and the sheet that it lies on or behind; beyond all sheets if there is none.
int next_end_sheet(inout float depth) {
    if (next_end >= last_end) return kNone;
    vec2 depths = intervals[next_end / 2u];
    depth = next_end % 2u == 0u ? depths.x : depths.y;
    return int(clamp((depth - first_depth) / sheet_distance, 0.0, float(sheets - 1)));
}

// Finds the values where rays enter and leave the volume on or behind the sheets from `first` to `end`: all threads take their
// next end at a time. Those of sheets that were passed over stay unknown, as nothing is seen there.
void find_ends(uint bin, int first, int end) {
    float depth = 0.0;
    while (next_end_sheet(depth) < first) ++next_end;
    while (true) {
        bool mine = enter_z != kNever && next_end_sheet(depth) < end;
        if (!any_of(mine)) return;
        sum_kernels_at(bin, depth, mine);
        if (!mine) continue;
        Sheet here = first_sum();
#if UNBOUNDED
        here.known = here.known && here.weight > half_weight;
#endif
        vec2 light = here.light;
#if SHADED
        if (next_end % 2u == 0u) {
            float pixel_world = pixel * (perspective ? middle_depth + depth : 1.0);
            light = light_at_entry(here.x, light, ends[next_end].zw, pixel_world);
        }
#endif
        ends[next_end] = vec4(here.known ? here.x : 3e38, here.color, light);
        ++next_end;
    }
}
#endif

// Takes the values of the last sheet of a batch that was passed over.
void look_back(uint bin, int batch) {
#if INTERVALS
    find_ends(bin, batch * kBatch + kBatch - 1, batch * kBatch + kBatch);
#endif
    sum_kernels(bin, batch * kBatch, 1u << (kBatch - 1), true);
    for (int k = 0; k + 1 < kBatch; ++k) shift_sums();
    skip_to(first_sum());
}

void pass_over(int batch) {
    float back = sheet_depth(min((batch + 1) * kBatch, sheets) - 1);
    while (exit_z <= back) {
        ++interval;
        take_interval();
    }
}

void go_through(uint bin, int batch) {
    int first_sheet = batch * kBatch, end_sheet = min(first_sheet + kBatch, sheets);
#if INTERVALS
    find_ends(bin, first_sheet, end_sheet);
#endif
    bool awake = enter_z < sheet_depth(end_sheet - 1) + 1.5 * sheet_distance;
    sum_kernels(bin, first_sheet, 0xffffffffu, awake);
    for (int sheet = first_sheet; awake && sheet < end_sheet; ++sheet) {
        Sheet here = first_sum();
        if (sheet == 0) skip_to(here);
        else go(sheet_depth(sheet - 1), sheet_depth(sheet), here);
        shift_sums();
    }
}

void main() {
    uint tile = group_number();
    if (tile >= uint(tiles.x * tiles.y)) return;
    if (gl_LocalInvocationIndex < 3u) {
        next_batch[gl_LocalInvocationIndex] = range_low[gl_LocalInvocationIndex] = kNone;
        range_high[gl_LocalInvocationIndex] = -kNone;
    }
    barrier();
    start_pixel(tile);
    load_state();
    uint first_bin = tile * uint(end_batch - first_batch);
    bool passed_over = false;  // whether the batch before was passed over
    int batch = vote(first_batch), before = -2;
    while (batch < end_batch) {
        uint bin = first_bin + uint(batch - first_batch);
        bool unseen = invisible(batch, bin);
        if (unseen) {
            pass_over(batch);
        } else {
            if (passed_over && before == batch - 1) look_back(bin - 1u, before);
            go_through(bin, batch);
        }
        passed_over = unseen;
        before = batch;
        batch = vote(batch + 1);
    }
    store();
}
