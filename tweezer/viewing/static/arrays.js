// Arrays of a page, as `arrays.py` packs them.

// Values of a packed array as Float64Array, in its unit; missing ones are NaN.
export function unpack(packed) {
  const bytes = Uint8Array.from(atob(packed.data), (letter) => letter.charCodeAt(0));
  const view = new DataView(bytes.buffer);
  const whole = packed.type === "uint16";
  const size = whole ? 2 : 4;
  const values = new Float64Array(bytes.length / size);
  for (let i = 0; i < values.length; i++) {
    const number = whole ? view.getUint16(size * i, true) : view.getFloat32(size * i, true);
    values[i] = whole && number === 65535 ? NaN : packed.offset + packed.step * number;
  }
  return values;
}

// Column `k` of an array of rows of `width`, times `factor`.
export function column(values, k, width, factor = 1) {
  const taken = new Float64Array(values.length / width);
  for (let i = 0; i < taken.length; i++) taken[i] = factor * values[width * i + k];
  return taken;
}

// Directions of the x, y and z axes of a body, by its Euler parameters e0 to e3 of any length.
export function axesOf([a, b, c, d]) {
  const size = a * a + b * b + c * c + d * d;
  return [
    [a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c)],
    [2 * (b * c - a * d), a * a - b * b + c * c - d * d, 2 * (c * d + a * b)],
    [2 * (b * d + a * c), 2 * (c * d - a * b), a * a - b * b - c * c + d * d],
  ].map((axis) => axis.map((x) => x / size));
}

// Index i with times[i] <= t < times[i + 1], and the part of that interval passed.
export function locate(times, t) {
  const last = times.length - 1;
  if (last < 1 || !(t > times[0])) return [0, 0];
  if (t >= times[last]) return [last, 0];
  let low = 0, high = last;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= t) low = middle; else high = middle;
  }
  return [low, (t - times[low]) / (times[high] - times[low])];
}

// A number as text with `digits` digits; a dash where there is none.
export function text(value, digits = 3) {
  if (value === null || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e5 || size < 1e-4) {
    const [mantissa, power] = value.toExponential(digits - 1).split("e");
    return `${mantissa}·10${[...String(Number(power))].map((c) => SUPER[c]).join("")}`.replace("-", "−");
  }
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  return value.toFixed(Math.min(decimals, 12)).replace("-", "−");
}

const SUPER = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

// The factor of 1000 in which a quantity of this size reads best: {factor, unit}.
export function scaled(size, unit) {
  for (const [factor, prefix] of PREFIXES) {
    if (size * factor >= 0.9995 || prefix === "a") return { factor, unit: prefix + unit };
  }
}

const PREFIXES = [[1, ""], [1e3, "m"], [1e6, "µ"], [1e9, "n"], [1e12, "p"], [1e15, "f"], [1e18, "a"]];

// A number with its error: {value, error} as text, the error with two digits and the value to the same.
export function withError(value, error) {
  if (!Number.isFinite(value)) return { value: "–", error: "" };
  if (!Number.isFinite(error) || !(error > 0)) return { value: text(value, 4), error: "" };
  const fourth = value ? 10 ** (Math.floor(Math.log10(Math.abs(value))) - 3) : 0;
  if (error < fourth) return { value: text(value, 4), error: text(error, 2) };
  const last = Math.floor(Math.log10(error)) - 1, size = Math.max(Math.abs(value), error);
  if (size >= 1e7 || size < 1e-5 || -last > 7) return { value: text(value, 5), error: text(error, 2) };
  const round = (x) => (last > 0 ? String(Math.round(x / 10 ** last) * 10 ** last) : x.toFixed(-last)).replace("-", "−");
  return { value: round(value), error: round(error) };
}
