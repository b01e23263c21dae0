// SPDX-License-Identifier: Apache-2.0
// A pixel on its way from front to back: splat_composite-inl.h.
layout(std430, binding = 5) readonly buffer IntervalRanges { uvec2 interval_ranges[]; };  // first, end
layout(std430, binding = 6) readonly buffer Intervals { vec2 intervals[]; };  // enter, exit

// What a pixel sees on one sheet.
struct Sheet {
    float x;  // in cells
    bool known;
    float weight;
    float color;  // the second channel's, in cells
    vec2 light;   // diffuse, specular
};

precise float transmittance;
precise vec3 seen_color;
precise float seen_depth;
float enter_z, exit_z;  // the interval that the ray is in or comes to; enter = kNever: it is done
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

// Without a boundary the volume ends where the weight, linear between sheets, falls below a level.
void cut_where_weights_end(float front, float back, float weight, inout float from, inout float to) {
    bool inside0 = last.weight > half_weight, inside1 = weight > half_weight;
    precise float part = (half_weight - last.weight) / (inside0 != inside1 ? weight - last.weight : 1.0);
    precise float crossing = fma(part, back - front, front);
    from = inside0 ? from : inside1 ? max(from, crossing) : kNever;
    to = inside1 ? to : min(to, crossing);
}

// The part of the ray between two sheets that lies in its interval.
void stretch(float front, float back, Sheet here, inout Place place, inout bool placed) {
    float from = max(enter_z, front), to = min(exit_z, back);
#if UNBOUNDED
    cut_where_weights_end(front, back, here.weight, from, to);
#endif
    if (!(from < to) || !(last.known || here.known)) return;
    float x_front = last.known ? last.x : here.x, x_back = here.known ? here.x : last.x;
    precise float slope = (x_back - x_front) * (1.0 / (back - front));
    precise float x0 = fma(slope, from - front, x_front), x1 = fma(slope, to - front, x_front);
    if (from == front) x0 = x_front;
    if (to == back) x1 = x_back;
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
    // Nothing is left of rounding where there is nothing to see, and no colour is brighter than 1.
    if (!(mean.x > 0.0)) return;
    precise float depth = (to - from) * ray_length * mean.x, passes = exp_of(-depth), light = transmittance * (1.0 - passes);
    precise vec3 emission = min(mean.yzw, mean.x);
#if COLORED
    emission = 0.5 * mean.x * (color_at(last.known ? last.color : here.color) + color_at(here.known ? here.color : last.color));
#endif
    precise float per_extinction = light / max(mean.x, 1e-37);
#if SHADED
    // An end that knows nothing is like the other.
    precise vec2 lit = 0.5 * ((last.known ? last.light : here.light) + (here.known ? here.light : last.light)) * vec2(per_extinction, light);
    seen_color += fma(vec3(lit.x), emission, vec3(lit.y));
#else
    seen_color = fma(vec3(per_extinction), emission, seen_color);
#endif
    seen_depth = fma(light, 0.5 * (from + to), seen_depth);
    transmittance *= passes;
}

void skip_to(Sheet here) {
    last = here;
    last_placed = false;
}

// Goes on to the sheet at depth `back`, on which the pixel sees `here`; the last one was at `front`.
void go(float front, float back, Sheet here) {
    Place place;
    bool placed = false;
    while (enter_z < back) {
        stretch(front, back, here, place, placed);
        if (transmittance < kOpaque) {
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
