#version 450
// SPDX-License-Identifier: Apache-2.0
// A work group for each tile, a thread for each pixel; batches of sheets from front to back, with sums in registers. Every
// order is fixed, and no number depends on where tiles and batches begin: pictures are bitwise reproducible.
//
// A tile may need any number of steps, so a dispatch does a limited number of them, keeps the state and is repeated until no
// tile is left: drivers end loops, or reset the device, if one takes too long. What threads do together is counted as it is
// done (splat_sums.glsl). What a thread does for the intervals of its own ray is limited by their number.
layout(local_size_x = kTile, local_size_y = kTile) in;
layout(std430, binding = 2) readonly buffer Ranges { vec2 ranges[]; };
layout(std430, binding = 11) writeonly buffer Picture { vec4 picture[]; };
struct State {
    vec4 color;    // opacity in the last component
    vec4 going;    // depth, enter, exit; weight on the last sheet
    vec4 on_last;  // x, color, light
    uvec4 at;      // interval; next end, and a bit: whether there is a value on the last sheet; a word of the tile's state;
                   // levels
};
layout(std430, binding = 13) buffer States { State states[]; };  // of the pixels of tiles, between dispatches
layout(location = 0) uniform uvec2 tile_range;  // the tiles of this dispatch: first, end
layout(location = 1) uniform uint first_state;    // the tile to which the first states belong
layout(location = 2) uniform bool resumed;        // whether the tiles have been begun in this pass

const int kNone = 0x7fffffff;

// Three of each: one is read, one is written and one is cleared between two barriers.
shared int next_batch[3];
shared int range_low[3];
shared int range_high[3];

// What a tile does next with its batch.
const int kChoose = 0, kLookBack = 1, kGoThrough = 2, kDone = 3;

uint pixel_id, state_id;
ivec2 own_px;
bool in_picture;
int next_batch_id, job = kChoose;
bool ends_found = false, passed_over = false;
// Of FinerSheets: the level of the pixel's cell, the most of those of the tile, and one more than the layer they are of; and
// how many of the sheets of a batch have been composited.
int own_level = 0, tile_level = 0, leveled = 0, first_of_part = 0;
uint step_number = 0u;
uint next_end = 0u, last_end = 0u;  // the ends of the pixel's intervals that have no values yet
int ranged = -2;  // the batch to which `range` belongs
vec2 range = vec2(0.0);
float sum_depth;  // at which the first sums are

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
    own_px = at;
    in_picture = at.x < size.x && at.y < size.y;
    pixel_id = in_picture ? uint(at.y) * uint(size.x) + uint(at.x) : 0u;
    precise vec2 slopes = vec2(float(at.x) + 0.5 - 0.5 * float(size.x), 0.5 * float(size.y) - (float(at.y) + 0.5)) * pixel;
    ray = slopes;
    precise float square = 1.0 + slopes.x * slopes.x + slopes.y * slopes.y;
    ray_length = perspective ? sqrt(square) : 1.0;

    beam = Beam(vec3(0.0), 0.0, 0.0);
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
    if (first_batch == 0 && !resumed) {
        for (uint i = next_end; i < last_end; ++i) ends[i].x = 3e38;
    }
#endif
}

uint tile_word(uint which) { return states[state_id - gl_LocalInvocationIndex + which].at.z; }

void load_state() {
    next_batch_id = first_batch;
    if (first_batch == 0 && !resumed) return;
    State s = states[state_id];
    own_level = int(s.at.w & 0xffu);
    tile_level = int(s.at.w >> 8 & 0xffu);
    leveled = int(s.at.w >> 16);
    beam = Beam(s.color.rgb, s.color.w, s.going.x);
    enter_z = s.going.y;
    exit_z = s.going.z;
    interval = s.at.x;
    next_end = s.at.y >> 1;
    last = Sheet(s.on_last.x, (s.at.y & 1u) != 0u, s.going.w, s.on_last.y, s.on_last.zw);
    if (!resumed) return;
    job = int(tile_word(0u) & 3u);
    first_of_part = int(tile_word(0u) >> 2);
    next_batch_id = int(tile_word(1u));
    entry = tile_word(2u);
    ends_found = tile_word(3u) != 0u;
    passed_over = tile_word(4u) != 0u;
    ranged = int(tile_word(5u));
    range = uintBitsToFloat(uvec2(tile_word(6u), tile_word(7u)));
    if (entry > 0u) take_sums();
}

void store_state() {
    if (entry > 0u) keep_sums();
    uint words[8] = uint[](uint(job) | uint(first_of_part) << 2, uint(next_batch_id), entry, uint(ends_found), uint(passed_over),
                           uint(ranged), floatBitsToUint(range.x), floatBitsToUint(range.y));
    states[state_id] = State(vec4(beam.color, beam.opacity), vec4(beam.depth, enter_z, exit_z, last.weight),
                             vec4(last.x, last.color, last.light),
                             uvec4(interval, next_end << 1 | uint(last.known), words[gl_LocalInvocationIndex & 7u],
                                   uint(own_level) | uint(tile_level) << 8 | uint(leveled) << 16));
}

void write_pixel() {
    if (!in_picture) return;
    precise float mean_depth = middle_depth + beam.depth / (beam.opacity > 0.0 ? beam.opacity : 1.0);
    picture[pixel_id] = vec4(beam.color, beam.opacity);
    kept[pixel_id] = beam.opacity > 0.0 ? mean_depth : uintBitsToFloat(0x7f800000u);
}

// The levels are behind the counts of visible rows, four in a word.
const int kFinerAt = kCells + 3, kCellsOfTile = kTile / kFinerSide;
shared uint light_left[kCellsOfTile * kCellsOfTile];

int stored_level(ivec2 cell, int layer) {
    ivec2 cells = (size + kFinerSide - 1) / kFinerSide;
    if (cell.x >= cells.x || cell.y >= cells.y) return 0;
    int at = (cell.y * cells.x + cell.x) * ((sheets + kFinerSheets - 1) / kFinerSheets) + layer;
    return visible[kFinerAt + at / 4] >> (at % 4 * 8) & 0xff;
}

// Finds the levels of the tile's cells for the stretches that end at a sheet, as FinerSheets and level_in_light do.
void find_levels(int sheet) {
    int layer = sheet / kFinerSheets, most = 0;
    if (leveled == layer + 1) return;
    leveled = layer + 1;
    own_level = tile_level = 0;
    ivec2 first = tile_px / kFinerSide;
    for (int i = 0; i < kCellsOfTile * kCellsOfTile; ++i)
        most = max(most, stored_level(first + ivec2(i % kCellsOfTile, i / kCellsOfTile), layer));
    if (most == 0) return;
    ivec2 in_tile = own_px / kFinerSide - first;
    int own = in_tile.y * kCellsOfTile + in_tile.x;
    barrier();
    if (gl_LocalInvocationIndex < uint(light_left.length())) light_left[gl_LocalInvocationIndex] = 0u;
    barrier();
    if (enter_z != kNever) atomicMax(light_left[own], floatBitsToUint(max(1.0 - beam.opacity, 0.0)));
    barrier();
    for (int i = 0; i < kCellsOfTile * kCellsOfTile; ++i) {
        int level = stored_level(first + ivec2(i % kCellsOfTile, i / kCellsOfTile), layer);
        level = clamp(level + int(light_left[i] >> 23) - 127 + 1, 0, level);
        tile_level = max(tile_level, level);
        if (i == own) own_level = level;
    }
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

// Bounds of the values of a bin's kernels. To find those of very many would take longer than to sum them.
vec2 range_of(uint bin) {
    uint slot = step_number % 3u, begin = bin_offsets[bin], end = bin_offsets[bin + 1u];
    if (end - begin > kMostRanged) return vec2(-kNever, kNever);
    steps += (end - begin) / kPixels + 1u;
    vec2 own = vec2(kNever, -kNever);
    for (uint i = begin + gl_LocalInvocationIndex; i < end; i += kPixels) {
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
#if SHADOWED
    vec2 arrives = arrival_at(vec3(ray * (perspective ? middle_depth + sum_depth : 1.0), sum_depth));
#if SHADED
    here.light = shadowed_light_on(gradient * per_weight, arrives);
#else
    here.light = vec2(unlit(arrives), 0.0);
#endif
#elif SHADED
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
// next end at a time. Those of sheets that were passed over stay unknown, as nothing is seen there. False if it has to be
// continued.
bool find_ends(uint bin, int first, int end) {
    float depth = 0.0;
    while (next_end_sheet(depth) < first) ++next_end;
    while (steps < most_steps) {
        steps += kRoundSteps;
        bool mine = enter_z != kNever && next_end_sheet(depth) < end;
        if (entry == 0u && !any_of(mine)) return true;
        if (!sum_kernels_at(bin, depth, mine)) return false;
        if (!mine) continue;
        sum_depth = depth;
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
    return false;
}
#endif

void pass_over(int batch) {
    float back = sheet_depth(min((batch + 1) * kBatch, sheets) - 1);
    while (exit_z <= back) {
        ++interval;
        take_interval();
    }
}

// Chooses the next batch, and what to do with it: one that is passed over needs nothing, and one behind it the values of its
// last sheet.
void choose(uint first_bin) {
    int batch = vote(next_batch_id);
    if (batch >= end_batch) {
        job = kDone;
        return;
    }
    bool follows = batch == next_batch_id, unseen = invisible(batch, first_bin + uint(batch - first_batch));
    if (unseen) pass_over(batch);
    else job = passed_over && follows ? kLookBack : kGoThrough;
    passed_over = unseen;
    ends_found = false;
    next_batch_id = batch + 1;
}

// Takes the values of the last sheet of a batch that was passed over.
void look_back(int batch) {
    for (int k = 0; k + 1 < kBatch; ++k) shift_sums();
    sum_depth = sheet_depth(batch * kBatch + kBatch - 1);
    skip_to(first_sum());
}

// Composites the placed sheets: those of the pixel's level, and none before the first of the stack.
void go_through(int count, bool awake) {
    int stride = 1 << (tile_level - own_level);
    float step = place_step * float(stride);
    for (int k = 0; awake && k < count; ++k) {
        float place = place_of(k);
        if ((first_of_part + k + 1) % stride == 0 && place >= 0.0) {
            sum_depth = depth_at(place);
            Sheet here = first_sum();
            if (place == 0.0) skip_to(here);
            else go(depth_at(place - step), sum_depth, here);
        }
        shift_sums();
    }
}

// Goes on with the job. If the sums are not complete yet, it stays to be done.
void work(uint first_bin) {
    bool back = job == kLookBack;
    int batch = next_batch_id - (back ? 2 : 1), first_sheet = batch * kBatch, end_sheet = min(first_sheet + kBatch, sheets);
    uint bin = first_bin + uint(batch - first_batch);
#if INTERVALS
    if (!ends_found) ends_found = find_ends(bin, back ? end_sheet - 1 : first_sheet, end_sheet);
    if (!ends_found) return;
#endif
    bool awake = back || enter_z < sheet_depth(end_sheet - 1) + 1.5 * sheet_distance;
    if (finer && !back) find_levels(first_sheet);
    int level = back ? 0 : tile_level, count = (end_sheet - first_sheet) << level;
    place_step = 1.0 / float(1 << level);
    place_before = float(first_sheet - 1) + float(first_of_part) * place_step;
    if (!sum_kernels(bin, back ? 1u << (kBatch - 1) : 0xffffffffu, awake)) return;
    if (back) {
        look_back(batch);
    } else {
        go_through(min(kBatch, count - first_of_part), awake);
        first_of_part += kBatch;
        if (first_of_part < count) return;
        first_of_part = 0;
    }
    job = back ? kGoThrough : kChoose;
    ends_found = false;
}

void main() {
    uint tile = tile_range.x + group_number();
    if (tile >= tile_range.y) return;
    if (gl_LocalInvocationIndex < 3u) {
        next_batch[gl_LocalInvocationIndex] = range_low[gl_LocalInvocationIndex] = kNone;
        range_high[gl_LocalInvocationIndex] = -kNone;
    }
    barrier();
    state_id = (tile - first_state) * kPixels + gl_LocalInvocationIndex;
    sums_id = uint(size.x) * uint(size.y) + group_number() * kPixels * kKeptSums + gl_LocalInvocationIndex;
    start_pixel(tile);
    load_state();
    if (resumed && job == kDone) return;
    uint first_bin = tile * uint(end_batch - first_batch);
    while (job != kDone && steps < most_steps) {
        steps += kBatchSteps;
        if (job == kChoose) choose(first_bin);
        if (job == kLookBack || job == kGoThrough) work(first_bin);
    }
    if (job == kDone && end_batch == batches) {
        write_pixel();
        states[state_id].at.z = uint(kDone);
    } else {
        store_state();
    }
    if (job != kDone && gl_LocalInvocationIndex == 0u) atomicAdd(batches_left, uint(max(end_batch - next_batch_id, 1)));
}
