// Flat pictures with axes: maps in colours, with lines and marks over them.
import { text } from "tweezer/arrays";
import { nice } from "tweezer/clock";
import { make } from "tweezer/shell";

// Colours from low to high, as of Matplotlib's viridis.
export const VIRIDIS = [[68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141], [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37]];

// The colour at `part` of a ramp, 0 to 255 each.
export function shade(stops, part) {
  const at = Math.min(Math.max(part, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2);
  return stops[k].map((c, i) => c + (at - k) * (stops[k + 1][i] - c));
}

export function css([red, green, blue]) {
  return `rgb(${Math.round(red)} ${Math.round(green)} ${Math.round(blue)})`;
}

// What the colours of a map mean: a bar with numbers below it.
export function colourBar() {
  const bar = make("span", { class: "wide-ramp" }), numbers = make("span", { class: "ramp-numbers" });
  bar.style.background = `linear-gradient(90deg, ${VIRIDIS.map(css).join()})`;
  return {
    element: make("div", { class: "colour-bar" }, bar, numbers),
    // words: at even distances, from left to right
    set: (words) => numbers.replaceChildren(...words.map((word) => make("span", {}, word))),
  };
}

// A choice: [[value, words], ...]; `act` is called with the value.
export function choice(label, entries, act) {
  const list = make("select", { "aria-label": label, onchange: () => act(list.value) },
    ...entries.map(([value, words]) => make("option", { value }, words)));
  return list;
}

const LEFT = 68, RIGHT = 14, TOP = 12, BOTTOM = 38;

export class Chart {
  // options: {label, equal, paint(pen, chart), over(pen, chart), onpick(x, y)}. `equal`: a length is as
  // long on both axes. `paint` draws within the axes and `over` above them.
  constructor(shell, host, options) {
    Object.assign(this, { shell, options });
    this.canvas = make("canvas", { role: "img", tabindex: 0, "aria-label": options.label ?? "" });
    this.host = make("div", { class: "chart" }, this.canvas);
    host.append(this.host);
    const pick = (event) => {
      const { left, top } = this.canvas.getBoundingClientRect();
      options.onpick(this.xAt(event.clientX - left), this.yAt(event.clientY - top));
    };
    if (options.onpick) {
      this.canvas.addEventListener("pointerdown", (event) => {
        if (event.button) return;
        this.canvas.setPointerCapture(event.pointerId);
        pick(event);
      });
      this.canvas.addEventListener("pointermove", (event) => {
        if (this.canvas.hasPointerCapture(event.pointerId)) pick(event);
      });
    }
    new ResizeObserver(() => this.resize()).observe(this.host);
    shell.onTheme(() => this.draw());
  }

  // Each axis: {low, high, log, name, unit, ticks}; ticks, [[value, words], ...], in place of numbers.
  axes(x, y) {
    Object.assign(this, { x, y });
    if (this.width) this.fit(); else this.resize();
  }

  resize() {
    const { clientWidth, clientHeight } = this.host;
    if (!clientWidth || !clientHeight) return;
    this.ratio = Math.min(devicePixelRatio || 1, 2);
    this.canvas.width = Math.round(clientWidth * this.ratio);
    this.canvas.height = Math.round(clientHeight * this.ratio);
    Object.assign(this, { width: clientWidth, height: clientHeight });
    this.fit();
    this.draw();
  }

  // Where the axes are in the canvas.
  fit() {
    if (!this.width || !this.x) return;
    let [left, right, top, bottom] = [LEFT, this.width - RIGHT, TOP, this.height - BOTTOM];
    if (this.options.equal) {
      const wide = this.x.high - this.x.low, tall = this.y.high - this.y.low;
      const scale = Math.min((right - left) / wide, (bottom - top) / tall);
      const middle = (left + right) / 2;
      [left, right] = [middle - (scale * wide) / 2, middle + (scale * wide) / 2];
      top = bottom - scale * tall;
    }
    this.frame = { left, right, top, bottom };
  }

  across(value) {
    return this.frame.left + part(this.x, value) * (this.frame.right - this.frame.left);
  }

  up(value) {
    return this.frame.bottom - part(this.y, value) * (this.frame.bottom - this.frame.top);
  }

  xAt(pixel) {
    return value(this.x, (pixel - this.frame.left) / (this.frame.right - this.frame.left));
  }

  yAt(pixel) {
    return value(this.y, (this.frame.bottom - pixel) / (this.frame.bottom - this.frame.top));
  }

  draw() {
    if (!this.width || !this.x) return;
    const pen = this.canvas.getContext("2d"), { left, right, top, bottom } = this.frame;
    pen.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    pen.clearRect(0, 0, this.width, this.height);
    pen.save();
    pen.beginPath(); pen.rect(left, top, right - left, bottom - top); pen.clip();
    this.options.paint(pen, this);
    pen.restore();
    pen.strokeStyle = pen.fillStyle = this.shell.colour("soft");
    pen.lineWidth = 1;
    pen.font = "12px system-ui, sans-serif";
    pen.strokeRect(left - 0.5, top - 0.5, right - left + 1, bottom - top + 1);
    pen.textAlign = "center"; pen.textBaseline = "top";
    let free = -Infinity;
    for (const [at, words] of ticks(this.x, (right - left) / 62)) {
      const x = this.across(at), half = pen.measureText(words).width / 2;
      pen.beginPath(); pen.moveTo(x, bottom); pen.lineTo(x, bottom + 4); pen.stroke();
      if (x - half < free) continue;
      pen.fillText(words, x, bottom + 6);
      free = x + half + 6;
    }
    pen.textAlign = "right"; pen.textBaseline = "bottom";
    pen.fillText(titled(this.x), Math.max(right, pen.measureText(titled(this.x)).width), this.height - 1);
    pen.textBaseline = "middle";
    free = Infinity;
    for (const [at, words] of ticks(this.y, (bottom - top) / 40)) {
      const y = this.up(at);
      pen.beginPath(); pen.moveTo(left - 4, y); pen.lineTo(left, y); pen.stroke();
      if (y + 7 > free) continue;
      pen.fillText(words, left - 7, y);
      free = y - 7;
    }
    pen.save();
    pen.translate(left - 57, top); pen.rotate(-Math.PI / 2);
    pen.textBaseline = "middle";
    pen.fillText(titled(this.y), 0, 0);
    pen.restore();
    this.options.over?.(pen, this);
  }
}

function titled({ name, unit }) {
  return unit ? `${name} (${unit})` : name;
}

function part({ low, high, log }, at) {
  return log ? Math.log(at / low) / Math.log(high / low) : (at - low) / (high - low || 1);
}

function value({ low, high, log }, at) {
  const held = Math.min(Math.max(at, 0), 1);
  return log ? low * (high / low) ** held : low + held * (high - low);
}

// Values and words along an axis, about `most` of them, ascending.
function ticks(axis, most) {
  const { low, high, log } = axis;
  if (axis.ticks) return axis.ticks;
  const found = [];
  if (log) {
    const decades = Math.log10(high / low);
    const leads = decades * 3 <= most ? [1, 2, 5] : [1];
    const every = Math.max(1, Math.ceil(decades / most));
    for (let k = Math.floor(Math.log10(low)); k <= Math.log10(high); k += every)
      for (const lead of leads) {
        const at = lead * 10 ** k;
        if (at >= low * (1 - 1e-9) && at <= high * (1 + 1e-9)) found.push([at, text(at, 1)]);
      }
    if (found.length > 1) return found;
    return [[low, text(low, 3)], [high, text(high, 3)]];
  }
  const step = nice((high - low) / Math.max(3, most)) || 1;
  const places = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++)
    found.push([k * step, k === 0 ? "0" : (k * step).toFixed(Math.min(places, 9)).replace("-", "−")]);
  return found;
}
