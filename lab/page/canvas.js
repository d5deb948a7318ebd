// What every chart needs of a canvas: sharp pixels, colours of the theme, curves of any length, labels that do not cover one another.
const FONT = '-apple-system,"Segoe UI",Roboto,"Helvetica Neue","Noto Sans","Liberation Sans",Arial,sans-serif';

let colours = new Map();
export const forgetColours = () => (colours = new Map());
// A colour of the theme, or one given as such.
export function colour(name) {
  if (!name.startsWith("--")) return name;
  if (!colours.has(name)) colours.set(name, getComputedStyle(document.documentElement).getPropertyValue(name).trim());
  return colours.get(name);
}

export class Pen {
  // Takes a canvas that is `height` high and as wide as its place, or as is said.
  constructor(canvas, height, width = canvas.parentNode.clientWidth, ratio = window.devicePixelRatio || 1) {
    this.ratio = ratio;
    this.width = width;
    this.height = height;
    const [w, h] = [Math.round(this.width * ratio), Math.round(height * ratio)];
    if (canvas.width !== w || canvas.height !== h) {
      canvas.style.height = `${height}px`;
      [canvas.width, canvas.height] = [w, h];
    }
    this.c = canvas.getContext("2d");
    this.c.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.c.clearRect(0, 0, this.width, height);
    this.c.font = `12px ${FONT}`;
  }

  text(text, x, y, { css = "--soft", align = "left", bold = false } = {}) {
    const { c } = this;
    c.font = `${bold ? "600 " : ""}12px ${FONT}`;
    c.fillStyle = colour(css);
    c.textAlign = align;
    c.fillText(text, x, y);
    return c.measureText(text).width;
  }

  measure(text, bold) {
    this.c.font = `${bold ? "600 " : ""}12px ${FONT}`;
    return this.c.measureText(text).width;
  }

  box(x, y, w, h, css, radius = 0) {
    const { c } = this;
    c.fillStyle = colour(css);
    c.beginPath();
    c.roundRect(x, y, Math.max(0, w), h, radius);
    c.fill();
  }

  frame(x, y, w, h, css, radius) {
    const { c } = this;
    c.strokeStyle = colour(css);
    c.lineWidth = 1.5;
    c.setLineDash([]);
    c.beginPath();
    c.roundRect(x, y, w, h, radius);
    c.stroke();
  }

  line(x1, y1, x2, y2, css, { width = 1, dash = [] } = {}) {
    const { c } = this;
    c.strokeStyle = colour(css);
    c.lineWidth = width;
    c.setLineDash(dash);
    c.beginPath();
    c.moveTo(x1, y1);
    c.lineTo(x2, y2);
    c.stroke();
  }

  // A curve of `value(k)`, k from a to b, NaN where there is a gap.
  curve(a, b, value, X, Y, css, { width = 1.6, dash = [], step = false } = {}) {
    this.begin(css, width, dash);
    points(this.c, a, b, value, X, Y, step);
    this.c.stroke();
  }

  // The same where there are many k to a pixel: from the least to the largest of each. Dashes would not be seen. Boxes that lie on whole
  // pixels are filled many times faster than lines are drawn.
  band(a, b, low, high, X, Y, css, { width = 1.6, dash = [] } = {}) {
    const { c, ratio } = this;
    const thick = dash.length ? 1 / ratio : Math.max(1, Math.round(Math.min(width, 1.4) * ratio)) / ratio;
    c.fillStyle = colour(css);
    columns(a, b, low, high, (k) => Math.round(X(k) * ratio) / ratio, (x, least, most) => {
      const top = Math.round(Y(most) * ratio) / ratio;
      c.fillRect(x, top, 1 / ratio, Math.max(thick, Math.round(Y(least) * ratio) / ratio - top));
    });
  }

  begin(css, width, dash) {
    const { c } = this;
    c.strokeStyle = colour(css);
    c.lineWidth = width;
    c.setLineDash(dash);
    c.lineJoin = "round";
    c.beginPath();
  }

  within(x, y, w, h, draw) {
    const { c } = this;
    c.save();
    c.beginPath();
    c.rect(x, y, w, h);
    c.clip();
    draw();
    c.restore();
  }
}

function points(c, a, b, value, X, Y, step) {
  let before = NaN;
  for (let k = a; k <= b; k++) {
    const v = value(k);
    if (v === v) {
      const [x, y] = [X(k), Y(v)];
      if (before !== before) c.moveTo(x, y);
      else {
        if (step) c.lineTo(x, before);
        c.lineTo(x, y);
      }
      before = y;
    } else before = NaN;
  }
}

// Calls `column` with the least and the largest of each place; where no gap is between, a column reaches to the one before it.
function columns(a, b, low, high, X, column) {
  let [place, least, most] = [NaN, NaN, NaN];
  let [from, to] = [NaN, NaN]; // of the column before
  const flush = () => {
    if (place !== place) return;
    column(place, least > to ? to : least, most < from ? from : most);
    [from, to] = [least, most];
  };
  for (let k = a; k <= b; k++) {
    const [v, w] = [low(k), high(k)];
    if (v !== v) {
      flush();
      place = from = to = NaN;
      continue;
    }
    const x = X(k);
    if (x === place) {
      if (v < least) least = v;
      if (w > most) most = w;
    } else {
      flush();
      [place, least, most] = [x, v, w];
    }
  }
  flush();
}

// Pushes labels apart, within bounds; they keep their order.
export function spread(labels, low, high, gap = 15) {
  labels.sort((a, b) => a.y - b.y);
  for (const label of labels) label.y = Math.min(high, Math.max(low, label.y));
  for (let round = 0; round < 10; round++) {
    for (let i = 1; i < labels.length; i++) {
      const lack = gap - (labels[i].y - labels[i - 1].y);
      if (lack > 0) ((labels[i].y += lack / 2), (labels[i - 1].y -= lack / 2));
    }
  }
  const over = labels.length ? labels[labels.length - 1].y - high : 0;
  if (over > 0) for (const label of labels) label.y -= over;
  return labels;
}

// A round step that gives about so many ticks.
export function niceStep(range, count) {
  const raw = range / count;
  const ten = 10 ** Math.floor(Math.log10(raw));
  return ten * [1, 2, 5, 10].find((m) => m * ten >= raw * 0.999);
}
