// GLSL of the bodies and lines. Sizes on the screen are in pixels of the canvas.

const COMMON = `#version 300 es
precision highp float;
uniform mat4 uMatrix;
uniform vec2 uViewport;
uniform float uPixels;     // of a metre where w is 1
uniform float uRatio;      // canvas pixels of a CSS pixel
`;

const PLACE = `
in float aX0, aY0, aZ0, aX1, aY1, aZ1;
uniform float uMix;
vec3 place() { return mix(vec3(aX0, aY0, aZ0), vec3(aX1, aY1, aZ1), uMix); }
`;

const COLOUR = `
in uint aColour;
uniform vec4 uPalette[16];
uniform int uRobots;
uniform int uByNumber;
vec4 colour() {
  if (gl_InstanceID >= uRobots) return uPalette[15];
  uint entry = uByNumber == 1 ? uint(gl_InstanceID) % 7u : aColour == 255u ? 14u : min(aColour, 13u);
  return uPalette[entry];
}
`;

// A ribbon of `width` pixels between two places, as two triangles.
const RIBBON = `
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
  bool last = (gl_VertexID & 2) != 0;
  float sign = (gl_VertexID & 1) != 0 ? 1.0 : -1.0;
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

export const BODIES = [`${COMMON}${PLACE}${COLOUR}
in vec2 aHeading;
in float aRadius;
in uint aWait;
uniform float uLeast;      // radius in CSS pixels that a body has at least
out vec2 vAt;
flat out vec4 vColour;
flat out vec2 vHeading;
flat out float vRadius;
flat out int vKind;        // 1 waits, 2 an intruder
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vec4 clip = uMatrix * vec4(place(), 1.0);
  vRadius = max(uLeast * uRatio, aRadius * uPixels / max(clip.w, 1e-6));
  vKind = gl_InstanceID >= uRobots ? 2 : aWait != 255u ? 1 : 0;
  float reach = vRadius + (vKind == 1 ? 3.5 * uRatio : 1.5);
  vAt = corner * reach;
  vColour = colour();
  vHeading = dot(aHeading, aHeading) > 0.0 ? normalize(aHeading) : vec2(0.0);
  gl_Position = clip;
  gl_Position.xy += vAt * 2.0 / uViewport * clip.w;
}`, `${COMMON}
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
    float rim = vRadius > 3.0 * uRatio ? clamp(r - (vRadius - 1.4 * uRatio), 0.0, 1.0) : 0.0;
    if (vRadius > 3.5 * uRatio && vKind != 2) {
      float ahead = dot(vAt, vHeading), beside = abs(vAt.x * vHeading.y - vAt.y * vHeading.x);
      float wedge = clamp((ahead * 0.5 - beside) + 0.5, 0.0, 1.0) * step(0.001, dot(vHeading, vHeading));
      colour.rgb = mix(colour.rgb, uRim.rgb, 0.85 * wedge);
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
}`];

export const VELOCITIES = [`${COMMON}${PLACE}
in float aVx, aVy, aVz;
in float aRadius;
uniform float uSeconds;
uniform vec4 uInk;
${RIBBON}
flat out vec4 vColour;
void main() {
  vec3 from = place();
  vec3 to = from + vec3(aVx, aVy, aVz) * uSeconds;
  vColour = uInk;
  if (from == to || !ribbon(from, to, 1.6)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`, `${COMMON}${EDGE}
flat in vec4 vColour;
out vec4 result;
void main() { result = vColour * edge(); }`];

export const TARGETS = [`${COMMON}${COLOUR}
in float aTx, aTy, aTz;
uniform float uSize;
out vec2 vAt;
flat out vec4 vColour;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0 - 1.0;
  vAt = corner * (uSize + 1.5) * uRatio;
  vColour = colour();
  bool none = isnan(aTx);
  gl_Position = uMatrix * vec4(none ? 0.0 : aTx, none ? 0.0 : aTy, none ? 0.0 : aTz, 1.0);
  gl_Position.xy += vAt * 2.0 / uViewport * gl_Position.w;
  if (none) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`, `${COMMON}
in vec2 vAt;
flat in vec4 vColour;
uniform vec4 uRim;
uniform float uSize;
out vec4 result;
void main() {
  vec2 p = abs(vAt) / uRatio;
  float off = abs(p.x - p.y) * 0.7071;
  float end = max(p.x, p.y) - uSize * 0.75;
  float fill = clamp(1.4 - off, 0.0, 1.0) * clamp(0.5 - end, 0.0, 1.0);
  float halo = clamp(2.4 - off, 0.0, 1.0) * clamp(1.5 - end, 0.0, 1.0) * 0.7;
  float alpha = max(fill, halo);
  if (alpha < 0.02) discard;
  result = vec4(mix(uRim.rgb, vColour.rgb, fill / alpha) * alpha, alpha);
}`];

export const LINES = [`${COMMON}
in vec3 aFrom, aTo;
in vec4 aInk;
in vec2 aStyle;            // width, and pixels of a dash or 0
${RIBBON}
flat out vec4 vColour;
flat out float vDash;
void main() {
  vColour = vec4(aInk.rgb * aInk.a, aInk.a);
  vDash = aStyle.y * uRatio;
  if (!ribbon(aFrom, aTo, aStyle.x)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`, `${COMMON}${EDGE}
flat in vec4 vColour;
flat in float vDash;
out vec4 result;
void main() {
  float on = vDash > 0.0 ? step(fract(vAlong / (2.0 * vDash)), 0.5) : 1.0;
  if (on == 0.0) discard;
  result = vColour * edge();
}`];

export const TRAILS = [`${COMMON}
in vec3 aFrom, aTo;
uniform vec4 uPalette[16];
uniform vec4 uInk;
uniform int uByNumber;
uniform int uBodies;
uniform float uFirst, uAll; // segments since the oldest one, and all of them
${RIBBON}
flat out vec4 vColour;
void main() {
  float age = 1.0 - (uFirst + float(gl_InstanceID / uBodies)) / uAll;
  vec4 ink = uByNumber == 1 ? uPalette[(gl_InstanceID % uBodies) % 7] : uInk;
  float alpha = ink.a * mix(0.85, 0.08, age);
  vColour = vec4(ink.rgb * alpha, alpha);
  if (aFrom == aTo || !ribbon(aFrom, aTo, uByNumber == 1 ? 2.0 : 1.3)) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
}`, `${COMMON}${EDGE}
flat in vec4 vColour;
out vec4 result;
void main() { result = vColour * edge(); }`];
