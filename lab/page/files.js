// Traces and links: what is saved, copied, opened.
import { readTrace } from "lab/csv.js";
import { refusal } from "lab/say.js";
import { toLink } from "lab/scene.js";
import { fromRecording, replay } from "lab/sources.js";
import { $, embedded, lab, toast } from "lab/state.js";
import { say } from "lab/strings.js";
import { ask, use } from "lab/talk.js";

// The worker of the page, and the session that runs in it.
export const parts = () => ({ worker: embedded("worker"), wasm: embedded("wasm") });

$("download").addEventListener("click", async () => {
  const answer = await ask({ command: "trace" });
  const { parts, type } = answer;
  if (type !== "trace") return toast(refusal(answer));
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob(parts, { type: "text/csv" }));
  link.download = "trace.csv";
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
  toast(say("replay_with", { file: "trace.csv" }));
});
$("link").addEventListener("click", async () => {
  const { scene, tick } = await ask({ command: "scene" });
  history.replaceState(null, "", "#" + toLink(scene, tick));
  try {
    await navigator.clipboard.writeText(location.href);
    toast(say("copied"));
  } catch {
    toast(say("link_in_bar"));
  }
});
$("file").addEventListener("change", async ({ target }) => {
  const [file] = target.files;
  if (!file) return;
  try {
    const text = await file.text();
    if (!embedded("wasm")) toast(say("as_recorded"));
    const again = embedded("wasm") && (await replay(text, parts()).catch(({ message }) => void toast(say("not_replayed", { why: message }))));
    const { hello, values } = again || readTrace(text, lab.hello);
    use((hear) => fromRecording(hear, { hello: { ...hello, session: undefined }, name: file.name, values }));
  } catch (error) {
    toast(say("bad_trace", { why: error.message }));
  }
  target.value = "";
});
