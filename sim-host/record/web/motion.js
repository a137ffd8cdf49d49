// Positions between two ticks: bodies are drawn slightly late, interpolated from the previous frame
// to the last one.

const SLOWEST_MS = 2000;
// More ticks at once than this multiple of the usual number count as a jump.
const JUMP = 8;

export class Motion {
  constructor() {
    this.reset();
  }

  reset() {
    this.pending = this.previous = this.current = null;
    this.mix = 1;
    this.interval = 50;
    this.stride = 1;
    this.taken = 0;
  }

  /** Replaces a frame that was not drawn yet. */
  offer(frame) {
    this.pending = frame;
  }

  /** Takes the newest frame. Returns "none", "next", or "jump" if it does not follow the previous one. */
  advance(now, paused) {
    let news = "none";
    const frame = this.pending;
    if (frame) {
      this.pending = null;
      const before = this.current;
      const ticks = before ? frame.tick - before.tick : 0;
      const usual = paused ? 1 : JUMP * (this.stride + 1);
      const follows = before && before.key === frame.key && ticks >= 0 && ticks <= usual;
      news = follows ? "next" : "jump";
      this.previous = follows && !paused ? before : frame;
      // Grows at once and shrinks slowly, so that motion stays visible when a run speeds up.
      if (ticks > 0) this.stride = Math.max(0.9 * this.stride, Math.min(ticks, usual));
      this.current = frame;
      const gap = Math.min(now - this.taken, SLOWEST_MS);
      this.interval = follows ? this.interval + 0.3 * (gap - this.interval) : 50;
      this.taken = now;
    }
    this.mix = paused ? 1 : Math.min(1, (now - this.taken) / this.interval);
    return news;
  }

  /** Whether bodies still move without a new frame. */
  get moving() {
    return this.mix < 1;
  }

  /** Writes the displayed position of body `i` to `out`. */
  place(i, out) {
    const { previous: a, current: b, mix } = this;
    out[0] = a.x[i] + (b.x[i] - a.x[i]) * mix;
    out[1] = a.y[i] + (b.y[i] - a.y[i]) * mix;
    out[2] = b.z ? a.z[i] + (b.z[i] - a.z[i]) * mix : 0;
    return out;
  }

  /** The last tick before the displayed moment, or at it. */
  get tick() {
    const { previous: a, current: b, mix } = this;
    return Math.floor(a.tick + (b.tick - a.tick) * mix);
  }
}
