#version 300 es
// Where rays cross the boundary between two sheets. Sums: of entries and of exits their number, depths in parts of the distance
// of the sheets, and values. The last component of the first target is not cleared: the number of shells that the ray is in.
precision highp float;
in vec3 place;
in vec3 facing;
in float field, beyond, start;
uniform float front, back, from_depth, per_depth;
layout(location = 0) out vec4 entries;
layout(location = 1) out vec4 exits;

void main() {
  if ((start > 0.0 && beyond > 0.0) || place.z <= front || place.z > back) discard;
  vec3 hit = vec3(1.0, (place.z - from_depth) * per_depth, field);
  bool enters = gl_FrontFacing;
  entries = vec4(enters ? hit : vec3(0.0), enters ? 1.0 : -1.0);
  exits = vec4(enters ? vec3(0.0) : hit, 0.0);
}
