// The scene in a link: everything that led here, as text that an address can hold.
import { say } from "lab/strings.js";

export const DEFAULT = { seed: 1, preset: "paper", disturbance: "calm", orders: [[0, { order: "arm" }]] };

const DEEPEST = 16; // a scene is nested seven deep
const isObject = (x) => typeof x === "object" && x !== null && !Array.isArray(x);
const isDeep = (x, left = DEEPEST) => typeof x === "object" && x !== null && (left === 0 || Object.values(x).some((y) => isDeep(y, left - 1)));

// Bytes as text that an address can hold (base64url), and back.
export const toText = (bytes) => btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
export const fromText = (text) => Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));

export const toLink = (scene, tick) => "s=" + toText(new TextEncoder().encode(JSON.stringify({ v: 1, at: tick, scene })));

// What is no JSON is no scene: what a parser says of it helps nobody.
function parsed(text) {
  try {
    return JSON.parse(new TextDecoder().decode(fromText(text)));
  } catch {
    return null;
  }
}

// What a fragment holds; null where it holds no scene. Throws where it is broken.
export function fromLink(fragment) {
  const text = new URLSearchParams(fragment.replace(/^#/, "")).get("s");
  if (!text) return null;
  const link = parsed(text);
  // No worker is sent what is nested so deep that it cannot be copied.
  if (isDeep(link)) throw new Error(say("link_deep"));
  if (!isObject(link) || !isObject(link.scene)) throw new Error(say("link_other"));
  const { v, at, scene } = link;
  if (v !== 1) throw new Error(`version ${v}`);
  if (!Number.isInteger(at) || at < 0 || at > 1e6) throw new Error(`at ${at}`);
  return { at, scene };
}
