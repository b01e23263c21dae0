// SPDX-License-Identifier: Apache-2.0
// From values to light along a stretch of a ray; the same as in splat_cpu/splat_composite-inl.h.
const float kUnknown = 1.5e38;  // a value is known if it is less: those that are not are 3e38
const int kMostSteps = 96;

// An end of a stretch. Values are in cells of their tables; light is a factor, and white that is added.
struct End {
    float x, color;
    vec2 light;
};

// The state of a ray; depth is weighted by opacity. The opacity is kept, not what passes: next to 1 that has no digits for the
// little that a thin stretch takes away.
struct Beam {
    vec3 color;
    float opacity, depth;
};

bool is_opaque(Beam beam) { return 1.0 - beam.opacity < kSplatCutoff; }

// Adds something opaque.
void see_surface(inout Beam beam, vec3 color, float depth) {
    float left = 1.0 - beam.opacity;
    beam = Beam(beam.color + left * color, 1.0, beam.depth + left * depth);
}

// Adds the light of a stretch with the mean extinction and emission `mean`.
void add_light(inout Beam beam, End e0, End e1, vec4 mean, float length_world, float middle) {
    // Rounding must not leave light where there is none, nor make a colour brighter than 1.
    if (!(mean.x > 0.0)) return;
    precise float light = (1.0 - beam.opacity) * opacity_of(length_world * mean.x);
    precise vec3 emission = min(mean.yzw, mean.xxx);
#if COLORED
    emission = 0.5 * mean.x * (color_at(e0.color) + color_at(e1.color));
#endif
    precise float per_extinction = light / max(mean.x, 1e-37);
#if SHADED || SHADOWED
    precise vec2 lit = 0.5 * (e0.light + e1.light) * vec2(per_extinction, light);
    precise vec3 color = beam.color + fma(vec3(lit.x), emission, vec3(lit.y));
#else
    precise vec3 color = fma(vec3(per_extinction), emission, beam.color);
#endif
    precise float depth = fma(light, middle, beam.depth), opacity = beam.opacity + light;
    beam = Beam(color, opacity, depth);
}

End between_ends(End e0, End e1, float part) {
    return End(e0.x, fma(part, e1.color - e0.color, e0.color), fma(vec2(part), e1.light - e0.light, e0.light));
}

// Composites a stretch that is not thin: its front hides its back, so the mean colour of the whole would be wrong. Each step is
// as long as its optical depth allows; it shrinks until it is thin, and the next one may be twice as long.
void go_in_steps(inout Beam beam, End e0, End e1, float length_world, float from, float to) {
    precise float slope = e1.x - e0.x, begin = 0.0, step_part = 1.0;
    Place front = place_of(e0.x);
    for (int i = 0; i < kMostSteps && begin < 1.0 && !is_opaque(beam); ++i) {
        bool last_step = i + 1 == kMostSteps;
        precise float end = last_step ? 1.0 : min(begin + step_part, 1.0), x = end == 1.0 ? e1.x : fma(slope, end, e0.x);
        Place back = place_of(x);
        vec4 mean = means(front, back);
        precise float part = (end - begin) * length_world, depth = part * mean.x;
        if (depth <= kThickDepth || last_step) {
            add_light(beam, between_ends(e0, e1, begin), between_ends(e0, e1, end), mean, part,
                      fma(to - from, 0.5 * (begin + end), from));
            step_part = (end - begin) * 2.0;
            front = back;
            begin = end;
        } else {
            step_part = (end - begin) * clamp(kAimedDepth / depth, 0.0625, 0.9);
        }
    }
}

// Composites a volume that is opaque from its boundary on: whether all light ends within the skin.
bool see_boundary(inout Beam beam, End end, float enter, float exit, float ray_length, float skin) {
    if (!(end.x < kUnknown)) return false;
    Place at = place_of(end.x);
    vec4 here = max(means(at, at), 0.0);
    if (!(here.x * skin * ray_length > kOpaqueDepth && exit - enter > skin)) return false;
    precise vec3 color = min(here.yzw / here.x, 1.0);
#if COLORED
    color = color_at(end.color);
#endif
#if SHADED || SHADOWED
    color = color * end.light.x + end.light.y;
#endif
    see_surface(beam, color, enter);
    return true;
}

// Composites a slice, if there is a value on it.
void see_slice(inout Beam beam, End end, float depth) {
    if (!(end.x < kUnknown)) return;
#if COLORED
    precise vec3 color = color_at(end.color);
#else
    precise vec3 color = color_at(end.x);
#endif
    see_surface(beam, color, depth);
}

// Light at the end where a ray enters: the boundary is a surface if the volume is more than half opaque there within a pixel.
vec2 light_at_entry(float x, vec2 inside, vec2 boundary, float pixel_world) {
    Place at = place_of(x);
    precise float cover = max(1.0 - 2.0 * exp_of(-(pixel_world * max(means(at, at).x, 0.0))), 0.0);
    return fma(vec2(cover), boundary - inside, inside);
}
