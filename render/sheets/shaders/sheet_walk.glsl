// SPDX-License-Identifier: Apache-2.0
// From sums to light, between two sheets; the same as splat_cpu/splat_composite-inl.h.

// The values of a ray on a sheet. Values are in cells of their tables; light is a factor, and white that is added.
struct Seen {
    float value, weight, color;
    vec2 light;
    bool known;
};

// The state of a ray between two sheets; depth is weighted by opacity.
struct Beam {
    vec3 color;
    float transmittance, depth;
};

// Without a boundary the volume ends where the sum of weights, linear between sheets, falls below a level.
void cut_where_weights_end(Seen front, Seen back, float front_z, float back_z, inout float from, inout float to) {
    bool inside0 = front.weight > half_weight, inside1 = back.weight > half_weight;
    if (!inside0 && !inside1) to = from;
    if (inside0 == inside1) return;
    float crossing = (half_weight - front.weight) / (back.weight - front.weight) * (back_z - front_z) + front_z;
    if (inside0) to = min(to, crossing);
    else from = max(from, crossing);
}

// Composites the part of a ray between two sheets that is inside the volume: from `enter` to `exit`.
void follow(inout Beam beam, Seen front, Seen back, float front_z, float back_z, float enter, float exit, float ray_length) {
    float from = max(enter, front_z), to = min(exit, back_z);
#if !BOUNDED
    cut_where_weights_end(front, back, front_z, back_z, from, to);
#endif
    if (!(from < to) || !(front.known || back.known)) return;
    // An end without a value is taken to be like the other.
    if (!front.known) front = back;
    if (!back.known) back = front;
    float slope = (back.value - front.value) * (1.0 / (back_z - front_z));
    float x0 = from == front_z ? front.value : slope * (from - front_z) + front.value;
    float x1 = to == back_z ? back.value : slope * (to - front_z) + front.value;
    if (transparent(x0, x1)) return;
    vec4 mean = means(place_of(x0), place_of(x1));
    if (!(mean.x > 0.0)) return;  // rounding must not leave light where there is none
    mean.yzw = min(mean.yzw, mean.xxx);
#if COLORED
    mean.yzw = 0.5 * mean.x * (color_at(front.color) + color_at(back.color));
#endif
    float opacity = 1.0 - exp_of(-(to - from) * ray_length * mean.x), light = beam.transmittance * opacity;
    float per_extinction = light / max(mean.x, 1e-37);
#if SHADED
    vec2 lit = 0.5 * (front.light + back.light);
    beam.color += lit.x * per_extinction * mean.yzw + lit.y * light;
#else
    beam.color += per_extinction * mean.yzw;
#endif
    beam.depth += light * (0.5 * (from + to));
    beam.transmittance -= light;
}
