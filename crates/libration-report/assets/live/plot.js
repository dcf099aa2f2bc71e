// Plots on a canvas.

/** Colors of the page by the names of its properties, as a canvas can read them: those of light or of dark. */
class Palette {
  constructor(holder) {
    this.probe = holder.appendChild(document.createElement("span"));
    this.probe.hidden = true;
    this.known = new Map();
  }
  /** Forgets the colors, which change with the appearance of the page. */
  clear() {
    this.known.clear();
  }
  ink(name) {
    if (!this.known.has(name)) {
      this.probe.style.color = `var(${name})`;
      this.known.set(name, getComputedStyle(this.probe).color);
    }
    return this.known.get(name);
  }
}

/** A range that contains all numbers, with a margin. */
const extent = (columns, margin = 0.06) => {
  let [low, high] = [Infinity, -Infinity];
  for (const column of columns) {
    for (const x of column) {
      if (x < low) low = x;
      if (x > high) high = x;
    }
  }
  if (!(low <= high)) return [-1, 1];
  const pad = margin * (high - low) || 0.1 * Math.abs(low) || 1;
  return [low - pad, high + pad];
};

/** Ticks of a linear axis. */
const ticks = ([low, high], count = 4) => {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= rough);
  const all = [];
  for (let k = Math.ceil(low / step); k * step <= high; k++) all.push(k * step);
  return all;
};

const logTicks = ([low, high]) => {
  const all = [];
  for (let k = Math.ceil(Math.log10(low)); 10 ** k <= high * 1.0001; k++) all.push(10 ** k);
  return all.length > 1 ? all : [low, high];
};

/** An axis: its range, and whether it is logarithmic. */
class Scale {
  constructor(range, log = false) {
    [this.range, this.log] = [range, log];
    [this.low, this.high] = log ? range.map(Math.log) : range;
  }
  part(x) {
    return ((this.log ? Math.log(x) : x) - this.low) / (this.high - this.low);
  }
  value(part) {
    const x = this.low + part * (this.high - this.low);
    return this.log ? Math.exp(x) : x;
  }
  ticks() {
    return this.log ? logTicks(this.range) : ticks(this.range);
  }
}

/** A canvas with axes. Colors are those of the page. */
class Plot {
  constructor(canvas, palette) {
    [this.canvas, this.palette] = [canvas, palette];
    this.context = canvas.getContext("2d");
  }
  begin(x, y, labels) {
    const { canvas, context } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth || 400, canvas.clientHeight || 300];
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.font = "12px system-ui, sans-serif";
    // The widest label of a tick, with its tick, is whole.
    const widest = Math.max(0, ...y.ticks().map((tick) => context.measureText(format(tick)).width));
    this.box = { left: Math.max(52, Math.ceil(widest) + 10), top: 22, right: width - 10, bottom: height - 36 };
    [this.x, this.y] = [x, y];
    this.axes(labels);
  }
  ink(name) {
    return this.palette.ink(name);
  }
  at(x, y) {
    const { left, top, right, bottom } = this.box;
    return [left + this.x.part(x) * (right - left), bottom - this.y.part(y) * (bottom - top)];
  }
  valueAt(event) {
    const rect = this.canvas.getBoundingClientRect();
    const { left, top, right, bottom } = this.box;
    const clamp = (part) => Math.min(1, Math.max(0, part));
    const part = [(event.clientX - rect.left - left) / (right - left), (bottom - event.clientY + rect.top) / (bottom - top)];
    return [this.x.value(clamp(part[0])), this.y.value(clamp(part[1]))];
  }
  axes([xLabel, yLabel]) {
    const { context, box } = this;
    context.strokeStyle = this.ink("--rule");
    context.fillStyle = this.ink("--soft");
    context.lineWidth = 1;
    context.strokeRect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    context.textAlign = "center";
    for (const tick of this.x.ticks()) {
      const [x] = this.at(tick, this.y.range[0]);
      context.beginPath();
      context.moveTo(x, box.bottom);
      context.lineTo(x, box.bottom + 4);
      context.stroke();
      context.fillText(format(tick), x, box.bottom + 16);
    }
    context.textAlign = "right";
    for (const tick of this.y.ticks()) {
      const [, y] = this.at(this.x.range[0], tick);
      context.beginPath();
      context.moveTo(box.left - 4, y);
      context.lineTo(box.left, y);
      context.stroke();
      context.fillText(format(tick), box.left - 7, y + 4);
    }
    context.textAlign = "right";
    context.fillText(xLabel, box.right, box.bottom + 31);
    context.textAlign = "left";
    context.fillText(yLabel, 6, 13);
  }
  clip(draw) {
    const { context, box } = this;
    context.save();
    context.beginPath();
    context.rect(box.left, box.top, box.right - box.left, box.bottom - box.top);
    context.clip();
    draw();
    context.restore();
  }
  line(xs, ys, ink, width = 1.5, dash = []) {
    this.clip(() => {
      const { context } = this;
      context.strokeStyle = this.ink(ink);
      context.lineWidth = width;
      context.setLineDash(dash);
      context.beginPath();
      const count = Math.min(xs.length, ys.length);
      for (let i = 0; i < count; i++) {
        const [x, y] = this.at(xs[i], ys[i]);
        if (i) context.lineTo(x, y);
        else context.moveTo(x, y);
      }
      context.stroke();
    });
  }
  dot(x, y, ink, radius = 4, open = false) {
    const { context } = this;
    const [left, top] = this.at(x, y);
    context.beginPath();
    context.arc(left, top, radius, 0, 2 * Math.PI);
    context.lineWidth = 1.8;
    if (open) {
      context.strokeStyle = this.ink(ink);
      context.stroke();
    } else {
      context.fillStyle = this.ink(ink);
      context.fill();
    }
  }
}
