// The picture where the browser has no WebGL: the same things as `stage.js` draws, as lines and
// circles on a plain canvas, seen from the same directions.
import { axesOf, scaled, text } from "tweezer/arrays";
import { nice } from "tweezer/clock";
import { make } from "tweezer/shell";
import { VIEWS, triangles } from "tweezer/stage";

// Directions of the screen's axes, to the right and up, seen from a direction
function axes([x, y, z]) {
  const across = Math.hypot(x, y), far = Math.hypot(x, y, z);
  return {
    right: [-y / across, x / across, 0],
    up: [(-z * x) / across / far, (-z * y) / across / far, across / far],
  };
}

export class Flat {
  constructor(shell, { center, reach, label }) {
    Object.assign(this, { shell, center, reach, things: [], frames: 0 });
    this.canvas = make("canvas", { role: "img", "aria-label": label });
    this.over = make("div", { class: "over" });
    this.host = make("div", { class: "stage" }, this.canvas, this.over);
    shell.picture.append(this.host);
    this.buttons = Object.entries(VIEWS).map(([key, { name, short }]) => {
      shell.key(key, `see it ${name}`, () => this.look(key));
      return make("button", { type: "button", "aria-label": `See it ${name}`, onclick: () => this.look(key) }, short);
    });
    this.bar = make("span", { class: "bar" });
    this.barText = make("span");
    this.over.append(make("div", { class: "views", role: "group", "aria-label": "Views" }, ...this.buttons), ...shell.pupils(),
      make("div", { class: "scale" }, make("span", { class: "length" }, this.bar, this.barText)));
    this.look(1);
    new ResizeObserver(() => this.draw()).observe(this.host);
    shell.onTheme(() => this.draw());
    Object.assign(window.tweezer, {
      pixel: (position) => this.pixel(position),
      frames: () => this.frames, look: (view) => this.look(view), draw: () => this.draw(),
    });
  }

  look(view) {
    Object.assign(this, axes(VIEWS[view].from));
    this.buttons.forEach((button, k) => button.setAttribute("aria-pressed", String(k + 1 === Number(view))));
    this.draw();
  }

  follow(position) {
    if (position) this.center = position;
  }

  onTheme(act) {
    this.shell.onTheme(act);
  }

  // Where a position, um, is on the canvas.
  place(position) {
    const way = position.map((x, k) => x - this.center[k]);
    const dot = (axis) => axis.reduce((sum, x, k) => sum + x * way[k], 0);
    return [this.width / 2 + this.scale * dot(this.right), this.height / 2 - this.scale * dot(this.up)];
  }

  // Where a position, um, is in the window, pixels of the style sheet.
  pixel(position) {
    const { left, top } = this.canvas.getBoundingClientRect(), [x, y] = this.place(position);
    return [left + x, top + y];
  }

  request() {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.requested = false;
    const { clientWidth, clientHeight } = this.host;
    if (!clientWidth || !clientHeight) return;
    Object.assign(this, { width: clientWidth, height: clientHeight, scale: Math.min(clientWidth, clientHeight) / (2 * this.reach) });
    const ratio = Math.min(devicePixelRatio || 1, 2);
    this.canvas.width = Math.round(clientWidth * ratio);
    this.canvas.height = Math.round(clientHeight * ratio);
    const pen = this.canvas.getContext("2d");
    pen.scale(ratio, ratio);
    for (const thing of this.things) if (thing.visible) { pen.save(); thing.draw(pen); pen.restore(); }
    const length = nice(90 / this.scale), { factor, unit } = scaled(length * 1e-6, "m");
    this.bar.style.width = `${length * this.scale}px`;
    this.barText.textContent = `${text(length * 1e-6 * factor, 2)} ${unit}`;
    this.frames++;
  }

  add(draw) {
    const thing = { visible: true, draw };
    this.things.push(thing);
    return thing;
  }

  line(pen, positions, colour, width = 1) {
    pen.strokeStyle = this.shell.colour(colour);
    pen.lineWidth = width;
    pen.beginPath();
    positions.forEach((position, i) => pen[i ? "lineTo" : "moveTo"](...this.place(position)));
    pen.stroke();
  }

  floor() {
    return {};
  }

  wall(z, normal, words) {
    const group = this.add((pen) => {
      const [x, y] = this.center, size = 1.5 * this.reach;
      this.line(pen, [[-1, -1], [1, -1], [1, 1], [-1, 1], [-1, -1]].map(([u, v]) => [x + size * u, y + size * v, z]), "wall", 2);
      pen.fillStyle = this.shell.colour("soft");
      pen.font = "13px system-ui, sans-serif";
      pen.fillText(words, 8, this.place([x, y, z])[1] - 5);
    });
    return { group };
  }

  beam({ half_angle }, length) {
    let at = [0, 0, 0], factor = 1;
    const group = this.add((pen) => {
      pen.globalAlpha = 0.8 * Math.min(factor, 1);
      // the outline of the cone that faces the eye lies along the direction to the right
      for (const side of [-1, 1]) {
        const r = side * length * Math.sin(half_angle), z = length * Math.cos(half_angle);
        const ends = [-1, 1].map((way) => at.map((x, k) => x + way * (r * this.right[k] + (k === 2 ? z : 0))));
        this.line(pen, ends, "light", 1.5);
      }
      const [x, y] = this.place(at);
      pen.strokeStyle = this.shell.colour("light-ink");
      pen.beginPath(); pen.moveTo(x - 7, y); pen.lineTo(x + 7, y); pen.moveTo(x, y - 7); pen.lineTo(x, y + 7); pen.stroke();
    });
    return { group, place: (position, power = 1) => { [at, factor] = [position, power]; } };
  }

  path(positions, joined) {
    let colours = null, last = 0;
    const group = this.add((pen) => {
      for (let i = 0; i < positions.length / 3; i++) {
        const [x, y] = this.place([...positions.slice(3 * i, 3 * i + 3)]);
        pen.globalAlpha = i <= last ? 1 : 0.25;
        const colour = `rgb(${[0, 1, 2].map((k) => Math.round(255 * colours[3 * i + k] ** (1 / 2.2)))})`;
        pen.fillStyle = pen.strokeStyle = colour;
        if (joined && i) { pen.lineWidth = 2; pen.lineTo(x, y); pen.stroke(); } else if (!joined) pen.fillRect(x - 1, y - 1, 2, 2);
        pen.beginPath(); pen.moveTo(x, y);
      }
    });
    return { group, colour: (given) => { colours = given; }, upTo: (index) => { last = index; } };
  }

  // `body`, of a bead that is not a sphere: its surface, or none, where axes stick out of the sphere.
  bead(shells, body) {
    let at = [0, 0, 0], columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
    const surface = body?.surface && triangles(body.surface);
    // from the frame of the bead to the picture, um
    const moved = ([x, y, z]) => at.map((c, i) => c + columns[0][i] * x + columns[1][i] * y + columns[2][i] * z);
    const vertex = (k) => moved(surface.vertices.subarray(3 * k, 3 * k + 3));
    const group = this.add((pen) => {
      pen.fillStyle = this.shell.colour("bead-dark");
      pen.strokeStyle = this.shell.colour("bead-rim");
      if (surface) {
        const places = Array.from({ length: surface.vertices.length / 3 }, (_, k) => this.place(vertex(k)));
        const { faces } = surface;
        pen.beginPath();
        for (let i = 0; i < faces.length; i += 3) {
          const [a, b, c] = [places[faces[i]], places[faces[i + 1]], places[faces[i + 2]]];
          // the sides that face the eye, which cover the body
          if ((b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])) continue;
          pen.moveTo(...a); pen.lineTo(...b); pen.lineTo(...c); pen.closePath();
        }
        pen.lineWidth = 3; pen.lineJoin = "round"; pen.stroke(); pen.fill();
      } else for (const radius of shells) {
        pen.globalAlpha = 0.35;
        pen.beginPath(); pen.arc(...this.place(at), radius * this.scale, 0, 7); pen.fill();
        pen.globalAlpha = 1; pen.stroke();
      }
      if (body) ["x", "y", "z"].forEach((name, k) => this.line(pen,
        [at, moved([0, 1, 2].map((i) => (i === k ? 1.35 * shells.at(-1) : 0)))], name, 2));
    });
    return {
      group, at: () => at, vertex,
      place: (position, euler) => {
        at = position;
        if (euler) columns = axesOf(euler);
      },
      // The axes of the bead, as columns of a matrix (4, 4).
      turned: () => [...columns.flatMap((column) => [...column, 0]), 0, 0, 0, 1],
    };
  }

  tether(colour) {
    let where = [];
    const group = this.add((pen) => this.line(pen, where, colour, 2.5));
    return { group, ends: () => where, set: (from, to) => { where = [from, to]; } };
  }

  arrow(colour) {
    let from = [0, 0, 0], vector = [0, 0, 0];
    const group = this.add((pen) => {
      const to = from.map((x, k) => x + vector[k]);
      if (Math.hypot(...vector) < 0.004 * this.reach) return;
      this.line(pen, [from, to], colour, 3);
      const [a, b] = this.place(from), [x, y] = this.place(to), turn = Math.atan2(y - b, x - a);
      pen.fillStyle = this.shell.colour(colour);
      pen.beginPath(); pen.moveTo(x, y);
      for (const side of [-1, 1]) pen.lineTo(x - 11 * Math.cos(turn + 0.4 * side), y - 11 * Math.sin(turn + 0.4 * side));
      pen.fill();
    });
    return { group, set: (position, force) => { [from, vector] = [position, force]; } };
  }

  // Words at a position, um.
  label(words, position) {
    this.add((pen) => {
      pen.fillStyle = this.shell.colour("soft");
      pen.font = "13px system-ui, sans-serif";
      pen.fillText(words, ...this.place(position));
    });
  }

  // A colour of the style sheet `n` times, as paths take them.
  colours(name, n) {
    const hex = this.shell.colour(name), parts = [1, 3, 5].map((k) => (parseInt(hex.slice(k, k + 2), 16) / 255) ** 2.2);
    return Float32Array.from({ length: 3 * n }, (_, i) => parts[i % 3]);
  }

  cloud(n, colour, size, ring = false) {
    const places = new Float32Array(3 * n);
    let drawn = 0;
    const group = this.add((pen) => {
      pen.fillStyle = pen.strokeStyle = this.shell.colour(colour);
      for (let i = 0; i < drawn; i++) {
        const [x, y] = this.place([places[3 * i], places[3 * i + 1], places[3 * i + 2]]);
        if (ring) { pen.beginPath(); pen.arc(x, y, size / 2, 0, 7); pen.stroke(); } else pen.fillRect(x - size / 2, y - size / 2, size, size);
      }
    });
    return { group, places, set: (count) => { drawn = count; } };
  }

  // The half axes of shells about a place, as crosses.
  shells(colour, opacities) {
    let at = [0, 0, 0], lengths = [0, 0, 0];
    const group = this.add((pen) => {
      opacities.forEach((_, k) => at.forEach((__, i) => this.line(pen,
        [-1, 1].map((side) => at.map((x, j) => x + (i === j ? side * (k + 1) * lengths[j] : 0))), colour, 3 - k)));
    });
    return { group, set: (place, given) => { [at, lengths] = [place, given]; } };
  }

  // The edge of a slice; its colours are beside the picture.
  sheet() {
    let corners = [];
    const group = this.add((pen) => this.line(pen, [...corners, ...corners.slice(0, 1)], "soft"));
    return { group, set: (given) => { corners = given; } };
  }
}
