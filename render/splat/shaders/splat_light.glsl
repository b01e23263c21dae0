// SPDX-License-Identifier: Apache-2.0
// The effect of light on a colour, as in splat_cpu/splat_light-inl.h: a factor, and white that is added.
vec3 unit_vector(vec3 v) { return v * (1.0 / sqrt(max(dot(v, v), 1e-30))); }

float gloss(float cosine) { return exp_of(material.w * log_of(max(cosine, 1e-3))); }

// gradient: in cells for each world length, in eye space
vec2 light_on(vec3 gradient) {
    vec3 to_eye = unit_vector(vec3(perspective ? -ray : vec2(0.0), -1.0));
    vec3 halfway = unit_vector(key.xyz + to_eye), normal = unit_vector(gradient);
    float head = abs(dot(normal, to_eye)), side = abs(dot(normal, key.xyz));
    precise float directed = key.w * head + (1.0 - key.w) * side;
    float lit = fma(material.y, directed, material.x);
    float shine = material.z * (0.5 * (gloss(head) + gloss(abs(dot(normal, halfway)))));
    // Where the value hardly changes there is no surface to light.
    float square = dot(gradient, gradient), surface = square / (square + least_gradient * least_gradient);
    precise vec2 light = vec2(fma(surface, lit - 1.0, 1.0), surface * shine);
    return light;
}
