// The numbers of the last two hours, a row a tick, in one ring: memory is bounded however long a session lasts. Beside it, for views of long
// times, the least and the largest of each block of ticks.
const CAPACITY = 1 << 16;
export const BLOCK = 16;
const USUAL_TS = 0.11; // s: of the rig whose times the page is made for
// How much slower than that a plant is sampled: what takes it some samples lasts longer by this.
export const slowness = (ts) => ts / USUAL_TS;
const SWINGS_IN = 2; // s: the models begin with a guess of the air; what they expect so early says nothing

export class Store {
  constructor(hello) {
    this.use(hello.ts);
    this.given = hello.fields.length;
    // What the models leave unexplained is a column of its own.
    this.fields = [...hello.fields, "t1_left", "t2_left"];
    this.width = this.fields.length;
    this.at = Object.fromEntries(this.fields.map((name, i) => [name, i]));
    this.ring = new Float32Array(CAPACITY * this.width);
    this.low = new Float32Array((CAPACITY / BLOCK) * this.width);
    this.high = new Float32Array((CAPACITY / BLOCK) * this.width);
    this.clear();
  }

  // Takes another sample time.
  use(ts) {
    [this.ts, this.slow] = [ts, slowness(ts)];
  }

  clear() {
    this.first = 0;
    this.end = 0; // one past the last tick
    this.expecting = 0; // ticks in a row
  }

  // Rows from a tick on, one after another, as a source gives them.
  push(from, values) {
    const rows = values.length / this.given;
    if (from !== this.end) this.first = this.end = from;
    for (let i = Math.max(0, rows - CAPACITY); i < rows; i++) this.set(from + i, values.subarray(i * this.given, (i + 1) * this.given));
    this.end = from + rows;
    // A block that is written over is no more.
    this.first = Math.max(this.first, Math.ceil((this.end - CAPACITY) / BLOCK) * BLOCK);
  }

  set(tick, row) {
    const { ring, at, low, high, width } = this;
    const place = this.place(tick);
    ring.set(row, place);
    this.expecting = Number.isFinite(ring[place + at.t1_expected]) ? this.expecting + 1 : 0;
    for (const t of ["t1", "t2"]) {
      if (this.expecting * USUAL_TS <= SWINGS_IN) ring[place + at[t + "_expected"]] = NaN;
      ring[place + at[t + "_left"]] = ring[place + at[t]] - ring[place + at[t + "_expected"]];
    }
    const block = this.block(Math.floor(tick / BLOCK));
    const fresh = tick % BLOCK === 0 || tick === this.first;
    for (let i = 0; i < width; i++) {
      const v = ring[place + i];
      if (fresh || !(low[block + i] <= v)) if (fresh || v === v) low[block + i] = v;
      if (fresh || !(high[block + i] >= v)) if (fresh || v === v) high[block + i] = v;
    }
  }

  get last() {
    return this.end - 1;
  }

  get now() {
    return this.last * this.ts;
  }

  has(tick) {
    return tick >= this.first && tick < this.end;
  }

  // Where a row begins in the ring, and where a block does.
  place(tick) {
    return (tick % CAPACITY) * this.width;
  }

  block(number) {
    return (number % (CAPACITY / BLOCK)) * this.width;
  }

  get(tick, name) {
    return this.has(tick) ? this.ring[this.place(tick) + this.at[name]] : NaN;
  }

  // A row by names.
  row(tick) {
    if (!this.has(tick)) return null;
    const place = this.place(tick);
    const row = {};
    this.fields.forEach((name, i) => (row[name] = this.ring[place + i]));
    row.t = tick * this.ts;
    return row;
  }

  tickAt(t) {
    return Math.round(t / this.ts);
  }
}

// Some columns of a store as they are now.
export class Kept {
  constructor(store, names) {
    Object.assign(this, { ts: store.ts, first: store.first, end: store.end, columns: new Map() });
    const blocks = Math.ceil(store.end / BLOCK);
    for (const name of names.filter((name) => name in store.at)) {
      const at = store.at[name];
      const take = (from, to, value) => Float32Array.from({ length: to - from }, (_, i) => value(from + i));
      const block = (of) => (number) => of[store.block(number) + at];
      const from = Math.floor(store.first / BLOCK);
      this.columns.set(name, {
        from, value: take(store.first, store.end, (tick) => store.ring[store.place(tick) + at]),
        low: take(from, blocks, block(store.low)), high: take(from, blocks, block(store.high)),
      });
    }
  }

  // A column as a chart's series has it, by ticks and blocks; NaN where there is none.
  of(name, scale = 1) {
    const column = this.columns.get(name);
    if (!column) return null;
    const by = (values, from) => (k) => (k >= from && k < from + values.length ? values[k - from] * scale : NaN);
    return { value: by(column.value, this.first), low: by(column.low, column.from), high: by(column.high, column.from) };
  }
}
