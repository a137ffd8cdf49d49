// Small plots of figures over time.

// Samples per figure; of longer runs, the last of several ticks counts.
const MOST = 1 << 16;
// Beside each plot, for the values at its upper and lower edge.
const SCALE_PIXELS = 28;

// Plotted figures in the order of the message `figures`. A plot appears once one of its lines has a
// value.
const PLOTS = [
  { name: "Arrived", lines: [{ of: (f) => f.arrived, colour: "ok" }], digits: 0 },
  { name: "Waiting", lines: [{ of: (f) => f.waiting, colour: "warn" }], digits: 0 },
  { name: "Collisions", lines: [{ of: (f) => f.collisions, colour: "bad" }], digits: 0 },
  { name: "Formation error", unit: "cells", lines: [{ of: (f) => f.formation_error, colour: "accent" }], digits: 2 },
  { name: "Group order", lines: [{ of: (f) => f.order, colour: "accent" }], digits: 3, greatest: 1 },
  {
    name: "Packets delivered, lost",
    digits: 0,
    lines: [
      { of: (f) => f.packets?.delivered, colour: "ok" },
      { of: (f) => f.packets?.lost, colour: "bad" },
    ],
  },
  { name: "Smallest gap", unit: "m", lines: [{ of: (f) => f.gap_m, colour: "violet" }], digits: 3 },
];
// Plotted figures of the selected robot.
export const ROBOT_PLOTS = [
  { name: "Speed", unit: "m/s", lines: [{ of: (r) => r.speed_mps, colour: "accent" }], digits: 3 },
  { name: "Gap to the nearest", unit: "m", lines: [{ of: (r) => r.gap_m, colour: "violet" }], digits: 3 },
  { name: "Oldest knowledge", unit: "s", lines: [{ of: (r) => r.age_s, colour: "warn" }], digits: 2 },
];
const linesOf = (plots) => plots.flatMap((plot) => plot.lines);
export const PLOTTED = linesOf(PLOTS).length;

/** The plotted values of figures, NaN for none. */
export function plotted(figures, plots = PLOTS) {
  return linesOf(plots).map((line) => line.of(figures) ?? NaN);
}

export class Plots {
  constructor(element, onSeek, plots = PLOTS) {
    this.element = element;
    this.columns = linesOf(plots);
    this.onSeek = onSeek;
    this.first = 0;
    this.last = 1;
    this.rows = plots.map((plot) => this.row(plot));
    this.reset();
  }

  row(plot) {
    const row = document.createElement("div");
    row.className = "plot";
    row.hidden = true;
    const name = document.createElement("span");
    name.className = "plot-name";
    name.textContent = plot.name;
    const value = document.createElement("span");
    value.className = "plot-value";
    const canvas = document.createElement("canvas");
    canvas.setAttribute("role", "img");
    canvas.addEventListener("pointerdown", (event) => {
      const { left, width } = canvas.getBoundingClientRect();
      const share = Math.min(1, (event.clientX - left) / (width - SCALE_PIXELS));
      this.onSeek(this.first + share * (this.last - this.first));
    });
    const label = document.createElement("div");
    label.append(name, value);
    row.append(label, canvas);
    this.element.append(row);
    return { plot, row, value, canvas };
  }

  reset() {
    // One sample for every `spacing` ticks, and whether it is known.
    this.samples = new Float32Array(0);
    this.known = new Uint8Array(0);
    this.count = 0;
    this.spacing = 1;
    // Samples with more ticks between them are not joined.
    this.every = 1;
    // The samples of the branch that was shown before.
    this.before = null;
    this.stale = true;
  }

  /** Starts with another branch; the lines of the one before stay as faint lines. */
  changeBranch() {
    const { samples, known, count, spacing, every, columns } = this;
    this.reset();
    this.before = { samples, known, count, spacing, every, columns };
  }

  add(tick, values, every = 1) {
    while (tick / this.spacing >= MOST) this.coarsen();
    const at = Math.floor(tick / this.spacing);
    if (at >= this.known.length) this.grow(at + 1);
    this.known[at] = 1;
    this.samples.set(values, at * this.columns.length);
    this.count = Math.max(this.count, at + 1);
    this.every = Math.max(this.every, every);
    this.stale = true;
  }

  grow(least) {
    const size = Math.min(MOST, Math.max(least, 2 * this.known.length, 1024));
    const { known, samples } = this;
    this.known = new Uint8Array(size);
    this.known.set(known);
    this.samples = new Float32Array(size * this.columns.length);
    this.samples.set(samples);
  }

  coarsen() {
    const { known, samples, count } = this;
    for (let i = 0; i < count; i++) {
      const [from, to] = [i * this.columns.length, (i >> 1) * this.columns.length];
      if (known[i]) samples.copyWithin(to, from, from + this.columns.length);
      known[i >> 1] = known[i] | (i & 1 ? known[i >> 1] : 0);
    }
    this.spacing *= 2;
    this.count = (count + 1) >> 1;
    known.fill(0, this.count);
  }

  /** The least value up to `tick` of the first line of the plot with this name; null for none. */
  least(name, tick) {
    const column = this.columns.indexOf(this.rows.find(({ plot }) => plot.name === name)?.plot.lines[0]);
    const end = Math.min(this.count, Math.floor(tick / this.spacing) + 1);
    let least = Infinity;
    for (let at = 0; column >= 0 && at < end; at++) {
      const value = this.samples[at * this.columns.length + column];
      if (this.known[at] && value < least) least = value;
    }
    return least < Infinity ? least : null;
  }

  /** Drops samples after `tick`, from which the run continues differently. */
  forgetAfter(tick) {
    const keep = Math.floor(tick / this.spacing) + 1;
    if (this.count <= keep) return;
    this.known.fill(0, keep);
    this.count = keep;
    this.stale = true;
  }

  setRange(first, last) {
    if (first === this.first && last === this.last) return;
    this.first = first;
    this.last = Math.max(last, first + 1);
    this.stale = true;
  }

  /** The drawn pieces of a plot's first line. */
  lines(name) {
    const same = (value) => value;
    return pieces(this, this.column(name), same, same);
  }

  column(name) {
    return this.columns.indexOf(this.rows.find(({ plot }) => plot.name === name).plot.lines[0]);
  }

  /** The known samples of a plot's first line, `[tick, value]`. */
  series(name) {
    const line = this.column(name);
    const found = [];
    for (let i = 0; i < this.count; i++)
      if (this.known[i]) found.push([i * this.spacing, this.samples[i * this.columns.length + line]]);
    return found;
  }

  draw(tick, figures, colours) {
    const key = `${tick}:${this.element.clientWidth}:${colours.ink}`;
    if (!this.stale && key === this.drawn) return;
    this.stale = false;
    this.drawn = key;
    let line = 0;
    for (const { plot, row, value, canvas } of this.rows) {
      const from = line;
      line += plot.lines.length;
      const values = plot.lines.map(({ of }) => of(figures) ?? null);
      if (row.hidden && (values.some((each) => each !== null) || this.hasValues(from, line))) row.hidden = false;
      if (row.hidden) continue;
      value.replaceChildren(
        ...values.map((each, i) => {
          const span = document.createElement("span");
          span.textContent = each === null ? "–" : each.toFixed(plot.digits);
          if (plot.lines.length > 1) span.style.color = colours[plot.lines[i].colour];
          if (plot.unit && each !== null) span.textContent += `\u2009${plot.unit}`;
          return span;
        }),
      );
      canvas.setAttribute(
        "aria-label",
        `${plot.name}: ${[...value.children].map((span) => span.textContent).join(", ")}`,
      );
      this.drawPlot(canvas, plot, from, tick, colours);
    }
  }

  /** Whether a line of `from..to` has a known value. */
  hasValues(from, to) {
    for (let i = 0; i < this.count; i++) {
      for (let k = from; this.known[i] && k < to; k++) if (!Number.isNaN(this.samples[i * this.columns.length + k])) return true;
    }
    return false;
  }

  drawPlot(canvas, plot, from, tick, colours) {
    const ratio = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width) return;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const context = canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    let greatest = plot.greatest ?? 0;
    if (!plot.greatest) {
      for (let i = 0; i < this.count; i++) {
        for (let k = 0; this.known[i] && k < plot.lines.length; k++) {
          const value = this.samples[i * this.columns.length + from + k];
          if (value > greatest) greatest = value;
        }
      }
    }
    const right = width - SCALE_PIXELS;
    const x = (at) => ((at - this.first) / (this.last - this.first)) * right;
    const y = (value) => height - 2 - (greatest > 0 ? value / greatest : 0) * (height - 5);
    context.strokeStyle = colours.grid;
    context.beginPath();
    context.moveTo(0, height - 1.5);
    context.lineTo(right, height - 1.5);
    context.stroke();
    plot.lines.forEach(({ colour }, i) => {
      context.strokeStyle = context.fillStyle = colours[colour];
      context.lineJoin = context.lineCap = "round";
      const column = (at) => Math.round(x(at) * 2 * ratio) / 2 / ratio;
      context.lineWidth = 1;
      context.globalAlpha = 0.4;
      for (const points of this.before ? pieces(this.before, from + i, column, y) : []) {
        context.beginPath();
        for (const point of points) context.lineTo(...point);
        context.stroke();
      }
      context.lineWidth = 1.4;
      context.globalAlpha = 1;
      for (const points of pieces(this, from + i, column, y)) {
        const [[firstX, firstY], [lastX]] = [points[0], points.at(-1)];
        context.beginPath();
        for (const point of points) context.lineTo(...point);
        if (points.length === 1) context.lineTo(firstX, firstY);
        context.stroke();
        if (plot.lines.length > 1) continue;
        context.lineTo(lastX, height - 2);
        context.lineTo(firstX, height - 2);
        context.globalAlpha = 0.12;
        context.fill();
        context.globalAlpha = 1;
      }
    });
    if (greatest > 0) {
      // The scale: the value at the upper edge; the lower edge is 0.
      context.font = "9px system-ui, sans-serif";
      context.fillStyle = colours.muted;
      context.fillText(+greatest.toPrecision(3), right + 4, 9);
      context.fillText(0, right + 4, height - 1);
    }
    context.strokeStyle = colours.cursor;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(x(tick), 0);
    context.lineTo(x(tick), height);
    context.stroke();
  }
}

/** Joined points of a line; each gap in time or value starts a new piece. Of the samples with one
    place on the x axis, it keeps the first, least, greatest and last one. */
function pieces({ samples, known, count, spacing, every, columns }, line, x, y) {
  const joined = Math.max(every, spacing);
  const found = [];
  let before = -Infinity,
    column = null;
  const flush = () => {
    if (!column) return;
    const { at, values } = column;
    const [first, last] = [values[0], values.at(-1)];
    const kept = values.length > 2 ? [first, Math.min(...values), Math.max(...values), last] : values;
    found.at(-1).push(...kept.map((value) => [at, y(value)]));
    column = null;
  };
  for (let i = 0; i < count; i++) {
    const value = samples[i * columns.length + line];
    if (!known[i] || Number.isNaN(value)) {
      if (known[i]) before = -Infinity;
      continue;
    }
    const tick = i * spacing,
      at = x(tick);
    const isNew = tick - before > joined;
    if (isNew || column?.at !== at) flush();
    if (isNew) found.push([]);
    if (column) column.values.push(value);
    else column = { at, values: [value] };
    before = tick;
  }
  flush();
  return found;
}
