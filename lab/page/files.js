// Traces and links: what is saved, copied, opened.
import { readTrace } from "lab/csv.js";
import { refusal } from "lab/say.js";
import { toLink } from "lab/scene.js";
import { connect } from "lab/serial.js";
import { fromRecording, fromServer, inWorker, replay } from "lab/sources.js";
import { exam } from "lab/parts.js";
import { reveal } from "lab/show.js";
import { $, embedded, lab, toast } from "lab/state.js";
import { say } from "lab/strings.js";
import { ask, use } from "lab/talk.js";

const SURE = 7000; // ms: a second press is meant while the words of the first are there

// The worker of the page, and the session that runs in it.
export const parts = () => ({ worker: embedded("worker"), wasm: embedded("wasm") });
// Where the page begins: at the server that has sent it, or at its own session.
export const home = (hear) => (embedded("token") ? fromServer(hear, embedded("token")) : inWorker(hear, parts()));

// One way to save what was recorded: a board's log, a session's trace.
$("download").addEventListener("click", async () => {
  if (holds()) return save((await ask({ command: "log" })).parts, "board.log", "text/plain", say("replay_with", { file: "board.log" }));
  const answer = await ask({ command: "trace" });
  if (answer.type !== "trace") return toast(refusal(answer));
  save(answer.parts, "trace.csv", "text/csv", say("replay_with", { file: "trace.csv" }));
});
// With the page go the port, its Stop, and what was not saved of the log.
const holds = () => lab.can.has("log");
addEventListener("beforeunload", (event) => holds() && event.preventDefault());
let warned = -Infinity; // ms: when the first press of the way back from a board was
// Saves a file, and says so.
export function save(parts, file, type, told) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob(parts, { type }));
  link.download = file;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  toast(told);
}

// Goes over to another source, from which there is a way back; a session's scene is kept for it.
async function leave(make) {
  if (lab.hello.kind === "simulated") {
    const { type, scene, tick: at } = await ask({ command: "scene" });
    lab.left = type === "scene" ? { scene, at } : null;
  }
  lab.away = true;
  use(make);
}
$("back").addEventListener("click", () => {
  if (holds() && performance.now() - warned > SURE) {
    warned = performance.now();
    return toast(say("leaves_board"));
  }
  lab.away = false;
  use(home);
});
let any = false; // where no ST-LINK was chosen, the next press offers all ports
$("connect").addEventListener("click", () => {
  toast(say("connecting"));
  // What a browser asks its user for, it asks at once after the press.
  connect(any, parts()).then(async (make) => {
    any = false;
    await leave(make);
    toast(say("connected"));
    reveal("say");
  }, ({ message }) => {
    any = message === "no_port";
    toast(say(["no_serial", "no_port", "port_busy"].includes(message) ? message : "no_board", { why: message }));
  });
});
$("link").addEventListener("click", async () => {
  const { scene, tick } = await ask({ command: "scene" });
  copyText("#" + toLink(scene, tick));
});
// Copies a scene or an exam: as a link, or of a file, whose address is of use to nobody else, as the end of one.
export async function copyText(text) {
  const isFile = location.protocol === "file:";
  const address = location.href.replace(/#.*/, "") + text;
  try {
    await navigator.clipboard.writeText(isFile ? text : address);
    toast(say(isFile ? "copied_scene" : "copied"));
  } catch {
    toast(say("link_in_bar"));
  }
  history.replaceState(null, "", text);
}
// A scene or an exam that is pasted, dropped or typed, as a link or as its end.
function opens(text) {
  const [found] = /#[sx]=[\w-]+/.exec(text ?? "") ?? [];
  if (!found || lab.hello?.kind !== "simulated") return false;
  history.replaceState(null, "", "#"); // the same one may be opened again
  location.hash = found;
  return true;
}
function scene(event, data) {
  if (!/INPUT|TEXTAREA/.test(event.target.tagName) && opens(data?.getData("text"))) event.preventDefault();
}
$("opentext").addEventListener("input", ({ target }) => opens(target.value) && (target.value = ""));
addEventListener("paste", (event) => scene(event, event.clipboardData));
addEventListener("drop", (event) => {
  const [file] = event.dataTransfer.files;
  if (!file) return scene(event, event.dataTransfer);
  event.preventDefault(); // a browser that is left to itself leaves the page for the file
  if (!exam.hides) openTrace(file);
});
addEventListener("dragover", (event) => ["text/plain", "Files"].some((type) => event.dataTransfer.types.includes(type)) && event.preventDefault());
async function openTrace(file) {
  if (holds()) return toast(say("board_first"));
  try {
    const text = await file.text();
    const notes = [say("opened", { what: file.name })];
    if (!embedded("wasm")) notes.push(say("as_recorded"));
    const again = embedded("wasm") && (await replay(text, parts()).catch(({ message }) => void notes.push(say("not_replayed", { why: message }))));
    const { hello, values } = again || readTrace(text, lab.hello);
    await leave((hear) => fromRecording(hear, { hello: { ...hello, session: undefined }, name: file.name, values }));
    toast(notes.join(" "));
    reveal("say");
  } catch (error) {
    toast(say("bad_trace", { why: error.message }));
  }
}
$("file").addEventListener("change", async ({ target }) => {
  const [file] = target.files;
  if (file) await openTrace(file);
  target.value = "";
});
