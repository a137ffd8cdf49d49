// A recording as a file: an index of blocks, which are uncompressed on demand (PROTOCOL.md,
// "Recordings").

import { parseFrame } from "staya/frame.js";

const MAGIC = "STAYAREC";
const VERSION = 1;
const FILE_HEADER = 12;
const BLOCK_HEADER = 13;
const SCENE = 1,
  FRAMES = 2,
  ORDERS = 3,
  MINDS = 5;
// Cache of uncompressed blocks, bytes.
const KEPT = 96 << 20;

const text = new TextDecoder();

const crcTable = Uint32Array.from({ length: 256 }, (_, n) => {
  for (let bit = 0; bit < 8; bit++) n = n & 1 ? (n >>> 1) ^ 0xedb88320 : n >>> 1;
  return n;
});

function crc32(bytes) {
  let crc = 0xffffffff;
  for (let i = 0; i < bytes.length; i++) crc = crcTable[(crc ^ bytes[i]) & 255] ^ (crc >>> 8);
  return (crc ^ 0xffffffff) >>> 0;
}

function inflated(packed) {
  return new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
}

/** At least the first `least` bytes, or all if there are fewer. */
async function beginning(packed, least) {
  const reader = inflated(packed);
  const bytes = new Uint8Array(least);
  let have = 0;
  while (have < least) {
    const { done, value } = await reader.read();
    if (done) break;
    bytes.set(value.subarray(0, least - have), have);
    have += value.length;
  }
  reader.cancel().catch(() => {});
  return bytes;
}

async function unpack(block) {
  if (crc32(block.packed) !== block.crc) throw new Error(`the block at byte ${block.at} is damaged`);
  const raw = new Uint8Array(block.rawLength);
  const reader = inflated(block.packed);
  let have = 0;
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    if (have + value.length > raw.length) throw new Error(`the block at byte ${block.at} is longer than it says`);
    raw.set(value, have);
    have += value.length;
  }
  if (have !== raw.length) throw new Error(`the block at byte ${block.at} is shorter than it says`);
  return raw;
}

/** Undoes the XOR. Frames are stored one after the other, aligned for typed arrays. */
function framesOf(raw) {
  const view = new DataView(raw.buffer);
  const spans = [];
  let room = 0;
  for (let at = 0; at + 4 <= raw.length;) {
    const length = view.getUint32(at, true);
    if (at + 4 + length > raw.length) break;
    spans.push([at + 4, length, room]);
    room += (length + 7) & ~7;
    at += 4 + length;
  }
  const bytes = new Uint8Array(room);
  let before = 0,
    beforeLength = 0;
  for (const [from, length, to] of spans) {
    const shared = Math.min(length, beforeLength);
    for (let i = 0; i < shared; i++) bytes[to + i] = raw[from + i] ^ bytes[before + i];
    if (length > shared) bytes.set(raw.subarray(from + shared, from + length), to + shared);
    before = to;
    beforeLength = length;
  }
  const all = new DataView(bytes.buffer);
  return {
    ticks: Uint32Array.from(spans, ([, , to]) => all.getUint32(to + 4, true)),
    frame: (i) => parseFrame(bytes.buffer.slice(spans[i][2], spans[i][2] + spans[i][1])),
    size: room,
  };
}

export class Recording {
  /** Reads the index; throws an error with the reason if `bytes` are not a recording. */
  static async open(bytes) {
    if (bytes.length < FILE_HEADER || text.decode(bytes.subarray(0, 8)) !== MAGIC) {
      throw new Error("not a recording (STAYAREC)");
    }
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    const version = view.getUint32(8, true);
    if (version !== VERSION) throw new Error(`the recording has version ${version}, this page reads ${VERSION}`);
    const recording = new Recording();
    let scene = null;
    for (let at = FILE_HEADER; at + BLOCK_HEADER <= bytes.length;) {
      const packedLength = view.getUint32(at + 5, true);
      const end = at + BLOCK_HEADER + packedLength;
      if (end > bytes.length) break;
      const block = {
        at,
        rawLength: view.getUint32(at + 1, true),
        crc: view.getUint32(at + 9, true),
        packed: bytes.subarray(at + BLOCK_HEADER, end),
        scene: null,
        first: 0,
      };
      const kind = bytes[at];
      if (kind === SCENE) scene = block;
      if (kind === FRAMES && scene) recording.frames.push(Object.assign(block, { scene }));
      if (kind === ORDERS) recording.ordersBlock = block;
      if (kind === MINDS && recording.frames.length) recording.frames.at(-1).minds = block;
      at = end;
    }
    if (!recording.frames.length) throw new Error("the recording has no frames");
    await recording.readTicks();
    return recording;
  }

  constructor() {
    this.frames = [];
    this.ordersBlock = null;
    // Why the recording ends early, if the file is damaged.
    this.damage = null;
    this.kept = new Map();
    this.scenes = new Map();
  }

  /** Reads the ticks of all blocks; blocks after a damaged one are dropped. */
  async readTicks() {
    const { frames } = this;
    for (let i = 0; i < frames.length; i++) {
      try {
        frames[i].first = new DataView((await beginning(frames[i].packed, 12)).buffer).getUint32(8, true);
      } catch {
        this.damage = `the block at byte ${frames[i].at} is damaged`;
        frames.length = i;
      }
    }
    while (frames.length) {
      try {
        const { ticks } = await this.unpacked(frames.length - 1);
        this.first = frames[0].first;
        this.last = ticks[ticks.length - 1];
        return;
      } catch (error) {
        this.damage = error.message;
        frames.pop();
      }
    }
    throw new Error(this.damage);
  }

  /** Uncompressed size of all frames, bytes. */
  get size() {
    return this.frames.reduce((sum, block) => sum + block.rawLength, 0);
  }

  async scene(block) {
    if (!this.scenes.has(block.at)) this.scenes.set(block.at, JSON.parse(text.decode(await unpack(block))));
    return this.scenes.get(block.at);
  }

  /** Orders given during the run, `[{tick, order}]`. */
  async orders() {
    return this.ordersBlock ? JSON.parse(text.decode(await unpack(this.ordersBlock))) : [];
  }

  /** The frames of block `index`; recently used blocks are cached. */
  async unpacked(index) {
    let block = this.kept.get(index);
    if (block) this.kept.delete(index);
    else {
      const { minds } = this.frames[index];
      block = framesOf(await unpack(this.frames[index]));
      block.minds = minds ? JSON.parse(text.decode(await unpack(minds))) : [];
    }
    this.kept.set(index, block);
    let size = 0;
    for (const each of this.kept.values()) size += each.size;
    for (const [old, each] of this.kept) {
      if (size <= KEPT || old === index) break;
      this.kept.delete(old);
      size -= each.size;
    }
    return block;
  }

  /** The last frame at or before `tick` with its scene and minds; `{frame, scene, next, minds}`, where `next` is the
      following tick or null. */
  async at(tick) {
    let low = 0;
    for (let high = this.frames.length - 1; low < high;) {
      const middle = (low + high + 1) >> 1;
      if (this.frames[middle].first <= tick) low = middle;
      else high = middle - 1;
    }
    const block = await this.unpacked(low);
    let i = 0;
    while (i + 1 < block.ticks.length && block.ticks[i + 1] <= tick) i++;
    const after = i + 1 < block.ticks.length ? block.ticks[i + 1] : (this.frames[low + 1]?.first ?? null);
    const minds = block.minds.filter((mind) => mind.tick === block.ticks[i]);
    return { frame: block.frame(i), scene: await this.scene(this.frames[low].scene), next: after, minds };
  }
}
