// The numbers of the last two hours, a row a tick, in one ring: memory is bounded however long a session lasts.
const CAPACITY = 1 << 16;

export class Store {
  constructor(hello) {
    this.fields = hello.fields;
    this.width = hello.fields.length;
    this.ts = hello.ts;
    this.at = Object.fromEntries(hello.fields.map((name, i) => [name, i]));
    this.ring = new Float32Array(CAPACITY * this.width);
    this.clear();
  }

  clear() {
    this.first = 0;
    this.end = 0; // one past the last tick
  }

  // Rows from a tick on, one after another.
  push(from, values) {
    const rows = values.length / this.width;
    if (from !== this.end) this.first = this.end = from;
    for (let i = Math.max(0, rows - CAPACITY); i < rows; i++) {
      const row = values.subarray(i * this.width, (i + 1) * this.width);
      this.ring.set(row, ((from + i) % CAPACITY) * this.width);
    }
    this.end = from + rows;
    this.first = Math.max(this.first, this.end - CAPACITY);
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

  // Where a row begins in the ring.
  place(tick) {
    return (tick % CAPACITY) * this.width;
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
