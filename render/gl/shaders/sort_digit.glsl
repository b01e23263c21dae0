// SPDX-License-Identifier: Apache-2.0
layout(location = 4) uniform uint shift;
layout(location = 5) uniform uint bits;  // of the digit, 1..8

uint digit(uint key) { return (key >> shift) & ((1u << bits) - 1u); }
