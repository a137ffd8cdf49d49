// GLSL of bodies and lines. Vertices fetch their data from textures by index, six vertices for each
// body or line. This is fast on any GPU, and ten times faster than instancing without one.

const COMMON = `#version 300 es
precision highp float;
precision highp sampler2D;
precision highp usampler2D;
uniform mat4 uMatrix;
uniform vec2 uViewport;
uniform float uPixels;     // of a metre where w is 1
uniform float uRatio;      // canvas pixels of a CSS pixel
`;

const CORNER = `
// Which corner of its quad the vertex is: bit 0 across, bit 1 along.
int corner() {
  int k = gl_VertexID % 6;
  return k > 2 ? k - 2 : k;
}
vec2 square() { return vec2(corner() & 1, corner() >> 1) * 2.0 - 1.0; }
`;

// The words of a frame; uAt gives the offset of each array.
const FRAME = `
uniform usampler2D uNow, uBefore;
uniform ivec3 uAtPlace, uAtVelocity, uAtTarget;
uniform ivec2 uAtModeWait;
uniform float uMix;
uniform sampler2D uStatic;
uint word(usampler2D words, int i) { return texelFetch(words, ivec2(i & 2047, i >> 11), 0).r; }
float number(usampler2D words, int i) { return uintBitsToFloat(word(words, i)); }
vec3 triple(usampler2D words, ivec3 at, int i) {
  return vec3(number(words, at.x + i), number(words, at.y + i), at.z < 0 ? 0.0 : number(words, at.z + i));
}
uint octet(int at, int i) { return (word(uNow, at + (i >> 2)) >> (8 * (i & 3))) & 255u; }
vec3 place(int i) { return mix(triple(uBefore, uAtPlace, i), triple(uNow, uAtPlace, i), uMix); }
vec2 pair(sampler2D pairs, int i) { return texelFetch(pairs, ivec2(i & 2047, i >> 11), 0).rg; }
`;

const COLOUR = `
uniform vec4 uPalette[16];
uniform int uRobots;
uniform int uColourBy;     // 0 mode, 1 what it waits for, 2 group, 3 number
vec4 colour(int i) {
  if (i >= uRobots) return uPalette[15];
  if (uColourBy == 3) return uPalette[i % 7];
  if (uColourBy == 2) return uPalette[int(pair(uStatic, i).g)];
  uint entry = octet(uColourBy == 1 ? uAtModeWait.y : uAtModeWait.x, i);
  return uPalette[entry == 255u ? 14u : min(entry, 13u)];
}
`;

// A ribbon of `width` pixels between two places, as two triangles.
const RIBBON = `${CORNER}
out float vAcross;
out float vAlong;
out float vHalf;
bool ribbon(vec3 from, vec3 to, float width) {
  vec4 a = uMatrix * vec4(from, 1.0), b = uMatrix * vec4(to, 1.0);
  float near = 1e-3 * max(abs(a.w), abs(b.w));
  if (a.w < near && b.w < near) return false;
  if (a.w < near) a = mix(b, a, (b.w - near) / (b.w - a.w));
  if (b.w < near) b = mix(a, b, (a.w - near) / (a.w - b.w));
  vec2 pa = a.xy / a.w * 0.5 * uViewport, pb = b.xy / b.w * 0.5 * uViewport;
  vec2 along = pb - pa;
  float span = length(along);
  vec2 side = span > 0.0 ? vec2(-along.y, along.x) / span : vec2(0.0, 1.0);
  bool last = (corner() & 2) != 0;
  float sign = (corner() & 1) != 0 ? 1.0 : -1.0;
  vHalf = 0.5 * width * uRatio;
  vAcross = sign * (vHalf + 1.0);
  vAlong = last ? span : 0.0;
  gl_Position = last ? b : a;
  gl_Position.xy += side * vAcross * 2.0 / uViewport * gl_Position.w;
  return true;
}
`;

const EDGE = `
in float vAcross;
in float vAlong;
in float vHalf;
float edge() { return clamp(vHalf + 0.5 - abs(vAcross), 0.0, 1.0) * min(1.0, 2.0 * vHalf); }
`;

export const BODIES = [
  `${COMMON}${CORNER}${FRAME}${COLOUR}
uniform float uLeast;      // radius in CSS pixels that a body has at least
out vec2 vAt;
flat out vec4 vColour;
flat out vec2 vHeading;
flat out float vRadius;
flat out int vKind;        // 1 waits and has room for a ring, 2 an intruder
void main() {
  int body = gl_VertexID / 6;
  vec4 clip = uMatrix * vec4(place(body), 1.0);
  vRadius = max(uLeast * uRatio, pair(uStatic, body).r * uPixels / max(clip.w, 1e-6));
  vKind = body >= uRobots ? 2 : vRadius > 3.0 * uRatio && octet(uAtModeWait.y, body) != 255u ? 1 : 0;
  float reach = vRadius + (vKind == 1 ? 3.5 * uRatio : 1.5);
  vAt = square() * reach;
  vColour = colour(body);
  vec2 heading = triple(uNow, uAtVelocity, body).xy;
  vHeading = dot(heading, heading) > 0.0 ? normalize(heading) : vec2(0.0);
  gl_Position = clip;
  gl_Position.xy += vAt * 2.0 / uViewport * clip.w;
}`,
  `${COMMON}
in vec2 vAt;
flat in vec4 vColour;
flat in vec2 vHeading;
flat in float vRadius;
flat in int vKind;
uniform vec4 uRim;
uniform vec4 uWaiting;
uniform int uSpace;
out vec4 result;
void main() {
  float r = length(vAt);
  vec4 colour = vColour;
  if (uSpace == 1) {
    float inside = min(r / vRadius, 1.0);
    vec3 normal = vec3(vAt / vRadius, sqrt(1.0 - inside * inside));
    float light = max(dot(normal, normalize(vec3(-0.45, 0.65, 0.6))), 0.0);
    colour.rgb *= 0.42 + 0.66 * light;
    colour.rgb += 0.25 * pow(light, 12.0);
  } else {
    float rim = vRadius > 4.5 * uRatio ? clamp(r - (vRadius - 1.4 * uRatio), 0.0, 1.0) : 0.0;
    if (vRadius > 4.5 * uRatio && vKind != 2) {
      float ahead = dot(vAt, vHeading), beside = abs(vAt.x * vHeading.y - vAt.y * vHeading.x);
      // An arrowhead, with a notch at its back.
      float flank = (0.68 * vRadius - ahead) * 0.52 - beside;
      float back = ahead + 0.42 * vRadius - 0.55 * (0.45 * vRadius - beside);
      float arrow = clamp(flank + 0.5, 0.0, 1.0) * clamp(back + 0.5, 0.0, 1.0) * step(0.001, dot(vHeading, vHeading));
      colour.rgb = mix(colour.rgb, uRim.rgb, 0.92 * arrow);
    }
    if (vKind == 2) {
      float stripe = abs(fract((vAt.x + vAt.y) / (6.0 * uRatio)) - 0.5);
      colour.rgb = mix(colour.rgb, uRim.rgb, smoothstep(0.22, 0.3, stripe));
      rim = clamp(r - (vRadius - 2.2 * uRatio), 0.0, 1.0);
      colour.rgb = mix(colour.rgb, vColour.rgb, rim);
    } else {
      colour.rgb = mix(colour.rgb, uRim.rgb, rim);
    }
  }
  float cover = clamp(vRadius + 0.5 - r, 0.0, 1.0);
  float ring = vKind == 1 ? clamp(1.5 * uRatio - abs(r - vRadius - 1.8 * uRatio), 0.0, 1.0) : 0.0;
  float alpha = max(cover, ring);
  if (alpha < 0.02) discard;
  result = vec4(mix(uWaiting.rgb, colour.rgb, cover) * alpha, alpha);
}`,
];

export const VELOCITIES = [
  `${COMMON}${FRAME}
uniform float uSeconds;
uniform vec4 uInk;
${RIBBON}
flat out vec4 vColour;
void main() {
  int body = gl_VertexID / 6;
  vec3 from = place(body);
  vec3 to = from + triple(uNow, uAtVelocity, body) * uSeconds;
  vColour = uInk;
  if (from == to || !ribbon(from, to, 1.6)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`,
  `${COMMON}${EDGE}
flat in vec4 vColour;
out vec4 result;
void main() { result = vColour * edge(); }`,
];

export const TARGETS = [
  `${COMMON}${CORNER}${FRAME}${COLOUR}
uniform float uSize;
out vec2 vAt;
flat out vec4 vColour;
void main() {
  int body = gl_VertexID / 6;
  vAt = square() * (uSize + 1.5) * uRatio;
  vColour = colour(body);
  uint x = word(uNow, uAtTarget.x + body);
  bool none = (x & 0x7fffffffu) > 0x7f800000u;
  gl_Position = uMatrix * vec4(none ? vec3(0.0) : triple(uNow, uAtTarget, body), 1.0);
  gl_Position.xy += vAt * 2.0 / uViewport * gl_Position.w;
  if (none) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`,
  `${COMMON}
in vec2 vAt;
flat in vec4 vColour;
uniform vec4 uRim;
uniform float uSize;
uniform float uAlpha;
out vec4 result;
void main() {
  vec2 p = abs(vAt) / uRatio;
  float off = abs(p.x - p.y) * 0.7071;
  float end = max(p.x, p.y) - uSize * 0.75;
  float fill = clamp(1.4 - off, 0.0, 1.0) * clamp(0.5 - end, 0.0, 1.0);
  float halo = clamp(2.4 - off, 0.0, 1.0) * clamp(1.5 - end, 0.0, 1.0) * 0.7;
  float alpha = max(fill, halo);
  if (alpha < 0.02) discard;
  result = vec4(mix(uRim.rgb, vColour.rgb, fill / alpha), 1.0) * alpha * uAlpha;
}`,
];

export const LINES = [
  `${COMMON}
uniform usampler2D uLines;  // three texels each: from and to, colour, width, and pixels of a dash or 0
${RIBBON}
flat out vec4 vColour;
flat out float vDash;
void main() {
  int line = gl_VertexID / 6;
  ivec2 at = ivec2(3 * (line & 255), line >> 8);
  uvec4 a = texelFetch(uLines, at, 0);
  uvec4 b = texelFetch(uLines, at + ivec2(1, 0), 0);
  uvec4 c = texelFetch(uLines, at + ivec2(2, 0), 0);
  vec4 ink = vec4(uvec4(b.z, b.z >> 8, b.z >> 16, b.z >> 24) & 255u) / 255.0;
  vColour = vec4(ink.rgb * ink.a, ink.a);
  vDash = uintBitsToFloat(c.x) * uRatio;
  vec3 from = uintBitsToFloat(a.xyz), to = uintBitsToFloat(uvec3(a.w, b.xy));
  if (!ribbon(from, to, uintBitsToFloat(b.w))) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`,
  `${COMMON}${EDGE}
flat in vec4 vColour;
flat in float vDash;
out vec4 result;
void main() {
  float on = vDash > 0.0 ? step(fract(vAlong / (2.0 * vDash)), 0.5) : 1.0;
  if (on == 0.0) discard;
  result = vColour * edge();
}`,
];

export const TRAILS = [
  `${COMMON}
uniform sampler2D uSnapshots;
uniform vec4 uPalette[16];
uniform vec4 uInk;
uniform int uColourBy;
uniform int uBodies, uRows, uSegments;
uniform int uOrder[161];   // the snapshots' rows, oldest first
${RIBBON}
flat out vec4 vColour;
vec3 place(int snapshot, int body) {
  return texelFetch(uSnapshots, ivec2(body & 1023, uOrder[snapshot] * uRows + (body >> 10)), 0).xyz;
}
void main() {
  int segment = gl_VertexID / 6, body = segment % uBodies, step = segment / uBodies;
  float age = 1.0 - float(step) / float(uSegments);
  vec4 ink = uColourBy == 3 ? uPalette[body % 7] : uInk;
  float alpha = ink.a * mix(0.85, 0.08, age);
  vColour = vec4(ink.rgb * alpha, alpha);
  vec3 from = place(step, body), to = place(step + 1, body);
  if (from == to || !ribbon(from, to, uColourBy == 3 ? 2.0 : 1.3)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`,
  `${COMMON}${EDGE}
flat in vec4 vColour;
out vec4 result;
void main() { result = vColour * edge(); }`,
];
