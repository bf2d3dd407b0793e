// Plots on a canvas: curves are drawn once, the cursor moves above them.
import { locate, text } from "tweezer/arrays";
import { make, write } from "tweezer/shell";
import { nice } from "tweezer/clock";

const LEFT = 58, RIGHT = 12, TOP = 8, BOTTOM = 30;

export class Plot {
  // x: {values, name, unit}, ascending. curves: [{name, values, errors, colour, dash, points}], colour
  // a name of the style sheet. options: {title, unit, log, even, range, jumps,
  // onpick(x)}.
  constructor(shell, host, x, curves, options) {
    Object.assign(this, { shell, x, curves, options });
    this.cursor = x.values[0];
    this.back = make("canvas", { role: "img" });
    this.line = make("span", { class: "cursor" });
    this.dots = curves.map(({ colour }) => make("span", { class: "dot", style: `background: var(--${colour})` }));
    this.legend = make("div", { class: "legend" });
    this.shown = curves.map((curve) => make("span", { class: "number" }));
    this.legend.append(make("h2", {}, options.title + (options.unit && ` (${options.unit})`)), ...curves.map((curve, i) =>
      make("span", { class: "entry" }, swatch(curve), ` ${curve.name} `, this.shown[i])));
    // what is clicked takes keys
    this.tip = make("span", { class: "tip", hidden: true });
    this.area = make("div", { class: "area", tabindex: options.onpick ? -1 : null }, this.back,
      make("div", { "aria-hidden": "true" }, this.line, ...this.dots, this.tip));
    this.area.addEventListener("pointermove", (event) => this.hover(event));
    this.area.addEventListener("pointerleave", () => { this.tip.hidden = true; });
    this.box = make("figure", { class: "plot" }, this.legend, this.area);
    host.append(this.box);
    this.range = options.range ?? this.extent();
    this.partly = curves.some(({ values }) => values.some((value) => this.below(value)));
    if (this.partly) this.legend.append(make("span", { class: "entry below" }, `not drawn below ${text(this.range[0], 2)} ${options.unit}`));
    this.describe();
    const pick = (event) => this.options.onpick(this.under(event));
    if (options.onpick) {
      this.area.classList.add("picks");
      this.area.addEventListener("pointerdown", (event) => {
        if (event.button) return;
        this.area.setPointerCapture(event.pointerId);
        pick(event);
      });
      this.area.addEventListener("pointermove", (event) => {
        if (this.area.hasPointerCapture(event.pointerId)) pick(event);
      });
    }
    new ResizeObserver(() => this.resize()).observe(this.area);
    shell.onTheme(() => this.width && this.draw());
  }

  // The value of x under the pointer.
  under(event) {
    const [low, high] = this.ends(), { left } = this.area.getBoundingClientRect();
    const part = (event.clientX - left - LEFT) / (this.width - LEFT - RIGHT);
    return low + Math.min(Math.max(part, 0), 1) * (high - low);
  }

  // Values of the curves at a value of x: between samples, unless the curve jumps.
  at(value) {
    const [i, part] = locate(this.x.values, value);
    return this.curves.map(({ values }) => {
      const next = values[Math.min(i + 1, values.length - 1)];
      return this.options.jumps || part === 0 ? values[i] : values[i] + part * (next - values[i]);
    });
  }

  // Show the values under a mouse beside it.
  hover(event) {
    if (event.pointerType !== "mouse" || !this.width) return;
    const value = this.under(event), x = this.across(value), right = x > this.width / 2;
    const each = this.at(value).map((number, k) => `${this.curves[k].name} ${this.number(number)}`);
    this.tip.textContent = [`${text(value, 4)} ${this.x.unit}`, ...each].join(" · ");
    this.tip.hidden = false;
    this.tip.style.transform = `translate(${x + (right ? -8 : 8)}px, ${TOP}px)${right ? " translateX(-100%)" : ""}`;
  }

  ends() {
    const { values } = this.x;
    return [values[0], values[values.length - 1]];
  }

  extent() {
    let low = Infinity, high = -Infinity, least = Infinity;
    for (const { values, errors } of this.curves) {
      for (const [i, value] of values.entries()) {
        if (!Number.isFinite(value)) continue;
        const error = errors?.[i] || 0;
        if (value - error < low) low = value - error;
        if (value + error > high) high = value + error;
        if (value > 0 && value < least) least = value;
      }
    }
    if (this.options.log) {
      if (!(high > 0)) return [0.1, 1];
      return [Math.max(least, high * 1e-5) / 1.5, high * 1.5];
    }
    if (!(high >= low)) return [0, 1];
    const room = 0.06 * (high - low) || Math.abs(high) || 1;
    return [low - room, high + room];
  }

  // Whether a value is too small for a logarithmic axis, and so not drawn.
  below(value) {
    return Boolean(this.options.log) && value < this.range[0];
  }

  // A value of a curve; where all are `even`, to the same decimal, a thousandth of the range.
  number(value) {
    if (!this.options.even || !Number.isFinite(value)) return text(value, 3);
    const digit = Math.floor(Math.log10(Math.max(...this.range.map(Math.abs)))) - 3;
    if (Math.abs(digit) > 6) return text(value, 4);
    return value.toFixed(Math.max(0, -digit)).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
  }

  describe() {
    const { title, unit } = this.options;
    const each = this.curves.map(({ name, values }) => {
      let low = Infinity, high = -Infinity;
      for (const value of values) {
        if (value < low) low = value;
        if (value > high) high = value;
      }
      return `${name} from ${text(low)} to ${text(high)}`;
    });
    this.back.setAttribute("aria-label", `${title}${unit && ` in ${unit}`} over ${this.x.name}: ${each.join("; ")}` +
      (this.partly ? `; what is below ${text(this.range[0], 2)} ${unit} is not drawn` : ""));
  }

  resize() {
    const { clientWidth, clientHeight } = this.area;
    if (!clientWidth || !clientHeight) return;
    this.width = clientWidth;
    this.height = clientHeight;
    this.ratio = Math.min(devicePixelRatio || 1, 2);
    this.back.width = Math.round(clientWidth * this.ratio);
    this.back.height = Math.round(clientHeight * this.ratio);
    this.line.style.height = `${this.height - BOTTOM - TOP + 4}px`;
    this.draw();
  }

  across(value) {
    const [low, high] = this.ends();
    return LEFT + (value - low) / (high - low || 1) * (this.width - LEFT - RIGHT);
  }

  up(value) {
    let [low, high] = this.range;
    if (this.options.log) [value, low, high] = [value, low, high].map(Math.log10);
    return this.height - BOTTOM - (value - low) / (high - low) * (this.height - BOTTOM - TOP);
  }

  // Curves and axes; seldom.
  draw() {
    const pen = this.back.getContext("2d"), { shell } = this;
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    const ink = shell.colour("soft"), line = shell.colour("line");
    pen.font = "12px system-ui, sans-serif";
    pen.lineWidth = 1;
    for (const value of this.ticks()) {
      const y = Math.round(this.up(value)) + 0.5;
      pen.strokeStyle = line;
      pen.beginPath(); pen.moveTo(LEFT, y); pen.lineTo(this.width - RIGHT, y); pen.stroke();
      pen.fillStyle = ink; pen.textAlign = "right"; pen.textBaseline = "middle";
      pen.fillText(label(value, this.options.log, this.step), LEFT - 7, y);
    }
    const [low, high] = this.ends();
    const step = nice((high - low) / Math.max(2, (this.width - LEFT - RIGHT) / 90)) || 1;
    const axis = `${this.x.name} (${this.x.unit})`, room = pen.measureText(axis).width + 10;
    pen.textAlign = "center"; pen.textBaseline = "top"; pen.fillStyle = ink;
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high * (1 + 1e-9); k++) {
      const x = Math.round(this.across(k * step)) + 0.5;
      pen.strokeStyle = line;
      pen.beginPath(); pen.moveTo(x, this.height - BOTTOM); pen.lineTo(x, this.height - BOTTOM + 4); pen.stroke();
      const words = label(k * step, false, step);
      if (x + pen.measureText(words).width / 2 < this.width - RIGHT - room) pen.fillText(words, x, this.height - BOTTOM + 6);
    }
    pen.textAlign = "right";
    pen.fillText(axis, this.width - RIGHT, this.height - BOTTOM + 6);
    pen.save();
    pen.beginPath(); pen.rect(LEFT, TOP - 2, this.width - LEFT - RIGHT, this.height - BOTTOM - TOP + 4); pen.clip();
    for (const curve of [...this.curves].reverse()) this.curve(pen, curve);
    pen.restore();
    this.move(this.cursor);
  }

  curve(pen, { values, errors, colour, dash, points, width }) {
    pen.strokeStyle = pen.fillStyle = this.shell.colour(colour);
    if (errors) this.band(pen, values, errors);
    pen.lineWidth = width ?? 1.7;
    pen.setLineDash(dash ?? []);
    const drawn = (value) => Number.isFinite(value) && !this.below(value);
    const n = values.length, per = n / (this.width - LEFT - RIGHT);
    pen.beginPath();
    if (points) {
      for (let i = 0; i < n; i += Math.max(1, Math.floor(per / 4))) {
        if (drawn(values[i])) pen.rect(this.across(this.x.values[i]) - 1, this.up(values[i]) - 1, 2, 2);
      }
      pen.fill();
      return;
    }
    // of many samples in a column of pixels the lowest and the highest are enough
    const stride = per > 4 ? Math.floor(per) : 1;
    let pending = true;
    for (let i = 0; i < n; i += stride) {
      let low = i, high = i;
      for (let j = i + 1; j < Math.min(i + stride, n); j++) {
        if (values[j] < values[low]) low = j;
        if (values[j] > values[high]) high = j;
      }
      for (const k of low === high ? [i] : low < high ? [low, high] : [high, low]) {
        if (!drawn(values[k])) { pending = true; continue; }
        const x = this.across(this.x.values[k]), y = this.up(values[k]);
        if (pending) pen.moveTo(x, y); else pen.lineTo(x, y);
        pending = false;
      }
    }
    pen.stroke();
    pen.setLineDash([]);
  }

  // What lies within the errors on either side.
  band(pen, values, errors) {
    const known = [...values.keys()].filter((i) => Number.isFinite(values[i]) && Number.isFinite(errors[i]));
    const corner = (i, side) => [this.across(this.x.values[i]), this.up(values[i] + side * errors[i])];
    pen.globalAlpha = 0.25;
    pen.beginPath();
    for (const i of known) pen.lineTo(...corner(i, 1));
    for (const i of known.reverse()) pen.lineTo(...corner(i, -1));
    pen.fill();
    pen.globalAlpha = 1;
  }

  ticks() {
    const [low, high] = this.range;
    const found = [];
    if (this.options.log) {
      const every = Math.ceil(Math.log10(high / low) / 5);
      const parts = high < 100 * low ? [1, 2, 5] : [1]; // two decades may hold one power of ten
      for (let k = Math.floor(Math.log10(low)); 10 ** k <= high; k += every) {
        found.push(...parts.map((part) => part * 10 ** k).filter((value) => value >= low && value <= high));
      }
      return found;
    }
    this.step = nice((high - low) / Math.max(2, (this.height - TOP - BOTTOM) / 32));
    for (let k = Math.ceil(low / this.step); k * this.step <= high; k++) found.push(k * this.step);
    return found;
  }

  // Show the cursor at `value` of x, and what the curves have there.
  move(value) {
    this.cursor = value;
    const there = this.at(value);
    there.forEach((number, k) => write(this.shown[k], this.number(number)));
    if (!this.width) return;
    const x = this.across(value);
    this.line.style.transform = `translate(${x}px, ${TOP - 4}px)`;
    there.forEach((number, k) => {
      this.dots[k].hidden = !Number.isFinite(number) || this.below(number);
      if (!this.dots[k].hidden) this.dots[k].style.transform = `translate(${x}px, ${this.up(number)}px)`;
    });
  }
}

// A short line in the style of a curve.
export function swatch({ colour, dash, points }) {
  const line = `<line x1="1" x2="21" y1="5" y2="5" stroke="var(--${colour})" stroke-width="2.4" stroke-dasharray="${(points ? [2, 4] : dash ?? []).join(" ")}"/>`;
  const holder = make("span", { class: "swatch", "aria-hidden": "true" });
  holder.innerHTML = `<svg width="22" height="10">${line}</svg>`;
  return holder;
}

function label(value, log, step) {
  if (log) return text(value, 1).replace("1·", "");
  if (Math.abs(value) < 1e-9 * step) return "0";
  if (Math.abs(value) >= 1e5 || step < 1e-4) return text(value, 2);
  return value.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9))).replace("-", "−");
}
