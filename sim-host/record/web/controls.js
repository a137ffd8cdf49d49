// The top bar, the time line, keyboard shortcuts, layers and the legend.

const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, null];
const PAN_PIXELS = 60;
const NARROW = "(max-width: 720px)";

const element = (id) => document.getElementById(id);

/** Formats seconds of a run. */
export function duration(seconds) {
  if (seconds < 100) return `${seconds.toFixed(1)} s`;
  const whole = Math.floor(seconds);
  const pad = (part) => String(part).padStart(2, "0");
  const hours = Math.floor(whole / 3600);
  return (hours ? `${hours}:${pad(Math.floor(whole / 60) % 60)}` : `${Math.floor(whole / 60)}`) + `:${pad(whole % 60)}`;
}

export class Controls {
  constructor(app) {
    this.app = app;
    this.is = "";
    const click = (id, action) => element(id).addEventListener("click", action);
    click("play", () => this.playOrPause());
    click("undo", () => app.send({ do: "undo" }));
    click("step", () => this.step(1));
    click("back", () => this.step(-1));
    click("zoom-in", () => this.zoom(1.4));
    click("zoom-out", () => this.zoom(1 / 1.4));
    click("measure", () => app.pointer.measure());
    click("fit", () => app.fit());
    click("theme", () => app.look.toggleTheme());
    click("toggle-side", () => this.toggleSide());
    click("open-help", () => element("help").showModal());
    element("timeline").addEventListener("input", () => this.scrub());
    element("timeline").addEventListener("change", () => {
      this.scrubbing = false;
    });
    element("branch").addEventListener("change", () => {
      app.send({ do: "branch", number: Number(element("branch").value) });
    });
    element("speed").addEventListener("change", () => {
      app.send({ do: "speed", x: element("speed").value === "null" ? null : Number(element("speed").value) });
    });
    for (const box of document.querySelectorAll("[data-layer]")) {
      box.addEventListener("change", () => this.setLayer(box.dataset.layer, box.checked));
    }
    element("colour-by").addEventListener("change", () => {
      app.look.colourBy = element("colour-by").value;
      app.restyle();
    });
    element("trail-length").addEventListener("change", () => this.setTrails());
    if (matchMedia(NARROW).matches) {
      this.toggleSide();
      element("legend").open = false;
      element("layers-panel").open = false;
    }
    document.addEventListener("keydown", (event) => this.key(event));
  }

  scene() {
    const { app } = this,
      { scene } = app;
    document.title = `${scene.name} – Staya`;
    element("name").textContent = scene.name;
    const groups = new Set(scene.robots.group).size;
    element("facts").textContent = [
      `${app.robots.toLocaleString("en")} ${app.robots === 1 ? "robot" : "robots"}`,
      groups > 1 ? `${groups} groups` : "",
      `seed ${scene.seed}`,
      `tick ${scene.tick_s} s`,
    ]
      .filter(Boolean)
      .join(" · ");
    element("about-panel").hidden = !scene.description;
    element("about").textContent = scene.description ?? "";
    const root = element("app");
    root.dataset.mode = document.body.dataset.mode = scene.mode;
    root.dataset.kind = scene.kind;
    root.toggleAttribute("data-land", Boolean(scene.land));
    const show = (layer, on) => {
      document.querySelector(`[data-layer="${layer}"]`).parentElement.hidden = !on;
    };
    show("formation", Boolean(scene.formation));
    show("relief", Boolean(scene.land));
    show("window", Boolean(scene.land) && scene.mode !== "recording");
    for (const layer of ["known", "links", "mind"]) show(layer, app.hasMinds);
    element("colour-by").value = app.look.colourBy;
    if (this.trailsFor !== app.robots) {
      this.trailsFor = app.robots;
      element("trail-length").value = app.robots <= 20 ? "0.5" : app.robots <= 1000 ? "0.15" : "0";
    }
    this.setTrails();
    this.showStatus();
  }

  setTrails() {
    const { app } = this,
      { scene } = app;
    if (!scene) return;
    const [x0, y0, x1, y1] = scene.bounds_m;
    // Time in which the fastest robot crosses the scene.
    const across = Math.hypot(x1 - x0, y1 - y0) / Math.max(app.fastest, 1e-3);
    app.look.trails = Number(element("trail-length").value) * across;
    app.dirty = true;
  }

  state(before) {
    const { app } = this,
      { state } = app;
    const playing = !state.paused;
    element("play-icon").setAttribute("href", playing ? "#i-pause" : "#i-play");
    element("play").setAttribute("aria-label", playing ? "Pause" : "Play");
    element("back").disabled = state.tick <= state.first;
    this.branches();
    const { speed } = state,
      select = element("speed");
    const speeds = SPEEDS.includes(speed) ? SPEEDS : [...SPEEDS.slice(0, -1), speed].sort((a, b) => a - b).concat(null);
    if (select.options.length !== speeds.length || !before) {
      select.replaceChildren(
        ...speeds.map((each) => new Option(each === null ? "fastest" : `${each} ×`, String(each))),
      );
    }
    select.value = String(speed);
    const timeline = element("timeline");
    timeline.min = state.first;
    timeline.max = Math.max(app.horizon, state.first + 1);
    this.mark();
    this.clock();
    this.showStatus();
    if (before && before.paused !== state.paused) {
      app.announce(state.paused ? `Paused at tick ${state.tick}${state.at_end ? ", the end" : ""}` : "Playing");
    }
  }

  /** Lists the branches once there are two. */
  branches() {
    const { state, scene } = this.app;
    const branches = state.branches ?? [];
    element("branch-label").hidden = branches.length < 2;
    document.querySelector("[data-layer='branch']").parentElement.hidden = branches.length < 2;
    element("undo").disabled = !branches.some(({ number, orders }) => number === state.branch && orders);
    const key = JSON.stringify(branches.map(({ number, from, orders }) => [number, from, orders]));
    if (key !== this.listed) {
      this.listed = key;
      element("branch").replaceChildren(
        ...branches.map(({ number, from, orders }) => {
          const origin = number > 1 ? `from ${duration(from * scene.tick_s)}, ` : "";
          return new Option(`${number}: ${origin}${orders} ${orders === 1 ? "change" : "changes"}`, String(number));
        }),
      );
    }
    element("branch").value = String(state.branch);
  }

  connection(is) {
    this.is = is;
    this.showStatus();
    if (is !== "open") this.app.announce(is === "over" ? "Ended" : "Connection lost");
  }

  showStatus() {
    const { state, scene } = this.app;
    const [is, text] =
      this.is === "over"
        ? ["", "Ended"]
        : this.is === "lost"
          ? ["lost", "Disconnected"]
          : this.is === "failed"
            ? ["lost", "Damaged"]
            : !scene || !state
              ? ["", "Connecting"]
              : state.at_end && state.paused
                ? ["", "At the end"]
                : state.paused
                  ? ["paused", "Paused"]
                  : ["running", scene.mode === "watch" ? "Watching" : "Running"];
    const chip = element("status");
    chip.dataset.is = is;
    const kind = scene?.mode === "recording" && is !== "lost" ? "Recording · " : "";
    const others = state?.clients > 1 ? ` · ${state.clients} pages` : "";
    chip.textContent = kind + (kind ? text.toLowerCase() : text) + others;
  }

  clock() {
    const { motion, state, scene } = this.app;
    const frame = motion.current;
    if (!state || !frame) return;
    element("time").textContent = duration(frame.time);
    const text = `tick ${frame.tick}`;
    element("tick").textContent = text;
    const timeline = element("timeline");
    if (!this.scrubbing) timeline.value = frame.tick;
    timeline.setAttribute("aria-valuetext", `${text}, ${duration(frame.time)}`);
    // The centre of the knob stays half its width inside the line.
    const share = (tick) => {
      const part = (tick - state.first) / Math.max(timeline.max - state.first, 1);
      return part >= 1 ? "100%" : `calc(7px + (100% - 14px) * ${part})`;
    };
    timeline.style.setProperty("--played", share(this.scrubbing ? Number(timeline.value) : frame.tick));
    timeline.style.setProperty("--known", share(Math.max(state.last, scene.mode === "recording" ? 0 : frame.tick)));
  }

  /** Marks the orders on the timeline, one mark for each tick. */
  mark() {
    const { state, marked, horizon } = this.app;
    if (!state || !marked || (marked === this.marked && horizon === this.markedTo)) return;
    this.marked = marked;
    this.markedTo = horizon;
    const kinds = new Map();
    for (const { tick, order } of marked) kinds.set(tick, (kinds.get(tick) ?? new Set()).add(order.kind));
    element("marks").replaceChildren(
      ...[...kinds].map(([tick, of]) => {
        const mark = document.createElement("i");
        mark.style.left = `${(100 * (tick - state.first)) / Math.max(horizon - state.first, 1)}%`;
        mark.title = `${[...of].join(", ")} at tick ${tick}`;
        return mark;
      }),
    );
  }

  scrub() {
    const { app } = this;
    this.scrubbing = true;
    this.scrubbedTo = Number(element("timeline").value);
    // At most one order per frame.
    if (this.scrubWaits) return;
    this.scrubWaits = true;
    requestAnimationFrame(() => {
      this.scrubWaits = false;
      app.seek(this.scrubbedTo);
    });
  }

  playOrPause() {
    const { app } = this;
    if (app.timed && app.state) app.send({ do: app.state.paused ? "play" : "pause" });
  }

  step(by) {
    const { app } = this;
    if (!app.timed || !app.motion.current) return;
    const tick = app.motion.current.tick;
    if (by > 0 && (app.scene.mode === "recording" || tick >= app.state.last)) app.send({ do: "step" });
    else app.seek(tick + by);
  }

  faster(by) {
    const select = element("speed");
    const next = select.selectedIndex + by;
    if (!this.app.timed || next < 0 || next >= select.options.length) return;
    select.selectedIndex = next;
    select.dispatchEvent(new Event("change"));
    this.app.announce(`Speed ${select.options[next].text}`);
  }

  zoom(factor) {
    this.app.pointer.touched = true;
    this.app.camera.zoom(factor);
  }

  /** On narrow screens panels stay closed until a robot is selected. */
  showPanels() {
    if (matchMedia(NARROW).matches && element("app").classList.contains("side-closed")) this.toggleSide();
  }

  toggleSide() {
    const closed = element("app").classList.toggle("side-closed");
    element("toggle-side").setAttribute("aria-expanded", !closed);
  }

  setLayer(layer, on) {
    const { app } = this;
    app.look.layers[layer] = on;
    if (layer === "links") {
      app.links = null;
      app.send({ do: "links", on });
    }
    if (layer === "relief") app.restyle();
    if (layer === "window") app.showWindow();
    this.legend();
    app.dirty = true;
  }

  follow() {
    const button = document.getElementById("follow");
    button?.setAttribute("aria-pressed", this.app.follow);
  }

  toggleFollow() {
    const { app } = this;
    app.follow = !app.follow && app.selected !== null;
    app.dirty = true;
    this.follow();
  }

  key(event) {
    const { app } = this;
    const typing = event.target.closest("input:not([type='range'], [type='checkbox']), select, dialog");
    if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
    const onControl = event.target.closest("button, input, summary");
    const pan = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const next = (by) => {
      if (app.robots) app.select(((app.selected ?? (by > 0 ? -1 : 0)) + by + app.robots) % app.robots);
    };
    const keys = {
      ".": () => this.step(1),
      ",": () => this.step(-1),
      "[": () => this.faster(-1),
      "]": () => this.faster(1),
      "+": () => this.zoom(1.25),
      "=": () => this.zoom(1.25),
      "-": () => this.zoom(1 / 1.25),
      f: () => app.fit(),
      "?": () => element("help").showModal(),
      n: () => next(1),
      b: () => next(-1),
      c: () => this.toggleFollow(),
      p: () => this.toggleSide(),
      m: () => app.pointer.measure(),
      z: () => element("undo").click(),
      d: () => app.look.toggleTheme(),
      l: () => {
        if (app.hasMinds) document.querySelector("[data-layer='links']").click();
      },
      Escape: () => {
        if (app.pointer.corners.length) app.pointer.choose("polygon");
        else if (app.pointer.drag) app.pointer.cancel();
        else if (app.pointer.measures) app.pointer.measure();
        else if (app.pointer.tool !== "select") app.pointer.choose("select");
        else app.select(null);
      },
    };
    const tools = ["select", "goal", "move", "wall", "circle", "polygon", "erase", "paint"];
    if (app.pointer.corners.length && !onControl) keys.Enter = () => app.pointer.close();
    if (event.key === " " && !(onControl && onControl.id !== "timeline")) this.playOrPause();
    else if (pan && !onControl) {
      app.pointer.touched = true;
      app.follow = false;
      this.follow();
      app.camera.pan(pan[0] * PAN_PIXELS, pan[1] * PAN_PIXELS);
    } else if (/^[1-8]$/.test(event.key)) app.pointer.choose(tools[event.key - 1]);
    else if (keys[event.key]) keys[event.key]();
    else return;
    event.preventDefault();
  }

  /** Builds the legend; `counts` fills in the numbers of robots. */
  legend() {
    const { app } = this,
      { scene, look } = app;
    if (!scene) return;
    const { css, layers } = look;
    const keys = [];
    const key = (draw, text, count = null) => {
      const row = document.createElement("div");
      row.className = "key";
      const canvas = document.createElement("canvas");
      canvas.width = 52;
      canvas.height = 28;
      const context = canvas.getContext("2d");
      context.scale(2, 2);
      draw(context);
      const label = document.createElement("span");
      label.textContent = text;
      row.append(canvas, label);
      if (count !== null) {
        const number = document.createElement("span");
        number.className = "count";
        row.append(number);
        row.dataset.count = count;
      }
      keys.push(row);
    };
    const disc = (colour, ring) => (context) => {
      context.fillStyle = colour;
      context.beginPath();
      context.arc(13, 7, ring ? 4 : 5, 0, 2 * Math.PI);
      context.fill();
      if (!ring) return;
      context.strokeStyle = ring;
      context.lineWidth = 1.6;
      context.beginPath();
      context.arc(13, 7, 6, 0, 2 * Math.PI);
      context.stroke();
    };
    const line =
      (colour, dash = []) =>
      (context) => {
        context.strokeStyle = colour;
        context.lineWidth = 1.8;
        context.setLineDash(dash);
        context.beginPath();
        context.moveTo(2, 7);
        context.lineTo(24, 7);
        context.stroke();
      };
    const area =
      (colour, alpha = 1) =>
      (context) => {
        context.globalAlpha = alpha;
        context.fillStyle = colour;
        context.fillRect(1, 2, 24, 10);
      };
    if (look.colourBy === "mode")
      scene.words.modes.forEach((word, i) => key(disc(look.modeColours[i]), word, `mode:${i}`));
    if (look.colourBy === "wait") {
      scene.words.waits.forEach((word, i) => key(disc(look.waitColours[i]), `waits: ${word}`, `wait:${i}`));
      key(disc(css.grey), "does not wait", "wait:255");
    }
    if (look.colourBy === "group") {
      for (const group of [...new Set(scene.robots.group)].slice(0, 7))
        key(disc(look.numberColours[group % 7]), `group ${group}`);
    }
    key(disc(css.grey, css.orange), "waits", "waits");
    if (scene.intruders.length) key(disc(css.rim, css.purple), "intruder");
    if (layers.targets) {
      key((context) => {
        context.strokeStyle = css.muted;
        context.lineWidth = 2;
        context.beginPath();
        context.moveTo(9, 3);
        context.lineTo(17, 11);
        context.moveTo(17, 3);
        context.lineTo(9, 11);
        context.stroke();
      }, "goal");
    }
    if (layers.velocities) key(line(css.velocity), "velocity", "velocity");
    if (layers.formation && scene.formation) key(line(css.formation), "formation");
    if (app.otherBranch !== null) key(disc("transparent", css.muted), `branch ${app.otherBranch}`);
    if (layers.leaders) key(line(css.leader, [3, 3]), "leader");
    if (layers.links) {
      key(line(css.ok), "packet delivered");
      key(line(css.vermillion), "packet lost");
      key(line(css.orange, [2, 2]), "packet damaged");
    }
    if (layers.known && app.robot?.neighbors)
      key(disc("transparent", css.ghost), "known positions of others");
    if (layers.mind && app.robot?.orca) {
      key(area(css.allowed), "permitted velocities");
      key(line(css.line), "half-planes");
      if (scene.kind !== "space") key(area(css.ghost, 0.2), "velocity obstacles");
    }
    if (app.view.plan().length) key(line(css.selected), "planned moves");
    if (scene.land) {
      key((context) => {
        const shades = context.createLinearGradient(1, 0, 25, 0);
        shades.addColorStop(0, css.landLow);
        shades.addColorStop(1, css.landHigh);
        context.fillStyle = shades;
        context.fillRect(1, 2, 24, 10);
      }, `land, easy to slow (${scene.land.classes})`);
      key(area(css.wall), "wall");
    }
    element("legend-body").replaceChildren(...keys);
    this.counts();
  }

  counts() {
    const { app } = this;
    const frame = app.motion.current;
    if (!frame || !element("legend").open) return;
    const counts = { mode: new Uint32Array(256), wait: new Uint32Array(256) };
    const n = Math.min(frame.n, app.robots);
    for (let i = 0; i < n; i++) {
      counts.mode[frame.mode[i]]++;
      counts.wait[frame.wait[i]]++;
    }
    for (const row of element("legend-body").children) {
      const [kind, index] = row.dataset.count?.split(":") ?? [];
      if (!kind) continue;
      const text =
        kind === "velocity"
          ? app.look.crowded
            ? "when closer"
            : `in ${+app.look.velocitySeconds.toPrecision(2)} s`
          : kind === "waits"
            ? n - counts.wait[255]
            : counts[kind][index];
      if (row.lastChild.textContent !== String(text)) row.lastChild.textContent = text;
      row.hidden = (kind === "mode" || kind === "wait") && text === 0;
    }
  }
}
