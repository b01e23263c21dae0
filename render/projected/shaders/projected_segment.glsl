// SPDX-License-Identifier: Apache-2.0
// Exact light of a segment on which the value goes linearly, as Optics::integrate: split at the knots of the transfer function,
// between which colour and opacity are linear.
struct Knot {
    vec4 look;   // colour, opacity
    vec4 value;  // in parts of the range of the knots; the rest is not used
};
layout(std430, binding = 10) readonly buffer Knots { Knot knots[]; };
uniform float per_unit;  // opacity units in the unit of length

// Optical depth of a panel of Gauss's rule of three points, whose error in the colour is then below 1e-5 of its change; the error
// of Simpson's is below that for what is thin.
const float kPanel = 0.5;
const float kMostPanels = 32.0;
const float kThin = 0.05;
const float kGaussOffset = 0.3872983346;  // √(3/5) / 2
const float kNothingLeft = 1e-7;

float one_minus_exp(float x) {
    return x < 0.02 ? x * (1.0 - 0.5 * x * (1.0 - x * (1.0 / 3.0) * (1.0 - 0.25 * x))) : 1.0 - exp_of(-x);
}

// Mean of −ln b over b from b0 to b1, in (0,1]: closed form, and as a series where that would lose digits.
float mean_extinction(float b0, float b1) {
    float middle = 0.5 * (b0 + b1), half_width = 0.5 * abs(b1 - b0), r = half_width / middle;
    if (r > 0.5) return 1.0 - (b1 * log_of(b1) - b0 * log_of(b0)) / (b1 - b0);
    float q = r * r;
    float series = 1.0 / 6.0 + q * (1.0 / 20.0 + q * (1.0 / 42.0 + q * (1.0 / 72.0 + q * (1.0 / 110.0 + q * (1.0 / 156.0)))));
    return q * series - log_of(middle);
}

// How many knots are at a value or below.
int knots_up_to(float x) {
    int low = 0, high = kKnots;
    while (low < high) {
        int middle = (low + high) / 2;
        if (knots[middle].value.x <= x) low = middle + 1;
        else high = middle;
    }
    return low;
}

// Colour and opacity of a value below the knot `above` and not below the one before.
vec4 look_at(int above, float x) {
    if (above == 0) return knots[0].look;
    Knot low = knots[above - 1];
    if (above == kKnots) return low.look;
    Knot high = knots[above];
    return mix(low.look, high.look, clamp((x - low.value.x) / (high.value.x - low.value.x), 0.0, 1.0));
}

// Opacity of the first part u of a piece.
float opacity_before(float b0, float b1, float u, float units) {
    return one_minus_exp(mean_extinction(b0, mix(b0, b1, u)) * u * units);
}

// By parts: ∫ c dA = c₁·A(1) − (c₁ − c₀)·∫A, A the opacity of what lies before.
void add_piece(inout vec4 light, vec4 look0, vec4 look1, float units) {
    float b0 = 1.0 - look0.a, b1 = 1.0 - look1.a;
    if (b0 == 1.0 && b1 == 1.0) return;
    float depth = mean_extinction(b0, b1) * units;
    float opacity = one_minus_exp(depth), left = 1.0 - light.a, mean_opacity = 0.0;
    if (depth < kThin) {
        mean_opacity = (4.0 * opacity_before(b0, b1, 0.5, units) + opacity) / 6.0;
    } else {
        float panels = clamp(ceil(depth / kPanel), 1.0, kMostPanels);
        for (float i = 0.5; i < panels; ++i) {
            float offset = kGaussOffset / panels, u = i / panels;
            mean_opacity += 5.0 * (opacity_before(b0, b1, u - offset, units) + opacity_before(b0, b1, u + offset, units)) +
                            8.0 * opacity_before(b0, b1, u, units);
        }
        mean_opacity /= 18.0 * panels;
    }
    light += left * vec4(look1.rgb * opacity - (look1.rgb - look0.rgb) * mean_opacity, opacity);
}

// Premultiplied colour and opacity.
vec4 segment_light(float x0, float x1, float segment_length) {
    vec4 light = vec4(0.0);
    bool up = x1 > x0;
    int above = knots_up_to(x0), last = knots_up_to(x1);
    float at = x0, units = segment_length * per_unit;
    for (;;) {
        bool done = above == last;
        float to = done ? x1 : knots[up ? above : above - 1].value.x;
        float part = x1 == x0 ? 1.0 : (to - at) / (x1 - x0);
        if (part > 0.0) add_piece(light, look_at(above, at), look_at(above, to), part * units);
        if (done || light.a > 1.0 - kNothingLeft) return light;
        above += up ? 1 : -1;
        at = to;
    }
}
