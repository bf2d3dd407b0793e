// The page of a run of several beads: all move in the light, with tethers, distances and forces.
import { column, locate, scaled, text } from "tweezer/arrays";
import { Clock, nice } from "tweezer/clock";
import { Flat } from "tweezer/flat";
import { Plot, swatch } from "tweezer/plot";
import { make, write } from "tweezer/shell";
import { Stage, drawing } from "tweezer/stage";

// Colours of the beads and of the pairs, in their order
const COLOURS = ["x", "y", "z", "speed", "terminal", "force-fluid"];
const DASHES = [[], [7, 3], [2, 2.5], [7, 3, 2, 3], [4, 2], [1, 2]];
const AXES = ["x", "y", "z"];
const style = (k) => ({ colour: COLOURS[k % COLOURS.length], dash: DASHES[k % DASHES.length] });

export function start(content, shell) {
  const { facts } = content, { beads: given, tethers } = facts;
  const times = shell.array("time"), place = shell.array("position").map((x) => 1e6 * x);
  const foci = shell.array("foci"), factors = shell.array("factors"), light = shell.array("force_light");
  const n = times.length, count = given.length, width = 3 * count;
  const { center, reach } = seen(facts, place, foci);

  const names = given.map(({ name }) => name).join(", ");
  const label = `${count} beads (${names}), their paths, tethers and the light, to scale; ` +
    "the plots and the table below have the numbers.";
  const flat = !drawing().possible;
  const stage = new (flat ? Flat : Stage)(shell, { center, reach, label });
  if (flat) shell.picture.append(make("p", { class: "warning" },
    "This browser does not draw in 3-D (WebGL is off): the picture is a plain projection."));
  const grid = stage.floor(center[2] - reach);
  const walls = facts.walls.map(({ z, normal, name }) => stage.wall(1e6 * z, normal, name));
  const beams = facts.beams.map((beam) => stage.beam(beam, 1.5 * reach));
  const paths = given.map((_, k) => {
    const each = new Float32Array(3 * n);
    for (let i = 0; i < n; i++) each.set(place.subarray(i * width + 3 * k, i * width + 3 * k + 3), 3 * i);
    const path = stage.path(each, facts.resolved);
    shell.onTheme(() => path.colour(stage.colours(style(k).colour, n)));
    return path;
  });
  const beads = given.map(({ shells }) => stage.bead(shells.map((r) => 1e6 * r)));
  const lines = tethers.map(() => stage.tether("force-sum"));
  const arrows = given.map(() => stage.arrow("force-light"));
  const clock = new Clock(shell, times);

  const at = (values, wide, index, part) => Array.from({ length: wide }, (_, k) => {
    const a = values[index * wide + k], b = values[Math.min(index + 1, n - 1) * wide + k];
    return facts.resolved ? a + part * (b - a) : a;
  });
  const of = (values, k) => values.slice(3 * k, 3 * k + 3);

  // ---- arrows of the light
  let largest = 0;
  for (let i = 0; i < light.length; i += 3) largest = Math.max(largest, Math.hypot(light[i], light[i + 1], light[i + 2]));
  const newtons = largest > 0 ? nice(largest / (0.5 * reach)) : 1; // of an arrow of one micrometre
  const numbers = given.map(() => make("span", { class: "number" }));
  let shown = true;
  shell.picture.append(make("details", { class: "forces", open: matchMedia("(min-width: 700px)").matches },
    make("summary", {}, "Light on the beads"),
    ...given.map(({ name }, k) => make("p", {}, swatch(style(k)), ` ${name} `, numbers[k])),
    make("label", {}, make("input", { type: "checkbox", checked: true, onchange: (event) => { shown = event.target.checked; show(clock.time); } }),
      ` arrows; 1 µm is ${inUnit(newtons, "N", 2)}`),
    shell.layers({ light: beams, paths, beads, tethers: lines, grid: [grid], walls }, () => stage.draw())));

  const plots = plotted(content, shell, clock, place, width);

  // ---- what is shown at a time
  const show = (time) => {
    const [index, part] = locate(times, time);
    const here = at(place, width, index, part), now = at(light, width, index, part);
    const focus = foci && at(foci, 3 * beams.length, index, part);
    const power = factors && at(factors, beams.length, index, part);
    beams.forEach((beam, k) => beam.place((foci ? of(focus, k) : facts.beams[k].focus).map((x) => 1e6 * x), power ? power[k] : 1));
    given.forEach((_, k) => {
      beads[k].place(of(here, k));
      paths[k].upTo(index);
      const force = of(now, k);
      arrows[k].set(of(here, k), shown ? force.map((x) => x / newtons) : [0, 0, 0]);
      write(numbers[k], inUnit(Math.hypot(...force), "N", 3));
    });
    tethers.forEach(({ beads: [a, b], point }, k) => lines[k].set(...ends(here, a, b, point)));
    for (const plot of plots) plot.move(plot.x.factor * time);
    stage.request();
  };
  // From the surface of a bead to the surface of another, or to a point, um.
  const ends = (here, a, b, point) => {
    const from = of(here, a), to = point ? point.map((x) => 1e6 * x) : of(here, b);
    const way = from.map((x, k) => to[k] - x), length = Math.hypot(...way) || 1;
    const [first, last] = [a, b].map((k) => (k === undefined ? 0 : 1e6 * given[k].shells.at(-1) / length));
    return [from.map((x, k) => x + first * way[k]), to.map((x, k) => x - last * way[k])];
  };
  clock.listen(show);
  Object.assign(window.tweezer, {
    seek: (time) => { clock.seek(time); stage.draw(); },
    time: () => clock.time, play: () => clock.play(), pause: () => clock.pause(),
    duration: [clock.first, clock.last],
    // Where a bead and the ends of a tether are, um: for tests.
    bead: (k) => beads[k].at(),
    tether: (k) => lines[k].ends(),
    // Hide or show a part of the picture.
    show: (name, on) => {
      const parts = { light: beams, path: paths, bead: beads, tether: lines, arrows };
      for (const each of parts[name]) each.group.visible = on;
      stage.draw();
    },
  });
  shell.offer("Data", "save the samples as a CSV file, in SI units", () => shell.downloadTable(samples(shell, facts, width)));
  if (window.MediaRecorder && stage.canvas.captureStream && n > 1)
    shell.offer("Film", "record the picture from the start to the end as a video", () => clock.film(stage.canvas));
  if (clock.time === clock.first && !matchMedia("(prefers-reduced-motion: reduce)").matches && n > 1) clock.play();
}

function inUnit(value, si, digits) {
  const { factor, unit } = scaled(value || 1, si);
  return value > 0 ? `${text(value * factor, digits)} ${unit}` : "0";
}

// Middle and half the size of what is to be seen, um.
function seen({ beads, beams, tethers }, place, foci) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const radius = 1e6 * Math.max(...beads.map(({ shells }) => shells.at(-1)));
  const take = (values, factor, room) => values.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], factor * x - room);
    high[i % 3] = Math.max(high[i % 3], factor * x + room);
  });
  take(place, 1, radius);
  if (foci) take(foci, 1e6, 0);
  else for (const { focus } of beams) take(focus, 1e6, 0);
  for (const { point } of tethers) if (point) take(point, 1e6, 0);
  return { center: low.map((x, k) => (x + high[k]) / 2), reach: 0.62 * Math.hypot(...high.map((x, k) => x - low[k])) };
}

// The plots: along the line of the first two beads, distances and forces between.
function plotted(content, shell, clock, place, width) {
  const { facts } = content, { factor, unit } = clock.shown, times = shell.array("time"), points = !facts.resolved;
  const x = { values: times.map((t) => factor * t), name: "time", unit, factor };
  const options = { jumps: points, onpick: (value) => clock.seek(value / factor) };
  const far = AXES.map((_, k) => Math.abs(place[3 + k] - place[k])), axis = far.indexOf(Math.max(...far));
  const moved = facts.beads.map(({ name }, k) => {
    const values = column(place, 3 * k + axis, width);
    return { name, values: values.map((value) => 1e3 * (value - values[0])), ...style(k), points };
  });
  const plots = [new Plot(shell, shell.plots, x, moved, { ...options, title: `Displacement in ${AXES[axis]}`, unit: "nm" })];
  const add = (title, name, size, shown) => {
    const values = shell.array(name), wide = facts.pairs.length;
    if (!values) return;
    const curves = facts.pairs.map((pair, k) => ({ name: pair, values: column(values, k, wide, size), ...style(k), points }));
    plots.push(new Plot(shell, shell.plots, x, curves, { ...options, title, unit: shown }));
  };
  add("Distance of the centres", "distance", 1e6, "µm");
  add("Force between", "force_between", 1e12, "pN");
  return plots;
}

// Columns of the samples of a run, in SI units, by their headings.
function samples(shell, { beads, pairs }, width) {
  const columns = { "time (s)": shell.array("time") };
  for (const [name, unit] of [["position", "m"], ["force_light", "N"]])
    beads.forEach((bead, k) => AXES.forEach((axis, j) => {
      columns[`${name} ${axis} of ${bead.name} (${unit})`] = column(shell.array(name), 3 * k + j, width);
    }));
  for (const [name, unit] of [["distance", "m"], ["force_between", "N"]]) {
    const values = shell.array(name);
    if (values) pairs.forEach((pair, k) => { columns[`${name} of ${pair.replace(", ", " and ")} (${unit})`] = column(values, k, pairs.length); });
  }
  return columns;
}
