// The page: receives data from the server or the recording, and draws them.

import { Camera } from "staya/camera.js";
import { Claims } from "staya/claims.js";
import { Controls } from "staya/controls.js";
import { fromBase64 } from "staya/frame.js";
import { Ground } from "staya/ground.js";
import { Live } from "staya/live.js";
import { Look } from "staya/look.js";
import { Mind } from "staya/mind.js";
import { Motion } from "staya/motion.js";
import { Orders } from "staya/orders.js";
import { Panel } from "staya/panel.js";
import { Player } from "staya/player.js";
import { Picture, download } from "staya/picture.js";
import { Plots, ROBOT_PLOTS, plotted } from "staya/plots.js";
import { Pointer } from "staya/pointer.js";
import { Renderer } from "staya/renderer.js";
import { View } from "staya/view.js";

const PLOTS_EVERY_MS = 120;
// The camera keeps up to this many robots in sight.
const MOST_IN_SIGHT = 20000;
const TOAST_MS = 6000;
const TOP_RATIO = 2;
// Robots of another branch are shown up to this number.
const MOST_OTHERS = 2000;
const NO_WEBGL =
  "This browser does not support WebGL2, so robots cannot be drawn. Turn on hardware acceleration in its settings, " +
  "or start Chromium with --enable-unsafe-swiftshader; current versions of Firefox, Chrome, Edge and Safari support it.";

const element = (id) => document.getElementById(id);

class App {
  constructor() {
    this.scene = null;
    this.state = null;
    this.selected = null;
    this.robot = null;
    this.links = null;
    this.follow = false;
    this.dirty = true;
    this.frames = { received: 0, drawn: 0 };
    this.fps = 0;
    this.figures = {};
    this.camera = new Camera();
    this.motion = new Motion();
    this.look = new Look();
    this.renderer = Renderer.on(element("bodies"));
    this.lack = this.renderer ? null : NO_WEBGL;
    this.ground = new Ground(element("ground"));
    this.mind = new Mind(this);
    this.view = new View(this, element("overlay"));
    this.plots = new Plots(element("plots"), (tick) => this.seek(tick));
    this.panel = new Panel(this);
    this.claims = new Claims(this);
    this.robotPlots = new Plots(element("robot-plots"), (tick) => this.seek(tick), ROBOT_PLOTS);
    this.orders = new Orders(this);
    this.picture = new Picture(this);
    this.controls = new Controls(this);
    this.pointer = new Pointer(this, element("overlay"));
    this.look.onTheme = () => this.restyle();
    this.restyle();
    this.banner(this.lack);
    new ResizeObserver(() => this.resize()).observe(element("stage"));
    // A plot in a closed panel has no size and is drawn when the panel opens.
    const plots = new ResizeObserver(() => {
      this.plots.stale = this.robotPlots.stale = this.dirty = true;
      this.plottedAt = 0;
    });
    for (const id of ["plots", "robot-plots"]) plots.observe(element(id));
    addEventListener("hashchange", () => this.scene && this.state && this.openAddress());
    this.resize();
  }

  start() {
    const recording = element("recording");
    this.source = recording ? new Player(recording, this) : new Live(this);
    this.source.start();
    const turn = (now) => {
      requestAnimationFrame(turn);
      this.turn(now);
    };
    requestAnimationFrame(turn);
  }

  // Events of the source.

  onScene(scene) {
    const before = this.scene;
    const same =
      before &&
      before.name === scene.name &&
      before.kind === scene.kind &&
      before.robots.id.length === scene.robots.id.length &&
      `${before.bounds_m}` === `${scene.bounds_m}`;
    this.scene = scene;
    this.cells = scene.land ? fromBase64(scene.land.cells) : null;
    this.solids = scene.solids.map((solid) => ({ ...solid }));
    this.links = null;
    this.robots = scene.robots.id.length;
    this.groups = Uint8Array.from(scene.robots.group, (group) => group % 7);
    const radii = Float32Array.from([...scene.robots.radius_m, ...scene.intruders.map(({ radius_m }) => radius_m)]);
    this.radii = radii;
    this.fastest = scene.robots.max_speed_mps.reduce((most, speed) => Math.max(most, speed), 0);
    const isNewRun = !same || before.seed !== scene.seed;
    if (isNewRun) {
      this.motion.reset();
      this.plots.reset();
      this.robotPlots.reset();
      this.lastFrame = null;
      this.renderer?.trails.reset();
    }
    const balls = scene.kind === "space" ? this.solids.filter(({ kind }) => kind === "ball") : [];
    if (isNewRun || balls.length) {
      this.renderer?.setBodies(
        this.robots,
        Float32Array.from([...radii].flatMap((radius, i) => [radius, this.groups[i] ?? 0])),
        balls.map(({ center_m: [x, y, z], radius_m: radius }) => [x, y, z ?? 0, radius]),
      );
    }
    this.ground.setScene(scene, this.cells, this.solids);
    this.look.words = scene.words;
    if (!same) {
      this.look.colourBy = scene.colour_by ?? "mode";
      this.select(null);
      this.fit();
      // The panels of narrow screens are closed at first.
      if (scene.description && element("app").classList.contains("side-closed")) this.toast(scene.description);
    }
    this.controls.scene();
    this.claims.scene();
    this.orders.scene();
    this.restyle();
  }

  onState(state) {
    const before = this.state;
    if (before && before.speed !== state.speed) this.motion.interval = 50;
    const other = this.otherBranch;
    this.state = state;
    if (before && before.branch !== state.branch) {
      this.shownBefore = before.branch;
      this.plots.changeBranch();
      this.robotPlots.reset();
      this.renderer?.trails.reset();
    }
    if (this.timed) {
      for (const plots of [this.plots, this.robotPlots]) plots.forgetAfter(state.last);
      this.renderer?.trails.forgetAfter(state.last);
    }
    for (const plots of [this.plots, this.robotPlots]) plots.setRange(state.first, this.horizon);
    if (this.otherBranch !== other) {
      this.other = null;
      this.controls.legend();
    }
    this.controls.state(before);
    this.orders.state();
    this.dirty = true;
    if (!this.opened && this.scene) {
      this.opened = true;
      this.openAddress();
    }
  }

  /** The tick at the end of the timeline: of all ticks of the scenario or the recording. */
  get horizon() {
    const { state, scene } = this;
    if (!state || !scene) return 1;
    return scene.mode === "live" ? Math.max(state.last, scene.ticks) : state.last;
  }

  onFrame(frame) {
    this.frames.received++;
    if (!this.scene) return;
    this.motion.offer(frame);
    this.figures = frame.figures;
    this.lastFrame = frame;
    this.sample(frame, this.robot);
    // A live run sends the figures of all ticks.
    if (!this.live) this.plots.add(frame.tick, plotted(frame.figures));
    // Frames and other messages are not ordered, so that a frame may be of the branch before.
    if (!this.live && this.suitTrails(frame)) this.renderer.trails.store(frame.tick, frame.x, frame.y, frame.z);
  }

  /** Adds a moment of the selected robot to its plots; its knowledge may be of another tick. */
  sample(frame, robot, every = 1) {
    const i = this.selected;
    if (i === null || i >= frame.n) return;
    const far = (j) => Math.hypot(frame.x[j] - frame.x[i], frame.y[j] - frame.y[i], frame.z ? frame.z[j] - frame.z[i] : 0);
    let gap = Infinity;
    for (let j = 0; j < frame.n; j++) if (j !== i) gap = Math.min(gap, far(j) - this.radii[i] - this.radii[j]);
    const known = robot?.tick === frame.tick ? (robot.neighbors ?? []) : [];
    const figures = {
      speed_mps: Math.hypot(frame.vx[i], frame.vy[i], frame.vz?.[i] ?? 0),
      gap_m: gap < Infinity ? gap : null,
      age_s: known.length ? Math.max(...known.map(({ age_s }) => age_s)) : null,
    };
    this.robotPlots.add(frame.tick, plotted(figures, ROBOT_PLOTS), every);
    if (frame === this.lastFrame) this.robotFigures = figures;
  }

  /** Passes figures to the plots; `every` is the distance between ticks. */
  onFigures(tick, values, every) {
    this.plots.add(tick, values, every);
    this.dirty = true;
  }

  /** The branch to compare with: the one that was shown before, else the newest; null for none. */
  get otherBranch() {
    const { state, look } = this;
    const others = (state?.branches ?? []).map(({ number }) => number).filter((number) => number !== state.branch);
    if (!others.length || !look.layers.branch || this.robots > MOST_OTHERS) return null;
    return others.includes(this.shownBefore) ? this.shownBefore : others.at(-1);
  }

  /** Past positions, which the trails lack, or positions in another branch. */
  onTrail(rows, branch = null) {
    const { renderer, motion } = this;
    if (branch !== null) {
      const [[tick, at]] = rows;
      this.other = { branch, tick, at };
      this.askedOther = null;
      this.dirty = true;
      return;
    }
    if (!renderer || !motion.current) return;
    const { trails } = renderer,
      { n } = motion.current;
    for (const [tick, at] of rows) {
      trails.store(tick, at.subarray(0, n), at.subarray(n, 2 * n), at.length > 2 * n ? at.subarray(2 * n) : null);
    }
    trails.answered();
    this.dirty = true;
  }

  suitTrails(frame) {
    const { renderer, look, scene } = this;
    return Boolean(renderer?.suitTrails(frame, look.trails, scene.tick_s));
  }

  onRobot(robot) {
    if (robot.index !== this.selected) return;
    const keys = (robot) => ["plan", "orca", "neighbors"].map((name) => Boolean(robot?.[name]?.length ?? robot?.[name]));
    const changes = `${keys(robot)}` !== `${keys(this.robot)}`;
    this.robot = robot;
    if (this.lastFrame?.tick === robot.tick) this.sample(this.lastFrame, robot);
    if (changes) this.controls.legend();
    this.showWindow();
    this.panelStale = true;
    this.orders.robot();
    this.dirty = true;
  }

  onLinks(tick, pairs) {
    this.links = { tick, pairs };
    this.dirty = true;
  }

  onOrders(orders) {
    this.marked = orders;
    this.controls.mark();
  }

  onMessage(kind, text) {
    this.toast(text, kind);
  }

  onSaved({ name, text, branch, orders }) {
    download(name, new Blob([text], { type: "application/toml" }));
    this.toast(`Saved branch ${branch} with ${orders} ${orders === 1 ? "change" : "changes"} as ${name}.`);
  }

  onConnection(is, inSeconds) {
    if (is === "open") {
      this.banner(this.lack);
      this.askedOther = null;
      if (this.selected !== null) this.send({ do: "select", robot: this.selected });
      if (this.look.layers.links) this.send({ do: "links", on: true });
    } else if (is === "over") {
      this.banner("The run has ended in its terminal. This is its last picture.");
    } else {
      this.banner(
        `No connection to staya view${this.scene ? "" : " yet"}. Is it still running in its terminal? Start it again and ` +
          `open the printed address. The page retries ${inSeconds > 1 ? `in ${inSeconds} s` : "now"}.`,
      );
    }
    this.controls.connection(is);
  }

  onFailed(text) {
    this.banner(text);
    this.controls.connection("failed");
  }

  // Actions of the controls.

  send(message) {
    this.source.send(message);
  }

  order(order) {
    this.send({ do: "order", order });
  }

  get live() {
    return this.scene?.mode === "live";
  }

  /** Whether there is more to show about a robot than its body. */
  get hasMinds() {
    return this.scene?.mode !== "recording" || Boolean(this.scene.minds?.length);
  }

  get timed() {
    return this.scene && this.scene.mode !== "watch";
  }

  seek(tick) {
    if (!this.timed) return;
    this.send({ do: "seek", tick: Math.max(this.state.first, Math.min(this.horizon, Math.round(tick))) });
  }

  /** Opens the moment in the address: `#t=SECONDS&robot=NUMBER`, both optional. */
  openAddress() {
    const wanted = new URLSearchParams(location.hash.slice(1));
    const [seconds, robot] = ["t", "robot"].map((name) => (wanted.has(name) ? Number(wanted.get(name)) : NaN));
    if (seconds >= 0) this.seek(seconds / this.scene.tick_s);
    const index = this.scene.robots.id.indexOf(robot);
    if (index >= 0) this.select(index);
    else if (wanted.has("robot")) this.toast(`There is no robot ${wanted.get("robot")}.`);
  }

  select(index) {
    if (index === this.selected) return;
    this.selected = index;
    this.robot = null;
    this.robotFigures = {};
    this.robotPlots.reset();
    this.follow = this.follow && index !== null;
    if (this.source) this.send({ do: "select", robot: index });
    this.showWindow();
    this.panel.update();
    this.orders.robot();
    this.controls.follow();
    this.controls.legend();
    if (index !== null) this.announce(`Robot ${this.idOf(index)} selected`);
    this.dirty = true;
  }

  showWindow() {
    this.ground.setWindow(this.look.layers.window ? (this.robot?.window ?? null) : null);
  }

  idOf(index) {
    return this.scene.robots.id[index] ?? index;
  }

  /** The robot nearest to a pixel, if it is near enough. */
  pick(px, py, reach = 14) {
    const { motion, camera } = this,
      { current } = motion;
    if (!current) return null;
    let best = null,
      least = Infinity;
    const place = [0, 0, 0],
      m = camera.matrix;
    const n = Math.min(current.n, this.robots);
    for (let i = 0; i < n; i++) {
      // As `camera.project`, without an array per robot.
      const [x, y, z] = motion.place(i, place);
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      if (w <= 0) continue;
      const dx = (((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) / 2) * camera.width - px;
      const dy = ((1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) / 2) * camera.height - py;
      const middle = Math.sqrt(dx * dx + dy * dy);
      // Of several robots at this point, the one with the nearest centre.
      const far = Math.max(0, middle - this.radii[i] * camera.pixelsPerMetre(w)) + 1e-3 * middle;
      if (far < least && far <= reach) {
        best = i;
        least = far;
      }
    }
    return best;
  }

  /** The position of body `i` in the other branch at this tick; null for none. */
  placeInOther(i) {
    const { other, otherBranch } = this;
    const frame = this.motion.current;
    if (!other || other.branch !== otherBranch || (this.state.paused && other.tick !== frame?.tick)) return null;
    const { at } = other,
      n = frame.n;
    return at.length < 2 * n ? null : [at[i], at[n + i], at.length > 2 * n ? at[2 * n + i] : 0];
  }

  /** The goal of body `i`; null for none. */
  targetOf(i) {
    const frame = this.motion.current;
    if (!frame?.tx || i >= frame.n || Number.isNaN(frame.tx[i])) return null;
    return [frame.tx[i], frame.ty[i], frame.tz ? frame.tz[i] : 0];
  }

  /** The scene's bounds and heights, moved and grown so far that all robots are inside; a function
      of the shown moment. */
  get sight() {
    const { scene, motion } = this;
    const [west, south, east, north] = scene.bounds_m;
    const ranges = [[west, east], [south, north], scene.height_m ?? [0, 0]];
    const n = Math.min(motion.current?.n ?? 0, this.robots);
    if (!n || n > MOST_IN_SIGHT) return ranges;
    const [low, high] = [Array(3).fill(Infinity), Array(3).fill(-Infinity)];
    const place = [0, 0, 0];
    for (let i = 0; i < n; i++) {
      motion.place(i, place);
      for (let k = 0; k < 3; k++) {
        low[k] = Math.min(low[k], place[k] - this.radii[i]);
        high[k] = Math.max(high[k], place[k] + this.radii[i]);
      }
    }
    return ranges.map(([from, to], k) => {
      const size = Math.max(to - from, high[k] - low[k]);
      const start = Math.max(high[k] - size, Math.min(low[k], from));
      return k < 2 ? [start, start + size] : [Math.min(from, low[k]), Math.max(to, high[k])];
    });
  }

  /** Shows all robots, and keeps them in sight until the camera is moved by hand. */
  fit() {
    const { scene, camera } = this;
    if (!scene) return;
    this.pointer.touched = false;
    const [[west, east], [south, north], heights] = this.sight;
    const phone = camera.width < 720;
    const left = this.live && !phone ? 58 : 12;
    camera.fit(
      [west, south, east, north],
      heights,
      scene.kind === "space",
      phone ? [8, this.live ? 56 : 8, 8, 44] : [left, 14, 58, 54],
    );
    this.follow = false;
    this.controls?.follow();
  }

  restyle() {
    this.look.read();
    this.ground.setLook(this.look.layers.relief, this.look.css);
    this.plots.stale = this.robotPlots.stale = true;
    this.controls.legend();
    this.panel.update();
    this.dirty = true;
  }

  toast(text, kind = "note") {
    const toast = document.createElement("div");
    toast.className = `toast ${kind}`;
    toast.textContent = text;
    element("toasts").replaceChildren(...[...element("toasts").children].slice(-2), toast);
    setTimeout(() => toast.remove(), TOAST_MS);
  }

  banner(text) {
    element("banner").hidden = text === null;
    element("banner").textContent = text ?? "";
  }

  announce(text) {
    element("announce").textContent = text;
  }


  resize() {
    const { clientWidth: width, clientHeight: height } = element("stage");
    const ratio = this.renderer?.software ? 1 : Math.min(devicePixelRatio || 1, TOP_RATIO);
    const first = this.camera.width === 1;
    this.camera.resize(Math.max(width, 1), Math.max(height, 1));
    for (const layer of [this.ground, this.renderer, this.view]) layer?.resize(width, height, ratio);
    if (first || !this.pointer.touched) this.fit();
    // A resized canvas is empty until it is drawn.
    if (this.scene) this.draw(performance.now());
    this.dirty = true;
  }

  turn(now) {
    const { motion, camera } = this;
    if (!this.scene) return;
    const paused = this.state?.paused ?? false;
    const news = motion.advance(now, paused);
    if (this.follow && this.selected !== null && motion.current)
      camera.centre(...motion.place(this.selected, [0, 0, 0]));
    else if (!this.pointer.touched && (news !== "none" || this.wasMoving)) {
      const sight = this.sight.join();
      if (sight !== this.seen) this.fit();
      this.seen = sight;
    }
    this.askForTrail(now);
    // Messages about a robot come before its frame is taken.
    if (this.panelStale && this.robot) {
      this.panelStale = false;
      this.panel.update();
    }
    if (news === "none" && !this.wasMoving && !this.dirty && camera.version === this.drawnVersion) return;
    this.wasMoving = motion.moving;
    this.dirty = false;
    this.drawnVersion = camera.version;
    this.draw(now);
    if (news !== "none") {
      this.frames.drawn++;
      if (this.source instanceof Live) this.source.seen();
    }
  }

  askForTrail(now) {
    const { motion, renderer, otherBranch: branch } = this;
    const tick = motion.current?.tick;
    if (branch !== null && tick !== undefined && !this.askedOther && this.other?.tick !== tick) {
      this.askedOther = true;
      this.send({ do: "trail", branch, ticks: [tick] });
    }
    if (!this.timed || !motion.current || !this.suitTrails(motion.current)) return;
    const ticks = renderer.trails.missing(tick, now);
    if (ticks.length) this.send({ do: "trail", ticks });
  }

  draw(now) {
    const { motion, camera, look } = this;
    this.view.suit(look);
    this.ground.draw(camera, look.layers.grid);
    this.view.lines();
    this.renderer?.draw(camera, motion, look, this.view);
    this.view.overlay();
    const passed = now - (this.drawnAt ?? now - 1000);
    this.drawnAt = now;
    this.fps += 0.1 * (1000 / Math.max(passed, 1) - this.fps);
    if (now - (this.plottedAt ?? 0) > PLOTS_EVERY_MS) {
      this.plottedAt = now;
      this.plots.draw(motion.current?.tick ?? 0, this.figures, look.css);
      if (this.selected !== null) this.robotPlots.draw(motion.current?.tick ?? 0, this.robotFigures, look.css);
      this.claims.update();
      this.controls.counts();
      this.controls.clock();
    } else {
      // The last frame before a pause gets its figures too.
      clearTimeout(this.plotLater);
      this.plotLater = setTimeout(() => {
        this.dirty = true;
      }, PLOTS_EVERY_MS);
    }
  }
}

const app = new App();

// Interface for tests.
window.staya = {
  send(message) {
    app.send(message);
  },
  get state() {
    return app.state;
  },
  get scene() {
    return app.scene;
  },
  get frames() {
    return { ...app.frames };
  },
  get currentTick() {
    return app.motion.current?.tick ?? null;
  },
  get selected() {
    return app.selected;
  },
  get robot() {
    return app.robot;
  },
  /** Numbers of the robots that wait. */
  get waiting() {
    return app.scene.robots.id.filter((_, i) => app.motion.current.wait[i] !== 255);
  },
  /** Corners of a measuring line, and its text. */
  get ruler() {
    return app.view.ruler && { ...app.view.ruler, text: app.view.rulerText };
  },
  get sentence() {
    return app.mind.sentence;
  },
  get caption() {
    return app.mind.caption;
  },
  get fps() {
    return app.fps;
  },
  get lastFigures() {
    return app.figures;
  },
  project: (x, y, z = 0) => {
    const at = app.camera.project(x, y, z);
    const { left, top } = element("overlay").getBoundingClientRect();
    return at && [at[0] + left, at[1] + top];
  },
  /** Known values of a plot, `[tick, value]`. */
  series: (name) => app.plots.series(name),
  robotSeries: (name) => app.robotPlots.series(name),
  /** The drawn lines of a plot, each a list of [tick, value]. */
  lines: (name) => app.plots.lines(name),
  /** Places of the written labels on the picture: left, top, right, bottom. */
  get labels() {
    return app.view.boxes;
  },
  /** Least radius of robots and size of goals, pixels. */
  get marks() {
    return { robot: app.look.leastRadius, goal: app.look.targetSize };
  },
  /** Position of a robot in the other branch, metres. */
  otherPlace: (i) => app.placeInOther(i),
  get plotted() {
    return [app.plots.first, app.plots.last];
  },
  get links() {
    return app.links && { tick: app.links.tick, pairs: app.links.pairs.length / 2 };
  },
  /** Ticks of the stored positions behind the shown ones. */
  get trail() {
    const { trails } = app.renderer;
    return trails.ticks(app.motion.tick).filter((tick) => trails.rows.has(tick)).reverse();
  },
  /** Whether the picture has all that belongs to the shown moment. */
  get settled() {
    const { motion, renderer } = app;
    if (!motion.current || motion.mix < 1) return false;
    if (app.otherBranch !== null && app.other?.tick !== motion.current.tick) return false;
    return !renderer?.hasTrails || renderer.trails.ticks(motion.tick).every((tick) => renderer.trails.rows.has(tick));
  },
  target: (i) => app.targetOf(i),
  place: (i) => (app.motion.current ? app.motion.place(i, [0, 0, 0]) : null),
};

app.start();
