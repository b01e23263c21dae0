// SPDX-License-Identifier: Apache-2.0
// Data that is the same for all tetrahedra. Lengths are in parts of the volume's diagonal, in eye space; depths are relative to
// that of the volume's middle.
uniform vec2 middle_px, size_px;
uniform float pixel, middle_depth;
const bool perspective = PERSPECTIVE == 1;
