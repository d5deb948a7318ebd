// What a Pen draws, as SVG: as much of a canvas's context as it uses.
import { escape } from "lab/strings.js";

const short = (x) => Number(x.toFixed(2));

export class Drawing {
  constructor() {
    Object.assign(this, { out: [], d: "", dash: [], clips: 0, open: [], globalAlpha: 1, lineWidth: 1, font: "", textAlign: "left", fillStyle: "", strokeStyle: "" });
    this.measured = document.createElement("canvas").getContext("2d");
  }

  setTransform() {}
  clearRect() {}

  measureText(text) {
    this.measured.font = this.font;
    return this.measured.measureText(text);
  }

  beginPath() {
    this.d = "";
  }

  moveTo(x, y) {
    this.d += `M${short(x)} ${short(y)}`;
  }

  lineTo(x, y) {
    this.d += `${this.d ? "L" : "M"}${short(x)} ${short(y)}`;
  }

  rect(x, y, w, h) {
    this.d += `M${short(x)} ${short(y)}h${short(w)}v${short(h)}h${short(-w)}z`;
  }

  roundRect(x, y, w, h, radius = 0) {
    const r = short(Math.min(radius, w / 2, h / 2));
    const [a, b] = [short(w - 2 * r), short(h - 2 * r)];
    const turn = (dx, dy) => `a${r} ${r} 0 0 1 ${dx} ${dy}`;
    if (r > 0) this.d += `M${short(x + r)} ${short(y)}h${a}${turn(r, r)}v${b}${turn(-r, r)}h${-a}${turn(-r, -r)}v${-b}${turn(r, -r)}z`;
    else this.rect(x, y, w, h);
  }

  setLineDash(dash) {
    this.dash = dash;
  }

  get alpha() {
    return this.globalAlpha < 1 ? ` opacity="${this.globalAlpha}"` : "";
  }

  fill() {
    this.out.push(`<path d="${this.d}" fill="${this.fillStyle}"${this.alpha}/>`);
  }

  fillRect(x, y, w, h) {
    this.beginPath();
    this.rect(x, y, w, h);
    this.fill();
  }

  stroke() {
    const dash = this.dash.length ? ` stroke-dasharray="${this.dash}"` : "";
    this.out.push(`<path d="${this.d}" fill="none" stroke="${this.strokeStyle}" stroke-width="${this.lineWidth}" stroke-linejoin="round"${dash}${this.alpha}/>`);
  }

  fillText(text, x, y) {
    const anchor = { left: "start", center: "middle", right: "end" }[this.textAlign];
    const weight = /^600/.test(this.font) ? ' font-weight="600"' : "";
    this.out.push(`<text x="${short(x)}" y="${short(y)}" fill="${this.fillStyle}" text-anchor="${anchor}"${weight}>${escape(text)}</text>`);
  }

  save() {
    this.open.push(0);
  }

  clip() {
    this.open[this.open.length - 1]++;
    this.out.push(`<clipPath id="clip${++this.clips}"><path d="${this.d}"/></clipPath><g clip-path="url(#clip${this.clips})">`);
  }

  restore() {
    this.out.push("</g>".repeat(this.open.pop()));
  }

  svg(width, height, ground) {
    const family = this.font.replace(/^(600 )?12px /, "");
    return `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}" font-size="12" font-family="${escape(family)}"><rect width="${width}" height="${height}" fill="${ground}"/>${this.out.join("")}</svg>`;
  }
}
