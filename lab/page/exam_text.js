// An exam as text for students: what it is follows from it, but cannot be read in it. That is no cryptography: whoever reads this file can undo it.
import { ANSWERS } from "lab/faults.js";
import { LIMITS, most, numbers } from "lab/exam.js";
import { fromText, toText } from "lab/scene.js";

const KEY = 0x326;
const SALT = 4; // bytes, so that two texts of one exam look different
export const PARTS_ASKED = [...new Set(ANSWERS.map(({ part }) => part))];

function mixed(bytes, salt) {
  const random = numbers(salt.reduce((sum, byte) => sum * 256 + byte, 0) ^ KEY);
  return bytes.map((byte) => byte ^ Math.floor(random() * 256));
}

export function toExam(paper) {
  const salt = crypto.getRandomValues(new Uint8Array(SALT));
  return "x=" + toText(Uint8Array.of(...salt, ...mixed(new TextEncoder().encode(JSON.stringify({ v: 1, ...paper })), salt)));
}

// What is wrong with a paper, by the name of what is; undefined where nothing is.
export function wrong({ seed, count, minutes, parts, preset, disturbance }) {
  const within = (value, [least, largest]) => Number.isInteger(value) && value >= least && value <= largest;
  const lacks = Object.entries({ seed, count, minutes }).find(([name, value]) => !within(value, LIMITS[name]));
  if (lacks) return lacks[0];
  if (!Array.isArray(parts) || !parts.length || !parts.every((part) => PARTS_ASKED.includes(part))) return "parts";
  if (typeof preset !== "string" || typeof disturbance !== "string") return "preset";
  if (count > most(minutes)) return "room";
}

// The exam that a fragment holds; null where it holds none. Throws where it is broken.
export function fromExam(fragment) {
  const text = new URLSearchParams(fragment.replace(/^#/, "")).get("x");
  if (!text) return null;
  const bytes = fromText(text);
  const { v, seed, count, minutes, parts, preset, disturbance } = JSON.parse(new TextDecoder().decode(mixed(bytes.slice(SALT), bytes.slice(0, SALT))));
  const paper = { seed, count, minutes, parts, preset, disturbance };
  if (v !== 1 || wrong(paper)) throw new Error(wrong(paper) ?? `version ${v}`);
  return paper;
}
