// The words of the page in its language, with their blanks filled in. A language is a file words_*.js and its line here.
import { SHORT } from "lab/classes.js";
import en from "lab/words_en.js";
import pt from "lab/words_pt.js";

// The classes have short names in English, and where a language has them in it.
const WORDS = { en: { ...SHORT, ...en }, pt: { ...SHORT, ...pt } };
const LANGUAGES = Object.keys(WORDS);
let language = LANGUAGES[0];

export const languages = () => WORDS;
export const current = () => language;
// The language that its button goes over to.
export const following = () => LANGUAGES[(LANGUAGES.indexOf(language) + 1) % LANGUAGES.length];
export function speak(name) {
  language = name in WORDS ? name : LANGUAGES[0];
  document.documentElement.lang = language;
}

// The words of a step of the tour: title, text and, where it has one, its button.
export const stepWords = (id) => WORDS[language].tour_steps[id];

// The plant that words are about, by its preset: some have words of their own.
let plant = "";
export const speakOf = (preset) => (plant = preset);
export const isTube = () => !WORDS[language].plants[plant];

// A string with its blanks filled in.
export function say(key, values = {}) {
  const words = WORDS[language];
  const text = words.plants[plant]?.[key] ?? words[key] ?? key;
  return text.replace(/\{(\w+)\}/g, (blank, name) => values[name] ?? blank).replace(/(?<=\d|\u2013) (?=°C|%|s\b)/g, "\u00a0");
}

// The same as HTML: parts in their colours. Values must be safe.
export const sayHtml = (key, values) =>
  say(key, values).replace(/\[(\w+)\](.*?)\[\/\]/g, '<span class="part-$1">$2</span>');

const formats = new Map();
// A number with so many decimals, in the way of the language.
export function num(x, decimals = 1) {
  if (x == null || !Number.isFinite(x)) return "–";
  const key = language + decimals;
  if (!formats.has(key)) {
    const digits = { minimumFractionDigits: decimals, maximumFractionDigits: decimals, useGrouping: false };
    formats.set(key, new Intl.NumberFormat(language, digits));
  }
  const text = formats.get(key).format(x);
  return text.replace(/^-(?=0[.,]?0*$)/, "").replace("-", "−");
}

export const escape = (text) => String(text).replace(/[&<>"']/g, (c) => `&#${c.charCodeAt(0)};`);
