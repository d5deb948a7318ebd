// The scene in a link: everything that led here, as text that an address can hold.
import { say } from "lab/strings.js";

export const DEFAULT = { seed: 1, preset: "paper", disturbance: "calm", orders: [[0, { order: "arm" }]] };

const DEEPEST = 16; // a scene is nested seven deep
const isObject = (x) => typeof x === "object" && x !== null && !Array.isArray(x);
const isDeep = (x, left = DEEPEST) => typeof x === "object" && x !== null && (left === 0 || Object.values(x).some((y) => isDeep(y, left - 1)));

export function toLink(scene, tick) {
  const bytes = new TextEncoder().encode(JSON.stringify({ v: 1, at: tick, scene }));
  return "s=" + btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join("")).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

// What a fragment holds; null where it holds no scene. Throws where it is broken.
export function fromLink(fragment) {
  const text = new URLSearchParams(fragment.replace(/^#/, "")).get("s");
  if (!text) return null;
  const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
  const link = JSON.parse(new TextDecoder().decode(bytes));
  // No worker is sent what is nested so deep that it cannot be copied.
  if (isDeep(link)) throw new Error(say("link_deep"));
  if (!isObject(link) || !isObject(link.scene)) throw new Error(say("link_other"));
  const { v, at, scene } = link;
  if (v !== 1) throw new Error(`version ${v}`);
  if (!Number.isInteger(at) || at < 0 || at > 1e6) throw new Error(`at ${at}`);
  return { at, scene };
}
