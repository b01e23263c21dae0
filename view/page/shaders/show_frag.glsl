#version 300 es
precision highp float;
// The picture over its background, in sRGB.
uniform highp sampler2D picture;
uniform vec2 size;  // of the canvas
uniform int samples;  // a side, of a pixel; 1 where the picture may also be smaller than the canvas
uniform bool transmits;  // the last component is what passes, not the opacity
uniform vec3 background;
out vec4 color;

vec4 texel(ivec2 at) {
  vec4 light = texelFetch(picture, clamp(at, ivec2(0), textureSize(picture, 0) - 1), 0);
  return transmits ? vec4(light.rgb, 1.0 - light.a) : light;
}
vec3 srgb(vec3 l) {
  return mix(1.055 * pow(max(l, 0.0), vec3(1.0 / 2.4)) - 0.055, l * 12.92, vec3(lessThanEqual(l, vec3(0.0031308))));
}
void main() {
  vec4 light = vec4(0.0);
  if (samples > 1) {
    ivec2 first = ivec2(gl_FragCoord.xy) * samples;
    for (int y = 0; y < samples; ++y) {
      for (int x = 0; x < samples; ++x) light += texel(first + ivec2(x, y));
    }
    light /= float(samples * samples);
  } else {
    vec2 at = gl_FragCoord.xy / size * vec2(textureSize(picture, 0)) - 0.5, part = fract(at);
    ivec2 low = ivec2(floor(at));
    light = mix(mix(texel(low), texel(low + ivec2(1, 0)), part.x),
                mix(texel(low + ivec2(0, 1)), texel(low + ivec2(1, 1)), part.x), part.y);
  }
  color = vec4(srgb(clamp(light.rgb + (1.0 - light.a) * background, 0.0, 1.0)), 1.0);
}
