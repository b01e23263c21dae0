// SPDX-License-Identifier: Apache-2.0
// From sums to light, between two sheets; the same as splat_cpu/splat_composite-inl.h.

// The values of a ray on a sheet. Values are in cells of their tables; light is a factor, and white that is added.
struct Seen {
    float value, weight, color;
    vec2 light;
    bool known;
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

// The rest of an end on the way between two sheets.
End end_between(Seen front, Seen back, float x, float part) {
    return between_ends(End(x, front.color, front.light), End(x, back.color, back.light), part);
}

// Composites the part of a ray between two sheets that is inside the volume: between the two ends of an interval, at the depths
// inside.x and inside.y.
void follow(inout Beam beam, Seen front, Seen back, float front_z, float back_z, vec2 inside, End enter, End exit,
            float ray_length, float skin) {
    float from = max(inside.x, front_z), to = min(inside.y, back_z);
#if !BOUNDED
    cut_where_weights_end(front, back, front_z, back_z, from, to);
#endif
    if (!(from < to)) return;
#if INTERVALS
    if (inside.x >= front_z && see_boundary(beam, enter, inside.x, inside.y, ray_length, skin)) return;
#endif
    bool at_enter = inside.x > front_z && enter.x < kUnknown, at_exit = inside.y < back_z && exit.x < kUnknown;
    bool on_sheet = front.known || back.known;
    if (!(on_sheet || at_enter || at_exit)) return;
    // An end without a value is taken to be like the other.
    if (!front.known) front = back;
    if (!back.known) back = front;
    float per_depth = 1.0 / (back_z - front_z), slope = (back.value - front.value) * per_depth;
    float x0 = from == front_z ? front.value : slope * (from - front_z) + front.value;
    float x1 = to == back_z ? back.value : slope * (to - front_z) + front.value;
    x0 = at_enter ? enter.x : on_sheet ? x0 : exit.x;
    x1 = at_exit ? exit.x : on_sheet ? x1 : enter.x;
    if (transparent(x0, x1)) return;
    vec4 mean = means(place_of(x0), place_of(x1));
    End e0 = at_enter ? enter : end_between(front, back, x0, (from - front_z) * per_depth);
    End e1 = at_exit ? exit : end_between(front, back, x1, (to - front_z) * per_depth);
    if (!(on_sheet || at_enter)) e0 = End(x0, e1.color, e1.light);
    if (!(on_sheet || at_exit)) e1 = End(x1, e0.color, e0.light);
    float length_world = (to - from) * ray_length;
    if (length_world * mean.x > kThickDepth) go_in_steps(beam, e0, e1, length_world, from, to);
    else add_light(beam, e0, e1, mean, length_world, 0.5 * (from + to));
}
