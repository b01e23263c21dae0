// SPDX-License-Identifier: Apache-2.0
// The exact light of a segment on which the value is linear, as Optics::integrate: the segment is split at the knots of the
// transfer function, between which colour and opacity are linear.
struct Knot {
    vec4 rgba;   // colour, opacity
    vec4 value;  // in parts of the range of the knots; the rest is not used
};
layout(std430, binding = 10) readonly buffer Knots { Knot knots[]; };
layout(location = 4) uniform float per_unit;  // opacity units in the unit of length
uint steps = 0u;  // iterations of loops that the integration has taken

// Optical depth of a panel of Gauss's rule with three points: the error of the colour is then below 1e-5 of its change. For
// thin pieces Simpson's rule is as accurate.
const float kPanel = 0.5;
const float kMostPanels = 32.0;
const float kThin = 0.05;
const float kGaussOffset = 0.3872983346;  // √(3/5) / 2
const float kNothingLeft = 1e-7;

// The mean of −ln b for b from b0 to b1, in (0,1]: closed form, or a series where that would lose digits.
float mean_extinction(float b0, float b1) {
    float middle = 0.5 * (b0 + b1), half_width = 0.5 * abs(b1 - b0), r = half_width / middle;
    if (r > 0.5) return 1.0 - (b1 * log_of(b1) - b0 * log_of(b0)) / (b1 - b0);
    float q = r * r;
    float series = 1.0 / 6.0 + q * (1.0 / 20.0 + q * (1.0 / 42.0 + q * (1.0 / 72.0 + q * (1.0 / 110.0 + q * (1.0 / 156.0)))));
    return q * series - log_of(middle);
}

// The number of knots at or below a value.
int knots_up_to(float x) {
    int low = 0, high = kKnots;
    while (low < high) {
        ++steps;
        int middle = (low + high) / 2;
        if (knots[middle].value.x <= x) low = middle + 1;
        else high = middle;
    }
    return low;
}

// Colour and opacity of a value between the knots `above` − 1 and `above`.
vec4 rgba_at(int above, float x) {
    if (above == 0) return knots[0].rgba;
    Knot low = knots[above - 1];
    if (above == kKnots) return low.rgba;
    Knot high = knots[above];
    return mix(low.rgba, high.rgba, clamp((x - low.value.x) / (high.value.x - low.value.x), 0.0, 1.0));
}

// The opacity of the first part u of a piece.
float opacity_before(float b0, float b1, float u, float units) {
    return opacity_of(mean_extinction(b0, mix(b0, b1, u)) * u * units);
}

// Integrates by parts: ∫ c dA = c₁·A(1) − (c₁ − c₀)·∫A du, where A(u) is the opacity of the part before u.
void add_piece(inout vec4 light, vec4 rgba0, vec4 rgba1, float units) {
    float b0 = 1.0 - rgba0.a, b1 = 1.0 - rgba1.a;
    if (b0 == 1.0 && b1 == 1.0) return;
    float depth = mean_extinction(b0, b1) * units;
    float opacity = opacity_of(depth), left = 1.0 - light.a, mean_opacity = 0.0;
    if (depth < kThin) {
        mean_opacity = (4.0 * opacity_before(b0, b1, 0.5, units) + opacity) / 6.0;
    } else {
        float panels = clamp(ceil(depth / kPanel), 1.0, kMostPanels);
        steps += uint(panels);
        for (float i = 0.5; i < panels; ++i) {
            float offset = kGaussOffset / panels, u = i / panels;
            mean_opacity += 5.0 * (opacity_before(b0, b1, u - offset, units) + opacity_before(b0, b1, u + offset, units)) +
                            8.0 * opacity_before(b0, b1, u, units);
        }
        mean_opacity /= 18.0 * panels;
    }
    light += left * vec4(rgba1.rgb * opacity - (rgba1.rgb - rgba0.rgb) * mean_opacity, opacity);
}

// Premultiplied colour and opacity.
vec4 segment_light(float x0, float x1, float segment_length) {
    vec4 light = vec4(0.0);
    bool up = x1 > x0;
    int above = knots_up_to(x0), last = knots_up_to(x1);
    float at = x0, units = segment_length * per_unit;
    for (int i = 0; i <= kKnots; ++i) {  // there are no more, whatever the values are
        ++steps;
        bool done = above == last;
        float to = done ? x1 : knots[up ? above : above - 1].value.x;
        float part = x1 == x0 ? 1.0 : (to - at) / (x1 - x0);
        if (part > 0.0) add_piece(light, rgba_at(above, at), rgba_at(above, to), part * units);
        if (done || light.a > 1.0 - kNothingLeft) return light;
        above += up ? 1 : -1;
        at = to;
    }
    return light;
}
