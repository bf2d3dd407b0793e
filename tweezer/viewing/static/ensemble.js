// The page of an ensemble: its beads as a cloud in motion, or the spread that statistics tell.
import { column, locate, scaled, text } from "tweezer/arrays";
import { Chart, VIRIDIS, choice, colourBar, css, shade } from "tweezer/chart";
import { Clock } from "tweezer/clock";
import { Flat } from "tweezer/flat";
import { Plot } from "tweezer/plot";
import { make } from "tweezer/shell";
import { Stage, drawing } from "tweezer/stage";

// Planes by name: the axes to the right and up
const PLANES = { "x–z": [0, 2], "y–z": [1, 2], "x–y": [0, 1] };
const DASHES = { x: [], y: [7, 3], z: [2, 2.5] };
const AXES = ["x", "y", "z"];
// Most cells of the density along an axis, and standard deviations on either side that are shown
const MOST = 48, SPREADS = 3.5;
// Pixels across the disc of a bead, and the ring of one that is lost
const DISC = 3, LARGE = 6, RING = 8;
// Number of beads above which discs are small
const MANY = 500;

export function start(content, shell) {
  const { facts } = content, times = shell.array("time"), radius = 1e6 * facts.shells.at(-1);
  const mean = shell.array("mean"), spread = shell.array("spread"), left = shell.array("left"), near = shell.array("near");
  const { low, high } = extent(mean, spread);
  const middle = low.map((x, k) => (x + high[k]) / 2);
  const reach = 0.55 * Math.hypot(...high.map((x, k) => x - low[k])) || radius;
  const beads = facts.trajectories ? facts.drawn : 0;
  const label = facts.trajectories
    ? `${beads} beads as points in the light; plots and the table below have the numbers.`
    : "The mean of the beads, with one and two standard deviations, in the light; plots and the table below have the numbers.";
  const flat = !drawing().possible;
  const stage = new (flat ? Flat : Stage)(shell, { center: middle, reach, label });
  const grid = stage.floor(low[2]);
  const close = ({ z }) => 1e6 * z > low[2] - reach && 1e6 * z < high[2] + reach;
  const walls = facts.walls.filter(close).map(({ z, normal, name }) => stage.wall(1e6 * z, normal, name));
  shell.outside(facts.walls.filter((wall) => !close(wall)));
  const beams = facts.beams.map((given) => {
    const beam = stage.beam(given, 1.5 * Math.max(reach, radius));
    beam.place(given.focus.map(micro));
    return beam;
  });
  const bead = stage.bead(facts.shells.map(micro), facts.body), euler = shell.array("orientation");
  const way = stage.path(mean.map((x) => (Number.isFinite(x) ? 1e6 * x : 0)), true);
  shell.onTheme(() => way.colour(stage.colours("speed", times.length)));
  const cloud = stage.cloud(Math.max(beads, 1), "bead-dark", beads > MANY ? DISC : LARGE), rings = stage.cloud(Math.max(beads, 1), "light-ink", RING, true);
  const shells = facts.trajectories ? null : stage.shells("bead-dark", [0.35, 0.16]);
  const clock = new Clock(shell, times);

  // ---- how many, and the bead to scale
  const counts = make("p", { class: "counts" });
  const sized = make("input", { type: "checkbox", checked: radius < 0.7 * reach, onchange: () => show(clock.time) });
  shell.picture.append(make("div", { class: "forces" }, counts,
    ...(facts.body && !euler ? [] : [make("label", {}, sized, facts.body ? " the first body, to scale" : " a bead to scale, at the mean")]),
    shell.layers({
      light: beams, ...(facts.trajectories && { beads: [cloud, rings] }), "path of the mean": [way], grid: [grid], walls,
    }, () => stage.draw())));
  shell.offer("Data", "save the mean and the spread over time as a CSV file, in SI units", () => shell.downloadTable({
    "time (s)": times,
    ...Object.fromEntries([["mean", mean], ["standard deviation", spread]].flatMap(([name, values]) =>
      AXES.map((axis, k) => [`${name} of ${axis} (m)`, column(values, k, 3)]))),
  }));

  // ---- the density
  const place = facts.trajectories ? AXES.map((name) => shell.array(name)) : null;
  // the sample at which each bead was seen last
  const seen = new Int32Array(beads);
  for (let n = 0; n < beads; n++)
    for (let i = times.length - 1; i > 0 && !seen[n]; i--) if (!Number.isNaN(place[0][i * beads + n])) seen[n] = i;
  let plane = "x–z", axesOf = "now", density = null;
  if (facts.trajectories) {
    const caption = make("p", { class: "caption" });
    const bar = colourBar();
    const holder = make("div", { class: "density" });
    const list = choice("Plane of the density", Object.keys(PLANES).map((name) => [name, name]), (name) => { plane = name; again(); });
    shell.plots.prepend(holder);
    const ranges = choice("Axes of the density", [["now", "axes of this time"], ["all", "axes of all times"]], (which) => { axesOf = which; again(); });
    holder.append(make("div", { class: "tools" }, make("h3", {}, "Probability density"), list, ranges, caption));
    const chart = new Chart(shell, holder, { equal: true, label: "Density of the beads", paint: (pen) => paint(pen) });
    holder.append(bar.element);
    // about one bead in a cell, so that the density is not the noise of its counts
    const cells = Math.min(Math.max(Math.round(Math.sqrt(beads)), 8), MOST);
    const counted = new Int32Array(cells * cells);
    const again = () => density(locate(times, clock.time)[0]);
    // no axes are narrower than this part of the widest spread: all beads may start at one place
    const widest = micro(spread.reduce((x, y) => (y > x ? y : x), 0));
    // The ends of the axes of the plane at a time, um, as long as each other.
    const ends = (plane, index) => {
      const middle = plane.map((k) => micro(mean[3 * index + k]));
      const room = SPREADS * Math.max(...plane.map((k) => micro(spread[3 * index + k]) || 0), 0.1 * widest);
      if (axesOf === "all" || !(room > 0 && middle.every(Number.isFinite))) return plane.map((k) => [low[k], high[k]]);
      return middle.map((x) => [x - room, x + room]);
    };
    let most = 1;
    const paint = (pen) => {
      const { left: x0, right, top, bottom } = chart.frame, wide = (right - x0) / cells, tall = (bottom - top) / cells;
      pen.fillStyle = css(VIRIDIS[0]);
      pen.fillRect(x0, top, right - x0, bottom - top);
      for (let k = 0; k < counted.length; k++) {
        if (!counted[k]) continue;
        pen.fillStyle = css(shade(VIRIDIS, counted[k] / most));
        pen.fillRect(x0 + (k % cells) * wide, bottom - (Math.floor(k / cells) + 1) * tall, wide + 0.5, tall + 0.5);
      }
    };
    density = (index) => {
      const [a, b] = PLANES[plane], [[x0, x1], [y0, y1]] = ends([a, b], index);
      const { factor, unit } = scaled(1e-6 * Math.max(x1 - x0, y1 - y0), "m");
      chart.axes(...[[a, x0, x1], [b, y0, y1]].map(([k, from, to]) =>
        ({ low: 1e-6 * factor * from, high: 1e-6 * factor * to, name: AXES[k], unit })));
      counted.fill(0);
      let within = 0, there = 0;
      for (let n = 0; n < beads; n++) {
        const x = place[a][index * beads + n], y = place[b][index * beads + n];
        if (Number.isNaN(x)) continue;
        there++;
        const i = Math.floor(((1e6 * x - x0) / (x1 - x0)) * cells), j = Math.floor(((1e6 * y - y0) / (y1 - y0)) * cells);
        if (i < 0 || j < 0 || i >= cells || j >= cells) continue;
        counted[j * cells + i]++;
        within++;
      }
      most = counted.reduce((x, y) => Math.max(x, y), 1);
      const area = (1e-6 * factor) ** 2 * ((x1 - x0) / cells) * ((y1 - y0) / cells);
      caption.textContent = `${there - within} of ${there} beads beyond the axes`;
      bar.set([0, 0.5, 1].map((part) => `${text((part * most) / (there || 1) / area, 2)}${part === 1 ? ` /${unit}²` : ""}`));
      chart.canvas.setAttribute("aria-label", `Probability density of ${there} beads in the plane ${plane}, at most ${text(most / (there || 1) / area, 2)} /${unit}², over ${text(Math.max(x1 - x0, y1 - y0) * 1e-6 * factor, 2)} ${unit}`);
      chart.draw();
    };
  }

  // ---- plots
  const plots = plotted(content, shell, clock, { mean, spread, left, near });

  // ---- what is shown at a time
  let before = -1;
  const show = (time) => {
    const [index] = locate(times, time);
    const here = [0, 1, 2].map((k) => micro(mean[3 * index + k]));
    const first = euler ? AXES.map((_, k) => micro(place[k][index * beads])) : here;
    bead.group.visible = sized.checked && (!facts.body || Boolean(euler)) && first.every(Number.isFinite);
    if (bead.group.visible) bead.place(first, euler?.subarray(4 * index, 4 * index + 4));
    way.upTo(index);
    if (place) {
      let drawn = 0, gone = 0;
      for (let n = 0; n < beads; n++) {
        const away = Number.isNaN(place[0][index * beads + n]), at = away ? seen[n] : index;
        const [into, to] = away ? [rings.places, 3 * gone++] : [cloud.places, 3 * drawn++];
        for (let k = 0; k < 3; k++) into[to + k] = 1e6 * place[k][at * beads + n];
      }
      cloud.set(drawn);
      rings.set(gone);
      if (index !== before) density(index);
    } else shells.set(here, [0, 1, 2].map((k) => micro(spread[3 * index + k])));
    const there = left[index];
    const words = [`${there} of ${facts.beads} beads are left, ${facts.beads - there} lost`];
    if (near) words.push(`${near[index]} within one bead radius of the equilibrium`);
    counts.replaceChildren(...words.flatMap((line, i) => (i ? [make("br"), line] : [line])));
    for (const plot of plots) plot.move(plot.x.factor * time);
    before = index;
    stage.request();
  };
  clock.listen(show);
  if (density) shell.onTheme(() => density(locate(times, clock.time)[0]));
  Object.assign(window.tweezer, {
    seek: (time) => { clock.seek(time); stage.draw(); },
    time: () => clock.time, play: () => clock.play(), pause: () => clock.pause(),
    duration: [clock.first, clock.last],
    // Places of the rings of the lost, um: for tests.
    rings: () => Array.from(rings.places),
    bead: () => ({ at: bead.at(), visible: bead.group.visible }),
    vertex: bead.vertex,
    show: (name, on) => { ({ bead, cloud })[name].group.visible = on; stage.draw(); },
  });
  if (!matchMedia("(prefers-reduced-motion: reduce)").matches && times.length > 1) clock.play();
}

const micro = (x) => 1e6 * x;

// What is shown: all means and some spreads on either side, um.
function extent(mean, spread) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  for (let i = 0; i < mean.length; i++) {
    if (!Number.isFinite(mean[i])) continue;
    const room = SPREADS * (spread[i] || 0);
    low[i % 3] = Math.min(low[i % 3], 1e6 * (mean[i] - room));
    high[i % 3] = Math.max(high[i % 3], 1e6 * (mean[i] + room));
  }
  const widest = Math.max(...high.map((x, k) => x - low[k]), 1e-6);
  // a cell has a size along every axis
  for (let k = 0; k < 3; k++) if (high[k] - low[k] < 0.01 * widest) { low[k] -= 0.05 * widest; high[k] += 0.05 * widest; }
  return { low, high };
}

function plotted(content, shell, clock, { mean, spread, left, near }) {
  const { facts } = content, { factor, unit } = clock.shown, times = shell.array("time");
  const x = { values: times.map((t) => factor * t), name: "time", unit, factor };
  const options = { jumps: true, onpick: (value) => clock.seek(value / factor) };
  const of = (values, name, size) => AXES.map((axis, k) => ({
    name: axis, values: column(values, k, 3, size), errors: column(shell.array(name), k, 3, size), colour: axis, dash: DASHES[axis],
  }));
  const plots = [
    new Plot(shell, shell.plots, x, of(mean, "mean_error", 1e6), { ...options, title: "Mean", unit: "µm", even: true }),
    new Plot(shell, shell.plots, x, of(spread, "spread_error", 1e9), { ...options, title: "Spread", unit: "nm" }),
  ];
  const alignment = shell.array("alignment");
  if (alignment) {
    const title = `Alignment of body axis ${AXES[facts.body.plotted_axes[0]]}`;
    plots.push(new Plot(shell, shell.plots, x, of(alignment, "alignment_error", 1), { ...options, title, unit: "", range: [-0.03, 1.03], even: true }));
  }
  const share = (values) => values.map((n) => (100 * n) / facts.beads);
  // of a part p of n, half of Wilson's interval of one standard deviation
  const errors = (values) => values.map((n) => {
    const total = facts.beads, p = n / total;
    return (100 * Math.sqrt((p * (1 - p)) / total + 1 / (4 * total * total))) / (1 + 1 / total);
  });
  const lost = left.map((n) => facts.beads - n);
  const shares = [{ name: "lost", values: share(lost), errors: errors(lost), colour: "light-ink", dash: [6, 4] }];
  if (near) shares.unshift({ name: "near the equilibrium", values: share(near), errors: errors(near), colour: "speed" });
  if (near || lost.some((n) => n > 0))
    plots.push(new Plot(shell, shell.plots, x, shares, { ...options, title: "Share of the beads", unit: "%" }));
  const bins = shell.array("bin");
  if (bins) {
    const densities = shell.array("density"), n = bins.length;
    new Plot(shell, shell.plots, { values: bins.map(micro), name: "x, y, z", unit: "µm" },
      AXES.map((axis, k) => ({ name: axis, values: densities.slice(k * n, (k + 1) * n).map((d) => 1e-6 * d), colour: axis, dash: DASHES[axis] })),
      { title: "Density over beads and time", unit: "1/µm" }).move(1e6 * bins[Math.floor(n / 2)]);
  }
  return plots;
}
