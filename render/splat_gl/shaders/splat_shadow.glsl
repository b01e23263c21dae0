// SPDX-License-Identifier: Apache-2.0
// The light that arrives at a place, and its effect; the same as in splat_cpu/splat_light-inl.h.
#if SHADOWED
layout(std430, binding = 15) readonly buffer LightNodes { vec2 nodes[]; };  // {key, open}

// eye: with a relative depth
vec2 arrival_at(vec3 eye) {
    vec3 x, low, most = vec3(light_nodes.xyz);
    for (int k = 0; k < 3; ++k) x[k] = dot(to_light[k], vec4(eye, 1.0));
    x = clamp(x, vec3(0.0), most - 1.0);
    low = min(floor(x), most - 2.0);
    vec3 part = x - low;
    ivec3 cell = ivec3(low);
    int first = (cell.z * light_nodes.y + cell.y) * light_nodes.x + cell.x, row = light_nodes.x, sheet = row * light_nodes.y;
    vec2 near0 = mix(nodes[first], nodes[first + 1], part.x);
    vec2 near1 = mix(nodes[first + row], nodes[first + row + 1], part.x);
    vec2 far0 = mix(nodes[first + sheet], nodes[first + sheet + 1], part.x);
    vec2 far1 = mix(nodes[first + sheet + row], nodes[first + sheet + row + 1], part.x);
    return mix(mix(near0, near1, part.y), mix(far0, far1, part.y), part.z);
}

// Where there is no surface.
float unlit(vec2 arrives) { return arrives.y * (1.0 - (1.0 - unlit_ambient) * (1.0 - arrives.x)); }

#if SHADED
// As light_on, with what arrives.
vec2 shadowed_light_on(vec3 gradient, vec2 arrives) {
    vec3 to_eye = unit_vector(vec3(perspective ? -ray : vec2(0.0), -1.0));
    vec3 halfway = unit_vector(key.xyz + to_eye), normal = unit_vector(gradient);
    float head = abs(dot(normal, to_eye)), side = arrives.x * abs(dot(normal, key.xyz));
    float lit = material.y * (key.w * head + (1.0 - key.w) * side) + material.x;
    float shine = material.z * 0.5 * (gloss(head) + arrives.x * gloss(abs(dot(normal, halfway))));
    float square = dot(gradient, gradient), surface = square / (square + least_gradient * least_gradient);
    return vec2(mix(unlit(arrives), arrives.y * lit, surface), arrives.y * surface * shine);
}
#endif
#endif
