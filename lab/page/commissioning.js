// The report of a commissioning by this page, a file to keep or to print: what was done, what the board said, which settings are its own.
import { wide } from "lab/board.js";
import { save } from "lab/files.js";
import { $, lab } from "lab/state.js";
import { current, escape, num, say } from "lab/strings.js";

const MOST = 5000; // lines that are kept

// The steps of the desk: which words on the console begin one, and by what it is seen to have ended well or otherwise.
const STEPS = [
  { id: "c_thermistors", begins: /^(> calibrate|calibrate:)/, done: /^> calibrate apply\nin force/, failed: /^> calibrate apply\nerror/, undone: /^> calibrate undo\nin force/ },
  { id: "c_wiring", begins: /^(> check|check[: ])/m, done: /^check passed/m, failed: /^(check (failed|ended)|> check\nerror)/m },
  { id: "c_controller", begins: /^(> tune|tune:)/m, done: /^tune: done/m, failed: /^(tune: ended|> tune start\nerror)/m },
  { id: "c_normal", begins: /^> (arm|baseline|relearn)\b/ },
  { id: "c_keep", begins: /^> save\b/, done: /^> save\nok/, failed: /^> save\nerror/ },
];
const OTHER = "report_other";

let [lines, dropped, outcomes, step] = [[], 0, {}, OTHER];

// Another board, of which nothing is known yet.
export function beginReport() {
  [lines, dropped, outcomes, step] = [[], 0, {}, OTHER];
}

// The console has said something: a typed line with its answer, or a line by itself, which belongs to the step before.
export function noted({ text }) {
  const begun = STEPS.find(({ begins }) => begins.test(text));
  if (begun || text.startsWith("> ")) step = begun?.id ?? OTHER;
  if (begun?.undone?.test(text)) delete outcomes[step];
  else if (begun?.failed?.test(text)) outcomes[step] = "failed";
  else if (begun?.done?.test(text)) outcomes[step] = "done";
  lines.push({ step, text });
  dropped += lines.splice(0, lines.length - MOST).length;
}

// Whether it has learnt what is normal, as its numbers say, as far back as they are kept.
function learnt() {
  const { store, hello } = lab;
  const [monitor, armed] = [hello.modes.indexOf("monitor"), hello.readiness.indexOf("armed")];
  for (let tick = store.last; tick >= store.first; tick--) if (store.get(tick, "mode") === monitor && store.get(tick, "readiness") === armed) return true;
  return false;
}

// The step of the first day that comes next: behind the last that has ended well; none where all have.
export const nextStep = () => STEPS[STEPS.findLastIndex(({ id }) => outcome(id) === "done") + 1]?.id;
// Brings it into view.
export function toStep() {
  const step = document.querySelector(`.steps [data-say="${nextStep()}"]`).parentElement;
  step.scrollIntoView({ block: "center" });
  step.querySelector("input, button").focus({ preventScroll: true });
}

const outcome = (id) => (id === "c_normal" ? (learnt() ? "done" : lines.some((line) => line.step === id) ? "failed" : undefined) : outcomes[id]);

const STYLE = `body{font:16px/1.5 system-ui,sans-serif;max-width:56rem;margin:2rem auto;padding:0 1rem;color:#1a1f26;background:#fff}h1,h2{line-height:1.2}
table{border-collapse:collapse}td{padding:.2rem 1.2rem .2rem 0;vertical-align:top}pre{font:13px/1.45 ui-monospace,monospace;background:#f4f5f7;padding:.8rem;white-space:pre-wrap;overflow-wrap:anywhere}
.failed{color:#b00020;font-weight:600}@media print{pre{background:none;border:1px solid #ccc}h2{break-after:avoid}}`;

// The report as a page of its own.
export function report(who, when) {
  const { settings, usual, hello } = lab;
  const part = (title, text) => `<h2>${escape(title)}</h2>\n<pre>${escape(text)}</pre>\n`;
  const steps = STEPS.map(({ id }) => [id, outcome(id) ?? "left"]);
  const rows = steps.map(([id, how]) => `<tr><td>${escape(say(id))}<td class="${how}">${escape(say(`report_${how}`))}`).join("\n");
  const saidIn = (id) => lines.filter((line) => line.step === id).map((line) => line.text).join("\n");
  const told = [...STEPS.map(({ id }) => id), OTHER].map((id) => [id, saidIn(id)]).filter(([, text]) => text);
  const own = Object.entries(settings).filter(([name, value]) => value !== usual?.[name]).map(([name, value]) => `${name} = ${value} ${hello.bounds[name]?.unit ?? ""}`.trim());
  const wider = wide(hello.limits, settings).map((name) => `${name} = ${settings[name]}`);
  const gone = dropped ? `<p>${escape(say("report_dropped", { count: num(dropped, 0) }))}</p>\n` : "";
  return `<!doctype html>
<html lang="${current()}"><meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>${escape(say("report_title"))}</title><style>${STYLE}</style>
<h1>${escape(say("report_title"))}</h1>
<p>${[who, when, say("source_board", { name: hello.name ?? "" })].filter(Boolean).map(escape).join("<br>")}</p>
<table>${rows}</table>
<p>${escape($("agrees").textContent)}</p>
${gone}${told.map(([id, text]) => part(say(id), text)).join("")}${part(say("report_own"), own.join("\n") || say("report_none"))}${part(say("report_wider"), wider.join("\n") || say("report_none"))}<p>${escape(say("report_by", { version: hello.version }))}</p>
</html>
`;
}

// It is printed from its file: a dialog of this page would keep a stop waiting.
$("report-save").addEventListener("click", () => {
  const page = report($("report-who").value.trim(), new Date().toLocaleString(current()));
  save([page], "commissioning.html", "text/html", say("saved", { file: "commissioning.html" }));
});
