// Details of the selected robot.

import { plotVelocities } from "staya/velocity.js";
import { metres } from "staya/view.js";

const MOST_NEIGHBORS = 32;
const REBOOT_S = 2;

/** Creates an element with a class and children; strings become text. */
function make(tag, className, ...children) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  made.append(...children);
  return made;
}

export class Panel {
  constructor(app) {
    this.app = app;
    this.panel = document.getElementById("robot-panel");
    this.body = document.getElementById("robot-body");
    this.build();
  }

  /** Creates the elements once and later fills in changes only, so that buttons keep the focus. */
  build() {
    const { app } = this;
    const button = (text, title, action) => {
      const made = make("button", "", text);
      made.type = "button";
      made.title = title;
      made.addEventListener("click", action);
      return made;
    };
    const order = (kind, fields) => () => app.order({ kind, robot: app.selected, ...fields });
    this.follow = button("Follow", "Keep it in the middle (c)", () => app.controls.toggleFollow());
    this.follow.id = "follow";
    this.follow.setAttribute("aria-pressed", "false");
    this.down = button("Take down", "Turn the robot's computer off", order("down", { for_s: null }));
    this.reboot = button(
      "Reboot",
      `Turn the robot's computer off and restart it after ${REBOOT_S} s`,
      order("down", { for_s: REBOOT_S }),
    );
    for (const each of [this.down, this.reboot]) each.classList.add("live-only");
    this.sentence = make("p", "sentence");
    this.facts = make("dl", "grid-facts");
    this.velocities = make("section");
    this.plot = make("canvas");
    this.plot.id = "velocity-plot";
    this.plot.setAttribute("role", "img");
    this.plot.setAttribute(
      "aria-label",
      "Permitted velocities, the preferred velocity and the chosen one",
    );
    new ResizeObserver(() => app.robot?.orca && this.showVelocities(app.robot)).observe(this.plot);
    this.key = make("p", "caption");
    this.velocityTitle = make("h3", "");
    this.velocities.append(this.velocityTitle, this.plot, this.key);
    this.plots = make("section");
    this.plots.id = "robot-plots";
    this.neighbors = make("section");
    this.neighborTitle = make("h3", "");
    this.rows = make("tbody");
    const head = make(
      "thead",
      "",
      make("tr", "", ...["Robot", "distance", "age", "error"].map((text) => make("th", "", text))),
    );
    this.neighbors.append(this.neighborTitle, make("div", "scroll", make("table", "table", head, this.rows)));
    this.rows.addEventListener("click", (event) => {
      const index = event.target.closest("tr")?.dataset.index;
      if (index !== undefined) app.select(Number(index));
    });
    this.eventsPart = make("section");
    this.events = make("ul", "events");
    this.eventsPart.append(make("h3", "", "Events"), make("div", "scroll", this.events));
    this.lack = make("p", "muted");
    this.body.append(
      this.sentence,
      this.lack,
      make("div", "actions", this.follow, this.reboot, this.down),
      this.facts,
      this.velocities,
      this.plots,
      this.neighbors,
      this.eventsPart,
    );
  }

  update() {
    const { app } = this;
    const opened = this.panel.hidden && app.selected !== null;
    this.panel.hidden = app.selected === null;
    if (app.selected === null) return;
    if (opened) this.panel.open = true;
    document.getElementById("robot-title").textContent = `Robot ${app.idOf(app.selected)}`;
    const { robot } = app;
    this.sentence.textContent = app.mind.sentence ?? "";
    const minds = app.scene.mode === "recording" && !robot?.neighbors ? (app.scene.minds ?? []) : [];
    this.lack.hidden = !minds.length;
    this.lack.textContent = `This page contains the knowledge of ${minds.length > 1 ? "robots" : "robot"} ${minds.map((i) => app.idOf(i)).join(", ")}.`;
    this.showFacts(robot);
    this.velocities.hidden = !robot?.orca;
    if (robot?.orca) this.showVelocities(robot);
    this.neighbors.hidden = !robot?.neighbors;
    if (robot?.neighbors) this.showNeighbors(robot.neighbors);
    this.eventsPart.hidden = !robot?.events?.length;
    if (robot?.events) this.showEvents(robot.events);
  }

  showFacts(robot) {
    const { app } = this,
      { scene, look } = app;
    const frame = app.motion.current,
      i = app.selected;
    const facts = [];
    const fact = (name, ...value) => facts.push(make("dt", "", name), make("dd", "", ...value));
    if (!robot || !frame) {
      this.facts.replaceChildren();
      return;
    }
    const swatch = make("i");
    swatch.style.background = look.modeColours[robot.mode] ?? "";
    fact(
      "mode",
      make("span", "tag", swatch, robot.up === false ? "down" : (scene.words.modes[robot.mode] ?? String(robot.mode))),
    );
    if (robot.wait !== null && robot.wait !== undefined)
      fact("waits for", scene.words.waits[robot.wait] ?? String(robot.wait));
    if (robot.leader !== null && robot.leader !== undefined) fact("leader", `robot ${app.idOf(robot.leader)}`);
    const speed = (v) => `${Math.hypot(...v).toFixed(3)} m/s`;
    if (i < frame.n) {
      const place = [frame.x[i], frame.y[i], ...(frame.z ? [frame.z[i]] : [])].map(
        (part, k) => part + scene.origin_m[k],
      );
      fact("place", `${place.map((part) => part.toFixed(2)).join(", ")} m`);
      fact("speed", speed([frame.vx[i], frame.vy[i], frame.vz ? frame.vz[i] : 0]));
    }
    if (robot.wish) fact("preferred speed", speed(robot.wish));
    const target = app.targetOf(i);
    if (target && i < frame.n) {
      fact(
        "distance to goal",
        metres(Math.hypot(target[0] - frame.x[i], target[1] - frame.y[i], frame.z ? target[2] - frame.z[i] : 0)),
      );
    }
    if (robot.boot !== undefined) fact("starts", String(robot.boot));
    for (const [name, value] of robot.facts ?? []) fact(name, value);
    if (robot.sent !== undefined) fact("bytes sent, received", `${thousands(robot.sent)}, ${thousands(robot.heard)}`);
    const { device } = robot;
    if (device) {
      if (device.instructions !== null) {
        fact("instructions", `${thousands(device.instructions)}, at most ${thousands(device.most_instructions)}`);
      } else if (device.ticks !== null) fact("clock ticks", thousands(device.ticks));
      fact("stack", `at most ${thousands(device.stack)} bytes`);
      fact("mismatches", `${thousands(device.mismatches)} in ${thousands(device.steps)} steps`);
      if (device.resets) fact("resets", thousands(device.resets));
    }
    this.facts.replaceChildren(...facts);
  }

  showVelocities({ orca, index }) {
    const { app } = this,
      { css } = app.look;
    const frame = app.motion.current;
    this.velocityTitle.textContent = `Permitted velocities${app.mind.isSlice ? " with the chosen climb (a slice)" : ""}`;
    const velocity = frame && index < frame.n ? [frame.vx[index], frame.vy[index]] : [0, 0];
    plotVelocities(this.plot, orca, velocity, css);
    const key = (colour, text) => {
      const sign = make("b", "", "—");
      sign.style.color = colour;
      return make("span", "", sign, ` ${text}`);
    };
    this.key.replaceChildren(
      key(css.chosen, "chosen"),
      key(css.preferred, "preferred"),
      key(css.muted, "actual"),
      key(css.line, `${orca.lines.length} half-planes`),
    );
  }

  showNeighbors(neighbors) {
    const { app } = this;
    const frame = app.motion.current;
    this.neighborTitle.textContent = neighbors.length ? `${neighbors.length} known robots` : "No known robots";
    const rows = neighbors
      .slice(0, MOST_NEIGHBORS)
      .map(({ id, index, position_m: place, age_s: age, error_m: error }) => {
        const far = frame ? Math.hypot(place[0] - frame.x[app.selected], place[1] - frame.y[app.selected]) : 0;
        const row = make(
          "tr",
          "",
          ...[String(id), metres(far), `${age.toFixed(age < 10 ? 2 : 0)} s`, error === null ? "–" : metres(error)].map(
            (text) => make("td", "", text),
          ),
        );
        if (index !== null) row.dataset.index = index;
        return row;
      });
    this.rows.replaceChildren(...rows);
  }

  showEvents(events) {
    const key = `${this.app.selected}:${events.length}:${events.at(-1)?.tick}:${events.at(-1)?.text}`;
    if (key === this.shownEvents) return;
    this.shownEvents = key;
    this.events.replaceChildren(
      ...events.toReversed().map(({ tick, text }) => make("li", "", make("span", "", String(tick)), text)),
    );
  }
}

function thousands(n) {
  return Math.round(n).toLocaleString("en").replace(/,/g, "\u202f");
}
