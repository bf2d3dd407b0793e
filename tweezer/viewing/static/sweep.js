// The page of a sweep: a map of its cases, from which one opens with its numbers.
import { text, withError } from "tweezer/arrays";
import { Chart, VIRIDIS, choice, colourBar, css, shade } from "tweezer/chart";
import { make } from "tweezer/shell";

// Ratio of the ends from which on colours go by the logarithm
const WIDE = 3;
// Colours of outcomes, told apart without hue by their lightness too
const OUTCOMES = [[39, 127, 142], [240, 228, 66], [213, 94, 0], [86, 40, 130], [180, 180, 180], [120, 20, 40]];
// Largest number of cells of a table
const CELLS = 4000;
// Of the axis of a curve the part that cases must fill, or those far off are left out of it, and the
// largest part of the cases that are
const FILLED = 0.05, FAR = 0.25;

export function start(content, shell) {
  const { facts } = content, { axes, words, quantities } = facts;
  const sizes = axes.map(({ keys }) => keys[0].values.length);
  const strides = sizes.map((_, k) => sizes.slice(k + 1).reduce((a, b) => a * b, 1));
  const varied = axes.map((_, k) => k).filter((k) => sizes[k] > 1);
  const flat = varied.length < 2;
  const number = (at) => at.reduce((sum, i, k) => sum + i * strides[k], 0);
  // the two longest axes of numbers first
  const order = [...varied].sort((a, b) => plain(axes[b]) - plain(axes[a]) || sizes[b] - sizes[a]);
  let [along, down] = flat ? [varied[0] ?? 0, null] : [Math.max(order[0], order[1]), Math.min(order[0], order[1])];
  const picked = sizes.map((size) => Math.floor(size / 2));
  const outcomeOf = (index) => words.outcome[shell.array("outcome")[index]];

  // ---- what is shown of a case
  const shows = [];
  for (const quantity of quantities) {
    const parts = quantity.along.length ? [...(quantity.least ? [-1] : []), ...quantity.along.keys()] : [0];
    for (const part of parts) shows.push({ quantity, part, words: named(quantity, part) });
  }
  const outcome = { outcome: true, words: "outcome" };
  shows.push(outcome);
  const first = { trap: "escape_energy", run: "outcome_time", ensemble: "lost", calibrate: "stiffness" }[facts.of];
  let show = shows.find(({ quantity }) => quantity?.name === first) ?? shows[0];
  // those that are infinite come apart
  const joined = {};
  const numbers = (name) => {
    const endless = shell.array(`${name}_endless`);
    if (!endless) return shell.array(name);
    return (joined[name] ??= shell.array(name).map((x, i) => (endless[i] ? Infinity : x)));
  };
  const value = (index, { quantity, part }, name = quantity.name) => {
    const values = numbers(name), width = quantity.along.length || 1;
    if (!values) return NaN;
    return values[index * width + (part < 0 ? least(index, quantity) : part)];
  };
  const least = (index, quantity) => {
    const values = numbers(quantity.name), width = quantity.along.length;
    let best = 0;
    for (let k = 1; k < width; k++) {
      const [here, there] = [values[index * width + k], values[index * width + best]];
      if (Number.isNaN(there) || here < there) best = k;
    }
    return best;
  };
  const spoken = (x, unit) => (x === Infinity ? "longer than 10²⁰" : text(x, 4)) + (unit ? ` ${unit}` : "");

  // ---- choices
  const tools = make("div", { class: "tools" });
  const holds = make("span", { class: "holds" });
  shell.picture.append(tools);
  tools.append(labelled(flat ? "shown" : "colour", choice("What the map shows", shows.map(({ words: w }, i) => [i, w]),
    (i) => { show = shows[i]; renew(); })));
  tools.querySelector("select").value = shows.indexOf(show);
  const chooser = (label, get, set) => {
    const list = choice(label, varied.map((k) => [k, axes[k].name]), (k) => { set(Number(k)); lists.forEach((each) => each()); renew(); });
    lists.push(() => { list.value = get(); });
    list.value = get();
    return labelled(label, list);
  };
  const lists = [];
  if (varied.length > 1) {
    tools.append(
      chooser("across", () => along, (k) => { if (k === down) down = along; along = k; }),
      chooser("up", () => down, (k) => { if (k === along) along = down; down = k; }), holds);
  }
  const renewHolds = () => holds.replaceChildren(...varied.filter((k) => k !== along && k !== down).map((k) => {
    const list = choice(`${axes[k].name}: value held`, axes[k].keys[0].values.map((_, i) => [i, valueWords(axes[k], i)]),
      (i) => { picked[k] = Number(i); renew(); });
    list.value = picked[k];
    return labelled(axes[k].name, list);
  }));

  // ---- the map, or the curve
  const bar = colourBar(), legend = make("div", { class: "kinds" });
  const caption = make("p", { class: "caption" });
  shell.picture.append(caption);
  const chart = new Chart(shell, shell.picture, {
    paint: (pen) => (flat ? curve(pen) : cells(pen)),
    onpick: (x, y) => pick(flat ? { x } : { x, y }),
  });
  shell.picture.append(bar.element, legend);
  let norm = null;
  const cases = () => {
    const found = [];
    for (let i = 0; i < sizes[along]; i++)
      for (let j = 0; j < (flat ? 1 : sizes[down]); j++) {
        const at = [...picked];
        at[along] = i;
        if (!flat) at[down] = j;
        found.push({ i, j, index: number(at) });
      }
    return found;
  };
  const renew = () => {
    renewHolds();
    const every = cases();
    if (!show.outcome) {
      const values = every.map(({ index }) => value(index, show)).filter((x) => Number.isFinite(x));
      const log = show.quantity.log && Math.min(...values) > 0 && Math.max(...values) / Math.min(...values) > WIDE;
      const within = flat ? gathered(values, log) : values;
      norm = { low: Math.min(...within), high: Math.max(...within), log, any: values.length > 0 };
    }
    const x = scale(axes[along]);
    chart.axes(x, flat ? curveRange() : scale(axes[down]));
    describe(every);
    chart.draw();
    open();
  };
  const curveRange = () => {
    if (show.outcome) return { low: -0.5, high: words.outcome.length - 0.5, name: "outcome", ticks: words.outcome.map((word, i) => [i, word.slice(0, 8)]) };
    const { low, high, log, any } = norm, { unit } = show.quantity;
    const name = show.words.length > 44 ? show.quantity.name.replaceAll("_", " ") : show.words;
    if (!any) return { low: 0, high: 1, name, unit };
    if (log) return { low: low / 1.5, high: high * 1.5, log, name, unit };
    const room = 0.08 * (high - low) || Math.abs(high) || 1;
    return { low: low - room, high: high + room, name, unit };
  };
  const inNorm = (x) => {
    if (x === Infinity) return 1;
    if (!(norm.high > norm.low)) return 0.5;
    return norm.log ? Math.log(x / norm.low) / Math.log(norm.high / norm.low) : (x - norm.low) / (norm.high - norm.low);
  };
  const describe = (every) => {
    const held = varied.filter((k) => k !== along && k !== down).map((k) => `${axes[k].name} = ${valueWords(axes[k], picked[k])}`);
    const over = flat ? axes[along].name : `${axes[along].name} and ${axes[down].name}`;
    caption.textContent = [`${show.words}${show.quantity?.unit ? ` (${show.quantity.unit})` : ""}`, ...held].join("; ");
    chart.canvas.setAttribute("aria-label",
      `${caption.textContent}, over ${over}. Arrow keys choose a case; the table below has all numbers.`);
    bar.element.hidden = flat || Boolean(show.outcome) || !norm?.any;
    if (!bar.element.hidden) {
      const middle = norm.log ? Math.sqrt(norm.low * norm.high) : (norm.low + norm.high) / 2;
      bar.set([norm.low, middle, norm.high].map((x) => text(x, 3)));
    }
    const without = new Set(), endless = !show.outcome && every.some(({ index }) => value(index, show) === Infinity);
    for (const { index } of every) if (show.outcome ? !flat : Number.isNaN(value(index, show))) without.add(outcomeOf(index));
    legend.replaceChildren(...[...without].map((word) => make("span", { class: "entry" },
      flat ? "cross:" : patch(show.outcome ? outcomeColour(word) : null, word), ` ${show.outcome ? word : `no number: ${word}`}`)),
    ...(endless && !flat ? [make("span", { class: "entry" }, "brightest: longer than 10²⁰ s too")] : []),
    ...(flat && !show.outcome ? edges(every.map(({ index }) => value(index, show))) : []),
    ...(every.some(({ index }) => doubted(index)) ? [make("span", { class: "entry" }, `${flat ? "hollow" : "dot"}: with a caveat`)] : []));
  };
  // What arrows at the edge of a curve say.
  const edges = (values) => {
    const { low, high } = chart.y, far = values.filter((x) => Number.isFinite(x) && (x < low || x > high)).length;
    return [
      ...(far ? [`arrow with a number: ${far} of ${values.length} cases, so far off that on one axis the others would not be told apart`] : []),
      ...(values.includes(Infinity) ? ["arrow without a number: longer than 10²⁰ s"] : []),
    ].map((words) => make("span", { class: "entry long" }, words));
  };
  const outcomeColour = (word) => OUTCOMES[words.outcome.indexOf(word) % OUTCOMES.length];
  const patch = (colour, word) => {
    const canvas = make("canvas", { width: 18, height: 12, class: "patch", "aria-hidden": "true" });
    const pen = canvas.getContext("2d");
    if (colour) { pen.fillStyle = css(colour); pen.fillRect(0, 0, 18, 12); } else { pen.fillStyle = hatch(pen, word); pen.fillRect(0, 0, 18, 12); }
    return canvas;
  };
  // Lines that slope one way, or crossed ones for what failed; dots for what is not computed.
  const hatch = (pen, word) => {
    const tile = make("canvas", { width: 8, height: 8 }), ink = tile.getContext("2d");
    ink.fillStyle = shell.colour("card"); ink.fillRect(0, 0, 8, 8);
    ink.strokeStyle = ink.fillStyle = shell.colour("soft"); ink.lineWidth = 1;
    const k = facts.unknown.indexOf(word);
    ink.beginPath();
    if (k === 1) ink.arc(4, 4, 1, 0, 7);
    else {
      for (const off of [-8, 0, 8]) { ink.moveTo(off, 8); ink.lineTo(off + 8, 0); }
      if (k === 0) for (const off of [-8, 0, 8]) { ink.moveTo(off, 0); ink.lineTo(off + 8, 8); }
    }
    if (k === 1) ink.fill(); else ink.stroke();
    return pen.createPattern(tile, "repeat");
  };
  const doubted = (index) => words.caveat[shell.array("caveat")[index]] !== "";

  const cells = (pen) => {
    const x = chart.x.edges.map((at) => chart.across(at)), y = chart.y.edges.map((at) => chart.up(at));
    const hatches = {};
    for (const { i, j, index } of cases()) {
      const word = outcomeOf(index), found = show.outcome ? 0 : value(index, show);
      if (show.outcome) pen.fillStyle = css(outcomeColour(word));
      else if (!Number.isNaN(found)) pen.fillStyle = css(shade(VIRIDIS, inNorm(found)));
      else pen.fillStyle = hatches[word] ??= hatch(pen, word);
      pen.fillRect(x[i], y[j + 1], x[i + 1] - x[i] + 0.5, y[j] - y[j + 1] + 0.5);
      if (doubted(index) && x[i + 1] - x[i] > 6) {
        pen.fillStyle = "#fff"; pen.strokeStyle = "#000"; pen.lineWidth = 1;
        pen.beginPath(); pen.arc((x[i] + x[i + 1]) / 2, (y[j] + y[j + 1]) / 2, 2, 0, 7); pen.fill(); pen.stroke();
      }
    }
    const [i, j] = [picked[along], picked[down]];
    for (const [colour, width] of [["#000", 5], ["#fff", 2.5]]) {
      pen.strokeStyle = colour; pen.lineWidth = width;
      pen.strokeRect(x[i] + 1, y[j + 1] + 1, x[i + 1] - x[i] - 2, y[j] - y[j + 1] - 2);
    }
  };
  const curve = (pen) => {
    const ink = shell.colour("speed"), { centres } = chart.x, bottom = chart.frame.bottom;
    pen.strokeStyle = pen.fillStyle = ink; pen.lineWidth = 1.6;
    const every = cases().map(({ i, index }) => {
      const found = show.outcome ? words.outcome.indexOf(outcomeOf(index)) : value(index, show);
      const error = show.outcome ? 0 : value(index, show, `${show.quantity.name}_error`);
      return { x: chart.across(centres[i]), found, error, index, i };
    });
    pen.beginPath();
    let pending = true;
    for (const { x, found } of every) {
      if (!Number.isFinite(found) || show.outcome) { pending = true; continue; }
      if (pending) pen.moveTo(x, chart.up(found)); else pen.lineTo(x, chart.up(found));
      pending = false;
    }
    pen.stroke();
    for (const { x, found, error, index, i } of every) {
      if (i === picked[along]) {
        pen.strokeStyle = shell.colour("ink"); pen.lineWidth = 1;
        pen.beginPath(); pen.moveTo(x, chart.frame.top); pen.lineTo(x, bottom); pen.stroke();
      }
      pen.strokeStyle = ink; pen.lineWidth = 1.2;
      if (Number.isNaN(found)) {
        pen.beginPath(); pen.moveTo(x - 4, bottom - 12); pen.lineTo(x + 4, bottom - 4); pen.moveTo(x + 4, bottom - 12); pen.lineTo(x - 4, bottom - 4); pen.stroke();
      } else {
        if (!show.outcome && (found < chart.y.low || found > chart.y.high)) {
          beyond(pen, x, found);
          continue;
        }
        const y = chart.up(found);
        if (error > 0) {
          const low = chart.y.log && found - error <= 0 ? bottom : chart.up(found - error), high = chart.up(found + error);
          pen.beginPath(); pen.moveTo(x, low); pen.lineTo(x, high); pen.moveTo(x - 3, low); pen.lineTo(x + 3, low); pen.moveTo(x - 3, high); pen.lineTo(x + 3, high); pen.stroke();
        }
        pen.fillStyle = doubted(index) ? shell.colour("card") : ink;
        pen.beginPath(); pen.arc(x, y, 4, 0, 7); pen.fill(); pen.stroke();
      }
    }
  };
  // An arrow at the edge beyond which a case lies, and its number.
  const beyond = (pen, x, found) => {
    const { left, right, top, bottom } = chart.frame, up = found > chart.y.high;
    const tip = up ? top + 3 : bottom - 3, base = tip + (up ? 10 : -10), before = x > (left + right) / 2;
    pen.fillStyle = shell.colour("speed");
    pen.beginPath(); pen.moveTo(x, tip); pen.lineTo(x - 6, base); pen.lineTo(x + 6, base); pen.fill();
    if (found === Infinity) return;
    pen.fillStyle = shell.colour("ink");
    pen.font = "600 12px system-ui, sans-serif"; pen.textBaseline = "middle"; pen.textAlign = before ? "right" : "left";
    pen.fillText(spoken(found, show.quantity.unit), x + (before ? -10 : 10), (tip + base) / 2);
  };

  // ---- choosing a case
  const nearest = (edges, at) => {
    let k = 0;
    while (k < edges.length - 2 && at >= edges[k + 1]) k++;
    return k;
  };
  const pick = ({ x, y }) => {
    picked[along] = nearest(chart.x.edges, x);
    if (y !== undefined) picked[down] = nearest(chart.y.edges, y);
    open();
    chart.draw();
  };
  const step = (axis, by) => {
    if (axis === null) return;
    picked[axis] = Math.min(Math.max(picked[axis] + by, 0), sizes[axis] - 1);
    open(true);
    chart.draw();
  };
  shell.key(["ArrowLeft", "ArrowRight"], "the case beside it (map in focus)", (event) => step(along, event.key === "ArrowRight" ? 1 : -1), [chart.canvas]);
  if (!flat) shell.key(["ArrowDown", "ArrowUp"], "the case below or above (map in focus)", (event) => step(down, event.key === "ArrowUp" ? 1 : -1), [chart.canvas]);
  shell.key(["q", "Q"], "the next quantity, or the one before", (event) => {
    show = shows[(shows.indexOf(show) + (event.key === "q" ? 1 : shows.length - 1)) % shows.length];
    tools.querySelector("select").value = shows.indexOf(show);
    renew();
    shell.say(show.words);
  });

  // ---- the numbers of a case
  const card = make("div", { class: "case" });
  shell.plots.setAttribute("aria-label", "The case that is chosen");
  shell.plots.append(card);
  const open = (told = false) => {
    const index = number(picked), word = outcomeOf(index);
    const reason = words.reason[shell.array("reason")[index]], caveat = words.caveat[shell.array("caveat")[index]];
    const keys = axes.flatMap((axis, k) => axis.keys.map((key) => ({ key, at: picked[k] })));
    const there = ({ name, along: parts }) => (parts.length ? parts : [""]).some(
      (_, k) => !Number.isNaN(value(index, { quantity: { name, along: parts }, part: k })));
    const absent = quantities.filter((quantity) => !there(quantity)).map(({ about }) => about);
    const rows = quantities.filter(there).flatMap((quantity) => {
      const { name, about, unit, along: parts } = quantity;
      const body = (parts.length ? parts : [""]).map((part, k) => {
        const found = value(index, { quantity, part: k }), error = quantity.error ? value(index, { quantity, part: k }, `${name}_error`) : NaN;
        const endless = found === Infinity;
        const told_ = endless ? { value: "longer than 10²⁰", error: "" } : withError(found, error);
        return make("tr", { "data-name": part ? `${name} ${part}` : name },
          make("th", { scope: "row" }, part || (parts.length ? "" : about)),
          make("td", {}, told_.value), make("td", {}, told_.error && `± ${told_.error}`), make("td", {}, unit));
      });
      return parts.length ? [make("tr", { class: "group" }, make("th", { colspan: 4, scope: "colgroup" }, about)), ...body] : body;
    });
    card.replaceChildren(
      make("h2", {}, `Case ${index + 1} of ${sizes.reduce((a, b) => a * b, 1)}`),
      make("dl", {}, ...keys.flatMap(({ key, at }) => [make("dt", {}, key.name), make("dd", {}, keyWords(key, at))]),
        make("dt", {}, "outcome"), make("dd", { class: "outcome" }, word)),
      ...(reason ? [make("p", { class: "warning" }, reason)] : []),
      ...(caveat ? [make("p", { class: "warning" }, `Caveat: ${caveat}`)] : []),
      make("div", { class: "scrolls", tabindex: 0, role: "region", "aria-label": "Numbers of the case" },
        make("table", {}, make("thead", {}, make("tr", {}, ...["quantity", "value", "error", "unit"].map((h) => make("th", { scope: "col" }, h)))),
          make("tbody", {}, ...rows))),
      ...(absent.length ? [make("p", { class: "caption absent" }, `Without a value in this case: ${absent.join("; ")}`)] : []),
      make("p", { class: "caption" }, "To compute it alone, change the scene by ",
        make("code", {}, keys.map(({ key, at }) => `--set ${key.key}=${key.given[at]}`).join(" "))));
    if (told) {
      const shown = show.outcome ? word : spoken(value(index, show), show.quantity.unit);
      shell.say(`${keys.map(({ key, at }) => `${key.name} ${keyWords(key, at)}`).join(", ")}: ${shown}, ${word}`);
    }
  };

  // ---- the map as a table
  const holder = make("div", { class: "scrolls", tabindex: 0, role: "region", "aria-label": "The map as a table" });
  const table = make("details", { ontoggle: () => tabulate() }, make("summary", {}, "What is shown, as a table"), holder);
  document.querySelector(".words").prepend(make("section", { class: "table" }, table));
  const tabulate = () => {
    if (!table.open) return;
    const rows = flat ? 1 : sizes[down];
    if (rows * sizes[along] > CELLS) { holder.textContent = `${rows * sizes[along]} cells are too many for a table.`; return; }
    const found = Object.fromEntries(cases().map(({ i, j, index }) => {
      const x = show.outcome ? NaN : value(index, show);
      return [`${i},${j}`, Number.isNaN(x) ? outcomeOf(index) : spoken(x, "")];
    }));
    const head = make("tr", {}, make("th", { scope: "col" }, flat ? "" : `${axes[down].name} \\ ${axes[along].name}`),
      ...axes[along].keys[0].values.map((_, i) => make("th", { scope: "col" }, valueWords(axes[along], i))));
    const body = Array.from({ length: rows }, (_, j) => make("tr", {},
      make("th", { scope: "row" }, flat ? show.words : valueWords(axes[down], j)),
      ...Array.from({ length: sizes[along] }, (__, i) => make("td", {}, found[`${i},${j}`]))));
    holder.replaceChildren(make("table", {}, make("caption", {}, caption.textContent), make("thead", {}, head), make("tbody", {}, ...body)));
  };
  shell.clock.remove();
  renew();
  new MutationObserver(tabulate).observe(caption, { childList: true });
  Object.assign(window.tweezer, {
    // The middle of a cell, or of a point, in the window, pixels of the style sheet: for tests.
    cell: (i, j = 0) => {
      chart.resize();
      const { left, top } = chart.canvas.getBoundingClientRect();
      const y = flat ? (chart.frame.top + chart.frame.bottom) / 2 : chart.up(chart.y.centres[j]);
      return [left + chart.across(chart.x.centres[i]), top + y];
    },
    axis: () => [chart.y.low, chart.y.high], picked: () => [...picked], drawn: () => ({ along, down }),
  });
}

// Values of a curve that its axis is made for: without those far off, if the others would fill too
// little of it.
function gathered(values, log) {
  const at = (x) => (log ? Math.log(x) : x), sorted = [...values].sort((a, b) => a - b);
  const middle = at(sorted[Math.floor(sorted.length / 2)]), all = at(sorted.at(-1)) - at(sorted[0]);
  const nearest = [...values].sort((a, b) => Math.abs(at(a) - middle) - Math.abs(at(b) - middle));
  for (let far = 1; far <= FAR * values.length; far++) {
    const kept = nearest.slice(0, -far);
    const span = at(Math.max(...kept)) - at(Math.min(...kept));
    if (span > 0 && span < FILLED * all) return kept;
  }
  return values;
}

function plain(axis) {
  return axis.keys.length === 1 && axis.keys[0].numeric ? 1 : 0;
}

function named({ about, along }, part) {
  if (!along.length) return about;
  return `${about}, ${part < 0 ? "smallest" : along[part]}`;
}

function labelled(words, list) {
  return make("label", { class: "tool" }, make("span", {}, words), list);
}

function keyWords({ values, unit, numeric }, i) {
  return numeric ? `${text(values[i], 4)}${unit ? ` ${unit}` : ""}` : String(values[i]);
}

function valueWords({ keys }, i) {
  return keys.map((key) => keyWords(key, i)).join(", ");
}

// The axis of a dimension: centres and edges of its cells; what is no number stands at 0, 1, 2 ...
function scale(axis) {
  const key = axis.keys[0], simple = plain(axis), { log } = key;
  const centres = simple ? key.values : key.values.map((_, i) => i);
  const [to, from] = simple && log ? [Math.log, Math.exp] : [(x) => x, (x) => x];
  const at = centres.map(to), middles = at.slice(1).map((x, i) => (x + at[i]) / 2);
  const ends = at.length > 1 ? [2 * at[0] - middles[0], 2 * at.at(-1) - middles.at(-1)] : [at[0] - 0.5, at[0] + 0.5];
  const edges = [ends[0], ...middles, ends[1]].map(from);
  return {
    centres, edges, low: edges[0], high: edges.at(-1), log: Boolean(simple && log),
    name: axis.name, unit: simple ? key.unit : "",
    ...(!simple && { ticks: centres.map((i) => [i, keyWords(key, i).slice(0, 9)]) }),
  };
}
