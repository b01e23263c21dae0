// From sums to light: the rules of classification and compositing that all splatters share (src/splat_scene.h has the numbers).
struct TableRow {
    ivec4 prefix;
    vec4 mean, bend;
};
struct ColorRow {
    vec4 color, slope;
};
layout(std430, binding = TABLE_BINDING) readonly buffer Table { TableRow table_rows[]; };
layout(std430, binding = TABLE_BINDING + 1) readonly buffer Visible { int table_visible[]; };
layout(std430, binding = TABLE_BINDING + 2) readonly buffer ColorTable { ColorRow color_rows[]; };
uniform vec4 table_unit;
uniform float half_weight;    // where there is no boundary: the volume ends where weights fall below
uniform float least_gradient;  // at which half of a surface is seen
uniform vec4 shading;         // ambient, diffuse, specular, shininess
uniform vec3 to_key;          // the key light, of unit length

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

float cell_of(float x) { return clamp(floor(x), -1.0, float(TABLE_CELLS)); }
TableRow row_of(float cell) { return table_rows[int(cell) + 1]; }

bool transparent(float x0, float x1) {
    return table_visible[int(cell_of(max(x0, x1))) + 2] == table_visible[int(cell_of(min(x0, x1))) + 1];
}

// Mean extinction and emission on a stretch between two values.
vec4 mean_emission(float x0, float x1) {
    if (abs(x1 - x0) < NEAR_VALUES) {
        float x = 0.5 * (x0 + x1), cell = cell_of(x);
        TableRow row = row_of(cell);
        return row.mean + (2.0 * (x - cell) - 1.0) * row.bend;
    }
    float cell0 = cell_of(x0), cell1 = cell_of(x1), s0 = x0 - cell0, s1 = x1 - cell1;
    TableRow row0 = row_of(cell0), row1 = row_of(cell1);
    vec4 within0 = s0 * (row0.mean + (s0 - 1.0) * row0.bend), within1 = s1 * (row1.mean + (s1 - 1.0) * row1.bend);
    vec4 integral = table_unit * vec4(row1.prefix - row0.prefix) + (within1 - within0);
    return max(integral * (1.0 / (x1 - x0)), vec4(0.0));
}

vec3 second_color(float x) {
    float cell = cell_of(x);
    ColorRow row = color_rows[int(cell) + 1];
    return row.color.rgb + (x - cell) * row.slope.rgb;
}

// 1 − exp(−t) for t ≥ 0 to float accuracy, small t too: drivers' exp is not good enough for hundreds of sheets.
float opacity_of(float t) {
    if (t < 0.25) return t * (1.0 - t * (0.5 - t * (1.0 / 6.0 - t * (1.0 / 24.0 - t * (1.0 / 120.0 - t * (1.0 / 720.0))))));
    if (t > 40.0) return 1.0;
    float k = floor(t * 1.44269504 + 0.5);
    float r = -((t - k * 0.693145752) - k * 1.42860677e-6);  // ln 2 in two parts; |r| ≤ 0.35
    float p = 1.0 + r * (1.0 + r * (0.5 + r * (1.0 / 6.0 + r * (1.0 / 24.0 + r * (1.0 / 120.0 + r * (1.0 / 720.0))))));
    return 1.0 - ldexp(p, -int(k));
}

vec3 unit(vec3 v) { return v * (1.0 / sqrt(max(dot(v, v), 1e-30))); }

float gloss(float cosine) { return exp(shading.w * log(max(cosine, 1e-3))); }

// gradient: cells a world length, in eye space; to_eye: of unit length
vec2 light_on(vec3 gradient, vec3 to_eye) {
    vec3 normal = unit(gradient), halfway = unit(to_key + to_eye);
    float head = abs(dot(normal, to_eye)), side = abs(dot(normal, to_key));
    float lit = shading.y * (0.5 * (head + side)) + shading.x;
    float shine = shading.z * (0.5 * (gloss(head) + gloss(abs(dot(normal, halfway)))));
    float square = dot(gradient, gradient), surface = square / (square + least_gradient * least_gradient);
    return vec2(surface * (lit - 1.0) + 1.0, surface * shine);
}

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
    float x_front = front.known ? front.value : back.value, x_back = back.known ? back.value : front.value;
    float slope = (x_back - x_front) * (1.0 / (back_z - front_z));
    float x0 = from == front_z ? x_front : slope * (from - front_z) + x_front;
    float x1 = to == back_z ? x_back : slope * (to - front_z) + x_front;
    if (transparent(x0, x1)) return;
    vec4 mean = mean_emission(x0, x1);
    if (!(mean.x > 0.0)) return;  // nothing is left of rounding where there is nothing to see
    mean.yzw = min(mean.yzw, mean.xxx);
#if COLORED
    mean.yzw = 0.5 * mean.x * (second_color(front.known ? front.color : back.color) + second_color(back.color));
#endif
    float opacity = opacity_of((to - from) * ray_length * mean.x), light = beam.transmittance * opacity;
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
