// SPDX-License-Identifier: Apache-2.0
// From sums to light, between two sheets: splat_composite-inl.h.

// What a ray sees on a sheet. Values are in cells of their tables; light is a factor, and the white that is added.
struct Seen {
    float value, weight, color;
    vec2 light;
    bool known;
};

// On its way from front to back; depth is weighted by opacity.
struct Beam {
    vec3 color;
    float transmittance, depth;
};

// Without a boundary the volume ends where the weight, linear between sheets, falls below a level.
void cut_where_weights_end(Seen front, Seen back, float front_z, float back_z, inout float from, inout float to) {
    bool inside0 = front.weight > half_weight, inside1 = back.weight > half_weight;
    if (!inside0 && !inside1) to = from;
    if (inside0 == inside1) return;
    float crossing = (half_weight - front.weight) / (back.weight - front.weight) * (back_z - front_z) + front_z;
    if (inside0) to = min(to, crossing);
    else from = max(from, crossing);
}

// Follows a beam between two sheets, where it is inside the volume: from `enter` to `exit`.
void follow(inout Beam beam, Seen front, Seen back, float front_z, float back_z, float enter, float exit, float ray_length) {
    float from = max(enter, front_z), to = min(exit, back_z);
#if !BOUNDED
    cut_where_weights_end(front, back, front_z, back_z, from, to);
#endif
    if (!(from < to) || !(front.known || back.known)) return;
    // An end that knows nothing is like the other.
    if (!front.known) front = back;
    if (!back.known) back = front;
    float slope = (back.value - front.value) * (1.0 / (back_z - front_z));
    float x0 = from == front_z ? front.value : slope * (from - front_z) + front.value;
    float x1 = to == back_z ? back.value : slope * (to - front_z) + front.value;
    if (transparent(x0, x1)) return;
    vec4 mean = means(place_of(x0), place_of(x1));
    if (!(mean.x > 0.0)) return;  // nothing is left of rounding where there is nothing to see
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
