// Colours and layers from style.css, in the formats of canvas and WebGL.

import { rgb } from "staya/ground.js";

const NAMED = {
  idle: "grey",
  forming: "sky",
  cruise: "blue",
  hold: "orange",
  arrived: "green",
  down: "vermillion",
  passive: "purple",
  team: "purple",
  stopped: "sky",
  route: "vermillion",
  radio: "blue",
  turn: "orange",
  robots: "yellow",
  goal_taken: "green",
};
// In the order of the colours of saved pictures.
const NUMBERED = ["blue", "vermillion", "green", "purple", "orange", "sky", "yellow"];
const CSS = {
  paper: "paper",
  grid: "grid",
  gridStrong: "grid-strong",
  gridOnLand: "grid-on-land",
  border: "border",
  landLow: "land-low",
  landHigh: "land-high",
  wall: "wall",
  solid: "solid",
  solidEdge: "solid-edge",
  fence: "fence",
  ink: "ink",
  muted: "muted",
  label: "label",
  halo: "halo",
  selected: "selected",
  ghost: "ghost",
  accent: "accent",
  ok: "ok",
  warn: "warn",
  bad: "bad",
  violet: "violet",
  cursor: "muted",
  axis: "edge",
  line: "bad",
  forbidden: "forbidden",
  allowed: "allowed",
  preferred: "accent",
  chosen: "ink",
  formation: "formation",
  leader: "leader",
  vermillion: "vermillion",
  blue: "blue",
  yellow: "yellow",
  orange: "orange",
  rim: "rim",
  trail: "trail",
  velocity: "velocity",
  grey: "grey",
  purple: "purple",
};

function vector(hex, alpha = 1) {
  return new Float32Array([...rgb(hex).map((part) => (part / 255) * alpha), alpha]);
}

/** `#rrggbb` as the bytes of a vertex attribute. */
export function packed(hex, alpha = 1) {
  const [r, g, b] = rgb(hex);
  return ((Math.round(alpha * 255) << 24) | (b << 16) | (g << 8) | r) >>> 0;
}

const THEME = "staya-theme";

/** The last chosen theme, or undefined. Views have changing ports, and storage is separate for each port while cookies
    are not; files have storage only. */
function chosenTheme() {
  const known = (theme) => (["dark", "light"].includes(theme) ? theme : undefined);
  try {
    return known(document.cookie.match(`${THEME}=(\\w+)`)?.[1]) ?? known(localStorage.getItem(THEME));
  } catch {
    // Storage is disabled in the browser.
    return undefined;
  }
}

function rememberTheme(theme) {
  try {
    document.cookie = `${THEME}=${theme}; path=/; max-age=31536000; samesite=strict`;
    localStorage.setItem(THEME, theme);
  } catch {
    // Storage is disabled in the browser.
  }
}

export class Look {
  constructor() {
    this.layers = {};
    for (const box of document.querySelectorAll("[data-layer]")) this.layers[box.dataset.layer] = box.checked;
    this.colourBy = "mode";
    this.trails = 0;
    this.palette = new Float32Array(64);
    // Updated for each frame by the zoom: CSS pixels, and the seconds of travel that an arrow
    // shows.
    this.leastRadius = 4;
    this.targetSize = 6;
    this.targetAlpha = 1;
    this.velocitySeconds = 1;
    this.crowded = false;
    this.words = { modes: [], waits: [] };
    const wish = matchMedia("(prefers-color-scheme: dark)");
    const theme = () => chosenTheme() ?? (wish.matches ? "dark" : "light");
    this.dark = theme() === "dark";
    wish.addEventListener("change", () => {
      this.dark = theme() === "dark";
      this.onTheme?.();
    });
    this.read();
  }

  toggleTheme() {
    this.dark = !this.dark;
    rememberTheme(this.dark ? "dark" : "light");
    this.onTheme?.();
  }

  get velocities() {
    return this.layers.velocities && !this.crowded;
  }

  get targets() {
    return this.layers.targets && !this.crowded;
  }

  /** The colour of a body, as the GPU draws it. */
  colourOf(frame, i, { robots, groups }) {
    if (i >= robots) return this.css.purple;
    if (this.colourBy === "robot") return this.numberColours[i % 7];
    if (this.colourBy === "group") return this.numberColours[groups[i] % 7];
    const of = this.colourBy === "wait" ? frame.wait[i] : frame.mode[i];
    const colours = this.colourBy === "wait" ? this.waitColours : this.modeColours;
    return of === 255 ? this.css.grey : (colours[Math.min(of, 12) % Math.max(colours.length, 1)] ?? this.css.grey);
  }

  /** Reads the colours again after a change of the theme, the words or the meaning of colours. */
  read() {
    document.documentElement.dataset.theme = this.dark ? "dark" : "light";
    const style = getComputedStyle(document.documentElement);
    const value = (name) => style.getPropertyValue(`--${name}`).trim();
    this.css = Object.fromEntries(Object.entries(CSS).map(([name, property]) => [name, value(property)]));
    this.colours = {
      rim: vector(this.css.rim),
      waiting: vector(this.css.orange),
      velocity: vector(this.css.velocity),
      trail: vector(this.css.trail, 0.8),
    };
    this.modeColours = this.words.modes.map((word, i) => value(NAMED[word] ?? NUMBERED[i % 7]));
    this.waitColours = this.words.waits.map((word, i) => value(NAMED[word] ?? NUMBERED[i % 7]));
    this.numberColours = NUMBERED.map(value);
    const entries = { mode: this.modeColours, wait: this.waitColours }[this.colourBy] ?? this.numberColours;
    for (let i = 0; i < 13; i++)
      this.palette.set(vector(entries[i % Math.max(entries.length, 1)] ?? this.css.grey), 4 * i);
    this.palette.set(vector(this.css.solidEdge), 52);
    this.palette.set(vector(this.css.grey), 56);
    this.palette.set(vector(this.css.purple), 60);
  }
}
