// The page of a trap: slices of the force about it that can be moved, and the ways out.
import { text, withError } from "tweezer/arrays";
import { Chart, VIRIDIS, choice, colourBar, shade } from "tweezer/chart";
import { Field } from "tweezer/field";
import { Flat } from "tweezer/flat";
import { Plot } from "tweezer/plot";
import { make } from "tweezer/shell";
import { Stage, drawing } from "tweezer/stage";

// Planes by the axis across them: the axes to the right and up
const PLANES = { y: [0, 2, 1], x: [1, 2, 0], z: [0, 1, 2] };
const AXES = ["x", "y", "z"];
// Pixels of the screen for a cell of a map of the force, and of the work
const FINE = 4, COARSE = 5;
// Distance of arrows, pixels
const ARROWS = 30;
// Number of steps of colour of the work, so that their edges are lines of equal work
const STEPS = 24;
// Largest distance of a mark from the slice that it is drawn on, in radii
const NEAR = 0.05;
const POINTS = 241;

export function start(content, shell) {
  const { facts } = content, { box, centre } = facts;
  const field = new Field(content, shell);
  // the force of the brightest colour, N; in the dark it is the weight
  const full = facts.largest || Math.hypot(...facts.weight) || 1e-15;
  const radius = facts.shells.at(-1), low = [-box.across, -box.across, box.low], high = [box.across, box.across, box.high];
  let across = "y", shows = "force", place = [...centre];
  const held = (p) => p.map((x, k) => Math.min(Math.max(x, low[k]), high[k]));
  place = held(place);

  // ---- the picture
  const reach = 1e6 * Math.max(2.4 * radius, 0.62 * Math.hypot(box.across, (box.high - box.low) / 2));
  const middle = [0, 0, (1e6 * (box.low + box.high)) / 2];
  const label = `The bead, ${text(2e6 * radius, 3)} µm across, at ${facts.held ? "its equilibrium" : "the focus"} in the light, and the slice, to scale.`;
  const flat = !drawing().possible;
  const stage = new (flat ? Flat : Stage)(shell, { center: middle, reach, label });
  const near = ({ z }) => Math.abs(z) < 3e-6 * reach;
  const walls = facts.walls.filter(near).map(({ z, normal, name }) => stage.wall(1e6 * z, normal, name));
  shell.outside(facts.walls.filter((wall) => !near(wall)));
  const beams = facts.beams.map((cone) => {
    const beam = stage.beam(cone, 1.4 * reach);
    beam.place(cone.focus.map(micro), cone.factor);
    return beam;
  });
  const bead = stage.bead(facts.shells.map(micro));
  bead.place(centre.map(micro));
  const sheet = stage.sheet();
  for (const { position, stable } of facts.equilibria) {
    const same = Math.hypot(...position.map((x, k) => x - centre[k])) < 1e-12;
    if (position.every((x, k) => x >= low[k] && x <= high[k]))
      stage.label(stable ? (same ? "equilibrium" : "stable too") : "unstable", position.map(micro));
  }
  const escapes = facts.escapes.map(({ direction, force_at }) => {
    const way = [0, 0, 0];
    way[AXES.indexOf(direction[1])] = Number(`${direction[0]}1`) * micro(force_at);
    const arrow = stage.arrow("speed");
    arrow.set(centre.map(micro), way);
    return arrow;
  });
  const here = stage.arrow("force-light");
  shell.picture.append(make("details", { class: "forces" }, make("summary", {}, "Layers"),
    shell.layers({ light: beams, bead: [bead], slice: [sheet], "escape directions": escapes, walls }, () => stage.draw())));

  // ---- the slice
  const slice = make("section", { class: "slice", "aria-label": "Slice" });
  shell.board.insertBefore(slice, shell.plots);
  const planes = choice("Plane of the slice", Object.entries(PLANES).map(([k, [u, v]]) => [k, `${AXES[u]}–${AXES[v]} at ${k}`]), (k) => { across = k; renew(); });
  const what = choice("What the slice shows", [["force", "force"], ["work", "work from the equilibrium"]].map(([k, w]) =>
    [k, k === "work" && !facts.held ? "work from the focus" : w]), (k) => { shows = k; renew(); });
  const slider = make("input", {
    type: "range", min: 0, max: 1, step: 0.001, oninput: () => {
      const k = PLANES[across][2];
      move(place.with(k, low[k] + slider.value * (high[k] - low[k])));
    },
  });
  const offset = make("output", { class: "number" });
  slice.append(make("div", { class: "tools" }, what, planes, slider, offset));
  const chart = new Chart(shell, slice, {
    equal: true, paint: (pen) => paint(pen), over: (pen) => marks(pen),
    onpick: (u, v) => {
      const [a, b] = PLANES[across];
      move(place.with(a, u * 1e-6).with(b, v * 1e-6), true);
    },
  });
  const bar = colourBar();
  slice.append(bar.element, make("p", { class: "caption key" },
    facts.held
      ? "dashed: bead at its equilibrium; + focus; disc: stable, ring: unstable; open square: largest pull back; bar: end of the pull"
      : "dashed: bead at the focus, for no equilibrium holds it; + focus; ring: unstable"));
  let image = null;
  const axis = (k) => ({ low: micro(low[k]), high: micro(high[k]), name: AXES[k], unit: "µm" });
  // Colours of the slice, cell by cell from below; kept until it changes.
  const render = () => {
    const [a, b, c] = PLANES[across], { left, right, top, bottom } = chart.frame;
    const cell = shows === "force" ? FINE : COARSE;
    const wide = Math.max(8, Math.round((right - left) / cell)), tall = Math.max(8, Math.round((bottom - top) / cell));
    const values = new Float64Array(wide * tall), p = [0, 0, 0];
    p[c] = place[c];
    for (let j = 0; j < tall; j++)
      for (let i = 0; i < wide; i++) {
        p[a] = low[a] + ((i + 0.5) / wide) * (high[a] - low[a]);
        p[b] = low[b] + ((j + 0.5) / tall) * (high[b] - low[b]);
        values[j * wide + i] = shows === "force" ? Math.hypot(...field.force(p)) : field.work(centre, p, 10) / facts.thermal;
      }
    const most = shows === "force" ? full : values.reduce((x, y) => Math.max(x, y), 0) || 1;
    const pixels = new Uint8ClampedArray(4 * values.length);
    values.forEach((x, k) => {
      // square roots: weak forces are seen beside strong ones
      let part = Math.sqrt(Math.max(x, 0) / most);
      if (shows === "work") part = Math.floor(part * STEPS) / STEPS;
      pixels.set(shows === "work" && x < 0 ? [150, 150, 150, 255] : [...shade(VIRIDIS, part), 255], 4 * k);
    });
    const canvas = make("canvas", { width: wide, height: tall });
    canvas.getContext("2d").putImageData(new ImageData(pixels, wide, tall), 0, 0);
    image = { canvas, key: keyed(), wide, tall, most };
    const corners = [[0, 0], [1, 0], [1, 1], [0, 1]].map(([u, v]) => {
      const corner = [0, 0, 0];
      corner[a] = u ? high[a] : low[a]; corner[b] = v ? high[b] : low[b]; corner[c] = place[c];
      return corner.map(micro);
    });
    sheet.set(corners, pixels, wide, tall);
    const [factor, unit] = shows === "force" ? [1e12, "pN"] : [1, "kT"];
    bar.set([0, 1 / 16, 1 / 4, 9 / 16, 1].map((x) => `${text(x * most * factor, 2)}${x === 1 ? ` ${unit}` : ""}`));
  };
  const keyed = () => [across, shows, place[PLANES[across][2]], chart.width, chart.height].join();
  const paint = (pen) => {
    if (image?.key !== keyed()) render();
    const { left, right, top, bottom } = chart.frame;
    pen.save();
    pen.translate(left, bottom); pen.scale(1, -1);
    pen.imageSmoothingEnabled = shows === "force";
    pen.drawImage(image.canvas, 0, 0, right - left, bottom - top);
    pen.restore();
    arrows(pen);
    solid(pen);
  };
  // The direction of the force within the slice; shorter where it leads out of it.
  const arrows = (pen) => {
    const [a, b] = PLANES[across], { left, right, top, bottom } = chart.frame, p = [...place];
    pen.lineCap = "round";
    const lines = new Path2D();
    for (let x = left + ARROWS / 2; x < right; x += ARROWS)
      for (let y = bottom - ARROWS / 2; y > top; y -= ARROWS) {
        p[a] = 1e-6 * chart.xAt(x); p[b] = 1e-6 * chart.yAt(y);
        const force = field.force(p), size = Math.hypot(...force);
        if (size < 2e-3 * full) continue;
        const u = (0.36 * ARROWS * force[a]) / size, v = (-0.36 * ARROWS * force[b]) / size;
        lines.moveTo(x - u, y - v); lines.lineTo(x + u, y + v);
        lines.lineTo(x + 0.35 * u - 0.4 * v, y + 0.35 * v + 0.4 * u);
        lines.moveTo(x + u, y + v);
        lines.lineTo(x + 0.35 * u + 0.4 * v, y + 0.35 * v - 0.4 * u);
      }
    pen.strokeStyle = "#000a"; pen.lineWidth = 2.6; pen.stroke(lines);
    pen.strokeStyle = "#fffd"; pen.lineWidth = 1.2; pen.stroke(lines);
  };
  // Walls: where the bead's centre cannot be is beyond the axes, what is solid is drawn where seen.
  const solid = (pen) => {
    if (across === "z") return;
    pen.fillStyle = shell.colour("wall");
    for (const { z, normal } of facts.walls) {
      const y = chart.up(micro(z)), { left, right, top, bottom } = chart.frame;
      if (normal > 0 && y < bottom) pen.fillRect(left, y, right - left, bottom - y);
      if (normal < 0 && y > top) pen.fillRect(left, top, right - left, y - top);
    }
  };
  const marks = (pen) => {
    const [a, b, c] = PLANES[across], { left, right, top, bottom } = chart.frame;
    const at = (p) => [chart.across(micro(p[a])), chart.up(micro(p[b]))];
    const scale = (right - left) / micro(high[a] - low[a]);
    const outlined = (draw, dash = []) => {
      for (const [colour, width] of [["#000c", 3.6], ["#fff", 1.6]]) {
        pen.strokeStyle = colour; pen.lineWidth = width; pen.setLineDash(dash);
        pen.beginPath(); draw(); pen.stroke();
      }
      pen.setLineDash([]);
    };
    pen.save();
    pen.beginPath(); pen.rect(left, top, right - left, bottom - top); pen.clip();
    for (const light of facts.beams) {
      const { half_angle, wavelength } = light;
      const waist = wavelength / (2 * Math.sin(half_angle)), slope = Math.tan(half_angle);
      if (across !== "z") {
        // the hyperbola in which the slice cuts the cone
        for (const side of [-1, 1]) outlined(() => {
          let begun = false;
          for (let i = 0; i <= 120; i++) {
            const z = low[2] + (i / 120) * (high[2] - low[2]), r = Math.hypot(waist, slope * (z - light.focus[2]));
            const off = place[c] - light.focus[c];
            if (r <= Math.abs(off)) { begun = false; continue; }
            const p = [...light.focus];
            p[a] += side * Math.sqrt(r * r - off * off); p[2] = z;
            if (begun) pen.lineTo(...at(p)); else pen.moveTo(...at(p));
            begun = true;
          }
        }, [2, 5]);
      }
      const [x, y] = at(light.focus);
      outlined(() => { pen.moveTo(x - 6, y); pen.lineTo(x + 6, y); pen.moveTo(x, y - 6); pen.lineTo(x, y + 6); });
    }
    const cut = radius ** 2 - (place[c] - centre[c]) ** 2;
    if (cut > 0) outlined(() => pen.arc(...at(centre), scale * micro(Math.sqrt(cut)), 0, 7), [6, 4]);
    const within = (p) => Math.abs(p[c] - place[c]) < NEAR * radius;
    const said = [];
    if (within(centre)) for (const escape of facts.escapes) {
      const k = AXES.indexOf(escape.direction[1]), side = Number(`${escape.direction[0]}1`);
      if (k === c) continue;
      const point = (distance) => at(centre.with(k, centre[k] + side * distance));
      const end = escape.range ?? escape.wall_at ?? 1;
      outlined(() => { pen.moveTo(...at(centre)); pen.lineTo(...point(end)); });
      const [x, y] = point(escape.force_at);
      outlined(() => pen.rect(x - 4, y - 4, 8, 8));
      if (escape.range ?? escape.wall_at) {
        const [u, v] = point(end), flatBar = k === b ? [7, 0] : [0, 7];
        outlined(() => { pen.moveTo(u - flatBar[0], v - flatBar[1]); pen.lineTo(u + flatBar[0], v + flatBar[1]); });
      }
      // beside the slice there is room for them, where it is narrow
      said.push(() => {
        pen.font = "600 12px system-ui, sans-serif"; pen.textBaseline = "middle";
        pen.textAlign = k === b || side > 0 ? "left" : "right";
        const words = `${text(1e12 * escape.force, 3)} pN`, spot = k === b ? [x + 9, y] : [x + 6 * side, y - 13];
        pen.strokeStyle = "#000c"; pen.lineWidth = 3.5; pen.strokeText(words, ...spot);
        pen.fillStyle = "#fff"; pen.fillText(words, ...spot);
      });
    }
    for (const { position, stable } of facts.equilibria) {
      if (!within(position)) continue;
      const [x, y] = at(position);
      outlined(() => pen.arc(x, y, 4.5, 0, 7));
      if (stable) { pen.fillStyle = "#fff"; pen.beginPath(); pen.arc(x, y, 4.5, 0, 7); pen.fill(); }
    }
    const [x, y] = at(place);
    outlined(() => { pen.moveTo(x - 14, y); pen.lineTo(x - 5, y); pen.moveTo(x + 5, y); pen.lineTo(x + 14, y); pen.moveTo(x, y - 14); pen.lineTo(x, y - 5); pen.moveTo(x, y + 5); pen.lineTo(x, y + 14); });
    pen.restore();
    for (const say of said) say();
  };

  // ---- the numbers and the curves at the place
  shell.plots.setAttribute("aria-label", "The place that is chosen");
  const cells = {};
  const row = (name, words) => make("tr", {}, make("th", { scope: "row" }, words), (cells[name] = make("td", { "data-name": name })));
  shell.plots.append(make("table", { class: "here" }, make("caption", {}, "A bead whose centre is at the place chosen"),
    make("tbody", {}, row("place", "place (x, y, z)"), row("force", "force (x, y, z)"), row("size", "size of the force"),
      row("off", "error of the tables"), row("straight", `work from the ${facts.held ? "equilibrium" : "focus"}, straight`),
      row("across", "  across, then along z"), row("along", "  along z, then across"))));
  const plots = AXES.map((name, k) => {
    const values = new Float64Array(POINTS).map((_, i) => micro(low[k]) + (i / (POINTS - 1)) * micro(high[k] - low[k]));
    return new Plot(shell, shell.plots, { values, name, unit: "µm" },
      [{ name: `F${name}`, values: new Float64Array(POINTS), colour: name }],
      { title: `Force along ${name}`, unit: "pN", range: [-1, 1], onpick: (x) => move(place.with(k, 1e-6 * x), true) });
  });
  const numbers = () => {
    const force = field.force(place), off = field.off(place);
    const of = (values, factor, digits) => values.map((x) => fixed(factor * x, digits)).join(", ");
    const digits = Math.min(Math.max(0, 4 - Math.floor(Math.log10(1e12 * full))), 8);
    cells.place.textContent = `${of(place, 1e6, 4)} µm`;
    cells.force.textContent = `${of(force, 1e12, digits)} pN`;
    cells.size.textContent = `${text(1e12 * Math.hypot(...force), 4)} pN`;
    cells.off.textContent = `${text(1e12 * off, 2)} pN`;
    const corner = (first) => (first ? [place[0], place[1], centre[2]] : [centre[0], centre[1], place[2]]);
    const work = (...stops) => stops.slice(1).reduce((sum, stop, i) => sum + field.work(stops[i], stop, 160), 0) / facts.thermal;
    const error = (off * Math.hypot(...place.map((x, k) => x - centre[k]))) / facts.thermal;
    for (const [name, found] of [["straight", work(centre, place)], ["across", work(centre, corner(true), place)], ["along", work(centre, corner(false), place)]]) {
      const { value } = withError(found, Math.max(error, 1e-3 * Math.abs(found)));
      cells[name].textContent = `${value} kT`;
    }
    for (const [k, plot] of plots.entries()) {
      const curve = plot.curves[0].values, xs = plot.x.values, [first, last] = [micro(low[k]), micro(high[k])];
      // the place itself is one of the points, so that the curve has its force
      const own = Math.round(((micro(place[k]) - first) / (last - first)) * (POINTS - 1));
      for (let i = 0; i < POINTS; i++) {
        xs[i] = i === own ? micro(place[k]) : first + (i / (POINTS - 1)) * (last - first);
        const found = 1e12 * field.force(place.with(k, 1e-6 * xs[i]))[k];
        curve[i] = Math.abs(found) < 1e4 * full ? 0 : found;
      }
      // beside the force of a wall that of the light would not be seen
      const most = Math.min(Math.max(...curve.map(Math.abs)), 2e12 * full) || 1;
      plot.range = [-1.12 * most, 1.12 * most];
      plot.cursor = micro(place[k]);
      plot.describe();
      if (plot.width) plot.draw(); else plot.move(plot.cursor);
    }
    const scale = (0.8 * reach) / full;
    here.set(place.map(micro), force.map((x) => x * scale));
    stage.request();
  };

  // ---- moving
  const renew = () => {
    const [a, b, c] = PLANES[across];
    chart.axes(axis(a), axis(b));
    planes.value = across; what.value = shows;
    slider.value = (place[c] - low[c]) / (high[c] - low[c]);
    slider.setAttribute("aria-label", `Where the slice cuts ${across}`);
    const words = `${across} = ${fixed(micro(place[c]), 3)} µm`;
    offset.textContent = words;
    slider.setAttribute("aria-valuetext", words);
    chart.canvas.setAttribute("aria-label", `${what.selectedOptions[0].text} on the plane ${AXES[a]}–${AXES[b]} at ${words}. Arrow keys move the place within it, page up and down the slice; numbers are in the table beside it.`);
    chart.draw();
    numbers();
  };
  const move = (to, told = false) => {
    place = held(to);
    renew();
    if (told) shell.say(`At ${cells.place.textContent} the force is ${cells.force.textContent}`);
  };
  const step = (k, by, large) => move(place.with(k, place[k] + by * (large ? 0.1 : 0.01) * (high[k] - low[k])), true);
  for (const [i, less, more, moves] of [
    [0, "ArrowLeft", "ArrowRight", "the place to the left or right"],
    [1, "ArrowDown", "ArrowUp", "the place down or up"],
    [2, "PageDown", "PageUp", "the slice back or on"],
  ]) shell.key([less, more], `${moves}; with shift ten times as far (slice in focus)`,
    ({ key, shiftKey }) => step(PLANES[across][i], key === more ? 1 : -1, shiftKey), [chart.canvas]);
  shell.key("p", "the next plane", () => { const names = Object.keys(PLANES); across = names[(names.indexOf(across) + 1) % 3]; renew(); shell.say(`Plane ${planes.selectedOptions[0].text}`); });
  shell.key("w", "force or work", () => { shows = shows === "force" ? "work" : "force"; renew(); shell.say(`The slice shows ${what.selectedOptions[0].text}`); });
  shell.key("e", facts.held ? "to the equilibrium" : "to the focus", () => move(centre, true));
  shell.clock.remove();
  Object.assign(window.tweezer, {
    force: (p) => field.force(p), off: (p) => field.off(p), work: (p) => field.work(centre, p, 160),
    place: () => place, move: (p) => move(p),
    // Where a place of the slice is in the window, pixels of the style sheet: for tests.
    spot: (p) => {
      chart.resize();
      const [a, b] = PLANES[across], { left, top } = chart.canvas.getBoundingClientRect();
      return [left + chart.across(micro(p[a])), top + chart.up(micro(p[b]))];
    },
  });
  renew();
}

const micro = (x) => 1e6 * x;

// With so many decimals, and no sign before zero.
function fixed(value, digits) {
  const words = value.toFixed(digits);
  return Number(words) === 0 ? words.replace("-", "") : words.replace("-", "−");
}
