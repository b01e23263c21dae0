#version 300 es
// The section of a kernel with a plane: a parallelogram around it. The planes are sheets, or the clip plane.
// With y = S^(-1/2) (x - center) a kernel is the unit ball; on the plane y is linear.
layout(location = 0) in uint kernel;
uniform highp sampler2D kernels;  // four texels each: centre, S^(-1/2), moment, value, changes
uniform vec3 plane, along, across;  // normal and two directions
uniform float offset;
uniform vec3 right, up, forward, eye;
uniform vec2 half_size;
uniform bool perspective;
out vec3 y;
flat out vec3 change;
flat out vec2 value;

void main() {
  int first = int(kernel) * 4, row = first >> 11, column = first & 2047;
  vec4 a = texelFetch(kernels, ivec2(column, row), 0), b = texelFetch(kernels, ivec2(column + 1, row), 0);
  vec4 c = texelFetch(kernels, ivec2(column + 2, row), 0), d = texelFetch(kernels, ivec2(column + 3, row), 0);
  mat3 root = mat3(a.w, b.x, b.y, b.x, b.z, b.w, b.y, b.w, c.x);
  value = c.zy;
  change = d.xyz;

  float away = dot(plane, a.xyz) - offset;
  vec3 y0 = root * (-away * plane), yu = root * along, yv = root * across;
  float uu = dot(yu, yu), uv = dot(yu, yv), vv = dot(yv, yv), det = uu * vv - uv * uv;
  vec2 q = vec2(dot(yu, y0), dot(yv, y0)), middle = -vec2(vv * q.x - uv * q.y, uu * q.y - uv * q.x) / det;
  vec3 ym = y0 + middle.x * yu + middle.y * yv;
  float left = 1.0 - dot(ym, ym);
  if (!(left > 0.0)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    return;
  }
  // The root of the inverse of (uu uv; uv vv) takes the corners of a square to those of a parallelogram about the ellipse.
  float u_size = sqrt(vv / det), shear = -uv / (det * u_size), v_size = sqrt(max(uu / det - shear * shear, 0.0));
  vec2 corner = sqrt(left) * (vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0);
  vec2 from = vec2(u_size * corner.x, shear * corner.x + v_size * corner.y);
  y = ym + from.x * yu + from.y * yv;
  vec2 at = middle + from;
  vec3 seen = a.xyz - away * plane + at.x * along + at.y * across - eye;
  gl_Position = vec4(vec2(dot(right, seen), dot(up, seen)) / half_size, 0.0, perspective ? dot(forward, seen) : 1.0);
}
