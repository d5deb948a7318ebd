// The wall: several rigs on one page, a tile each with what the rig's own page would say. It stops all of them, and does nothing else to any.
import { $, embedded, keep } from "lab/state.js";
import { current, escape, following, languages, num, say, speak, speakOf } from "lab/strings.js";
import { stateLine, verdict } from "lab/verdict.js";
import words from "lab/wall_words.js";

const EVERY = 1000; // ms
const KEY = JSON.parse(embedded("key"));
const TOKEN = embedded("token");
const HEADERS = { "X-Lab-Token": TOKEN };
const SUPPORTED = ["alarm", "advice", "tripped"]; // what these rest on stands on the tile, too

const word = (key, values = {}) => words[current()][key].replace(/\{(\w+)\}/g, (blank, name) => values[name] ?? blank);
const seen = { tiles: [], gone: false, told: null };

// The row of a tile by names, at the time of its rig.
function named({ row, ts }) {
  const now = Object.fromEntries(KEY.fields.map((name, i) => [name, row[i] ?? NaN]));
  return { ...now, t: now.tick * ts };
}

// What a rig's own page would say of its last row, without buttons.
function said(tile) {
  if (tile.why) return { state: "lost", icon: "off", word: word("absent"), aside: "", head: escape(tile.why), sub: "" };
  if (!tile.row) return { state: "learn", icon: "learn", word: say("state_settle"), aside: "", head: "", sub: "" };
  speakOf(tile.preset ?? "");
  const now = named(tile);
  const events = { last: { alarm: now.t - tile.alarm_for }, active: () => [] };
  const lost = tile.lost === null ? 0 : Math.max(1, tile.lost * 1000);
  const view = { row: now, hello: { ...KEY, kind: tile.kind }, events, since: now.t - tile.mode_for, begun: now, ts: tile.ts, settings: {}, can: new Set(), checking: false, lost };
  const { sub, ...rest } = verdict(view);
  return { ...rest, sub: SUPPORTED.includes(rest.state) ? sub : "" };
}

function numbers(tile) {
  if (!tile.row) return "";
  const now = named(tile);
  const cell = (key, value, unit) => `<dt>${word(key)}</dt><dd>${num(value)}${Number.isFinite(value) ? `\u00a0${unit}` : ""}</dd>`;
  return `<dl title="${word("setpoint", { x: num(now.setpoint) })}">${["t0", "t1", "t2"].map((t) => cell(t, now[t], "°C")).join("")}${cell("power", now.drive, "%")}</dl>`;
}

function html(tile) {
  const told = said(tile);
  const to = tile.why ? "" : ` href="boards/${tile.board}/?token=${TOKEN}"`;
  const sub = told.sub ? `<p class="sub">${told.sub}</p>` : "";
  const name = `<h2><span>${escape(tile.board)}</span><small>${escape(tile.name ?? "")}</small></h2>`;
  return `<a class="tile" data-board="${tile.board}" data-state="${told.state}"${to}>${name}<p class="state">${stateLine(told)}</p><p class="head">${told.head}</p>${sub}${numbers(tile)}</a>`;
}

// A tile is made anew only where it has changed: a press is not lost on one that goes in between.
const shown = new Map();
function show() {
  const tiles = $("tiles");
  seen.tiles.forEach((tile, i) => {
    const text = html(tile);
    if (shown.get(i) === text) return;
    shown.set(i, text);
    const template = document.createElement("template");
    template.innerHTML = text;
    const [before, made] = [tiles.children[i], template.content.firstChild];
    if (!before) return tiles.append(made);
    for (const { name, value } of made.attributes) before.setAttribute(name, value);
    before.replaceChildren(...made.childNodes);
  });
  document.body.classList.toggle("gone", seen.gone);
  const counts = Map.groupBy([...tiles.children], ({ dataset }) => dataset.state);
  const worst = ["tripped", "alarm", "lost", "advice", "learn", "off", "monitor"].filter((state) => counts.has(state));
  $("count").textContent = seen.gone ? word("gone") : worst.map((state) => `${counts.get(state).length} ${word(state)}`).join(", ");
  const bad = ["tripped", "alarm", "lost"].reduce((sum, state) => sum + (counts.get(state)?.length ?? 0), 0);
  document.title = `${bad ? `(${bad}) ` : ""}PT-326: ${word("title", { count: seen.tiles.length })}`;
}

// What stays, language and what became of a stop.
function showWords() {
  $("stop").textContent = word("stop_all");
  $("theme").ariaLabel = word("theme");
  Object.assign($("language"), { textContent: following().toUpperCase(), lang: following(), ariaLabel: languages()[following()].language });
  const { told } = seen;
  $("told").hidden = !told;
  if (!told) return;
  $("told").className = `told ${told.bad ? "bad" : ""}`;
  $("told").innerHTML = `<span>${escape(told.text())}</span><button class="quiet" aria-label="${word("close")}">×</button>`;
}

async function look() {
  try {
    const response = await fetch("tiles", { headers: HEADERS, signal: AbortSignal.timeout(5 * EVERY) });
    // It answers, but not to this page any more: it has begun anew, with another token.
    if (response.status === 403) return location.reload();
    Object.assign(seen, { tiles: await response.json(), gone: false });
  } catch {
    seen.gone = true;
  }
  show();
  setTimeout(look, EVERY);
}

// At once, without a question. What has not been stopped is said until somebody closes it.
async function stopAll() {
  const tell = (bad, text) => ((seen.told = { bad, text }), showWords());
  const sent = fetch("stop", { method: "POST", headers: HEADERS });
  tell(false, () => word("stops"));
  try {
    const rigs = await (await sent).json();
    const not = rigs.filter(({ why }) => why).map(({ board, why }) => `${board} (${why})`).join("; ");
    tell(not !== "", () => (not ? word("not_stopped", { what: not }) : word("stopped", { count: rigs.length })));
  } catch {
    tell(true, () => word("no_stop"));
  }
}

$("stop").addEventListener("click", stopAll);
addEventListener("keydown", ({ key, repeat }) => key === "!" && !repeat && stopAll());
$("told").addEventListener("click", ({ target }) => target.closest("button") && ((seen.told = null), showWords()));
$("language").addEventListener("click", () => {
  speak(following());
  keep.set("language", current());
  showWords();
  show();
});
$("theme").addEventListener("click", () => {
  const { dataset } = document.documentElement;
  dataset.theme = dataset.theme === "dark" ? "light" : "dark";
  keep.set("theme", dataset.theme);
});
// What stands below the bar leaves room for it.
new ResizeObserver(([{ target }]) => document.documentElement.style.setProperty("--bar", `${target.offsetHeight}px`)).observe(document.querySelector(".bar"));

// A token that the address has brought is kept for this tab, and seen no more: as the page of a rig does it.
if (location.search) {
  try { sessionStorage.setItem("pt326-lab-token", TOKEN); } catch { /* then the link is to be opened again */ }
  history.replaceState(null, "", location.pathname);
}
speak(keep.get("language") ?? navigator.language?.slice(0, 2));
document.documentElement.dataset.theme = keep.get("theme") ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
showWords();
look();
