// WebGL2: bodies, velocities, targets, lines and trails, each kind in one instanced call. A frame's bytes go to the GPU
// as they came, once.

import { BODIES, LINES, TARGETS, TRAILS, VELOCITIES } from "staya/shaders.js";
import { Trails } from "staya/trails.js";

const LINE_BYTES = 36;

class Program {
  constructor(gl, [vertex, fragment]) {
    this.gl = gl;
    this.program = gl.createProgram();
    for (const [type, source] of [[gl.VERTEX_SHADER, vertex], [gl.FRAGMENT_SHADER, fragment]]) {
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
    this.array = gl.createVertexArray();
    this.uniforms = {};
    const uniforms = gl.getProgramParameter(this.program, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < uniforms; i++) {
      const { name } = gl.getActiveUniform(this.program, i);
      this.uniforms[name.replace("[0]", "")] = gl.getUniformLocation(this.program, name);
    }
    this.attributes = {};
    const attributes = gl.getProgramParameter(this.program, gl.ACTIVE_ATTRIBUTES);
    for (let i = 0; i < attributes; i++) {
      const { name } = gl.getActiveAttrib(this.program, i);
      this.attributes[name] = gl.getAttribLocation(this.program, name);
    }
  }

  use() {
    this.gl.useProgram(this.program);
    this.gl.bindVertexArray(this.array);
  }

  /** One value an instance, from the bound buffer. */
  floats(name, size, stride, offset, type = this.gl.FLOAT) {
    const { gl } = this, location = this.attributes[name];
    if (location === undefined) return;
    gl.enableVertexAttribArray(location);
    gl.vertexAttribPointer(location, size, type, type !== gl.FLOAT, stride, offset);
    gl.vertexAttribDivisor(location, 1);
  }

  bytes(name, offset) {
    const { gl } = this, location = this.attributes[name];
    if (location === undefined) return;
    gl.enableVertexAttribArray(location);
    gl.vertexAttribIPointer(location, 1, gl.UNSIGNED_BYTE, 0, offset);
    gl.vertexAttribDivisor(location, 1);
  }

  /** The same for all instances. */
  constant(name, value) {
    const location = this.attributes[name];
    if (location === undefined) return;
    this.gl.disableVertexAttribArray(location);
    this.gl.vertexAttrib1f(location, value);
  }
}

export class Renderer {
  /** Null where there is no WebGL2. */
  static on(canvas) {
    const gl = canvas.getContext("webgl2", { alpha: true, antialias: false, depth: true, powerPreference: "high-performance" });
    return gl && new Renderer(canvas, gl);
  }

  constructor(canvas, gl) {
    this.canvas = canvas;
    this.gl = gl;
    this.bodies = 0;
    this.robots = 0;
    this.radii = new Float32Array(0);
    this.groups = new Uint8Array(0);
    this.make();
    canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    canvas.addEventListener("webglcontextrestored", () => {
      this.make();
      this.setBodies(this.robots, this.radii, this.groups);
    });
  }

  make() {
    const { gl } = this;
    this.programs = {
      bodies: new Program(gl, BODIES), velocities: new Program(gl, VELOCITIES), targets: new Program(gl, TARGETS),
      lines: new Program(gl, LINES), trails: new Program(gl, TRAILS),
    };
    const buffer = () => gl.createBuffer();
    this.frameBuffers = [buffer(), buffer()];
    this.held = [null, null];
    this.headingBuffer = buffer();
    this.radiusBuffer = buffer();
    this.groupBuffer = buffer();
    this.lineBuffer = buffer();
    this.ballBuffer = buffer();
    this.balls = 0;
    this.trails = new Trails(gl);
    gl.disable(gl.CULL_FACE);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
  }

  /** Radii and groups of the robots, then of the intruders. */
  setBodies(robots, radii, groups) {
    const { gl } = this;
    Object.assign(this, { robots, radii, groups });
    this.held = [null, null];
    this.store(this.radiusBuffer, radii, gl.STATIC_DRAW);
    this.store(this.groupBuffer, groups, gl.STATIC_DRAW);
    this.trails.reset();
  }

  store(buffer, data, usage) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, usage);
  }

  resize(width, height, ratio) {
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
  }

  /** The buffer that has `frame`; uploads it over `other` than that of `keep` if none has. */
  bufferOf(frame, keep) {
    let slot = this.held.indexOf(frame);
    if (slot < 0) {
      slot = this.held[0] === keep ? 1 : 0;
      this.store(this.frameBuffers[slot], frame.body, this.gl.STREAM_DRAW);
      this.held[slot] = frame;
    }
    return this.frameBuffers[slot];
  }

  draw(camera, motion, look, lines) {
    const { gl } = this;
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl[camera.space ? "enable" : "disable"](gl.DEPTH_TEST);
    const frame = motion.current;
    if (!frame) return;
    const bodies = Math.min(frame.n, this.radii.length);
    if (this.headingsOf !== frame || this.held[0] === null) {
      this.store(this.headingBuffer, motion.headings, gl.STREAM_DRAW);
      this.headingsOf = frame;
    }
    const now = this.bufferOf(frame, motion.previous), before = this.bufferOf(motion.previous, frame);
    const scene = { camera, motion, look, frame, now, before, bodies };
    if (look.trails) this.drawTrails(scene);
    this.drawLines(scene, lines.below);
    if (look.targets && frame.tx) this.drawTargets(scene);
    if (!camera.space && look.velocities) this.drawVelocities(scene);
    this.drawBodies(scene);
    if (camera.space && look.velocities) this.drawVelocities(scene);
    this.drawLines(scene, lines.above);
  }

  begin(program, { camera, look }) {
    const { gl } = this, { uniforms } = program;
    program.use();
    gl.uniformMatrix4fv(uniforms.uMatrix, false, camera.matrix);
    gl.uniform2f(uniforms.uViewport, this.canvas.width, this.canvas.height);
    gl.uniform1f(uniforms.uPixels, camera.pixelsPerMetre() * this.ratio);
    gl.uniform1f(uniforms.uRatio, this.ratio);
    if (uniforms.uPalette) gl.uniform4fv(uniforms.uPalette, look.palette);
    if (uniforms.uRim) gl.uniform4fv(uniforms.uRim, look.colours.rim);
    if (uniforms.uRobots) gl.uniform1i(uniforms.uRobots, this.robots);
    if (uniforms.uByNumber) gl.uniform1i(uniforms.uByNumber, look.colourBy === "robot" ? 1 : 0);
  }

  places(program, { motion, frame, now, before }) {
    const { gl } = this;
    [["0", before, motion.previous], ["1", now, frame]].forEach(([end, buffer, { at }]) => {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      for (const axis of ["x", "y", "z"]) {
        const name = `a${axis.toUpperCase()}${end}`;
        if (at[axis] === undefined) program.constant(name, 0);
        else program.floats(name, 1, 4, at[axis]);
      }
    });
    gl.uniform1f(program.uniforms.uMix, motion.mix);
  }

  colours(program, { look, frame, now }) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, look.colourBy === "group" ? this.groupBuffer : now);
    program.bytes("aColour", look.colourBy === "group" ? 0 : frame.at[look.colourBy === "wait" ? "wait" : "mode"]);
  }

  drawBodies(scene) {
    const { gl } = this, { camera, look, frame, bodies } = scene, program = this.programs.bodies;
    this.begin(program, scene);
    this.places(program, scene);
    this.colours(program, scene);
    gl.bindBuffer(gl.ARRAY_BUFFER, scene.now);
    program.bytes("aWait", frame.at.wait);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.radiusBuffer);
    program.floats("aRadius", 1, 4, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.headingBuffer);
    program.floats("aHeading", 2, 8, 0);
    gl.uniform1f(program.uniforms.uLeast, look.leastRadius);
    gl.uniform4fv(program.uniforms.uWaiting, look.colours.waiting);
    gl.uniform1i(program.uniforms.uSpace, camera.space ? 1 : 0);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, bodies);
    if (camera.space && this.balls) this.drawBalls(program);
  }

  /** Solids in space, `[x, y, z, radius]` each; from above the ground has them. */
  setBalls(balls) {
    this.balls = balls.length;
    this.store(this.ballBuffer, new Float32Array(balls.flat()), this.gl.STATIC_DRAW);
  }

  /** With the uniforms of the bodies, which have just been drawn. */
  drawBalls(program) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.ballBuffer);
    for (const end of ["0", "1"]) {
      ["x", "y", "z"].forEach((axis, i) => program.floats(`a${axis.toUpperCase()}${end}`, 1, 16, 4 * i));
    }
    program.floats("aRadius", 1, 16, 12);
    program.constant("aHeading", 0);
    for (const [name, value] of [["aWait", 255], ["aColour", 13]]) {
      gl.disableVertexAttribArray(program.attributes[name]);
      gl.vertexAttribI4ui(program.attributes[name], value, 0, 0, 0);
    }
    gl.uniform1i(program.uniforms.uRobots, this.balls);
    gl.uniform1i(program.uniforms.uByNumber, 0);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, this.balls);
  }

  drawVelocities(scene) {
    const { gl } = this, { look, frame, bodies } = scene, program = this.programs.velocities;
    this.begin(program, scene);
    this.places(program, scene);
    gl.bindBuffer(gl.ARRAY_BUFFER, scene.now);
    for (const axis of ["x", "y", "z"]) {
      const at = frame.at["v" + axis];
      if (at === undefined) program.constant(`aV${axis}`, 0);
      else program.floats(`aV${axis}`, 1, 4, at);
    }
    gl.uniform1f(program.uniforms.uSeconds, look.velocitySeconds);
    gl.uniform4fv(program.uniforms.uInk, look.colours.velocity);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, bodies);
  }

  drawTargets(scene) {
    const { gl } = this, { look, frame } = scene, program = this.programs.targets;
    this.begin(program, scene);
    this.colours(program, scene);
    gl.bindBuffer(gl.ARRAY_BUFFER, scene.now);
    for (const axis of ["x", "y", "z"]) {
      const at = frame.at["t" + axis];
      if (at === undefined) program.constant(`aT${axis}`, 0);
      else program.floats(`aT${axis}`, 1, 4, at);
    }
    gl.uniform1f(program.uniforms.uSize, look.targetSize);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, Math.min(this.robots, scene.bodies));
  }

  drawTrails(scene) {
    const { gl } = this, { motion, look, bodies } = scene, program = this.programs.trails;
    if (!this.trails.record(motion, bodies, look.trails)) return;
    this.begin(program, scene);
    gl.uniform4fv(program.uniforms.uInk, look.colours.trail);
    gl.uniform1i(program.uniforms.uBodies, bodies);
    this.trails.draw(program, bodies);
  }

  drawLines(scene, lines) {
    if (!lines.count) return;
    const { gl } = this, program = this.programs.lines;
    this.begin(program, scene);
    this.store(this.lineBuffer, new Uint8Array(lines.floats.buffer, 0, lines.count * LINE_BYTES), gl.STREAM_DRAW);
    program.floats("aFrom", 3, LINE_BYTES, 0);
    program.floats("aTo", 3, LINE_BYTES, 12);
    program.floats("aInk", 4, LINE_BYTES, 24, gl.UNSIGNED_BYTE);
    program.floats("aStyle", 2, LINE_BYTES, 28);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, lines.count);
  }
}

/** Straight lines, refilled for each picture; colours are 0xAABBGGRR. */
export class Lines {
  constructor() {
    this.floats = new Float32Array(64 * LINE_BYTES / 4);
    this.words = new Uint32Array(this.floats.buffer);
    this.count = 0;
  }

  clear() {
    this.count = 0;
  }

  add(x0, y0, z0, x1, y1, z1, ink, width = 1, dash = 0) {
    let at = this.count * LINE_BYTES / 4;
    if (at + LINE_BYTES / 4 > this.floats.length) {
      const larger = new Float32Array(2 * this.floats.length);
      larger.set(this.floats);
      this.floats = larger;
      this.words = new Uint32Array(larger.buffer);
    }
    const { floats } = this;
    floats[at++] = x0; floats[at++] = y0; floats[at++] = z0;
    floats[at++] = x1; floats[at++] = y1; floats[at++] = z1;
    this.words[at++] = ink;
    floats[at++] = width; floats[at] = dash;
    this.count++;
  }
}
