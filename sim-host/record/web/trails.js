// Past positions of bodies: one row of a texture for each snapshot, drawn in one call. Snapshots are
// taken at fixed ticks, so that the trail at a tick does not depend on the way to it; the source
// answers requests for those that the page did not receive.

const WIDTH = 1024;
const SNAPSHOTS = 160;
const SEGMENTS = 120000;
const SEGMENTS_IN_SOFTWARE = 8000;
// A request without an answer is repeated after this time.
const PATIENCE_MS = 2000;

export class Trails {
  constructor(gl, software) {
    this.gl = gl;
    this.most = software ? SEGMENTS_IN_SOFTWARE : SEGMENTS;
    this.texture = gl.createTexture();
    this.bodies = 0;
    this.reset();
  }

  reset() {
    // Each snapshot's texture row and positions, by its tick. Row 0 has the displayed positions.
    this.rows = new Map();
    this.free = Array.from({ length: this.slots ?? 0 }, (_, i) => i + 1);
    this.order = [];
    this.askedAt = -Infinity;
  }

  /** Prepares for `bodies` and trails of `seconds`. Returns whether there is room for trails. */
  suit(bodies, seconds, tickS) {
    const slots = Math.min(SNAPSHOTS, Math.floor(this.most / Math.max(bodies, 1)));
    if (slots < 4 || !(seconds > 0)) return false;
    const every = Math.max(1, Math.ceil(seconds / tickS / slots));
    if (bodies === this.bodies && every === this.every && slots === this.slots) return true;
    const { gl } = this;
    const lines = Math.ceil(bodies / WIDTH);
    Object.assign(this, { bodies, slots, every, lines, places: new Float32Array(4 * WIDTH * lines) });
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, WIDTH, (slots + 1) * lines, 0, gl.RGBA, gl.FLOAT, null);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
    gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
    this.reset();
    return true;
  }

  /** Stores the positions at `tick` if trails need them. */
  store(tick, x, y, z) {
    const { rows, free } = this;
    if (!this.slots || tick % this.every !== 0 || x.length !== this.bodies || rows.has(tick)) return;
    if (!free.length) {
      const old = [...rows.keys()].reduce((a, b) => (Math.abs(a - tick) > Math.abs(b - tick) ? a : b));
      free.push(rows.get(old).row);
      rows.delete(old);
    }
    const row = free.pop(),
      places = new Float32Array(3 * x.length);
    rows.set(tick, { row, places });
    for (let i = 0; i < x.length; i++) places.set([x[i], y[i], z ? z[i] : 0], 3 * i);
    this.write(row, (at, i) => {
      for (let k = 0; k < 3; k++) at[k] = places[3 * i + k];
    });
  }

  /** Drops snapshots after `tick`, from which the run continues differently. */
  forgetAfter(tick) {
    for (const [at, { row }] of this.rows) {
      if (at <= tick) continue;
      this.free.push(row);
      this.rows.delete(at);
    }
  }

  write(row, place) {
    const { gl, places, bodies, lines } = this;
    const at = [0, 0, 0];
    for (let i = 0; i < bodies; i++) {
      place(at, i);
      places.set(at, 4 * i);
    }
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, row * lines, WIDTH, lines, gl.RGBA, gl.FLOAT, places);
  }

  /** The ticks of the trail at `tick`, newest first. */
  ticks(tick) {
    const { every, slots } = this;
    const newest = Math.floor(tick / every);
    return Array.from({ length: Math.min(slots, newest + 1) }, (_, i) => (newest - i) * every);
  }

  /** Ticks to request, oldest first; empty while an answer is awaited. */
  missing(tick, now) {
    if (now - this.askedAt < PATIENCE_MS) return [];
    const missing = this.ticks(tick).filter((each) => !this.rows.has(each));
    if (missing.length) this.askedAt = now;
    return missing.reverse();
  }

  answered() {
    this.askedAt = -Infinity;
  }

  /** The positions of the stored snapshots at the displayed moment, oldest first. */
  known(motion) {
    return this.snapshots(motion).map(({ places }) => places);
  }

  snapshots(motion) {
    const found = this.ticks(motion.tick).map((tick) => this.rows.get(tick));
    return found.filter(Boolean).reverse();
  }

  /** Prepares the trail at the displayed moment. Returns whether there is something to draw. */
  record(motion) {
    this.write(0, (at, i) => motion.place(i, at));
    this.order = [...this.snapshots(motion).map(({ row }) => row), 0];
    return this.order.length > 1;
  }

  draw({ uniforms }) {
    const { gl, bodies, lines, order } = this;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    gl.uniform1i(uniforms.uSnapshots, 0);
    gl.uniform1i(uniforms.uBodies, bodies);
    gl.uniform1i(uniforms.uRows, lines);
    gl.uniform1iv(uniforms.uOrder, order);
    gl.uniform1i(uniforms.uSegments, order.length - 1);
    gl.drawArrays(gl.TRIANGLES, 0, 6 * (order.length - 1) * bodies);
  }
}
