// SPDX-License-Identifier: Apache-2.0
// Data that is the same for all tetrahedra. Lengths are in parts of the volume's diagonal, in eye space; depths are relative to
// that of the volume's middle.
layout(location = 0) uniform vec2 middle_px;
layout(location = 1) uniform vec2 size_px;
layout(location = 2) uniform float pixel;
layout(location = 3) uniform float middle_depth;
const bool perspective = PERSPECTIVE == 1;
