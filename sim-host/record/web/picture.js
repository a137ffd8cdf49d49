// Saves the picture as PNG, as SVG with all lines and texts as shapes, and as a movie.

import { duration } from "staya/controls.js";
import { niceStep } from "staya/ground.js";
import { metres } from "staya/view.js";

const SCALE_PIXELS = 80;
/** Formats of movies, the best first; a browser writes some of them. */
const MOVIES = ["video/webm;codecs=vp9", "video/webm", "video/mp4"];
const MOVIE_BITS_PER_SECOND = 8e6;

/** Saves a blob as a file. */
export function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export class Picture {
  constructor(app) {
    this.app = app;
    document.getElementById("save-png").addEventListener("click", () => this.png());
    document.getElementById("save-svg").addEventListener("click", () => this.svg());
    this.button = document.getElementById("save-movie");
    this.button.addEventListener("click", () => (this.recorder ? this.recorder.stop() : this.movie()));
  }

  save(kind, blob) {
    const { app } = this;
    const name = `${app.scene.name}-${app.motion.current?.tick ?? 0}.${kind}`;
    download(name, blob);
    app.toast(`Saved as ${name}.`);
  }

  png() {
    const { app } = this;
    if (!app.scene) return;
    // WebGL keeps a picture only until the next task.
    app.draw(performance.now());
    const canvas = document.createElement("canvas");
    this.layers(canvas);
    canvas.toBlob((blob) => this.save("png", blob), "image/png");
  }

  /** Copies what was drawn in this task, with the caption; the canvas keeps the size that it has. */
  layers(canvas) {
    const layers = ["ground", "bodies", "overlay"].map((id) => document.getElementById(id));
    if (!this.recorder) [canvas.width, canvas.height] = [layers[0].width, layers[0].height];
    const context = canvas.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    for (const layer of layers) context.drawImage(layer, 0, 0, canvas.width, canvas.height);
    const ratio = canvas.width / this.app.camera.width;
    context.scale(ratio, ratio);
    this.caption(context);
  }

  /** Records what the page shows, from playing on until the run pauses or the button is pressed. */
  movie() {
    const { app } = this;
    if (!app.scene) return;
    const kind = MOVIES.find((kind) => window.MediaRecorder?.isTypeSupported(kind));
    if (!kind) return app.toast("This browser records no movies. Save pictures, or use staya run --gif.");
    const canvas = document.createElement("canvas");
    app.draw(performance.now());
    this.layers(canvas);
    const options = { mimeType: kind, videoBitsPerSecond: MOVIE_BITS_PER_SECOND };
    const recorder = (this.recorder = new MediaRecorder(canvas.captureStream(), options));
    const parts = [];
    recorder.addEventListener("dataavailable", ({ data }) => parts.push(data));
    recorder.addEventListener("stop", () => {
      this.recorder = null;
      this.button.textContent = "Movie";
      this.save(kind.match(/\/(\w+)/)[1], new Blob(parts, { type: kind }));
    });
    recorder.start();
    this.button.textContent = "End movie";
    if (app.state.paused) document.getElementById("play").click();
    let hasPlayed = false;
    const paint = () => {
      if (recorder.state !== "recording") return;
      app.draw(performance.now());
      this.layers(canvas);
      hasPlayed ||= !app.state.paused;
      if (hasPlayed && app.state.paused) recorder.stop();
      else requestAnimationFrame(paint);
    };
    requestAnimationFrame(paint);
  }

  svg() {
    const { app } = this;
    if (!app.scene) return;
    const context = new SvgContext(app.camera.width, app.camera.height);
    const layer = (drawer, draw) => {
      const { context: canvas } = drawer;
      drawer.context = context;
      draw();
      drawer.context = canvas;
    };
    app.view.suit(app.look);
    app.ground.drawn = "";
    layer(app.ground, () => app.ground.draw(app.camera, app.look.layers.grid));
    app.ground.drawn = "";
    app.view.lines();
    this.bodies(context);
    layer(app.view, () => app.view.overlay());
    this.caption(context);
    this.save("svg", new Blob([context.text(app.scene.name)], { type: "image/svg+xml" }));
  }

  /** Writes the scale, the scenario and the moment into the corner. */
  caption(context) {
    const { app } = this,
      { camera, scene, look, motion } = app;
    const perMetre = camera.pixelsPerMetre(camera.space ? camera.distance : 1);
    const length = niceStep(SCALE_PIXELS / perMetre),
      bottom = camera.height - 14;
    context.strokeStyle = look.css.label;
    context.lineWidth = 1.5;
    context.beginPath();
    for (const [x, y] of [[0, -4], [0, 0], [1, 0], [1, -4]])
      context.lineTo(14 + x * length * perMetre, bottom + y);
    context.stroke();
    const place = `${scene.name}, seed ${scene.seed}, ${duration(motion.current?.time ?? 0)}`;
    app.view.write(`${metres(length)} · ${place}`, 14, bottom - 9, "left", 11, context);
  }

  /** Draws what the GPU draws: trails, goals, velocities, bodies, and lines below and above them. */
  bodies(context) {
    const { app } = this,
      { camera, look, motion, view, renderer } = app;
    const frame = motion.current;
    if (!frame) return;
    const at = (i) => camera.project(...motion.place(i, [0, 0, 0]));
    const line = (points, colour, width, dash = []) => {
      const seen = points.map((point) => camera.project(...point));
      if (seen.some((point) => !point)) return;
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.setLineDash(dash);
      context.beginPath();
      for (const [x, y] of seen) context.lineTo(x, y);
      context.stroke();
      context.setLineDash([]);
    };
    const lines = ({ floats, words, count }) => {
      for (let at = 0; at < 12 * count; at += 12) {
        const [width, dash] = [floats[at + 7], floats[at + 8]];
        const ends = [floats.slice(at, at + 3), floats.slice(at + 3, at + 6)];
        line(ends, inked(words[at + 6]), width, dash ? [dash, dash] : []);
      }
    };
    const robots = Math.min(frame.n, app.robots);
    if (renderer?.hasTrails) this.trails(context, renderer.trails.known(motion));
    lines(view.below);
    context.globalAlpha = look.targetAlpha;
    for (let i = 0; look.targets && i < robots; i++) {
      const target = app.targetOf(i),
        seen = target && camera.project(...target);
      if (!seen) continue;
      const [[x, y], size] = [seen, 0.7 * look.targetSize];
      context.strokeStyle = look.colourOf(frame, i, app);
      context.lineWidth = 2;
      context.beginPath();
      context.moveTo(x - size, y - size);
      context.lineTo(x + size, y + size);
      context.moveTo(x + size, y - size);
      context.lineTo(x - size, y + size);
      context.stroke();
    }
    context.globalAlpha = 1;
    for (let i = 0; look.velocities && i < frame.n; i++) {
      const from = motion.place(i, [0, 0, 0]);
      const by = [frame.vx[i], frame.vy[i], frame.vz?.[i] ?? 0];
      const to = from.map((v, k) => v + by[k] * look.velocitySeconds);
      if (by.some((v) => v !== 0)) line([from, to], look.css.velocity, 1.6);
    }
    const order = Array.from({ length: frame.n }, (_, i) => [i, at(i)]).filter(([, seen]) => seen);
    if (camera.space) order.sort(([, a], [, b]) => b[2] - a[2]);
    for (const [i, [x, y, w]] of order) {
      const radius = view.pixelRadius(i, [x, y, w]);
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fillStyle = look.colourOf(frame, i, app);
      context.fill();
      if (radius > 4.5) {
        context.strokeStyle = look.css.rim;
        context.lineWidth = 1.4;
        context.stroke();
      }
      if (i < robots && radius > 3 && frame.wait[i] !== 255) {
        context.beginPath();
        context.arc(x, y, radius + 1.8, 0, 2 * Math.PI);
        context.strokeStyle = look.css.orange;
        context.lineWidth = 2;
        context.stroke();
      }
      const speed = Math.hypot(frame.vx[i], frame.vy[i]);
      if (camera.space || radius <= 4.5 || i >= robots || speed === 0) continue;
      const [ux, uy] = [(frame.vx[i] / speed) * radius, (-frame.vy[i] / speed) * radius];
      context.beginPath();
      for (const [ahead, beside] of [[0.68, 0], [-0.42, 0.57], [-0.17, 0], [-0.42, -0.57]])
        context.lineTo(x + ahead * ux - beside * uy, y + ahead * uy + beside * ux);
      context.closePath();
      context.fillStyle = look.css.rim;
      context.fill();
    }
    lines(view.above);
  }

  /** Draws trails, which fade with age; the segments of one age and colour are one path. */
  trails(context, snapshots) {
    const { camera, look, motion } = this.app;
    const frame = motion.current;
    const own = look.colourBy === "robot";
    const places = [...snapshots, Array.from({ length: frame.n }, (_, i) => motion.place(i, [0, 0, 0])).flat()];
    const colours = own ? look.numberColours : [look.css.trail];
    context.lineWidth = own ? 2 : 1.3;
    for (let step = 0; step + 1 < places.length; step++) {
      const age = 1 - step / (places.length - 1);
      context.globalAlpha = (own ? 1 : 0.8) * (0.85 - 0.77 * age);
      colours.forEach((colour, k) => {
        context.strokeStyle = colour;
        context.beginPath();
        for (let i = k; i < frame.n; i += colours.length) {
          const [from, to] = [places[step], places[step + 1]].map((at) => camera.project(...at.slice(3 * i, 3 * i + 3)));
          if (!from || !to) continue;
          context.moveTo(from[0], from[1]);
          context.lineTo(to[0], to[1]);
        }
        context.stroke();
      });
    }
    context.globalAlpha = 1;
  }
}

/** A colour 0xAABBGGRR in CSS. */
function inked(word) {
  return `rgb(${word & 255} ${(word >> 8) & 255} ${(word >> 16) & 255} / ${(word >>> 24) / 255})`;
}

const rounded = (x) => String(Math.round(x * 100) / 100);
const escaped = (text) => text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);

/** The part of a canvas's 2D context that the page uses, which writes SVG. */
class SvgContext {
  constructor(width, height) {
    Object.assign(this, { width, height, parts: [], path: [], dash: [] });
    Object.assign(this, { fillStyle: "#000", strokeStyle: "#000", lineWidth: 1, globalAlpha: 1 });
    Object.assign(this, { font: "11px sans-serif", textAlign: "left", lineCap: "butt", lineJoin: "miter" });
  }

  text(title) {
    const size = `width="${this.width}" height="${this.height}" viewBox="0 0 ${this.width} ${this.height}"`;
    return (
      `<svg xmlns="http://www.w3.org/2000/svg" ${size} font-family="system-ui, sans-serif">\n` +
      `<title>${escaped(title)}</title>\n${this.parts.join("\n")}\n</svg>\n`
    );
  }

  setTransform() {}

  clearRect() {}

  setLineDash(dash) {
    this.dash = dash;
  }

  beginPath() {
    this.path = [];
  }

  closePath() {
    this.path.push("Z");
  }

  moveTo(x, y) {
    this.path.push(`M${rounded(x)} ${rounded(y)}`);
  }

  lineTo(x, y) {
    this.path.push(`${this.path.length ? "L" : "M"}${rounded(x)} ${rounded(y)}`);
  }

  /** A whole circle; the page draws no other arcs. */
  arc(x, y, radius) {
    const [r, across] = [rounded(radius), rounded(2 * radius)];
    this.path.push(`M${rounded(x - radius)} ${rounded(y)}a${r} ${r} 0 1 0 ${across} 0a${r} ${r} 0 1 0 -${across} 0`);
  }

  rect(x, y, width, height) {
    this.path.push(`M${rounded(x)} ${rounded(y)}h${rounded(width)}v${rounded(height)}h${rounded(-width)}Z`);
  }

  /** Colour and opacity as attributes, since not all programs read colours with both. */
  paint(name, style) {
    const long = style.match(/^(#[0-9a-f]{6})([0-9a-f]{2})$/i);
    const slashed = style.match(/^rgb\((\d+) (\d+) (\d+) \/ ([\d.e-]+)\)$/);
    const [colour, alpha] = long
      ? [long[1], parseInt(long[2], 16) / 255]
      : slashed
        ? [`rgb(${slashed.slice(1, 4).join(",")})`, Number(slashed[4])]
        : [style === "transparent" ? "none" : style, 1];
    const opacity = alpha * this.globalAlpha;
    return ` ${name}="${escaped(colour)}"${opacity < 1 ? ` ${name}-opacity="${rounded(opacity)}"` : ""}`;
  }

  get pen() {
    const dash = this.dash.length ? ` stroke-dasharray="${this.dash.join(" ")}"` : "";
    const ends = ` stroke-linecap="${this.lineCap}" stroke-linejoin="${this.lineJoin}"`;
    return `${this.paint("stroke", this.strokeStyle)} stroke-width="${rounded(this.lineWidth)}"${ends}${dash}`;
  }

  fill() {
    this.parts.push(`<path d="${this.path.join("")}"${this.paint("fill", this.fillStyle)}/>`);
  }

  stroke() {
    this.parts.push(`<path d="${this.path.join("")}" fill="none"${this.pen}/>`);
  }

  fillRect(x, y, width, height) {
    const kept = this.path;
    this.path = [];
    this.rect(x, y, width, height);
    this.fill();
    this.path = kept;
  }

  strokeRect(x, y, width, height) {
    const kept = this.path;
    this.path = [];
    this.rect(x, y, width, height);
    this.stroke();
    this.path = kept;
  }

  drawImage(image, x, y, width, height) {
    const place = `x="${rounded(x)}" y="${rounded(y)}" width="${rounded(width)}" height="${rounded(height)}"`;
    this.parts.push(`<image ${place} preserveAspectRatio="none" href="${image.toDataURL()}"/>`);
  }

  measureText(text) {
    measure.font = this.font;
    return measure.measureText(text);
  }

  letters(text, x, y, attributes) {
    const [weight, size] = this.font.match(/^(?:(\d+) )?([\d.]+)px/).slice(1);
    const anchor = { left: "start", center: "middle", right: "end" }[this.textAlign];
    const font = `font-size="${size}" font-weight="${weight ?? 400}" text-anchor="${anchor}"`;
    this.parts.push(`<text x="${rounded(x)}" y="${rounded(y)}" ${font}${attributes}>${escaped(text)}</text>`);
  }

  fillText(text, x, y) {
    this.letters(text, x, y, this.paint("fill", this.fillStyle));
  }

  strokeText(text, x, y) {
    this.letters(text, x, y, ` fill="none"${this.pen}`);
  }
}

const measure = document.createElement("canvas").getContext("2d");
