// The scene in a link: everything that led here, as text that an address can hold.
export const DEFAULT = { seed: 1, preset: "paper", disturbance: "calm", orders: [[0, { order: "arm" }]] };

export function toLink(scene, tick) {
  const bytes = new TextEncoder().encode(JSON.stringify({ v: 1, at: tick, scene }));
  return "s=" + btoa(String.fromCharCode(...bytes)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

// What a fragment holds; null where it holds no scene. Throws where it is broken.
export function fromLink(fragment) {
  const text = new URLSearchParams(fragment.replace(/^#/, "")).get("s");
  if (!text) return null;
  const bytes = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
  const { v, at, scene } = JSON.parse(new TextDecoder().decode(bytes));
  if (v !== 1) throw new Error(`version ${v}`);
  if (!Number.isInteger(at) || at < 0 || at > 1e6) throw new Error(`at ${at}`);
  return { at, scene };
}
