// A frame as typed arrays over the received bytes, without copies (PROTOCOL.md, "Frames").

const HEADER = 32;
const MAGIC = 0x31465453; // "STF1"
const HAS_Z = 1;
const HAS_TARGETS = 2;
export const NONE = 0xffffffff;

const text = new TextDecoder();

/** Parses a frame at the start of `buffer`; throws an error with the reason if it is invalid. */
export function parseFrame(buffer) {
  const head = new DataView(buffer);
  if (buffer.byteLength < HEADER || head.getUint32(0, true) !== MAGIC) throw new Error("not a frame (STF1); reload the page");
  const n = head.getUint32(16, true);
  const flags = head.getUint32(20, true);
  const figuresLength = head.getUint32(24, true);
  const axes = flags & HAS_Z ? ["x", "y", "z"] : ["x", "y"];
  const frame = {
    tick: head.getUint32(4, true),
    time: head.getFloat64(8, true),
    n,
    z: null,
    vz: null,
    tx: null,
    ty: null,
    tz: null,
    // Byte offset of each array in `body`, for vertex attributes.
    at: {},
    key: `${n}:${flags}`,
  };
  let offset = HEADER;
  const floats = (name) => {
    if (offset + 4 * n > buffer.byteLength) throw new Error("a frame is shorter than it says");
    frame[name] = new Float32Array(buffer, offset, n);
    frame.at[name] = offset - HEADER;
    offset += 4 * n;
  };
  for (const axis of axes) floats(axis);
  for (const axis of axes) floats("v" + axis);
  if (flags & HAS_TARGETS) for (const axis of axes) floats("t" + axis);
  const padded = (n + 3) & ~3;
  if (offset + 4 * n + 2 * padded + figuresLength > buffer.byteLength)
    throw new Error("a frame is shorter than it says");
  frame.leader = new Uint32Array(buffer, offset, n);
  offset += 4 * n;
  for (const name of ["mode", "wait"]) {
    frame[name] = new Uint8Array(buffer, offset, n);
    frame.at[name] = offset - HEADER;
    offset += padded;
  }
  frame.body = new Uint8Array(buffer, HEADER, offset - HEADER);
  frame.figures = figuresLength ? JSON.parse(text.decode(new Uint8Array(buffer, offset, figuresLength))) : {};
  return frame;
}

/** Decodes standard base64. */
export function fromBase64(encoded) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(encoded);
  const binary = atob(encoded);
  const bytes = new Uint8Array(binary.length);
  for (let i = 0; i < bytes.length; i++) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

/** Packets as pairs of sender and (receiver << 2 | result). */
export function pairsOf(encoded) {
  return new Uint32Array(fromBase64(encoded).buffer);
}
