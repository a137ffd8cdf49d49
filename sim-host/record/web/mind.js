// The decision of the selected robot: one sentence from its state, and the velocities that its safety
// layer permits, drawn around it.

import { niceStep } from "staya/ground.js";
import { circle, drawVelocities, permitted, velocityObstacle } from "staya/velocity.js";

const RADIUS_PIXELS = 64;
const OUTER = 1.3;
// Velocity obstacles of the nearest robots.
const MOST_OBSTACLES = 4;
// A velocity this far beyond a border, as a fraction of the greatest speed, is forbidden.
const TOLERANCE = 1e-3;

/** The borders that forbid `velocity`. */
function broken({ lines, max_speed_mps: fastest }, velocity) {
  const past = ({ point, normal }) =>
    (velocity[0] - point[0]) * normal[0] + (velocity[1] - point[1]) * normal[1] < -TOLERANCE * fastest;
  return lines.filter(past);
}

export class Mind {
  constructor(app) {
    this.app = app;
  }

  /** The selected robot's action and its reason, as far as its state says; null if unknown. */
  get sentence() {
    const { robot, scene } = this.app;
    if (!robot) return null;
    const { orca, leader } = robot;
    const name = `robot ${robot.id}`,
      Name = `Robot ${robot.id}`;
    if (robot.up === false) return `${Name} is down`;
    if (orca && !permitted(orca).length && Math.hypot(...orca.chosen_mps) > 0 && broken(orca, orca.chosen_mps).length) {
      const where = this.isSlice ? " of the slice" : "";
      return `No velocity${where} is free: ${name} takes the one that breaks the rules least`;
    }
    if (robot.wait !== null) {
      const wait = scene.words.waits[robot.wait];
      return `${Name} waits: ${this.blocker(wait) ?? scene.words.because?.[robot.wait] ?? wait}`;
    }
    const mode = scene.words.modes[robot.mode];
    const does = scene.words.does?.[scene.robots.group[robot.index]]?.[robot.mode] ?? mode;
    if (mode !== "cruise") return `${Name} ${does}`;
    const moves = leader === null ? does : `follows robot ${this.app.idOf(leader)}`;
    const [first] = orca ? broken(orca, orca.preferred_mps) : [];
    return `${Name} ${moves}${first ? ` and evades ${first.hard ? "an obstacle" : "other robots"}` : ""}`;
  }

  /** The known robot that a reason to wait is about, in words; null if the data do not tell. */
  blocker(wait) {
    const { app } = this,
      { robot } = app;
    if (wait === "team" && robot.leader !== null) return `it or its leader, robot ${app.idOf(robot.leader)}, is not in place yet`;
    const place = wait === "goal_taken" ? app.targetOf(robot.index) : null;
    const there = place && this.nearest(place).find(({ index, far }) => far < app.radii[index]);
    return there ? `robot ${there.id} occupies its goal` : null;
  }

  /** The known robots of this run by their distance from a place. */
  nearest([x, y, z]) {
    const far = ({ position_m: [px, py, pz] }) => Math.hypot(px - x, py - y, pz - z);
    const known = (this.app.robot.neighbors ?? []).filter(({ index }) => index !== null);
    return known.map((other) => ({ ...other, far: far(other) })).sort((a, b) => a.far - b.far);
  }

  /** In space, the plot shows the velocities with the chosen climb. */
  get isSlice() {
    return this.app.scene.kind === "space";
  }

  /** The meaning of the drawn velocities; null if none are drawn. */
  get caption() {
    const { robot, look } = this.app;
    if (!robot?.orca || !look.layers.mind) return null;
    const climb = robot.orca.climb_mps;
    return `Permitted velocities, ways of ${this.seconds} s${this.isSlice ? `; a slice at a climb of ${climb.toFixed(2)} m/s` : ""}`;
  }

  /** Seconds of travel that the drawn velocities show: a round number. */
  get seconds() {
    const { app } = this,
      { camera } = app;
    const perMetre = camera.pixelsPerMetre(camera.space ? camera.distance : 1);
    return +niceStep(RADIUS_PIXELS / perMetre / Math.max(app.robot.orca.max_speed_mps, 1e-6)).toPrecision(2);
  }

  draw(view) {
    const { app } = this,
      { robot, camera, look, motion } = app;
    if (!robot || !look.layers.mind) return;
    const place = motion.place(robot.index, [0, 0, 0]);
    const at = camera.project(...place);
    if (!at) return;
    let bottom = at[1] + view.pixelRadius(robot.index, at);
    if (robot.orca) bottom = Math.max(bottom, this.drawVelocities(view.context, place));
    const lines = [this.sentence, this.caption].filter(Boolean);
    const most = camera.height - 14 * lines.length;
    lines.forEach((text, i) => {
      const size = i ? 10 : 12;
      view.context.font = `500 ${size}px system-ui, "DejaVu Sans", sans-serif`;
      const half = view.context.measureText(text).width / 2 + 6;
      const x = Math.max(half, Math.min(camera.width - half, at[0]));
      view.write(text, x, Math.min(bottom + 16, most) + 14 * i, "center", size);
    });
  }

  /** Draws the velocity obstacles of near robots, and the half-planes. Returns the lowest pixel. */
  drawVelocities(context, place) {
    const { app, seconds } = this,
      { robot, camera, look, motion, radii } = app;
    const { orca, index } = robot;
    const reach = OUTER * orca.max_speed_mps;
    const climb = this.isSlice ? orca.climb_mps : 0;
    const px = ([x, y]) =>
      camera.project(place[0] + x * seconds, place[1] + y * seconds, place[2] + climb * seconds) ?? [NaN, NaN];
    const outer = circle(reach);
    if (!this.isSlice && robot.parameters?.horizon_s) {
      context.strokeStyle = look.css.ghost;
      context.lineWidth = 1;
      for (const { index: other, position_m: to, velocity_mps: velocity } of this.nearest(place).slice(0, MOST_OBSTACLES)) {
        const { horizon_s: horizon, margin_m: margin } = robot.parameters;
        const offset = [to[0] - place[0], to[1] - place[1]];
        const cone = velocityObstacle(offset, velocity, radii[index] + radii[other] + (margin ?? 0), horizon, reach);
        if (!cone.length) continue;
        context.beginPath();
        for (const corner of cone) context.lineTo(...px(corner));
        context.closePath();
        context.globalAlpha = 0.1;
        context.fillStyle = look.css.ghost;
        context.fill();
        context.globalAlpha = 0.7;
        context.stroke();
        context.globalAlpha = 1;
      }
    }
    const frame = motion.current;
    drawVelocities(context, orca, [frame.vx[index], frame.vy[index]], look.css, px, outer);
    return Math.max(...outer.map((corner) => px(corner)[1]));
  }
}
