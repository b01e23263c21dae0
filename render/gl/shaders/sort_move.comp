#version 450
// SPDX-License-Identifier: Apache-2.0
// A pass of the sort: sorts a block by its digit in shared memory, four bits at a time, then writes its runs of equal digits to
// the places given by the scanned counts.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer KeysIn { uint keys_in[]; };
layout(std430, binding = 1) readonly buffer ValuesIn { uint values_in[]; };
layout(std430, binding = 2) writeonly buffer KeysOut { uint keys_out[]; };
layout(std430, binding = 3) writeonly buffer ValuesOut { uint values_out[]; };
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 5) readonly buffer Plan { uvec4 plan[]; };

shared uint block_keys[kPaddedBlock];
shared uint block_values[kPaddedBlock];
shared uint counters[kPaddedBlock];  // 8 rows with a word for each thread; each half of a word counts one of the 16 digits
shared uint starts[256];

uint half_of(uint word, uint nibble) { return (word >> (16u * (nibble >> 3))) & 0xffffu; }

// Replaces each counter by the number of items that come before those it counts: with smaller digits, or of earlier threads.
// The upper eight digits are in the upper halves and come after all the lower ones.
void scan_counters() {
    uint first = gl_LocalInvocationIndex * kItems, sum = 0u;
    for (uint k = 0u; k < kItems; ++k) sum += counters[padded(first + k)];
    uint before = group_scan(sum) - sum;
    before += group_total() << 16;
    for (uint k = 0u; k < kItems; ++k) {
        uint count = counters[padded(first + k)];
        counters[padded(first + k)] = before;
        before += count;
    }
}

// Sorts the block by four bits of the digit. The sort is stable, as the items of a thread are neighbours.
void split(uint from_bit) {
    uint thread = gl_LocalInvocationIndex;
    uint key[kItems], value[kItems], rank[kItems];
    for (uint row = 0u; row < 8u; ++row) counters[padded(row * kThreads + thread)] = 0u;
    for (uint k = 0u; k < kItems; ++k) {
        key[k] = block_keys[padded(thread * kItems + k)];
        value[k] = block_values[padded(thread * kItems + k)];
        uint nibble = (digit(key[k]) >> from_bit) & 15u, counter = padded((nibble & 7u) * kThreads + thread);
        uint counts = counters[counter];
        rank[k] = half_of(counts, nibble);
        counters[counter] = counts + (1u << (16u * (nibble >> 3)));
    }
    barrier();
    scan_counters();
    barrier();
    for (uint k = 0u; k < kItems; ++k) {
        uint nibble = (digit(key[k]) >> from_bit) & 15u;
        uint to = padded(half_of(counters[padded((nibble & 7u) * kThreads + thread)], nibble) + rank[k]);
        block_keys[to] = key[k];
        block_values[to] = value[k];
    }
    barrier();
}

void main() {
    uint total = plan[0].w, group = group_number(), thread = gl_LocalInvocationIndex, first = group * kBlock;
    uint items = first < total ? min(total - first, kBlock) : 0u;
    for (uint i = thread; i < kBlock; i += kThreads) {
        // The places beyond the end get the largest keys, which stay behind all others.
        block_keys[padded(i)] = i < items ? keys_in[first + i] : 0xffffffffu;
        block_values[padded(i)] = i < items ? values_in[first + i] : 0u;
    }
    barrier();
    for (uint from_bit = 0u; from_bit < bits; from_bit += 4u) split(from_bit);

    for (uint i = thread; i < items; i += kThreads) {
        uint d = digit(block_keys[padded(i)]);
        if (i == 0u || d != digit(block_keys[padded(i - 1u)])) starts[d] = i;
    }
    barrier();
    if (thread < (1u << bits) && items > 0u) starts[thread] = offsets[thread * blocks_of(total) + group] - starts[thread];
    barrier();
    for (uint i = thread; i < items; i += kThreads) {
        uint key = block_keys[padded(i)], to = starts[digit(key)] + i;
        keys_out[to] = key;
        values_out[to] = block_values[padded(i)];
    }
}
