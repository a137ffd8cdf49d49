// Small plots of figures over time.

const MOST = 2048;

// Plotted figures of frames. A plot appears once one of its lines has a value.
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
const LINES = PLOTS.flatMap((plot) => plot.lines);

export class Plots {
  constructor(element, onSeek) {
    this.element = element;
    this.onSeek = onSeek;
    this.rows = PLOTS.map((plot) => this.row(plot));
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
      this.onSeek(this.first + ((event.clientX - left) / width) * (this.last - this.first));
    });
    const label = document.createElement("div");
    label.append(name, value);
    row.append(label, canvas);
    this.element.append(row);
    return { plot, row, value, canvas };
  }

  reset() {
    // One sample for every `spacing` ticks, the last one received.
    this.samples = [];
    this.spacing = 1;
    this.first = 0;
    this.last = 1;
    this.stale = true;
  }

  add(tick, figures) {
    while (tick / this.spacing >= MOST) this.coarsen();
    this.samples[Math.floor(tick / this.spacing)] = LINES.map((line) => line.of(figures) ?? NaN);
    this.stale = true;
  }

  coarsen() {
    const finer = this.samples;
    this.spacing *= 2;
    this.samples = [];
    finer.forEach((values, i) => {
      this.samples[i >> 1] = values;
    });
  }

  /** Drops samples after `tick`, from which the run continues differently. */
  forgetAfter(tick) {
    const keep = Math.floor(tick / this.spacing) + 1;
    if (this.samples.length > keep) {
      this.samples.length = keep;
      this.stale = true;
    }
  }

  setRange(first, last) {
    if (first === this.first && last === this.last) return;
    this.first = first;
    this.last = Math.max(last, first + 1);
    this.stale = true;
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
      if (row.hidden && values.some((each) => each !== null)) row.hidden = false;
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
      for (const values of this.samples) {
        if (values)
          for (let i = 0; i < plot.lines.length; i++) if (values[from + i] > greatest) greatest = values[from + i];
      }
    }
    const x = (at) => ((at - this.first) / (this.last - this.first)) * width;
    const y = (value) => height - 2 - (greatest > 0 ? value / greatest : 0) * (height - 5);
    context.strokeStyle = colours.grid;
    context.beginPath();
    context.moveTo(0, height - 1.5);
    context.lineTo(width, height - 1.5);
    context.stroke();
    plot.lines.forEach(({ colour }, i) => {
      context.beginPath();
      let pen = false,
        firstX = null,
        lastX = 0;
      this.samples.forEach((values, at) => {
        const value = values[from + i];
        if (Number.isNaN(value)) {
          pen = false;
          return;
        }
        lastX = x((at + 0.5) * this.spacing);
        if (pen) context.lineTo(lastX, y(value));
        else context.moveTo(lastX, y(value));
        firstX ??= lastX;
        pen = true;
      });
      context.strokeStyle = colours[colour];
      context.lineWidth = 1.4;
      context.lineJoin = "round";
      context.stroke();
      if (plot.lines.length === 1 && pen) {
        context.lineTo(lastX, height - 2);
        context.lineTo(firstX, height - 2);
        context.globalAlpha = 0.12;
        context.fillStyle = colours[colour];
        context.fill();
        context.globalAlpha = 1;
      }
    });
    context.strokeStyle = colours.cursor;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(x(tick), 0);
    context.lineTo(x(tick), height);
    context.stroke();
  }
}
