// Decorations around the bodies: lines for the GPU, and a canvas above them with labels, the
// selected robot's knowledge, and previews of tools.

import { NONE } from "staya/frame.js";
import { niceStep } from "staya/ground.js";
import { packed } from "staya/look.js";
import { Lines } from "staya/renderer.js";

const MOST_STEMS = 2000;
const MOST_FEET = 200;
const MOST_NUMBERS = 400;
const MOST_CROSSES = 400;
const MOST_TIES = 400;
const MANY = 200;
const LABEL_HEIGHT = 1.15;
const VECTOR_PIXELS = 34;
const CROWDED_PIXELS = 9;
const SCALE_PIXELS = 110;
const DELIVERED = 0,
  DAMAGED = 2;

export class View {
  constructor(app, canvas) {
    this.app = app;
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.below = new Lines();
    this.above = new Lines();
    // The action of the pointer: `{kind, ...}` or null.
    this.sketch = null;
    // The ends of the measuring line, or null.
    this.ruler = null;
    this.hovered = null;
  }

  resize(width, height, ratio) {
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
  }

  /** Shrinks or hides marks that would cover robots. */
  suit(look) {
    const { app } = this,
      { camera, scene } = app;
    const [x0, y0, x1, y1] = scene.bounds_m;
    const pixels = camera.pixelsPerMetre(camera.space ? camera.distance : 1);
    // Approximate distance between robots, pixels.
    const apart = Math.sqrt(((x1 - x0) * (y1 - y0)) / Math.max(app.robots, 1)) * pixels;
    look.leastRadius = Math.max(0.9, Math.min(app.robots <= MANY ? 6 : 3, 0.22 * apart));
    // Goals of many robots are dots, smaller and fainter than the robots.
    const many = app.robots > MANY;
    look.targetSize = many ? Math.max(1.2, 0.6 * look.leastRadius) : Math.max(2.5, Math.min(6, 0.3 * apart));
    look.targetAlpha = many ? 0.5 : 1;
    look.crowded = apart < CROWDED_PIXELS;
    // A round number of seconds in which the fastest robot travels about the length of an arrow.
    look.velocitySeconds = niceStep(
      Math.min(VECTOR_PIXELS, Math.max(0.8 * apart, 6)) / pixels / Math.max(app.fastest, 1e-6),
    );
  }

  lines() {
    const { app, below, above } = this;
    const { scene, motion, look, camera } = app;
    below.clear();
    above.clear();
    const frame = motion.current;
    if (!frame) return;
    if (camera.space) this.spaceLines(frame);
    const a = [0, 0, 0],
      b = [0, 0, 0];
    const join = (lines, i, j, ink, width, dash = 0) => {
      if (i >= frame.n || j >= frame.n) return;
      motion.place(i, a);
      motion.place(j, b);
      lines.add(a[0], a[1], a[2], b[0], b[1], b[2], ink, width, dash);
    };
    if (look.layers.formation && scene.formation) {
      const ink = packed(look.css.formation, 0.85);
      for (const [i, j] of scene.formation.edges) join(below, i, j, ink, 1.6);
    }
    if (look.layers.leaders) {
      const ink = packed(look.css.leader, 0.8);
      for (let i = 0; i < app.robots && i < frame.n; i++) {
        if (frame.leader[i] !== NONE) join(below, i, frame.leader[i], ink, 1.4, 4);
      }
    }
    if (look.targets && app.robots <= MOST_TIES) {
      const ink = packed(look.css.muted, 0.28);
      for (let i = 0; i < app.robots; i++) {
        const target = app.targetOf(i);
        if (target && i !== app.selected) below.add(...motion.place(i, a), ...target, ink, 1);
      }
    }
    this.crosses = [];
    if (look.layers.links && app.links) {
      const { pairs } = app.links;
      const inks = [packed(look.css.ok, 0.4), packed(look.css.vermillion, 0.75), packed(look.css.orange, 0.85)];
      for (let at = 0; at + 1 < pairs.length; at += 2) {
        const from = pairs[at],
          to = pairs[at + 1] >>> 2,
          fate = pairs[at + 1] & 3;
        if (fate === DELIVERED) {
          join(below, from, to, inks[0], 1);
        } else if (from < frame.n && to < frame.n) {
          // The line of a lost packet ends before its receiver.
          motion.place(from, a);
          motion.place(to, b);
          for (let k = 0; k < 3; k++) b[k] = a[k] + 0.6 * (b[k] - a[k]);
          above.add(a[0], a[1], a[2], b[0], b[1], b[2], inks[fate] ?? inks[1], 1.3, fate === DAMAGED ? 3 : 0);
          if (this.crosses.length < MOST_CROSSES) this.crosses.push([...b, fate]);
        }
      }
    }
    if (app.selected !== null) this.selectedLines(join);
  }

  selectedLines(join) {
    const { app, below, above } = this;
    const { look, motion } = app;
    const target = app.targetOf(app.selected);
    const place = motion.place(app.selected, [0, 0, 0]);
    if (target && look.layers.targets) below.add(...place, ...target, packed(look.css.selected, 0.6), 1.3, 5);
    if (!look.layers.known || !app.robot?.neighbors) return;
    for (const [index, to] of this.plan()) {
      above.add(...motion.place(index, [0, 0, 0]), ...to, packed(look.css.selected, 0.9), 2);
    }
    for (const { index, age_s, position_m } of app.robot.neighbors) {
      // Old positions are faint.
      const alpha = Math.max(0.2, 0.9 / (1 + age_s / (5 * app.scene.tick_s)));
      if (index !== null) join(below, index, app.selected, packed(look.css.ghost, alpha), 1.4);
      const from = index === null || index >= motion.current.n ? null : motion.place(index, [0, 0, 0]);
      if (from) above.add(...from, position_m[0], position_m[1], position_m[2] ?? 0, packed(look.css.ghost, 0.9), 1, 2);
    }
  }

  /** The moves of itself and others that the selected robot plans: `[robot, end]`. */
  plan() {
    const { app } = this;
    const { land } = app.scene;
    const moves = land && app.look.layers.known ? (app.robot?.plan ?? []) : [];
    const center = ({ cell }) => [...cell.map((at, axis) => land.origin_m[axis] + (at + 0.5) * land.cell_m), 0];
    return moves.filter(({ index }) => index < app.motion.current.n).map((move) => [move.index, center(move)]);
  }

  /** Draws the ground, obstacles, and the heights of bodies above it. */
  spaceLines(frame) {
    const { app, below } = this;
    const { scene, motion, look } = app;
    const [x0, y0, x1, y1] = scene.bounds_m;
    const z = Math.min(0, scene.height_m?.[0] ?? 0);
    if (look.layers.grid) {
      const step = niceStep(Math.max(x1 - x0, y1 - y0) / 12);
      const [west, east] = [Math.floor(x0 / step), Math.ceil(x1 / step)];
      const [south, north] = [Math.floor(y0 / step), Math.ceil(y1 / step)];
      const ink = packed(look.css.gridStrong);
      for (let i = west; i <= east; i++) below.add(i * step, south * step, z, i * step, north * step, z, ink, 1);
      for (let i = south; i <= north; i++) below.add(west * step, i * step, z, east * step, i * step, z, ink, 1);
    }
    const ink = packed(look.css.solidEdge);
    for (const solid of app.solids) {
      const points = solid.points_m
        ? [...solid.points_m, solid.points_m[0]]
        : solid.from_m && [solid.from_m, solid.to_m];
      points?.slice(1).forEach((point, i) => {
        below.add(points[i][0], points[i][1], z, point[0], point[1], z, ink, 2.5);
      });
    }
    if (frame.n > MOST_STEMS) return;
    const stem = packed(look.css.muted, 0.5 * Math.min(1, 8 / Math.sqrt(frame.n)));
    const place = [0, 0, 0];
    for (let i = 0; i < frame.n; i++) {
      motion.place(i, place);
      const [x, y] = place,
        foot = 0.5 * (app.radii[i] ?? 0);
      below.add(x, y, z, x, y, place[2], stem, 1);
      if (frame.n > MOST_FEET) continue;
      below.add(x - foot, y, z, x + foot, y, z, stem, 1.5);
      below.add(x, y - foot, z, x, y + foot, z, stem, 1.5);
    }
  }

  overlay() {
    const { app, context } = this;
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.clearRect(0, 0, app.camera.width, app.camera.height);
    this.boxes = [];
    this.drawScale();
    const frame = app.motion.current;
    if (!frame) return;
    const at = (i) => app.camera.project(...app.motion.place(i, [0, 0, 0]));
    const selected = app.selected !== null && app.selected < frame.n;
    if (selected && app.look.layers.known) this.drawGhosts();
    this.drawOther(frame);
    this.drawCrosses();
    this.drawGoals(frame);
    if (app.look.layers.numbers) this.drawNumbers(frame, at);
    if (this.hovered !== null && this.hovered < frame.n)
      this.ring(at(this.hovered), this.hovered, app.look.css.muted, 1.5);
    if (selected) {
      this.ring(at(app.selected), app.selected, app.look.css.selected, 2);
      app.mind.draw(this);
    }
    if (this.sketch) this.drawSketch(at);
    if (this.ruler) this.drawRuler();
  }

  pixelRadius(i, at) {
    const { app } = this;
    return Math.max(app.look.leastRadius, (app.radii[i] ?? 0) * app.camera.pixelsPerMetre(at[2]));
  }

  ring(at, i, colour, width) {
    if (!at) return;
    const { context } = this;
    context.beginPath();
    context.arc(at[0], at[1], this.pixelRadius(i, at) + 5, 0, 2 * Math.PI);
    context.strokeStyle = this.app.look.css.halo;
    context.lineWidth = width + 3;
    context.stroke();
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }

  /** Whether a centred label overlaps no other one; if so, its place is taken. */
  hasRoom(text, x, y, size = 11) {
    this.context.font = `500 ${size}px system-ui, "DejaVu Sans", sans-serif`;
    const half = this.context.measureText(text).width / 2 + 2;
    const box = [x - half, y - LABEL_HEIGHT * size, x + half, y + 2];
    if (this.boxes.some((other) => box[0] < other[2] && box[2] > other[0] && box[1] < other[3] && box[3] > other[1]))
      return false;
    this.boxes.push(box);
    return true;
  }

  write(text, x, y, align = "center", size = 11, context = this.context) {
    const { css } = this.app.look;
    context.font = `500 ${size}px system-ui, "DejaVu Sans", sans-serif`;
    context.textAlign = align;
    context.lineJoin = "round";
    context.lineWidth = 3;
    context.strokeStyle = css.halo;
    context.strokeText(text, x, y);
    context.fillStyle = css.label;
    context.fillText(text, x, y);
  }

  /** Draws numbers where there is room. */
  drawNumbers(frame, at) {
    const { app } = this;
    const { width, height } = app.camera;
    let written = 0;
    const number = (i) => {
      const place = at(i);
      if (!place) return;
      const [x, y] = place;
      if (x < 0 || y < 0 || x > width || y > height) return;
      const radius = this.pixelRadius(i, place);
      const text = i < app.robots ? String(app.idOf(i)) : "intruder";
      const above = y - radius - (i === app.selected ? 11 : 5);
      if (!this.hasRoom(text, x, above) && i !== app.selected) return;
      written++;
      this.write(text, x, above);
    };
    if (app.selected !== null && app.selected < frame.n) number(app.selected);
    for (let i = app.robots; i < frame.n; i++) number(i);
    const few =
      app.robots <= 60 ||
      (app.robots <= 2000 && app.camera.pixelsPerMetre(app.camera.distance) * (app.radii[0] ?? 0) > 7);
    for (let i = 0; few && i < Math.min(frame.n, app.robots) && written < MOST_NUMBERS; i++) {
      if (i !== app.selected) number(i);
    }
  }

  /** Draws the selected robot's estimates of other positions, and the ends of planned moves. */
  drawGhosts() {
    const { app, context } = this;
    const { css } = app.look;
    context.lineWidth = 1.5;
    context.fillStyle = css.selected;
    for (const [, [x, y]] of this.plan()) {
      const at = app.camera.project(x, y, 0);
      if (!at) continue;
      context.beginPath();
      context.arc(at[0], at[1], 3.5, 0, 2 * Math.PI);
      context.fill();
    }
    context.strokeStyle = context.fillStyle = css.ghost;
    for (const { index, id, position_m, age_s } of app.robot?.neighbors ?? []) {
      const at = app.camera.project(position_m[0], position_m[1], position_m[2] ?? 0);
      if (!at) continue;
      const radius = this.pixelRadius(index ?? app.selected, at);
      context.setLineDash([3, 3]);
      context.beginPath();
      context.arc(at[0], at[1], radius, 0, 2 * Math.PI);
      context.stroke();
      context.setLineDash([]);
      if (index === null || age_s > 2 * app.scene.tick_s) {
        this.write(
          `${index === null ? `${id}? ` : ""}${age_s.toFixed(age_s < 10 ? 1 : 0)} s`,
          at[0],
          at[1] + radius + 13,
          "center",
          10,
        );
        context.lineWidth = 1.5;
        context.strokeStyle = css.ghost;
      }
    }
  }

  /** Draws where the robots are in another branch at this tick. */
  drawOther(frame) {
    const { app, context } = this;
    if (app.otherBranch === null) return;
    context.lineWidth = 1;
    context.strokeStyle = app.look.css.muted;
    for (let i = 0; i < frame.n; i++) {
      const place = app.placeInOther(i),
        to = place && app.camera.project(...place),
        from = app.camera.project(...app.motion.place(i, [0, 0, 0]));
      if (!to || !from || Math.hypot(to[0] - from[0], to[1] - from[1]) < 1) continue;
      context.setLineDash([2, 3]);
      context.beginPath();
      context.moveTo(from[0], from[1]);
      context.lineTo(to[0], to[1]);
      context.stroke();
      context.setLineDash([]);
      context.beginPath();
      context.arc(to[0], to[1], this.pixelRadius(i, to), 0, 2 * Math.PI);
      context.stroke();
    }
  }

  drawCrosses() {
    const { app, context } = this;
    context.lineWidth = 1.6;
    for (const [x, y, z, fate] of this.crosses ?? []) {
      const at = app.camera.project(x, y, z);
      if (!at) continue;
      context.strokeStyle = fate === DAMAGED ? app.look.css.orange : app.look.css.vermillion;
      context.beginPath();
      context.moveTo(at[0] - 3, at[1] - 3);
      context.lineTo(at[0] + 3, at[1] + 3);
      context.moveTo(at[0] - 3, at[1] + 3);
      context.lineTo(at[0] + 3, at[1] - 3);
      context.stroke();
    }
  }

  /** Draws the goals of flocks as numbered flags. */
  drawGoals(frame) {
    const { app, context } = this;
    (frame.figures.goals ?? []).forEach((goal, i) => {
      const at = app.camera.project(goal[0], goal[1], goal[2] ?? 0);
      if (!at || !app.look.layers.targets) return;
      const [x, y] = at;
      context.beginPath();
      context.arc(x, y, 9, 0, 2 * Math.PI);
      context.fillStyle = app.look.css.halo;
      context.fill();
      context.strokeStyle = app.look.css.accent;
      context.lineWidth = 2;
      context.stroke();
      if (this.hasRoom(`goal ${i}`, x, y - 14)) this.write(`goal ${i}`, x, y - 14);
      context.beginPath();
      context.arc(x, y, 3, 0, 2 * Math.PI);
      context.fillStyle = app.look.css.accent;
      context.fill();
    });
  }

  get rulerText() {
    const { from, to } = this.ruler;
    return to && metres(Math.hypot(...from.map((value, axis) => to[axis] - value)));
  }

  drawRuler() {
    const { app, context, ruler } = this;
    const ends = [ruler.from, ruler.to].map((place) => place && app.camera.project(...place));
    if (!ends[0] || !ends[1]) return;
    context.strokeStyle = context.fillStyle = app.look.css.accent;
    context.lineWidth = 2;
    context.beginPath();
    for (const [x, y] of ends) context.lineTo(x, y);
    context.stroke();
    for (const [x, y] of ends) {
      context.beginPath();
      context.arc(x, y, 3, 0, 2 * Math.PI);
      context.fill();
    }
    this.write(this.rulerText, (ends[0][0] + ends[1][0]) / 2, (ends[0][1] + ends[1][1]) / 2 - 8, "center", 12);
  }

  drawSketch(at) {
    const { app, context, sketch } = this;
    const { css } = app.look;
    context.strokeStyle = context.fillStyle = css.accent;
    context.lineWidth = 2;
    if (sketch.kind === "goal") {
      const from = sketch.robot === null ? null : at(sketch.robot);
      const to = app.camera.project(...sketch.place);
      if (!to) return;
      context.setLineDash([5, 4]);
      context.beginPath();
      if (from) context.moveTo(from[0], from[1]);
      context.lineTo(to[0], to[1]);
      context.stroke();
      context.setLineDash([]);
      context.beginPath();
      context.arc(to[0], to[1], 7, 0, 2 * Math.PI);
      context.stroke();
    } else if (sketch.kind === "wall") {
      const [a, b] = [app.camera.project(...sketch.from), app.camera.project(...sketch.to)];
      context.lineWidth = 4;
      context.lineCap = "round";
      context.beginPath();
      context.moveTo(a[0], a[1]);
      context.lineTo(b[0], b[1]);
      context.stroke();
      this.write(
        `${metres(Math.hypot(sketch.to[0] - sketch.from[0], sketch.to[1] - sketch.from[1]))}`,
        b[0],
        b[1] - 12,
      );
    } else if (sketch.kind === "circle") {
      const a = app.camera.project(...sketch.from);
      const radius = Math.hypot(sketch.to[0] - sketch.from[0], sketch.to[1] - sketch.from[1]);
      context.beginPath();
      context.arc(a[0], a[1], radius * app.camera.scale, 0, 2 * Math.PI);
      context.globalAlpha = 0.2;
      context.fill();
      context.globalAlpha = 1;
      context.stroke();
      this.write(metres(radius), a[0], a[1] + 4);
    } else if (sketch.kind === "polygon") {
      const points = sketch.points.map(([x, y]) => app.camera.project(x, y, 0)).filter(Boolean);
      if (!points.length) return;
      context.beginPath();
      for (const [x, y] of points) context.lineTo(x, y);
      context.closePath();
      context.globalAlpha = 0.2;
      context.fill();
      context.globalAlpha = 1;
      context.stroke();
      context.beginPath();
      context.arc(points[0][0], points[0][1], 5, 0, 2 * Math.PI);
      context.fill();
    }
  }

  drawScale() {
    const { camera } = this.app;
    const perMetre = camera.pixelsPerMetre(camera.space ? camera.distance : 1);
    const key = `${camera.version}`;
    if (key === this.scaled) return;
    this.scaled = key;
    const length = niceStep((SCALE_PIXELS * 0.7) / perMetre);
    document.getElementById("scale-bar").style.width = `${length * perMetre}px`;
    const cell = this.app.scene.land?.cell_m;
    const cells = cell && length >= cell ? ` ≈ ${+(length / cell).toPrecision(3)} cells` : "";
    document.getElementById("scale-text").textContent = metres(length) + cells;
  }
}

/** A length with a suitable unit. */
export function metres(length) {
  if (length >= 1000) return `${+(length / 1000).toPrecision(3)} km`;
  if (length >= 1) return `${+length.toPrecision(3)} m`;
  if (length >= 0.01) return `${+(length * 100).toPrecision(3)} cm`;
  return `${+(length * 1000).toPrecision(2)} mm`;
}
