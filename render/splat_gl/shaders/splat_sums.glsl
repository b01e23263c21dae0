// SPDX-License-Identifier: Apache-2.0
// Sums of kernels on the sheets of a batch, for the pixel of each thread. The group cuts kernels by the sheets and puts them
// into shared memory, a chunk at a time. For each block of 8×4 pixels, bits mark the kernels and sheets that it may meet: its
// threads go through these only, together.
layout(std430, binding = 0) readonly buffer Splats { Splat splats[]; };
layout(std430, binding = 1) readonly buffer SplatExtras { vec4 splat_extras[]; };
layout(std430, binding = 3) readonly buffer BinOffsets { uint bin_offsets[]; };
layout(std430, binding = 4) readonly buffer BinSplats { uint bin_splats[]; };
layout(std430, binding = 10) readonly buffer KernelTable { float kernel_table[]; };
layout(std430, binding = 12) buffer Kept {
    uint batches_left;  // of all tiles that are not done
    float kept[];       // the depths of the picture; then sums that have to be continued
};

const uint kPixels = uint(kTile) * uint(kTile);
const uint kWords = kChunk / 32;
const int kBlocksX = kTile / 8, kBlocksY = kTile / 4, kBlocks = kBlocksX * kBlocksY;

// The iterations of all loops of a thread. Where they depend on the kernels, their number is the same in the whole group: it is
// counted, and the dispatch ends soon after most_steps. A chunk has up to kChunk · kKernelSteps + kStagingSteps.
const uint kKernelSteps = 1u + uint(kBatch) * (SEPARABLE == 1 ? 4u : 1u);
const uint kStagingSteps =
    (uint(kChunk * kBatch) / kPixels + 1u) * uint(kBlocksY + kExtras + 5) + (uint(kChunk * kBlocks) / kPixels + 1u) * uint(kBatch + 1) + 8u;
const uint kBatchSteps = uint(kBatch) * uint(kBatch + 16) + 16u;  // of choosing a batch, or of compositing its sheets
const uint kRoundSteps = 4u * uint(kBatch) + 8u;                    // of the next ends of all rays
const uint kMostRanged = 2048u * kPixels;
layout(location = 3) uniform uint most_steps;
uint steps = 0u;

// Of a kernel with a sheet: middle x, y; e and value there. Or, for sums at ends, two of each kernel: middle x, y, depth and
// 1 / S_zz; shear x, y, value and its slope.
shared vec4 cuts[kChunk * (kBatch > 1 ? kBatch : 2)];
shared vec4 shapes[kChunk];         // root xx, xy, yy; moment
shared vec2 gradients[kChunk];
shared uint met_blocks[kChunk * kBatch];   // a bit for each block
shared uint met_sheets[kChunk * kBlocks];  // a bit for each sheet
shared uint met_kernels[kWords * kBlocks];  // a bit for each kernel
#if GENERAL
shared vec4 rests[kChunk];  // depth, 1 / S_zz, value slope
shared vec2 shears[kChunk];
#endif
#if kExtras > 0
shared vec4 extras[kChunk * kExtras];
#endif

uint block;      // the block of this thread's pixel
vec2 ray;        // slopes of the pixel's ray, which do not depend on the division into tiles
float across[kBatch];  // world length of a unit of slope, on each sheet
ivec2 tile_px;
uint entry = 0u;  // of the bin, up to which it has been summed
uint sums_id;     // where the pixel's sums are kept

precise float weights[kBatch];
precise float values[kBatch];
#if COLORED
precise float colors[kBatch];
#endif
#if SHADED
precise vec3 gradient_sums[kBatch];
#endif

// The sheets that are summed: the place in the stack of the one before them, and their distance there.
float place_before = 0.0, place_step = 1.0;

float place_of(int k) { return place_before + float(k + 1) * place_step; }
float across_at(int k) { return perspective ? middle_depth + depth_at(place_of(k)) : 1.0; }

// The blocks that a section with its middle at px may meet, a bit for each, with a margin of half a pixel and a little for
// rounding.
uint blocks_at(vec2 px, vec2 half_size) {
    const vec2 kSize = vec2(8.0, 4.0);
    ivec2 first = max(ivec2(clamp((px - half_size) / kSize, -1.0, 64.0) + 1.0) - 1, 0);
    ivec2 last = min(ivec2(clamp((px + half_size) / kSize, -1.0, 64.0) + 1.0) - 1, ivec2(kBlocksX, kBlocksY) - 1);
    if (any(lessThan(last, first))) return 0u;
    uint row = (2u << last.x) - (1u << first.x), met = 0u;
    for (int y = first.y; y <= last.y; ++y) met |= row << (y * kBlocksX);
    return met;
}

void cut(uint j, uint k, uint id, bool wanted) {
    Splat s = splats[id];
    float zs = depth_at(place_of(int(k))) - s.place.z, e = zs * zs * s.place.w, left = 1.0 - e;
    vec2 middle = fma(s.shape.xy, vec2(zs), s.place.xy);
    cuts[j * kBatch + k] = vec4(middle, e, fma(zs, s.rest.x, s.slope.y));
    uint met = 0u;
    if (left > 0.0 && wanted) {
        float scale = 1.0 / (across_at(int(k)) * pixel);
        vec2 px = vec2(middle.x, -middle.y) * scale + (0.5 * vec2(size) - vec2(tile_px));
        met = blocks_at(px, s.rest.zw * (sqrt(left) * scale) + 0.55);
    }
    met_blocks[j * kBatch + k] = met;
    if (k == 0u) {
        shapes[j] = vec4(s.shape.zw, s.slope.x, s.rest.y);
        gradients[j] = s.slope.zw;
#if GENERAL
        rests[j] = vec4(s.place.z, s.place.w, s.rest.x, 0.0);
        shears[j] = s.shape.xy;
#endif
    }
#if kExtras > 0
    for (uint i = k; i < kExtras; i += kBatch) extras[j * kExtras + i] = splat_extras[id * kExtras + i];
#endif
}

// Turns the blocks that a kernel meets on each sheet into the sheets on which it meets a block: one atomic operation for a
// kernel and a block instead of two for each section.
void mark(uint j, uint at) {
    uint met = 0u;
    for (uint k = 0u; k < kBatch; ++k) met |= (met_blocks[j * kBatch + k] >> at & 1u) << k;
    met_sheets[j * kBlocks + at] = met;
    if (met != 0u) atomicOr(met_kernels[at * kWords + j / 32u], 1u << (j % 32u));
}

// Puts kernels `first` to `end` into shared memory.
void stage(uint first, uint end, uint wanted_sheets) {
    barrier();  // until the last chunk is not used any more
    for (uint i = gl_LocalInvocationIndex; i < kWords * kBlocks; i += kPixels) met_kernels[i] = 0u;
    for (uint i = gl_LocalInvocationIndex; i < (end - first) * kBatch; i += kPixels) {
        uint j = i / kBatch, k = i % kBatch;
        cut(j, k, bin_splats[first + j], (wanted_sheets & (1u << k)) != 0u);
    }
    barrier();
    for (uint i = gl_LocalInvocationIndex; i < (end - first) * kBlocks; i += kPixels) mark(i / kBlocks, i % kBlocks);
    barrier();
}

#if !COMPACT
// The kernel's table over [0,1], linear between its entries, and 0 beyond.
float profile(float t) {
    float at = min(t * kernel_cells, kernel_cells), cell = min(floor(at), kernel_cells - 1.0);
    float low = kernel_table[int(cell)], high = kernel_table[int(cell) + 1];
    return fma(at - cell, high - low, low);
}
#endif

float weight_of(uint j, vec3 d, float e) {
#if COMPACT
    precise float left = max(1.0 - e, 0.0), w = left * left * left;
    return w;
#elif SEPARABLE
    precise float w = 1.0;
    for (uint a = 0u; a < 3u; ++a) {
        vec3 row = extras[j * kExtras + kAxesAt + a].xyz;
        precise float xi = fma(row.x, d.x, fma(row.y, d.y, row.z * d.z));
        w *= profile(abs(xi));
    }
    return w;
#else
    return profile(e);
#endif
}

#if BENT
float bent_value(float value, uint at, vec3 d) {
    vec4 b = extras[at];
    vec2 rest = extras[at + 1u].xy;
    precise float along = fma(b.x, d.z, fma(b.y, d.x, b.z * d.y)), row = fma(b.w, d.x, 2.0 * rest.x * d.y);
    precise float v = fma(rest.y * d.y, d.y, fma(d.x, row, fma(d.z, along, value)));
    return v;
}
#endif

#if COLORED
float color_of(uint j, vec3 d, float e) {
    vec4 c = extras[j * kExtras + kColorAt];
    float v = fma(c.w, d.y, fma(c.y, d.z, c.x));
    v = fma(extras[j * kExtras + kColorAt + 1u].x, e, fma(c.z, d.x, v));
#if BENT
    v = bent_value(v, j * kExtras + kColorBendAt, d);
#endif
    return v;
}
#endif

#if SHADED
// The gradient of the value that a kernel represents, in eye space.
vec3 gradient_of(uint j, vec3 d) {
    vec4 shape = shapes[j], rest = rests[j];
    vec2 gradient = gradients[j], shear = shears[j];
    float twice = 2.0 * shape.w;
    precise float along_row = fma(shape.x, d.x, shape.y * d.y);
    precise vec3 g;
    g.x = fma(twice * shape.x, along_row, gradient.x);
    g.y = fma(twice * shape.y, along_row, fma(twice * shape.z * shape.z, d.y, gradient.y));
    g.z = fma(twice * rest.y, d.z, rest.z);
#if BENT
    vec4 b = extras[j * kExtras + kBendAt];
    vec2 more = extras[j * kExtras + kBendAt + 1u].xy;
    g.x += fma(b.y, d.z, 2.0 * fma(b.w, d.x, more.x * d.y));
    g.y += fma(b.z, d.z, 2.0 * fma(more.x, d.x, more.y * d.y));
    g.z += fma(2.0 * b.x, d.z, fma(b.y, d.x, b.z * d.y));
#endif
    // Offsets are relative to the section's middle, which moves with the depth.
    g.z = fma(-shear.x, g.x, fma(-shear.y, g.y, g.z));
    return g;
}
#endif

// Adds a kernel to the k-th sums. d: from the middle of its section, where e and the value are e_here and v_here
void add_at(int k, uint j, vec2 d, float zs, float e_here, float v_here) {
    vec4 shape = shapes[j];
    vec2 gradient = gradients[j];
    precise float across_row = shape.z * d.y, along_row = fma(shape.x, d.x, shape.y * d.y);
    precise float e = fma(along_row, along_row, fma(across_row, across_row, e_here));
    if (!(e <= 4.0)) return;  // far outside a flat kernel it overflows; beyond 1 the weight is 0
    precise float v = fma(shape.w, e, fma(gradient.x, d.x, fma(gradient.y, d.y, v_here)));
#if GENERAL
    precise vec3 offset = vec3(d, zs);
#if BENT
    v = bent_value(v, j * kExtras + kBendAt, offset);
#endif
#else
    const vec3 offset = vec3(0.0);
#endif
    float w = weight_of(j, offset, e);
    weights[k] += w;
    values[k] = fma(w, v, values[k]);
#if COLORED
    colors[k] = fma(w, color_of(j, offset, e), colors[k]);
#endif
#if SHADED
    gradient_sums[k] = fma(vec3(w), gradient_of(j, offset), gradient_sums[k]);
#endif
}

void add_kernel(uint j, uint met) {
    for (int k = 0; k < kBatch; ++k) {
        if ((met & (1u << k)) == 0u) continue;
        vec4 at = cuts[j * kBatch + k];
        precise vec2 d = fma(ray, vec2(across[k]), -at.xy);
#if GENERAL
        float zs = depth_at(place_of(k)) - rests[j].x;
#else
        const float zs = 0.0;
#endif
        add_at(k, j, d, zs, at.z, at.w);
    }
}

void start_sums(int k) {
    weights[k] = values[k] = 0.0;
#if COLORED
    colors[k] = 0.0;
#endif
#if SHADED
    gradient_sums[k] = vec3(0.0);
#endif
}

const uint kSums = 2u + (COLORED == 1 ? 1u : 0u) + (SHADED == 1 ? 3u : 0u);
const uint kKeptSums = kSums * uint(kBatch);

void keep_sums() {
    for (int k = 0; k < kBatch; ++k) {
        uint to = sums_id + uint(k) * kSums * kPixels;
        kept[to] = weights[k];
        kept[to + kPixels] = values[k];
#if COLORED
        kept[to + 2u * kPixels] = colors[k];
#endif
#if SHADED
        for (uint a = 0u; a < 3u; ++a) kept[to + (kSums - 3u + a) * kPixels] = gradient_sums[k][a];
#endif
    }
}

void take_sums() {
    for (int k = 0; k < kBatch; ++k) {
        uint from = sums_id + uint(k) * kSums * kPixels;
        weights[k] = kept[from];
        values[k] = kept[from + kPixels];
#if COLORED
        colors[k] = kept[from + 2u * kPixels];
#endif
#if SHADED
        for (uint a = 0u; a < 3u; ++a) gradient_sums[k][a] = kept[from + (kSums - 3u + a) * kPixels];
#endif
    }
}

bool end_sums(bool complete) {
    if (complete) entry = 0u;
    return complete;
}

// Begins the sums of a bin, unless they have to be continued.
void begin_sums() {
    for (int k = 0; k < kBatch; ++k) {
        if (entry == 0u) start_sums(k);
    }
}

#if INTERVALS
bool is_usable(float v) { return abs(v) < kMostOfKernel; }  // false for NaN

// Whether a kernel's sums are finite at any depth: not if it is so flat that rounding made its frame indefinite.
bool usable(Splat s, uint id) {
    bool all = is_usable(s.place.w) && is_usable(s.shape.x) && is_usable(s.shape.y) && is_usable(s.shape.z) &&
               is_usable(s.shape.w) && is_usable(s.slope.x) && is_usable(s.rest.x);
#if SEPARABLE
    for (uint a = 0u; a < 3u; ++a) {
        vec3 row = splat_extras[id * kExtras + kAxesAt + a].xyz;
        all = all && is_usable(row.x) && is_usable(row.y) && is_usable(row.z);
    }
#endif
    return all;
}

// Puts kernels `first` to `end` into shared memory for sums at depths that differ from pixel to pixel.
void stage_whole(uint first, uint end) {
    barrier();  // until the last chunk is not used any more
    for (uint j = gl_LocalInvocationIndex; j < end - first; j += kPixels) {
        uint id = bin_splats[first + j];
        Splat s = splats[id];
        cuts[2u * j] = vec4(s.place.xyz, usable(s, id) ? s.place.w : 3e38);
        cuts[2u * j + 1u] = vec4(s.shape.xy, s.slope.y, s.rest.x);
        shapes[j] = vec4(s.shape.zw, s.slope.x, s.rest.y);
        gradients[j] = s.slope.zw;
#if GENERAL
        rests[j] = vec4(s.place.z, s.place.w, s.rest.x, 0.0);
        shears[j] = s.shape.xy;
#endif
#if kExtras > 0
        for (uint i = 0u; i < kExtras; ++i) extras[j * kExtras + i] = splat_extras[id * kExtras + i];
#endif
    }
    barrier();
}

// Sums the kernels of a bin at a depth of each pixel's own into the first sums; false if it has to be continued.
bool sum_kernels_at(uint bin, float depth, bool awake) {
    begin_sums();
    float across_here = perspective ? middle_depth + depth : 1.0;
    uint begin = bin_offsets[bin], end = bin_offsets[bin + 1u];
    for (; begin + entry < end && steps < most_steps; entry += kChunk) {
        uint first = begin + entry, chunk_end = min(first + kChunk, end);
        steps += (chunk_end - first) * kKernelSteps + kStagingSteps;
        stage_whole(first, chunk_end);
        for (uint j = 0u; awake && j < chunk_end - first; ++j) {
            vec4 place = cuts[2u * j], slope = cuts[2u * j + 1u];
            float zs = depth - place.z, e = zs * zs * place.w;
            if (!(e < 1.0)) continue;
            precise vec2 d = fma(ray, vec2(across_here), -fma(slope.xy, vec2(zs), place.xy));
            add_at(0, j, d, zs, e, fma(zs, slope.w, slope.z));
        }
    }
    return end_sums(begin + entry >= end);
}
#endif

// Sums the wanted ones of the placed sheets, false if it has to be continued; the sums of pixels that are not awake stay 0.
bool sum_kernels(uint bin, uint wanted_sheets, bool awake) {
    for (int k = 0; k < kBatch; ++k) across[k] = across_at(k);
    begin_sums();
    uint begin = bin_offsets[bin], end = bin_offsets[bin + 1u];
    for (; begin + entry < end && steps < most_steps; entry += kChunk) {
        uint first = begin + entry, chunk_end = min(first + kChunk, end);
        steps += (chunk_end - first) * kKernelSteps + kStagingSteps;
        stage(first, chunk_end, wanted_sheets);
        for (uint word = 0u; word < kWords; ++word) {
            for (uint left = awake ? met_kernels[block * kWords + word] : 0u; left != 0u; left &= left - 1u) {
                uint j = word * 32u + uint(findLSB(left));
                add_kernel(j, met_sheets[j * kBlocks + block]);
            }
        }
    }
    return end_sums(begin + entry >= end);
}
