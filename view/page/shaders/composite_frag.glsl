precision highp float;
// The light between two sheets, blended under what is before it: the parts of the ray that are inside the boundary and before
// the clip plane, with values from the sums at the sheets and from the boundary where the ray crosses it.
uniform highp sampler2D front_sums, back_sums, entries, exits;
uniform float front, back;
uniform vec2 half_size, size;
uniform vec3 right, up, forward, eye;
uniform vec4 clip;
uniform bool perspective;
out vec4 light;  // colour, and the part of the light from behind that passes

float known(vec2 sums) { return sums.x > 0.02 ? 1.0 : 0.0; }

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  light = vec4(0.0, 0.0, 0.0, 1.0);
  vec4 enter = texelFetch(entries, at, 0), leave = texelFetch(exits, at, 0);
  float after = enter.a, before = after - (enter.x - leave.x);
  bool inside0 = before > 0.5, inside1 = after > 0.5;
  if (!inside0 && !inside1 && !(enter.x > 0.0 && leave.x > 0.0)) return;
  vec2 sums0 = texelFetch(front_sums, at, 0).xy, sums1 = texelFetch(back_sums, at, 0).xy;
  float known0 = known(sums0), known1 = known(sums1);
  float f0 = sums0.y / max(sums0.x, 0.02), f1 = sums1.y / max(sums1.x, 0.02);
  if (known0 == 0.0) f0 = f1;
  if (known1 == 0.0) f1 = f0;

  float from = 0.0, to = 1.0, part = 1.0, v0 = f0, v1 = f1;
  float turns = enter.y - leave.y;  // of depths
  if (inside0 && inside1) part = leave.x > 0.0 ? clamp(1.0 - turns * sign(enter.x), 0.0, 1.0) : 1.0;
  if (!inside0) from = inside1 && leave.x > 0.0 ? clamp(turns, 0.0, 1.0) : enter.y / max(enter.x, 1.0);
  if (!inside1) to = inside0 && enter.x > 0.0 ? clamp(-turns, 0.0, 1.0) : leave.y / max(leave.x, 1.0);
  if (!inside0 && !inside1) part = clamp(-turns, 0.0, 1.0) / max(to - from, 1e-6);
  if (!inside0) v0 = enter.z / max(enter.x, 1.0);
  if (!inside1) v1 = leave.z / max(leave.x, 1.0);
  if (known0 + known1 == 0.0) {  // a body thinner than the distance of the sheets
    if (inside0) v0 = v1;
    if (inside1) v1 = v0;
  }

  vec2 slope = (gl_FragCoord.xy / size * 2.0 - 1.0) * half_size;
  vec3 side = slope.x * right + slope.y * up;
  vec3 p0 = eye + front * forward + (perspective ? front : 1.0) * side, p1 = eye + back * forward + (perspective ? back : 1.0) * side;
  float g0 = dot(clip.xyz, p0) - clip.w, g1 = dot(clip.xyz, p1) - clip.w;
  if (g0 > 0.0 && g1 > 0.0) return;
  if (g0 > 0.0 || g1 > 0.0) {
    float cut = g0 / (g0 - g1), value = mix(f0, f1, cut);
    if (g0 > 0.0 && cut > from) {
      from = cut;
      v0 = value;
    }
    if (g1 > 0.0 && cut < to) {
      to = cut;
      v1 = value;
    }
  }
  if (!(from < to)) return;

  float x0 = cells_of(v0), x1 = cells_of(v1), path = (to - from) * part * distance(p0, p1);
  vec4 mean = means(x0, x1);
  if (!(mean.x > 0.0)) return;
  // A stretch that is not thin is cut: its front hides its back.
  float thick = path * mean.x;
  int pieces = int(clamp(ceil(thick / 0.45), 1.0, 64.0));
  float length_each = path / float(pieces);
  vec3 color = vec3(0.0);
  float passes = 1.0, a = x0;
  for (int i = 1; i <= pieces; ++i) {
    float b = mix(x0, x1, float(i) / float(pieces));
    vec4 here = pieces == 1 ? mean : means(a, b);
    float through = exp(-length_each * here.x);
    if (here.x > 0.0) color += passes * (1.0 - through) * min(here.yzw / here.x, 1.0);
    passes *= through;
    a = b;
  }
  light = vec4(color, passes);
}
