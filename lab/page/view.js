// The time axis of the charts: which seconds are in view, and the hand that moves and zooms them.
const SPANS = [2, 7200]; // s, of the usual rig

export class View {
  constructor({ stack, overview }, changed) {
    Object.assign(this, { stack, overview, changed });
    this.view = { end: null, span: null };
    this.hover = null;
    this.lead = 0;
    this.area = this.overArea = null; // where the axis lies on both canvases, once they are drawn
    this.listen();
  }

  follow() {
    this.view.end = null;
    this.changed();
  }

  // Near to the present, as at the beginning.
  moment() {
    this.view = { end: null, span: null };
    this.changed();
  }

  get following() {
    return this.view.end === null;
  }

  get narrow() {
    return this.stack.parentNode.clientWidth < 480;
  }

  get span() {
    return this.view.span ?? (this.narrow ? 22 : 40) * this.store.slow;
  }

  get end() {
    return this.view.end ?? this.store.now + this.lead;
  }

  // Shows so many seconds, up to a time.
  show(end, span) {
    const least = this.store.first * this.store.ts;
    this.view.span = this.bounded(span);
    this.view.end = end >= this.store.now ? null : Math.max(least + 1, end);
    this.changed();
  }

  bounded(span) {
    const [least, most] = SPANS.map((s) => s * this.store.slow);
    return Math.min(most, Math.max(least, span));
  }

  zoom(factor, t = this.end) {
    const span = this.bounded(this.span * factor);
    const right = (this.end - t) / this.span;
    this.show(this.following && t >= this.end - 0.02 * this.span ? Infinity : t + right * span, span);
  }

  listen() {
    const { stack, overview } = this;
    const time = (event) => this.area && this.end - this.span * (1 - (event.offsetX - this.area.left) / this.area.width);
    stack.addEventListener("wheel", (event) => {
      if (!this.store || event.ctrlKey) return;
      event.preventDefault();
      if (Math.abs(event.deltaX) > Math.abs(event.deltaY)) this.show(this.end + (event.deltaX / this.area.width) * this.span, this.span);
      else this.zoom(1.0015 ** event.deltaY, time(event));
    }, { passive: false });
    let drag = null;
    stack.addEventListener("pointerdown", (event) => {
      if (event.pointerType === "touch") return;
      drag = { x: event.offsetX, end: this.end };
      stack.setPointerCapture(event.pointerId);
    });
    stack.addEventListener("pointermove", (event) => {
      if (drag && Math.abs(event.offsetX - drag.x) > 2) this.show(drag.end - ((event.offsetX - drag.x) / this.area.width) * this.span, this.span);
      this.hover = time(event);
      this.changed();
    });
    stack.addEventListener("pointerup", () => (drag = null));
    stack.addEventListener("pointerleave", () => ((this.hover = null), this.changed()));
    stack.addEventListener("dblclick", () => this.follow());
    stack.addEventListener("keydown", (event) => {
      const act = {
        ArrowLeft: () => this.show(this.end - this.span / 8, this.span),
        ArrowRight: () => this.show(this.end + this.span / 8, this.span),
        "+": () => this.zoom(0.7), "=": () => this.zoom(0.7), "-": () => this.zoom(1.4),
        Home: () => this.follow(), Escape: () => this.follow(),
      }[event.key];
      if (act) (event.preventDefault(), act());
    });
    const jump = (event) => {
      if (!this.overArea) return;
      const { left, width, from, to } = this.overArea;
      this.show(from + ((event.offsetX - left) / width) * (to - from) + this.span / 2, this.span);
    };
    overview.addEventListener("pointerdown", (event) => (overview.setPointerCapture(event.pointerId), jump(event)));
    overview.addEventListener("pointermove", (event) => event.buttons && jump(event));
  }

}
