#version 450
// Sorts the list of each pixel from front to back and composites it. Lists come nearly sorted: insertion is quick.
layout(local_size_x = 64) in;
layout(std430, binding = 3) buffer Pictures { vec4 picture[]; };
layout(std430, binding = 4) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 5) buffer Lights { vec4 lights[]; };
layout(std430, binding = 6) buffer Places { uvec4 places[]; };
layout(std430, binding = 11) buffer Violations { uint violations; };
uniform uint pixels;

// Two segments of which one has to be the first. Tetrahedra touch: what overlaps by less is rounding.
const float kTouch = 1e-5;

bool before(uvec4 a, uvec4 b) {
    float za = uintBitsToFloat(a.x) + uintBitsToFloat(a.y), zb = uintBitsToFloat(b.x) + uintBitsToFloat(b.y);
    return za < zb || (za == zb && a.z > b.z);
}

void main() {
    uint id = gl_WorkGroupID.y * gl_NumWorkGroups.x * 64u + gl_GlobalInvocationID.x;
    if (id >= pixels) return;
    uint first = offsets[id], end = offsets[id + 1u];
    for (uint i = first + 1u; i < end; ++i) {
        uvec4 place = places[i];
        vec4 light = lights[i];
        uint k = i;
        for (; k > first && before(place, places[k - 1u]); --k) {
            places[k] = places[k - 1u];
            lights[k] = lights[k - 1u];
        }
        places[k] = place;
        lights[k] = light;
    }
    vec4 sum = vec4(0.0);
    bool wrong = false, known = false;
    uint last_rank = 0u;  // of the last that is thick enough to tell
    for (uint i = first; i < end; ++i) {
        sum += (1.0 - sum.a) * lights[i];
        uvec4 place = places[i];
        if (!(uintBitsToFloat(place.y) - uintBitsToFloat(place.x) > kTouch)) continue;
        // Drawn from back to front: what is nearer has the higher rank.
        wrong = wrong || (known && place.z > last_rank);
        last_rank = place.z;
        known = true;
    }
    picture[id] = sum;
    if (wrong) atomicAdd(violations, 1u);
}
