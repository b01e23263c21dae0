#version 450
// SPDX-License-Identifier: Apache-2.0
// The surface's points in eye space and in the picture.
layout(local_size_x = 256) in;
layout(std430, binding = 0) readonly buffer Positions { double positions[]; };
layout(std430, binding = 1) writeonly buffer EyePoints { EyePoint eye_points[]; };

// Rounds to the nearest integer. The border is a little less than a half, which points often have exactly: a division need not
// be rounded correctly, so its last bits must not decide.
int snap(double px) {
    precise double below = floor(abs(px) * double(kSnap) + (0.5lf + 1.0lf / 65536.0lf));
    return px < 0.0lf ? -int(below) : int(below);
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
