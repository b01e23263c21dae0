// SPDX-License-Identifier: Apache-2.0
// The drivers' own functions are too coarse for 1 − exp(−x) near 0. These are right to the last bit or two, and the same on
// every device.

// exp(x) = power · (1 + the result), where power is one of 2 and the result small.
float exp_parts(float x, out float power) {
    x = clamp(x, -87.0, 87.0);
    precise float n = floor(fma(x, 1.44269504, 0.5));
    precise float r = fma(n, 2.12194440e-4, fma(n, -0.693359375, x));
    precise float p = fma(r, fma(r, 1.0 / 5040.0, 1.0 / 720.0), 1.0 / 120.0);
    p = fma(r, fma(r, fma(r, p, 1.0 / 24.0), 1.0 / 6.0), 0.5);
    p = fma(r * r, p, r);
    power = intBitsToFloat((int(n) + 127) << 23);
    return p;
}

float exp_of(float x) {
    float power;
    precise float p = exp_parts(x, power) + 1.0;
    p *= power;
    return p;
}

// 1 − exp(−x), the opacity of an optical depth, with all digits where it is small.
float opacity_of(float x) {
    float power;
    precise float p = exp_parts(-x, power), opacity = (1.0 - power) - p * power;
    return opacity;
}

// The logarithm of a normal number > 0.
float log_of(float x) {
    int bits = floatBitsToInt(x), power = (bits - 0x3f3504f3) >> 23;
    precise float m = intBitsToFloat(bits - (power << 23)), s = (m - 1.0) / (m + 1.0), q = s * s;
    precise float series = fma(q, fma(q, fma(q, fma(q, 1.0 / 9.0, 1.0 / 7.0), 1.0 / 5.0), 1.0 / 3.0), 1.0);
    precise float result = fma(float(power), 0.693147181, 2.0 * s * series);
    return result;
}
