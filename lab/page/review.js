// Of a recording: what was said of each fault at its end, with its close-up, before anything else.
import { drawCloseup } from "lab/closeup.js";
import { namings } from "lab/events.js";
import { asTaught, delays, headline, support } from "lab/say.js";
import { num, say } from "lab/strings.js";

const MOST = 12;

export class Review {
  constructor(host) {
    this.host = host;
  }

  show({ store, events, hello }) {
    const faults = events.list.filter((event) => event.truth).slice(0, MOST);
    this.host.hidden = faults.length === 0;
    this.host.replaceChildren(...faults.map((event) => this.card(event, store, hello)));
    faults.forEach((event, i) => drawCloseup(this.host.querySelectorAll("canvas")[i], event, store));
  }

  card(event, store, hello) {
    const row = last(event, store, "class") ?? last(event, store, "taught");
    const name = row && hello.classes.find((c) => c.number === row.class)?.name;
    const card = document.createElement("article");
    const names = namings(event);
    const told = row && (name ? support(name, row, store.ts) : asTaught(row));
    const soon = `${names.length ? delays(names, event.from) : `${say("likelihood")} –`}, ${say("paper_s", { s: num(event.isolated - event.from, 2) })}`;
    card.innerHTML = `<h2>${num(event.from, 1)} s: ${event.label()}</h2><p class="head">${name ? headline(name, row.magnitude) : say("review_unnamed")}</p>
      <p>${told ?? ""}</p><p>${say("how_soon")}: ${soon}</p><div><canvas role="img" aria-label="${say("closeup", { s: num(event.from) })}"></canvas></div>`;
    return card;
  }
}

// The last row of a fault on which it had a class, or was one that was taught.
function last(event, store, what) {
  const [from, to] = [store.tickAt(event.from), Math.min(store.last, store.tickAt(event.to ?? store.now))];
  for (let tick = to - 1; tick >= from; tick--) if (store.get(tick, what) > 0) return store.row(tick);
  return null;
}
