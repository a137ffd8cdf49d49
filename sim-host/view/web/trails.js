// Where bodies have been: snapshots in a ring on the GPU. A segment is a body's places in two snapshots that follow each
// other, so one call draws all of them.

const SNAPSHOTS = 240;
const SEGMENTS = 120000;

export class Trails {
  constructor(gl) {
    this.gl = gl;
    this.buffer = gl.createBuffer();
    this.bodies = 0;
    this.reset();
  }

  reset() {
    this.head = 0;
    this.valid = 0;
  }

  /** Notes where bodies are drawn now. `seconds` is how long trails last. Whether there is something to draw. */
  record(motion, bodies, seconds) {
    const { gl } = this;
    // One slot more repeats the first, so that the segment across the seam is like the others.
    const slots = Math.min(SNAPSHOTS, Math.floor(SEGMENTS / Math.max(bodies, 1)));
    if (slots < 4) return false;
    if (bodies !== this.bodies || slots !== this.slots || seconds !== this.seconds) {
      Object.assign(this, { bodies, slots, seconds, places: new Float32Array(3 * bodies) });
      gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
      gl.bufferData(gl.ARRAY_BUFFER, (slots + 1) * bodies * 12, gl.DYNAMIC_DRAW);
      this.reset();
    }
    const { time } = motion;
    if (this.valid === 0) {
      this.write(motion);
      this.valid = 1;
      this.next();
      this.started = time;
    } else if (time - this.started >= seconds / slots) {
      this.write(motion);
      this.next();
      this.started = time;
    }
    this.write(motion);
    return true;
  }

  next() {
    this.head = (this.head + 1) % this.slots;
    this.valid = Math.min(this.valid + 1, this.slots);
  }

  write(motion) {
    const { gl, places, bodies, head } = this;
    const { previous: a, current: b, mix } = motion;
    for (let i = 0, at = 0; i < bodies; i++) {
      places[at++] = a.x[i] + (b.x[i] - a.x[i]) * mix;
      places[at++] = a.y[i] + (b.y[i] - a.y[i]) * mix;
      places[at++] = b.z ? a.z[i] + (b.z[i] - a.z[i]) * mix : 0;
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    gl.bufferSubData(gl.ARRAY_BUFFER, head * bodies * 12, places);
    if (head === 0) gl.bufferSubData(gl.ARRAY_BUFFER, this.slots * bodies * 12, places);
  }

  draw(program, bodies) {
    const segments = this.valid - 1;
    if (segments < 1) return;
    const oldest = (this.head - segments + this.slots) % this.slots;
    const untilSeam = Math.min(segments, this.slots - oldest);
    this.part(program, oldest, untilSeam, 0, segments, bodies);
    if (segments > untilSeam) this.part(program, 0, segments - untilSeam, untilSeam, segments, bodies);
  }

  part(program, slot, count, first, all, bodies) {
    const { gl } = this;
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffer);
    program.floats("aFrom", 3, 12, slot * bodies * 12);
    program.floats("aTo", 3, 12, (slot + 1) * bodies * 12);
    gl.uniform1f(program.uniforms.uFirst, first);
    gl.uniform1f(program.uniforms.uAll, all);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count * bodies);
  }
}
