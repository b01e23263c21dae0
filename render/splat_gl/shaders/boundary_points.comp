#version 450
// SPDX-License-Identifier: Apache-2.0
// The surface's points in eye space and in the picture.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Positions { double positions[]; };
layout(std430, binding = 1) writeonly buffer EyePoints { EyePoint eye_points[]; };

// Rounds to the nearest integer, halves away from 0.
int snap(double px) {
    precise double scaled = px * double(kSnap), low = floor(scaled), part = scaled - low;
    return int(low) + (part > 0.5lf || (part == 0.5lf && scaled > 0.0lf) ? 1 : 0);
}

void main() {
    uint id = group_number() * kThreads + gl_LocalInvocationIndex;
    if (id >= points) return;
    precise double x = positions[3u * id] - right.w, y = positions[3u * id + 1u] - up.w, z = positions[3u * id + 2u] - forward.w;
    precise double eye_x = right.x * x + right.y * y + right.z * z;
    precise double eye_y = up.x * x + up.y * y + up.z * z;
    precise double eye_z = forward.x * x + forward.y * y + forward.z * z;
    precise double per_unit = 1.0lf / (perspective ? eye_z * scale.x : scale.x);
    precise double px = 0.5lf * double(size.x) + eye_x * per_unit, py = 0.5lf * double(size.y) - eye_y * per_unit;
    eye_points[id] = EyePoint(eye_x, eye_y, eye_z, ivec2(snap(px), snap(py)));
}
