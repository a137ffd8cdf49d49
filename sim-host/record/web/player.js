// Plays a recording: handles the page's orders and answers like a server.

import { Recording } from "staya/recording.js";
import { fromBase64, pairsOf } from "staya/frame.js";
import { plotted } from "staya/plots.js";

// Recordings up to this size in bytes are read completely for the plots; of larger ones only played
// parts are plotted.
const READ_THROUGH = 1 << 30;
const STATE_EVERY_MS = 500;
// Initial playback speed, ticks per second at least.
const LEAST_TICKS = 10;
const FASTEST_S = 8;

export class Player {
  constructor(element, listener) {
    this.element = element;
    this.listener = listener;
    this.paused = true;
    this.speed = 1;
    this.tick = 0;
    this.selected = null;
    this.busy = false;
    this.wanted = null;
  }

  async start() {
    try {
      this.recording = await Recording.open(fromBase64(this.element.textContent.trim()));
      this.element.remove();
      this.tick = this.recording.first;
      await this.show(this.tick);
      const { tick_s: tickS } = this.shownScene;
      this.speed = Math.max(1, 10 ** Math.round(Math.log10(LEAST_TICKS * tickS)));
    } catch (error) {
      this.listener.onFailed(
        `The recording in this page cannot be read: ${error.message}. Make the page again with "staya page".`,
      );
      return;
    }
    const { damage, last } = this.recording;
    if (damage) this.listener.onMessage("error", `The recording is shown up to tick ${last}: ${damage}.`);
    this.played = performance.now();
    this.said = 0;
    const turn = (now) => {
      requestAnimationFrame(turn);
      this.advance(now);
    };
    requestAnimationFrame(turn);
    this.play();
    this.recording.orders().then(
      (orders) => this.listener.onOrders(orders),
      () => {},
    );
    this.readThrough();
  }

  get atEnd() {
    return this.tick >= this.recording.last;
  }

  play() {
    if (this.atEnd) this.seek(this.recording.first);
    this.paused = false;
    this.time = null;
    this.say();
  }

  say() {
    const { first, last } = this.recording;
    const { paused, speed, tick } = this;
    this.listener.onState({ type: "state", paused, speed, tick, first, last, clients: 1, at_end: tick >= last });
  }

  /** Shows `tick` once its block is unpacked. Of several requests only the last counts. */
  seek(tick) {
    this.wanted = Math.max(this.recording.first, Math.min(this.recording.last, Math.round(tick)));
    this.time = null;
    this.fetch();
  }

  async fetch() {
    if (this.busy) return;
    this.busy = true;
    try {
      while (this.wanted !== null) {
        const tick = this.wanted;
        this.wanted = null;
        this.awaited = tick;
        await this.show(tick);
        this.say();
      }
    } catch (error) {
      this.paused = true;
      this.listener.onMessage("error", `The recording cannot be shown from here on: ${error.message}.`);
      this.say();
    }
    this.busy = false;
  }

  async show(tick) {
    const { frame, scene, next, minds } = await this.recording.at(tick);
    if (scene !== this.shownScene) {
      this.shownScene = scene;
      this.listener.onScene({ ...scene, mode: "recording" });
    }
    this.tick = frame.tick;
    this.next = next;
    this.listener.onFrame(frame);
    this.tell(frame, minds);
  }

  /** Sends the recorded data of the selected robot. */
  tell(frame, minds) {
    const index = this.selected;
    const mind = minds.find((mind) => mind.index === index);
    this.listener.onLinks(frame.tick, mind ? pairsOf(mind.links) : new Uint32Array(0));
    if (index === null || index >= frame.n) return;
    this.listener.onRobot(mind ?? {
      index,
      id: this.shownScene.robots.id[index] ?? null,
      tick: frame.tick,
      mode: frame.mode[index],
      wait: frame.wait[index] === 255 ? null : frame.wait[index],
      leader: frame.leader[index] === 0xffffffff ? null : frame.leader[index],
    });
  }

  advance(now) {
    const passed = Math.min(now - this.played, 250) / 1000;
    this.played = now;
    if (this.paused || this.busy) return;
    if (this.atEnd) {
      this.paused = true;
      this.say();
      return;
    }
    const tickS = this.shownScene.tick_s;
    // Without a speed limit the whole recording plays in a few seconds, with all frames.
    const rate = this.speed === null ? (this.recording.last - this.recording.first) / FASTEST_S : this.speed / tickS;
    this.time = (this.time ?? this.tick) + passed * rate;
    const ahead = this.speed === null ? Math.max(this.next, Math.floor(this.time)) : Math.floor(this.time);
    if (this.next !== null && ahead >= this.next) {
      this.wanted = ahead;
      this.fetch();
    }
    if (now - this.said > STATE_EVERY_MS) {
      this.said = now;
      this.say();
    }
  }

  /** Fills the plots from the whole recording, one block at a time. */
  async readThrough() {
    if (this.recording.size > READ_THROUGH) return;
    const count = this.recording.frames.length;
    let before = null;
    try {
      for (let index = 0; index < count; index++) {
        const block = await this.recording.unpacked(index);
        for (let i = 0; i < block.ticks.length; i++) {
          const { tick, figures } = block.frame(i);
          this.listener.onFigures(tick, plotted(figures), tick - (before ?? tick));
          before = tick;
          if (i % 64 === 63) await new Promise((resolve) => setTimeout(resolve));
        }
      }
    } catch {
      // Playback reports the damaged block when it reaches it.
    }
  }

  /** Fills the plots of the selected robot from the whole recording. */
  async readRobot(index) {
    if (index === null || this.recording.size > READ_THROUGH) return;
    let before = null;
    try {
      for (let at = 0; at < this.recording.frames.length; at++) {
        const block = await this.recording.unpacked(at);
        const minds = new Map(block.minds.filter((mind) => mind.index === index).map((mind) => [mind.tick, mind]));
        for (let i = 0; i < block.ticks.length; i++) {
          const tick = block.ticks[i];
          if (this.selected !== index) return;
          this.listener.sample(block.frame(i), minds.get(tick), tick - (before ?? tick));
          before = tick;
          if (i % 64 === 63) await new Promise((resolve) => setTimeout(resolve));
        }
      }
    } catch {
      // Playback reports the damaged block when it reaches it.
    }
  }

  /** Sends the positions at past ticks. */
  async trail(ticks) {
    const rows = [];
    try {
      for (const tick of ticks) {
        const { x, y, z } = (await this.recording.at(tick)).frame;
        rows.push([tick, Float32Array.from([...x, ...y, ...(z ?? [])])]);
      }
    } catch {
      // Playback reports the damaged block when it reaches it.
    }
    this.listener.onTrail(rows);
  }

  send(message) {
    switch (message.do) {
      case "trail":
        this.trail(message.ticks);
        break;
      case "pause":
        this.paused = true;
        this.say();
        break;
      case "play":
        this.play();
        break;
      case "step":
        this.paused = true;
        if (this.next !== null) this.seek(this.next);
        break;
      case "speed":
        this.speed = message.x;
        this.time = null;
        this.say();
        break;
      case "seek":
        this.paused = true;
        this.seek(message.tick);
        break;
      case "links":
      case "select":
        if (message.do === "select") {
          this.selected = message.robot;
          this.readRobot(message.robot);
        }
        this.wanted ??= this.busy ? this.awaited : this.tick;
        this.fetch();
        break;
    }
  }
}
