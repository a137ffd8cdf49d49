// Past positions of bodies: snapshots in a ring of texture rows, drawn in one call.

const WIDTH = 1024;
const SNAPSHOTS = 240;
const SEGMENTS = 120000;
const SEGMENTS_IN_SOFTWARE = 8000;

export class Trails {
  constructor(gl, software) {
    this.gl = gl;
    this.most = software ? SEGMENTS_IN_SOFTWARE : SEGMENTS;
    this.texture = gl.createTexture();
    this.bodies = 0;
    this.reset();
  }

  reset() {
    this.head = 0;
    this.valid = 0;
  }

  /** Records the displayed positions; trails last `seconds`. Returns whether there is something to draw. */
  record(motion, bodies, seconds) {
    const { gl } = this;
    const slots = Math.min(SNAPSHOTS, Math.floor(this.most / Math.max(bodies, 1)));
    if (slots < 4) return false;
    if (bodies !== this.bodies || seconds !== this.seconds) {
      const rows = Math.ceil(bodies / WIDTH);
      Object.assign(this, { bodies, slots, seconds, rows, places: new Float32Array(4 * WIDTH * rows) });
      gl.bindTexture(gl.TEXTURE_2D, this.texture);
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, WIDTH, slots * rows, 0, gl.RGBA, gl.FLOAT, null);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
      gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
      this.reset();
    }
    // The newest snapshot moves with the bodies until its time is over.
    this.write(motion);
    if (this.valid === 0 || motion.time - this.started >= seconds / slots) {
      this.valid = Math.min(Math.max(this.valid, 1) + 1, slots);
      this.head = (this.head + 1) % slots;
      this.started = motion.time;
      this.write(motion);
    }
    return this.valid > 1;
  }

  write(motion) {
    const { gl, places, bodies, head, rows } = this;
    const { previous: a, current: b, mix } = motion;
    for (let i = 0, at = 0; i < bodies; i++, at += 4) {
      places[at] = a.x[i] + (b.x[i] - a.x[i]) * mix;
      places[at + 1] = a.y[i] + (b.y[i] - a.y[i]) * mix;
      places[at + 2] = b.z ? a.z[i] + (b.z[i] - a.z[i]) * mix : 0;
    }
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, head * rows, WIDTH, rows, gl.RGBA, gl.FLOAT, places);
  }

  draw({ uniforms }) {
    const { gl, bodies, slots, valid, head, rows } = this;
    const segments = valid - 1;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.uniform1i(uniforms.uSnapshots, 0);
    gl.uniform1i(uniforms.uBodies, bodies);
    gl.uniform1i(uniforms.uRows, rows);
    gl.uniform1i(uniforms.uSlots, slots);
    gl.uniform1i(uniforms.uOldest, (head - segments + slots) % slots);
    gl.uniform1i(uniforms.uSegments, segments);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * segments * bodies);
  }
}
