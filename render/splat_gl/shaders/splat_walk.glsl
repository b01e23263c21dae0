// SPDX-License-Identifier: Apache-2.0
// Composites a pixel from front to back; the same as splat_cpu/splat_composite-inl.h.
layout(std430, binding = 5) readonly buffer IntervalRanges { uvec2 interval_ranges[]; };  // first, end
layout(std430, binding = 6) readonly buffer Intervals { vec2 intervals[]; };  // enter, exit
layout(std430, binding = 14) buffer Ends { vec4 ends[]; };  // of each interval: value, second value, light

// The values of a pixel on one sheet.
struct Sheet {
    float x;  // in cells
    bool known;
    float weight;
    float color;  // the second channel's, in cells
    vec2 light;   // diffuse, specular
};

precise Beam beam;
float enter_z, exit_z;  // the interval that the ray is in or reaches next; enter = kNever: the ray is done
uint interval, intervals_end;
float ray_length;
Sheet last;
Place last_place;
bool last_placed = false;

void take_interval() {
    bool more = interval < intervals_end;
    vec2 depths = more ? intervals[interval] : vec2(kNever);
    enter_z = depths.x;
    exit_z = depths.y;
}

End end_of_interval(uint which) {
#if INTERVALS
    vec4 end = ends[2u * interval + which];
    return End(end.x, end.y, end.zw);
#else
    return End(3e38, 0.0, vec2(1.0, 0.0));
#endif
}

// Without a boundary the volume ends where the sum of weights, linear between sheets, falls below a level.
void cut_where_weights_end(float front, float back, float weight, inout float from, inout float to) {
    bool inside0 = last.weight > half_weight, inside1 = weight > half_weight;
    precise float part = (half_weight - last.weight) / (inside0 != inside1 ? weight - last.weight : 1.0);
    precise float crossing = fma(part, back - front, front);
    from = inside0 ? from : inside1 ? max(from, crossing) : kNever;
    to = inside1 ? to : min(to, crossing);
}

// The rest of an end on the way between two sheets. An end without a value is taken to be like the other.
End end_between(Sheet here, float x, float part) {
    End f = End(x, last.known ? last.color : here.color, last.known ? last.light : here.light);
    End b = End(x, here.known ? here.color : last.color, here.known ? here.light : last.light);
    return between_ends(f, b, part);
}

// Composites the part of the ray between two sheets that lies in its interval.
void stretch(float front, float back, Sheet here, inout Place place, inout bool placed) {
#if INTERVALS
    if (enter_z == exit_z) {
        see_slice(beam, end_of_interval(0u), enter_z);
        return;
    }
#endif
    float from = max(enter_z, front), to = min(exit_z, back);
#if UNBOUNDED
    cut_where_weights_end(front, back, here.weight, from, to);
#endif
    if (!(from < to)) return;
    End enter = end_of_interval(0u), exit = end_of_interval(1u);
#if INTERVALS
    float skin = kSkin_px * pixel * (perspective ? middle_depth + enter_z : 1.0);
    if (enter_z >= front && see_boundary(beam, enter, enter_z, exit_z, ray_length, skin)) return;
#endif
    bool at_enter = enter_z > front && enter.x < kUnknown, at_exit = exit_z < back && exit.x < kUnknown;
    bool on_sheet = last.known || here.known;
    if (!(on_sheet || at_enter || at_exit)) return;
    float x_front = last.known ? last.x : here.x, x_back = here.known ? here.x : last.x, per_depth = 1.0 / (back - front);
    precise float slope = (x_back - x_front) * per_depth;
    precise float x0 = fma(slope, from - front, x_front), x1 = fma(slope, to - front, x_front);
    if (from == front) x0 = x_front;
    if (to == back) x1 = x_back;
    x0 = at_enter ? enter.x : on_sheet ? x0 : exit.x;
    x1 = at_exit ? exit.x : on_sheet ? x1 : enter.x;
    if (!all_visible && transparent(x0, x1)) return;

    vec4 mean;
    if (x0 == last.x && x1 == here.x) {
        if (!last_placed) last_place = place_of(last.x);
        if (!placed) place = place_of(here.x);
        last_placed = placed = true;
        mean = means(last_place, place);
    } else {
        mean = means(place_of(x0), place_of(x1));
    }
    End e0 = at_enter ? enter : end_between(here, x0, (from - front) * per_depth);
    End e1 = at_exit ? exit : end_between(here, x1, (to - front) * per_depth);
    if (!(on_sheet || at_enter)) e0 = End(x0, e1.color, e1.light);
    if (!(on_sheet || at_exit)) e1 = End(x1, e0.color, e0.light);
    precise float length_world = (to - from) * ray_length;
    if (length_world * mean.x > kThickDepth) go_in_steps(beam, e0, e1, length_world, from, to);
    else add_light(beam, e0, e1, mean, length_world, 0.5 * (from + to));
}

void skip_to(Sheet here) {
    last = here;
    last_placed = false;
}

// Composites what lies between the last sheet, at `front`, and the next one, at `back` with the values `here`.
void go(float front, float back, Sheet here) {
    Place place;
    bool placed = false;
    while (enter_z < back) {
        stretch(front, back, here, place, placed);
        if (is_opaque(beam)) {
            enter_z = exit_z = kNever;
            break;
        }
        if (!(exit_z <= back)) break;
        ++interval;
        take_interval();
    }
    last = here;
    last_placed = placed;
    if (placed) last_place = place;
}
