// WebGL2: bodies, velocities, goals, lines and trails, one draw call for each kind. The bytes of a
// frame are uploaded once, unchanged, as a texture.

import { BODIES, LINES, TARGETS, TRAILS, VELOCITIES } from "staya/shaders.js";
import { Trails } from "staya/trails.js";

const WIDTH = 2048;
const LINE_WORDS = 12;
const LINES_A_ROW = 256;
const COLOUR_BY = ["mode", "wait", "group", "robot"];
const BALL_COLOUR = 13;

class Program {
  constructor(gl, [vertex, fragment]) {
    this.program = gl.createProgram();
    for (const [type, source] of [
      [gl.VERTEX_SHADER, vertex],
      [gl.FRAGMENT_SHADER, fragment],
    ]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(this.program, shader);
    }
    gl.linkProgram(this.program);
    if (!gl.getProgramParameter(this.program, gl.LINK_STATUS) && !gl.isContextLost()) {
      const logs = gl.getAttachedShaders(this.program).map((shader) => gl.getShaderInfoLog(shader));
      throw new Error(`a shader does not compile: ${logs.join(" ")}`);
    }
    this.uniforms = {};
    const uniforms = gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS) ?? 0;
    for (let i = 0; i < uniforms; i++) {
      const { name } = gl.getActiveUniform(this.program, i);
      this.uniforms[name.replace("[0]", "")] = gl.getUniformLocation(this.program, name);
    }
  }
}

/** Numbers in rows of texels. */
class Table {
  constructor(gl, internal, format, type, channels, width) {
    Object.assign(this, { gl, internal, format, type, channels, width, rows: 0 });
    this.texture = gl.createTexture();
  }

  store(data) {
    const { gl, format, type, channels, width } = this;
    const texels = data.length / channels,
      rows = Math.max(1, Math.ceil(texels / width));
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    if (rows > this.rows) {
      this.rows = rows;
      gl.texImage2D(gl.TEXTURE_2D, 0, this.internal, width, rows, 0, format, type, null);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    }
    const full = Math.floor(texels / width),
      rest = texels - full * width;
    if (full) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, full, format, type, data);
    if (rest) gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, full, rest, 1, format, type, data, full * width * channels);
  }
}

export class Renderer {
  /** Creates a renderer; null without WebGL2. */
  static on(canvas) {
    const gl = canvas.getContext("webgl2", {
      alpha: true,
      antialias: false,
      depth: true,
      powerPreference: "high-performance",
    });
    return gl && new Renderer(canvas, gl);
  }

  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    this.robots = 0;
    this.bodies = new Float32Array(0);
    this.balls = [];
    // Without a GPU every vertex matters.
    const named = gl.getExtension("WEBGL_debug_renderer_info");
    this.software =
      Boolean(named) &&
      /swiftshader|llvmpipe|software|basic render/i.test(gl.getParameter(named.UNMASKED_RENDERER_WEBGL));
    this.make();
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.make();
      this.setBodies(this.robots, this.bodies, this.balls);
    });
  }

  make() {
    const { gl } = this;
    this.programs = {
      bodies: new Program(gl, BODIES),
      velocities: new Program(gl, VELOCITIES),
      targets: new Program(gl, TARGETS),
      lines: new Program(gl, LINES),
      trails: new Program(gl, TRAILS),
    };
    const words = () => new Table(gl, gl.R32UI, gl.RED_INTEGER, gl.UNSIGNED_INT, 1, WIDTH);
    const pairs = () => new Table(gl, gl.RG32F, gl.RG, gl.FLOAT, 2, WIDTH);
    this.frames = [words(), words()];
    this.held = [null, null];
    this.statics = pairs();
    this.ballFrame = words();
    this.ballStatics = pairs();
    this.lines = new Table(gl, gl.RGBA32UI, gl.RGBA_INTEGER, gl.UNSIGNED_INT, 4, 3 * LINES_A_ROW);
    this.trails = new Trails(gl, this.software);
    gl.bindVertexArray(gl.createVertexArray());
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** `bodies`: radius and group of each robot, then of the intruders; `balls`: obstacles in space, [x, y, z, radius]. */
  setBodies(robots, bodies, balls) {
    Object.assign(this, { robots, bodies, balls });
    this.held = [null, null];
    this.statics.store(bodies);
    this.trails.reset();
    // Balls are drawn like bodies, from a frame of their own.
    const n = balls.length,
      padded = (n + 3) >> 2;
    const words = new Uint32Array(3 * n + 2 * padded);
    const floats = new Float32Array(words.buffer),
      bytes = new Uint8Array(words.buffer);
    balls.forEach((ball, i) => {
      for (let k = 0; k < 3; k++) floats[k * n + i] = ball[k];
      bytes[12 * n + i] = BALL_COLOUR;
      bytes[4 * (3 * n + padded) + i] = 255;
    });
    this.ballFrame.store(words);
    this.ballStatics.store(Float32Array.from(balls.flatMap((ball) => [ball[3], 0])));
  }

  resize(width, height, ratio) {
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
  }

  /** Prepares trails for the bodies of a frame. Returns whether they are drawn. */
  suitTrails(frame, seconds, tickS) {
    this.hasTrails = this.trails.suit(Math.min(frame.n, this.bodies.length / 2), seconds, tickS);
    return this.hasTrails;
  }

  /** The table with `frame`; if there is none, the one without `keep` is refilled. */
  tableOf(frame, keep) {
    let slot = this.held.indexOf(frame);
    if (slot < 0) {
      slot = this.held[0] === keep ? 1 : 0;
      this.frames[slot].store(new Uint32Array(frame.body.buffer, frame.body.byteOffset, frame.body.length / 4));
      this.held[slot] = frame;
    }
    return this.frames[slot];
  }

  draw(camera, motion, look, lines) {
    const { gl } = this;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.depthMask(true);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl[camera.space ? "enable" : "disable"](gl.DEPTH_TEST);
    // Thin items with soft edges hide nothing behind them.
    gl.depthMask(false);
    const frame = motion.current;
    if (!frame) return;
    gl.activeTexture(gl.TEXTURE0);
    const count = Math.min(frame.n, this.bodies.length / 2);
    const now = this.tableOf(frame, motion.previous),
      before = this.tableOf(motion.previous, frame);
    const { at } = frame;
    const triple = (name) => ["x", "y", "z"].map((axis) => (at[name + axis] === undefined ? -1 : at[name + axis] / 4));
    const scene = {
      camera,
      look,
      count,
      now,
      before,
      mix: motion.mix,
      statics: this.statics,
      robots: this.robots,
      colourBy: COLOUR_BY.indexOf(look.colourBy),
      place: triple(""),
      velocity: triple("v"),
      target: triple("t"),
      modeWait: [at.mode / 4, at.wait / 4],
    };
    if (this.hasTrails && this.trails.record(motion)) {
      const program = this.begin(this.programs.trails, scene);
      gl.uniform4fv(program.uniforms.uInk, look.colours.trail);
      this.trails.draw(program);
    }
    this.drawLines(scene, lines.below);
    if (look.targets && frame.tx) {
      const { uniforms } = this.beginBodies(this.programs.targets, scene);
      gl.uniform1f(uniforms.uSize, look.targetSize);
      gl.uniform1f(uniforms.uAlpha, look.targetAlpha);
      gl.drawArrays(gl.TRIANGLES, 0, 6 * Math.min(this.robots, count));
    }
    if (!camera.space && look.velocities) this.drawVelocities(scene);
    gl.depthMask(true);
    this.drawBodies(scene);
    if (camera.space && this.balls.length) this.drawBalls(scene);
    gl.depthMask(false);
    if (camera.space && look.velocities) this.drawVelocities(scene);
    this.drawLines(scene, lines.above);
  }

  begin(program, { camera, look, colourBy }) {
    const { gl } = this,
      { uniforms } = program;
    gl.useProgram(program.program);
    gl.uniformMatrix4fv(uniforms.uMatrix, false, camera.matrix);
    gl.uniform2f(uniforms.uViewport, this.canvas.width, this.canvas.height);
    gl.uniform1f(uniforms.uPixels, camera.pixelsPerMetre() * this.ratio);
    gl.uniform1f(uniforms.uRatio, this.ratio);
    if (uniforms.uPalette) gl.uniform4fv(uniforms.uPalette, look.palette);
    if (uniforms.uRim) gl.uniform4fv(uniforms.uRim, look.colours.rim);
    if (uniforms.uColourBy) gl.uniform1i(uniforms.uColourBy, colourBy);
    return program;
  }

  /** Starts a program that reads frames. */
  beginBodies(program, scene) {
    const { gl } = this,
      { uniforms } = this.begin(program, scene);
    [
      ["uNow", scene.now],
      ["uBefore", scene.before],
      ["uStatic", scene.statics],
    ].forEach(([name, table], unit) => {
      if (!uniforms[name]) return;
      gl.activeTexture(gl.TEXTURE0 + unit);
      gl.bindTexture(gl.TEXTURE_2D, table.texture);
      gl.uniform1i(uniforms[name], unit);
    });
    gl.activeTexture(gl.TEXTURE0);
    const triple = (uniform, at) => uniform && gl.uniform3i(uniform, ...at);
    triple(uniforms.uAtPlace, scene.place);
    triple(uniforms.uAtVelocity, scene.velocity);
    triple(uniforms.uAtTarget, scene.target);
    if (uniforms.uAtModeWait) gl.uniform2i(uniforms.uAtModeWait, ...scene.modeWait);
    if (uniforms.uMix) gl.uniform1f(uniforms.uMix, scene.mix);
    if (uniforms.uRobots) gl.uniform1i(uniforms.uRobots, scene.robots);
    return program;
  }

  drawBodies(scene) {
    const { gl } = this,
      { camera, look } = scene,
      { uniforms } = this.beginBodies(this.programs.bodies, scene);
    gl.uniform1f(uniforms.uLeast, look.leastRadius);
    gl.uniform4fv(uniforms.uWaiting, look.colours.waiting);
    gl.uniform1i(uniforms.uSpace, camera.space ? 1 : 0);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * scene.count);
  }

  drawBalls(scene) {
    const n = this.balls.length;
    this.drawBodies({
      ...scene,
      count: n,
      robots: n,
      now: this.ballFrame,
      before: this.ballFrame,
      statics: this.ballStatics,
      colourBy: 0,
      place: [0, n, 2 * n],
      modeWait: [3 * n, 3 * n + ((n + 3) >> 2)],
    });
  }

  drawVelocities(scene) {
    const { gl } = this,
      { look } = scene,
      { uniforms } = this.beginBodies(this.programs.velocities, scene);
    gl.uniform1f(uniforms.uSeconds, look.velocitySeconds);
    gl.uniform4fv(uniforms.uInk, look.colours.velocity);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * scene.count);
  }

  drawLines(scene, lines) {
    if (!lines.count) return;
    const { gl } = this,
      { uniforms } = this.begin(this.programs.lines, scene);
    this.lines.store(lines.words.subarray(0, lines.count * LINE_WORDS));
    gl.uniform1i(uniforms.uLines, 0);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * lines.count);
  }
}

/** Straight lines, filled for each picture; colours are 0xAABBGGRR. */
export class Lines {
  constructor() {
    this.floats = new Float32Array(64 * LINE_WORDS);
    this.words = new Uint32Array(this.floats.buffer);
    this.count = 0;
  }

  clear() {
    this.count = 0;
  }

  add(x0, y0, z0, x1, y1, z1, ink, width = 1, dash = 0) {
    let at = this.count * LINE_WORDS;
    if (at + LINE_WORDS > this.floats.length) {
      const larger = new Float32Array(2 * this.floats.length);
      larger.set(this.floats);
      this.floats = larger;
      this.words = new Uint32Array(larger.buffer);
    }
    const { floats } = this;
    floats[at++] = x0;
    floats[at++] = y0;
    floats[at++] = z0;
    floats[at++] = x1;
    floats[at++] = y1;
    floats[at++] = z1;
    this.words[at++] = ink;
    floats[at++] = width;
    floats[at] = dash;
    this.count++;
  }
}
