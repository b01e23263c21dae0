precision highp float;
// A solid body: its surface, the face where the clip plane cuts it, or the material at the eye.
uniform highp sampler2D surface, shells, face_sums, eye_sums;
uniform vec2 half_size, size;
uniform vec3 right, up, forward, eye;
uniform vec4 clip;
uniform bool perspective, clipped, inside;
uniform float nearest;  // the depth of the sums at the eye
out vec4 color;

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 seen = texelFetch(surface, at, 0);
  if ((clipped || inside) && texelFetch(shells, at, 0).a > 0.5) {  // the ray begins inside the body
    vec2 slope = (gl_FragCoord.xy / size * 2.0 - 1.0) * half_size;
    vec3 side = slope.x * right + slope.y * up, direction = perspective ? forward + side : forward;
    vec3 origin = perspective ? eye : eye + side;
    float before = clipped ? dot(clip.xyz, origin) - clip.w : -1.0, toward = dot(clip.xyz, direction);
    float here = before + nearest * toward;  // above the clip plane
    vec2 sum = texelFetch(eye_sums, at, 0).xy;
    if (inside && here <= 0.0 && sum.x > 0.0) seen = vec4(sum.y / sum.x, 1.0, 0.0, 1.0);  // at the eye, without light
    sum = texelFetch(face_sums, at, 0).xy;
    if (here > 0.0 && toward < 0.0 && sum.x > 0.0) {  // the ray enters what is left through the plane
      vec3 normal = vec3(dot(right, clip.xyz), dot(up, clip.xyz), dot(forward, clip.xyz));
      vec3 to_eye = perspective ? -normalize(vec3(slope, 1.0)) : vec3(0.0, 0.0, -1.0);
      seen = vec4(sum.y / sum.x, light_on(normal, to_eye), 1.0);
    }
  }
  color = seen.a * vec4(seen.y * color_at(cells_of(seen.x)) + seen.z, 1.0);
}
