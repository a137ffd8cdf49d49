// The connection to a running view, which reconnects by itself.

import { fromBase64, pairsOf, parseFrame } from "staya/frame.js";
import { PLOTTED } from "staya/plots.js";

const FIRST_RETRY_MS = 500;
const LAST_RETRY_MS = 8000;
/** Close code of a server that has ended; there is no reconnect. */
const OVER = 1001;

export class Live {
  constructor(listener) {
    this.listener = listener;
    this.retry = FIRST_RETRY_MS;
    this.socket = null;
    // Frames received in this connection.
    this.frames = 0;
  }

  start() {
    const token = new URLSearchParams(location.search).get("token") ?? "";
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    const socket = new WebSocket(`${scheme}//${location.host}/live?token=${encodeURIComponent(token)}`);
    socket.binaryType = "arraybuffer";
    socket.onmessage = ({ data }) => this.receive(data);
    socket.onopen = () => {
      this.retry = FIRST_RETRY_MS;
      this.frames = 0;
      this.listener.onConnection("open");
    };
    socket.onclose = ({ code }) => {
      if (code === OVER) {
        this.listener.onConnection("over");
        return;
      }
      this.listener.onConnection("lost", Math.round(this.retry / 1000));
      setTimeout(() => this.start(), this.retry);
      this.retry = Math.min(2 * this.retry, LAST_RETRY_MS);
    };
    this.socket = socket;
  }

  receive(data) {
    try {
      if (typeof data !== "string") {
        this.frames++;
        this.listener.onFrame(parseFrame(data));
        return;
      }
      const message = JSON.parse(data);
      switch (message.type) {
        case "scene":
          this.listener.onScene(message);
          break;
        case "state":
          this.listener.onState(message);
          break;
        case "robot":
          this.listener.onRobot(message);
          break;
        case "figures":
          for (const [tick, values] of figuresOf(message.rows)) this.listener.onFigures(tick, values, message.every);
          break;
        case "trail":
          this.listener.onTrail(
            message.rows.map(([tick, places]) => [tick, floatsOf(places)]),
            message.branch,
          );
          break;
        case "orders":
          this.listener.onOrders(message.orders);
          break;
        case "links":
          this.listener.onLinks(message.tick, pairsOf(message.pairs));
          break;
        case "saved":
          this.listener.onSaved(message);
          break;
        case "error":
        case "note":
          this.listener.onMessage(message.type, message.text);
          break;
      }
    } catch (error) {
      this.listener.onMessage("error", `A message of the server is invalid: ${error.message}. Reload the page.`);
    }
  }

  /** Confirms a drawn frame, which allows the server to send more. */
  seen() {
    this.send({ do: "seen", frames: this.frames });
  }

  send(message) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }
}

/** Rows of a tick and its plotted figures. */
function* figuresOf(encoded) {
  const { buffer } = fromBase64(encoded);
  const [ticks, values] = [new Uint32Array(buffer), new Float32Array(buffer)];
  for (let at = 0; at < ticks.length; at += 1 + PLOTTED) yield [ticks[at], values.subarray(at + 1, at + 1 + PLOTTED)];
}

function floatsOf(encoded) {
  return new Float32Array(fromBase64(encoded).buffer);
}
