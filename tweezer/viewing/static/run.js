// The page of a run: the bead moves in the light; forces, path and plots go with it.
import { axesOf, column, locate, scaled, text } from "tweezer/arrays";
import { VIRIDIS, shade } from "tweezer/chart";
import { Clock, nice } from "tweezer/clock";
import { Plot, swatch } from "tweezer/plot";
import { make, write } from "tweezer/shell";
import { Stage, drawing } from "tweezer/stage";
import { Flat } from "tweezer/flat";

// Names of forces, the colours of their arrows, and whether they are shown at first
const FORCES = {
  light: ["light", "force-light", true],
  weight: ["weight less buoyancy", "force-weight", false],
  wall: ["walls", "force-wall", true],
  others: ["other forces", "force-wall", true],
  drag: ["drag", "force-drag", true],
  fluid: ["inertia of the fluid", "force-fluid", true],
  medium: ["rest of the medium", "force-fluid", true],
  sum: ["sum", "force-sum", false],
};
const DASHES = { x: [], y: [7, 3], z: [2, 2.5] };

export function start(content, shell) {
  const { facts } = content;
  const times = shell.array("time");
  const place = shell.array("position").map((x) => 1e6 * x);
  const euler = shell.array("orientation"), foci = shell.array("foci"), factors = shell.array("factors");
  const n = times.length, radius = 1e6 * facts.shells.at(-1);
  const { center, reach, walls, outside } = seen(facts, place, foci, radius);

  const label = `The bead, ${text(2 * radius, 3)} µm across, its path and the light, to scale; ` +
    "the plots and the table below have the numbers.";
  const flat = !drawing().possible;
  const stage = new (flat ? Flat : Stage)(shell, { center, reach, label });
  if (flat) shell.picture.append(make("p", { class: "warning" },
    "This browser does not draw in 3-D (WebGL is off): the picture is a plain projection."));
  const lowest = walls.find(({ normal }) => normal > 0);
  const floor = lowest ? 1e6 * lowest.z : center[2] - reach;
  const grid = stage.floor(floor);
  const sheets = walls.map(({ z, normal, name }) => stage.wall(1e6 * z, normal, name));
  const beams = facts.beams.map((beam) => stage.beam(beam, 1.5 * reach));
  const path = stage.path(place, facts.resolved);
  path.group.visible = !(facts.body && facts.thermal); // a body is hard to see on a path that is tangled
  const bead = stage.bead(facts.shells.map((r) => 1e6 * r), facts.body);
  const clock = new Clock(shell, times);

  // ---- where everything is at a time
  const at = (values, width, index, part) => Array.from({ length: width }, (_, k) => {
    const a = values[index * width + k], b = values[Math.min(index + 1, n - 1) * width + k];
    return facts.resolved ? a + part * (b - a) : a;
  });
  const turned = (index, part) => {
    const a = at(euler, 4, index, 0), b = at(euler, 4, Math.min(index + 1, n - 1), 0);
    const sign = a.reduce((sum, x, k) => sum + x * b[k], 0) < 0 ? -1 : 1;
    return a.map((x, k) => x + (facts.resolved ? part : 0) * (sign * b[k] - x));
  };

  // ---- arrows
  const forces = Object.entries(FORCES).filter(([name]) => content.arrays[`force_${name}`]).map(([name, [words, colour, on]]) => ({
    name, words, colour, on, values: shell.array(`force_${name}`), arrow: stage.arrow(colour), number: make("span", { class: "number" }),
  }));
  let largest = 0;
  for (const { values } of forces) for (let i = 0; i < n; i++) largest = Math.max(largest, Math.hypot(...at(values, 3, i, 0)));
  // newtons of an arrow of one micrometre
  const fixed = largest > 0 ? nice(largest / (0.75 * reach)) : 1;
  let grown = false;
  const arrowScale = make("span");
  const card = make("details", { class: "forces", open: matchMedia("(min-width: 700px)").matches },
    make("summary", {}, "Forces"),
    ...forces.map((force) => make("label", {},
      make("input", { type: "checkbox", checked: force.on, onchange: (event) => { force.on = event.target.checked; show(clock.time); } }),
      swatch({ colour: force.colour }), ` ${force.words} `, force.number)),
    make("label", { title: "Arrows grow so that the longest is always as long" },
      make("input", { type: "checkbox", onchange: (event) => { grown = event.target.checked; show(clock.time); } }),
      " enlarge small forces"),
    make("p", {}, "an arrow of 1 µm is ", arrowScale),
    shell.layers({ light: beams, path: [path], bead: [bead], grid: [grid], walls: sheets }, () => stage.draw()));
  shell.picture.append(card);
  shell.outside(outside);

  // ---- the colours of the path
  const byTime = column(times, 0, 1), speed = shell.array("speed");
  const choices = { time: ["time", byTime, "s"], ...(speed && !facts.thermal && { speed: ["speed", speed, "m/s"] }) };
  let coloured = choices.speed ? "speed" : "time";
  const ramp = make("span", { class: "ramp" }), rampLow = make("span"), rampHigh = make("span");
  const chooser = make("select", { "aria-label": "What colours the path", onchange: () => { coloured = chooser.value; paint(); stage.request(); } },
    ...Object.entries(choices).map(([name]) => make("option", { value: name, ...(name === coloured && { selected: true }) }, `path by ${name}`)));
  stage.over.append(make("div", { class: "colours" }, chooser, rampLow, ramp, rampHigh));
  const paint = () => {
    const [, values, unit] = choices[coloured];
    let low = Infinity, high = -Infinity;
    for (const value of values) { if (value < low) low = value; if (value > high) high = value; }
    const colours = new Float32Array(3 * n), stops = ramps(shell.dark);
    for (let i = 0; i < n; i++) colours.set(linear(shade(stops, (values[i] - low) / (high - low || 1))), 3 * i);
    path.colour(colours);
    const { factor, unit: shown } = scaled(Math.max(Math.abs(low), Math.abs(high)), unit);
    rampLow.textContent = text(factor * low, 2);
    rampHigh.textContent = `${text(factor * high, 2)} ${shown}`;
    ramp.style.background = `linear-gradient(90deg, ${stops.map(([r, g, b]) => `rgb(${r} ${g} ${b})`).join()})`;
  };
  shell.onTheme(paint);

  // ---- plots
  const plots = plotted(content, shell, clock, times, place, foci);

  // ---- what is shown at a time
  let following = false;
  shell.key("f", "follow the bead with the view, or not", () => {
    following = !following;
    stage.follow(following ? at(place, 3, ...locate(times, clock.time)) : null);
    shell.say(following ? "The view follows the bead" : "The view stays");
  });
  const show = (time) => {
    const [index, part] = locate(times, time);
    const here = at(place, 3, index, part);
    bead.place(here, euler && turned(index, part));
    path.upTo(index);
    beams.forEach((beam, k) => beam.place(
      foci ? at(foci, 3 * beams.length, index, part).slice(3 * k, 3 * k + 3).map((x) => 1e6 * x) : facts.beams[k].focus.map((x) => 1e6 * x),
      factors ? at(factors, beams.length, index, part)[k] : 1));
    const now = forces.map(({ values }) => at(values, 3, index, part));
    let scale = fixed;
    if (grown) {
      const most = Math.max(...now.map((force, k) => (forces[k].on ? Math.hypot(...force) : 0)));
      if (most > 0) scale = nice(most / (0.75 * reach));
    }
    forces.forEach(({ on, arrow }, k) => arrow.set(here, on ? now[k].map((x) => x / scale) : [0, 0, 0]));
    forces.forEach(({ number }, k) => write(number, inUnit(Math.hypot(...now[k]), "N", 3)));
    write(arrowScale, inUnit(scale, "N", 2));
    if (following) stage.follow(here);
    for (const plot of plots) plot.move(plot.x.factor * time);
    stage.request();
  };
  clock.listen(show);
  Object.assign(window.tweezer, {
    seek: (time) => { clock.seek(time); stage.draw(); },
    time: () => clock.time, play: () => clock.play(), pause: () => clock.pause(),
    duration: [clock.first, clock.last],
    // Where the bead is on the screen, and how it is turned: for tests.
    bead: () => ({ pixel: stage.pixel(bead.at()), turned: bead.turned?.() }),
    // Where a vertex of the surface of a body is, um: for tests.
    vertex: bead.vertex,
    // Hide or show a part of the picture.
    show: (name, on) => {
      const parts = { light: beams, path: [path], bead: [bead], arrows: forces.map(({ arrow }) => arrow) };
      for (const each of parts[name]) each.group.visible = on;
      stage.draw();
    },
  });
  shell.offer("Data", "save the samples as a CSV file, in SI units", () => shell.downloadTable(samples(shell)));
  if (window.MediaRecorder && stage.canvas.captureStream && n > 1)
    shell.offer("Film", "record the picture from the start to the end as a video", () => clock.film(stage.canvas));
  if (clock.time === clock.first && !matchMedia("(prefers-reduced-motion: reduce)").matches && n > 1) clock.play();
}

// Columns of the samples of a run, in SI units, by their headings.
function samples(shell) {
  const columns = { "time (s)": shell.array("time") };
  const vectors = { position: "m", velocity: "m/s", angular_velocity: "rad/s", ...Object.fromEntries(Object.keys(FORCES).map((name) => [`force_${name}`, "N"])) };
  for (const [name, unit] of Object.entries(vectors)) {
    const values = shell.array(name);
    if (values) ["x", "y", "z"].forEach((axis, k) => { columns[`${name} ${axis} (${unit})`] = column(values, k, 3); });
  }
  const euler = shell.array("orientation");
  if (euler) for (let k = 0; k < 4; k++) columns[`e${k}`] = column(euler, k, 4);
  return columns;
}

// A colour as three.js wants it.
function linear(colour) {
  return colour.map((c) => (c / 255) ** 2.2);
}

function inUnit(value, si, digits) {
  const { factor, unit } = scaled(value, si);
  return value > 0 ? `${text(value * factor, digits)} ${unit}` : "0";
}

// Middle and half the size of what is to be seen, um, and the walls within it and outside.
function seen(facts, place, foci, radius) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const take = (values, factor, room) => values.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], factor * x - room);
    high[i % 3] = Math.max(high[i % 3], factor * x + room);
  });
  take(place, 1, radius);
  if (foci) take(foci, 1e6, 0);
  else for (const { focus } of facts.beams) take(focus, 1e6, 0);
  const near = (z) => 1e6 * z > low[2] - 1.5 * (high[2] - low[2]) && 1e6 * z < high[2] + 1.5 * (high[2] - low[2]);
  const walls = facts.walls.filter(({ z }) => near(z)), outside = facts.walls.filter(({ z }) => !near(z));
  for (const { z } of walls) { low[2] = Math.min(low[2], 1e6 * z); high[2] = Math.max(high[2], 1e6 * z); }
  const center = low.map((x, k) => (x + high[k]) / 2);
  const reach = Math.max(0.62 * Math.hypot(...high.map((x, k) => x - low[k])), 1.9 * radius);
  return { center, reach, walls, outside };
}

function plotted(content, shell, clock, times, place, foci) {
  const { facts } = content, { factor, unit } = clock.shown;
  const x = { values: times.map((t) => factor * t), name: "time", unit, factor };
  const options = { jumps: !facts.resolved, onpick: (value) => clock.seek(value / factor) };
  const points = !facts.resolved;
  const curves = ["x", "y", "z"].map((axis, k) => ({ name: axis, values: column(place, k, 3), colour: axis, dash: DASHES[axis], points }));
  const plots = [new Plot(shell, shell.plots, x, curves, { ...options, title: "Position", unit: "µm", even: true })];
  const of = (name, size) => {
    const values = shell.array(name);
    return values && { name: size.name, values, colour: size.colour, dash: size.dash, points };
  };
  const inUnits = (title, si, log, ...entries) => {
    const found = entries.filter(Boolean);
    if (!found.length) return;
    let most = 0;
    for (const { values } of found) for (const value of values) if (Math.abs(value) > most) most = Math.abs(value);
    const shown = si ? scaled(most || 1, si) : { factor: 1, unit: "kT" };
    for (const curve of found) curve.values = curve.values.map((value) => shown.factor * value);
    plots.push(new Plot(shell, shell.plots, x, found, { ...options, title, unit: shown.unit, log }));
  };
  if (facts.thermal) inUnits("Distance", "m", false, of("distance", { name: "to the focus", colour: "speed" }));
  else inUnits("Speed", "m/s", true, of("speed", { name: "bead", colour: "speed" }),
    facts.terminal_speed && of("terminal_speed", { name: "terminal", colour: "terminal", dash: [6, 4] }));
  if (facts.body) turns(shell, x, options, points, plots);
  inUnits("Energy", "", false,
    of("energy_work", { name: "work of the light", colour: "force-light" }),
    of("energy_lost", { name: "given to the medium", colour: "force-drag", dash: [7, 3] }),
    of("energy_kinetic", { name: "kinetic", colour: "force-sum", dash: [2, 2.5] }));
  return plots;
}

// The plots of how a body turns: where its axes point, and how fast it turns about them.
function turns(shell, x, options, points, plots) {
  const euler = shell.array("orientation"), speed = shell.array("angular_velocity");
  for (const k of shell.content.facts.body.plotted_axes) {
    const along = x.values.map(() => 0), each = [along, [...along], [...along]];
    for (let i = 0; i < along.length; i++) axesOf(euler.subarray(4 * i, 4 * i + 4))[k].forEach((c, j) => { each[j][i] = c; });
    const curves = ["x", "y", "z"].map((axis, j) => ({ name: axis, values: each[j], colour: axis, dash: DASHES[axis], points }));
    plots.push(new Plot(shell, shell.plots, x, curves, { ...options, title: `Body axis ${"xyz"[k]}`, unit: "", range: [-1.06, 1.06], even: true }));
  }
  if (!speed) return;
  let most = 0;
  for (const value of speed) if (Math.abs(value) > most) most = Math.abs(value);
  const { factor, unit } = scaled(most || 1, "rad/s");
  const curves = ["x", "y", "z"].map((axis, k) => ({ name: axis, values: column(speed, k, 3, factor), colour: axis, dash: DASHES[axis], points }));
  plots.push(new Plot(shell, shell.plots, x, curves, { ...options, title: "Angular velocity about the body's axes", unit }));
}

// Colours from low to high, without the end that the theme swallows.
function ramps(dark) {
  return dark ? VIRIDIS.slice(2) : VIRIDIS.slice(0, 8);
}
