// The picture: three.js draws bead, light, walls, paths and arrows, in micrometres, z up.
import {
  BufferAttribute, BufferGeometry, Color, ConeGeometry, CylinderGeometry, DataTexture, DoubleSide,
  FrontSide, Group, LineBasicMaterial, LineSegments, LinearFilter, Matrix4, Mesh, MeshBasicMaterial,
  OrbitControls, PerspectiveCamera, PlaneGeometry, Points, PointsMaterial, Quaternion, RGBAFormat,
  Scene, ShaderMaterial, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { scaled, text, unpack } from "tweezer/arrays";
import { nice } from "tweezer/clock";
import { make } from "tweezer/shell";

// Vertical angle of view, degrees
const ANGLE = 24;
// Largest number of pixels of the canvas for one of the screen, along an edge
const RATIO = 1.5;
// Time of a frame, ms, above which frames in motion have fewer pixels, and the fewest, as of RATIO
const SLOW = 30, COARSEST = 0.6;
// Part of what is seen at first below which a move on a path is not drawn by itself
const UNSEEN = 5e-4;
// Directions from which views look, their names, and whether they show a plane: in parallel projection,
// so that the scale bar is right everywhere
export const VIEWS = {
  1: { name: "at an angle", short: "3-D", from: [0.62, -1, 0.42] },
  2: { name: "from the side, x to the right", short: "x–z", from: [0, -1, 0], plane: true },
  3: { name: "from the side, y to the right", short: "y–z", from: [1, 0, 0], plane: true },
  4: { name: "against the light, x to the right", short: "x–y", from: [0, -1e-4, 1], plane: true },
};

// Whether the browser draws in 3-D, and whether a graphics card does it.
export function drawing() {
  const probe = document.createElement("canvas").getContext("webgl2");
  if (!probe) return { possible: false };
  const about = probe.getExtension("WEBGL_debug_renderer_info");
  const by = about ? probe.getParameter(about.UNMASKED_RENDERER_WEBGL) : "";
  probe.getExtension("WEBGL_lose_context")?.loseContext();
  return { possible: true, software: /swiftshader|llvmpipe|software/i.test(by) };
}

export class Stage {
  // center, reach: what is seen at first, um. label: of the picture, for screen readers.
  constructor(shell, { center, reach, label }) {
    Object.assign(this, { shell, reach, home: new Vector3(...center), frames: 0, labels: [], drawn: [], clouds: [] });
    const { software } = drawing();
    this.renderer = new WebGLRenderer({ antialias: !software, alpha: true, powerPreference: "low-power" });
    this.finest = this.ratio = software ? 1 : Math.min(devicePixelRatio || 1, RATIO);
    this.before = this.took = 0;
    this.renderer.setPixelRatio(this.finest);
    this.canvas = this.renderer.domElement;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", label);
    this.over = make("div", { class: "over" });
    this.host = make("div", { class: "stage" }, this.canvas, this.over);
    shell.picture.append(this.host);
    this.scene = new Scene();
    this.screen = new Vector2(1, 1);
    this.camera = new PerspectiveCamera(ANGLE, 1, 0.01 * reach, 200 * reach);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.enableDamping = false;
    this.controls.minDistance = 0.2 * reach;
    this.controls.maxDistance = 60 * reach;
    this.controls.addEventListener("change", () => this.request());
    this.buildScale();
    this.buildViews();
    this.buildTurns();
    new ResizeObserver(() => this.resize()).observe(this.host);
    this.themed = [];
    shell.onTheme(() => this.retheme());
    this.resize();
    this.look(1);
    shell.offer("Picture", "save the picture as a PNG file", () => this.save());
    shell.onReset(() => this.look(1));
    shell.remember("view", () => this.where(), (words) => this.goto(words));
    Object.assign(window.tweezer, {
      pixel: (position) => this.pixel(position), frames: () => this.frames, fps: () => this.fps(),
      camera: () => this.matrices(), look: (view) => this.look(view), draw: () => this.draw(),
    });
  }

  // ---- the camera

  look(view) {
    const { name, from } = VIEWS[view];
    this.view = view;
    const half = Math.tan((ANGLE * Math.PI) / 360) * Math.min(1, this.camera.aspect);
    const distance = this.reach / Math.sin(Math.atan(half));
    this.camera.updateProjectionMatrix();
    this.controls.target.copy(this.home);
    this.camera.position.set(...from).setLength(distance).add(this.home);
    this.controls.update();
    this.buttons.forEach((button, k) => button.setAttribute("aria-pressed", String(k + 1 === Number(view))));
    this.shell.say(`Seen ${name}`);
    this.request();
  }

  // The view as words of a link: its number, where the camera is and what it looks at, um.
  where() {
    const each = [...this.camera.position.toArray(), ...this.controls.target.toArray()];
    return [this.view, ...each.map((x) => Number(x.toPrecision(6)))].join("_");
  }

  goto(words) {
    const [view, ...each] = words.split("_").map(Number);
    if (!VIEWS[view] || each.length !== 6 || !each.every(Number.isFinite)) return;
    this.look(view);
    this.camera.position.set(...each.slice(0, 3));
    this.controls.target.set(...each.slice(3));
    this.controls.update();
    this.request();
  }

  // Parallel projection of a plane, as wide as the perspective at what the camera looks at.
  project() {
    const { camera } = this;
    if (!VIEWS[this.view]?.plane) return;
    const up = camera.position.distanceTo(this.controls.target) * Math.tan((ANGLE * Math.PI) / 360);
    const across = up * camera.aspect;
    camera.projectionMatrix.makeOrthographic(-across, across, up, -up, -camera.far, camera.far);
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
  }

  // Turn the camera about the vertical and up, rad, and come nearer by a factor.
  turn(around, over, nearer = 1) {
    const way = this.camera.position.clone().sub(this.controls.target), length = way.length();
    const height = Math.asin(way.z / length) + over, heading = Math.atan2(way.y, way.x) + around;
    const flat = Math.min(Math.max(height, -1.57), 1.57);
    way.set(Math.cos(flat) * Math.cos(heading), Math.cos(flat) * Math.sin(heading), Math.sin(flat));
    this.camera.position.copy(this.controls.target).addScaledVector(way, length / nearer);
    this.controls.update();
    this.request();
  }

  // Move what the camera looks at by as much as `position` has moved since the last call.
  follow(position) {
    if (this.followed) {
      const way = new Vector3(...position).sub(this.followed);
      this.camera.position.add(way);
      this.controls.target.add(way);
    }
    this.followed = position && new Vector3(...position);
  }

  // Where a position (um) is in the window, pixels of the style sheet.
  pixel(position) {
    this.camera.updateMatrixWorld();
    this.project();
    const { x, y } = new Vector3(...position).project(this.camera);
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    return [left + (x + 1) / 2 * width, top + (1 - y) / 2 * height];
  }

  // The matrices of the camera, by columns, and where the canvas is: for tests.
  matrices() {
    this.camera.updateMatrixWorld();
    this.project();
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    return {
      projection: this.camera.projectionMatrix.toArray(),
      view: this.camera.matrixWorldInverse.toArray(), left, top, width, height,
    };
  }

  resize() {
    const { clientWidth, clientHeight } = this.host;
    if (!clientWidth || !clientHeight) return;
    const before = this.camera.aspect;
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.screen.set(clientWidth, clientHeight);
    if (this.view && Math.min(before, 1) !== Math.min(this.camera.aspect, 1)) this.look(this.view);
    this.draw();
  }

  // ---- drawing, only when something has changed

  // Draw with the next frame. Where frames are slow, those in motion are coarser; the last is not.
  request() {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame((now) => {
      if (!this.requested) return;
      this.requested = false;
      clearTimeout(this.settling);
      const took = now - this.before;
      this.before = now;
      this.took = took < 200 ? this.took + 0.1 * (took - this.took) : 0;
      if (this.took > SLOW && this.ratio > COARSEST) {
        this.ratio = Math.max(COARSEST, this.ratio - 0.1);
        this.took = 0;
      }
      this.paint(this.ratio);
      if (this.ratio < this.finest) this.settling = setTimeout(() => this.draw(), 250);
    });
  }

  // Draw now, as finely as there is.
  draw() {
    this.requested = false;
    clearTimeout(this.settling);
    this.paint(this.finest);
  }

  paint(ratio) {
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    for (const { size, pixels } of this.clouds) size.value = pixels * ratio;
    this.project();
    this.renderer.render(this.scene, this.camera);
    this.frames++;
    this.drawn.push(performance.now());
    if (this.drawn.length > 240) this.drawn.shift();
    this.placeLabels();
    this.showScale();
  }

  // Save what is seen, with the scale bar and the words over it, as a PNG file.
  save() {
    this.draw();
    const { width, height } = this.canvas, ratio = width / this.host.clientWidth;
    const paper = make("canvas", { width, height }), pen = paper.getContext("2d");
    const glow = pen.createRadialGradient(width / 2, 0.35 * height, 0, width / 2, 0.35 * height, 0.7 * width);
    glow.addColorStop(0, this.shell.colour("stage-top"));
    glow.addColorStop(1, this.shell.colour("stage-low"));
    pen.fillStyle = glow;
    pen.fillRect(0, 0, width, height);
    pen.drawImage(this.canvas, 0, 0);
    const home = this.host.getBoundingClientRect();
    const words = (element) => {
      const { left, bottom } = element.getBoundingClientRect();
      pen.font = `${14 * ratio}px system-ui, sans-serif`;
      pen.textBaseline = "bottom";
      pen.fillText(element.textContent, ratio * (left - home.left), ratio * (bottom - home.top));
    };
    pen.fillStyle = pen.strokeStyle = this.shell.colour("ink");
    words(this.barText);
    const bar = this.bar.getBoundingClientRect(), y = ratio * (bar.bottom - home.top);
    pen.fillRect(ratio * (bar.left - home.left), y - 2 * ratio, ratio * bar.width, 2 * ratio);
    for (const { element } of this.labels) if (!element.hidden) words(element);
    paper.toBlob((blob) => this.shell.download(blob, "png"));
  }

  // Frames drawn in the last second.
  fps() {
    const now = performance.now();
    return this.drawn.filter((at) => at > now - 1000).length;
  }

  // Call `act` now and when the theme changes, and draw.
  onTheme(act) {
    this.themed.push(act);
    act();
  }

  retheme() {
    for (const act of this.themed) act();
    this.request();
  }

  colour(name) {
    return new Color(this.shell.colour(name));
  }

  // A colour of the style sheet `n` times, as paths take them.
  colours(name, n) {
    const { r, g, b } = this.colour(name);
    return Float32Array.from({ length: 3 * n }, (_, i) => [r, g, b][i % 3]);
  }

  // ---- words over the picture

  buildViews() {
    this.buttons = Object.entries(VIEWS).map(([key, { name, short }]) => {
      this.shell.key(key, `see it ${name}`, () => this.look(key));
      return make("button", { type: "button", title: `See it ${name} (${key})`, "aria-label": `See it ${name}`,
        onclick: () => this.look(key) }, short);
    });
    this.over.append(make("div", { class: "views", role: "group", "aria-label": "Views" }, ...this.buttons), ...this.shell.pupils());
  }

  buildTurns() {
    const { shell } = this, step = Math.PI / 18;
    shell.key(["a", "d"], "turn it left, right", (event) => this.turn(event.key === "a" ? -step : step, 0));
    shell.key(["v", "b"], "tilt it up, down", (event) => this.turn(0, event.key === "v" ? step : -step));
    shell.key(["i", "o"], "nearer, farther", (event) => this.turn(0, 0, event.key === "i" ? 1.15 : 1 / 1.15));
  }

  buildScale() {
    this.bar = make("span", { class: "bar" });
    this.barText = make("span");
    this.triad = make("span", { class: "triad", "aria-hidden": "true" });
    this.over.append(make("div", { class: "scale" }, this.triad,
      make("span", { class: "length" }, this.bar, this.barText)));
  }

  // A bar of a round length, as long as that length is at the centre of the view.
  showScale() {
    const height = this.host.clientHeight;
    if (!height) return;
    const distance = this.camera.position.distanceTo(this.controls.target);
    const pixels = height / (2 * distance * Math.tan((ANGLE * Math.PI) / 360));
    const length = nice(90 / pixels);
    const state = [Math.round(length * pixels * 2), length, ...this.camera.quaternion.toArray()].join();
    if (state === this.scaleState) return;
    this.scaleState = state;
    const { factor, unit } = scaled(length * 1e-6, "m");
    this.bar.style.width = `${(length * pixels).toFixed(1)}px`;
    this.barText.textContent = `${text(length * 1e-6 * factor, 2)} ${unit}`;
    const turn = this.camera.quaternion.clone().invert();
    const arms = ["x", "y", "z"].map((name, k) => {
      const way = new Vector3(...[0, 1, 2].map((i) => Number(i === k))).applyQuaternion(turn);
      return { name, x: 34 + 22 * way.x, y: 34 - 22 * way.y, tx: 34 + 30 * way.x, ty: 38 - 30 * way.y, depth: way.z };
    }).sort((a, b) => a.depth - b.depth);
    this.triad.innerHTML = `<svg width="68" height="68" viewBox="0 0 68 68">${arms.map(({ name, x, y, tx, ty }) =>
      `<line x1="34" y1="34" x2="${x}" y2="${y}" stroke="var(--${name})" stroke-width="2.5" stroke-linecap="round"/>` +
      `<text x="${tx}" y="${ty}" text-anchor="middle" fill="var(--ink)">${name}</text>`).join("")}</svg>`;
  }

  // Words at a position, um.
  label(words, position) {
    const element = make("span", { class: "label" }, words);
    this.over.append(element);
    this.labels.push({ element, position });
  }

  placeLabels() {
    const { width, height } = this.canvas.getBoundingClientRect();
    for (const { element, position } of this.labels) {
      const { x, y, z } = new Vector3(...position).project(this.camera);
      element.hidden = Math.abs(x) > 0.98 || Math.abs(y) > 0.98 || z > 1;
      element.style.transform = `translate(${((x + 1) / 2 * width).toFixed(1)}px, ${((1 - y) / 2 * height).toFixed(1)}px)`;
    }
  }

  // ---- things

  // Lines on the plane z, every `nice` length, to see depth by.
  floor(z) {
    const step = nice(this.reach / 4), n = Math.ceil((1.3 * this.reach) / step), points = [];
    const [cx, cy] = [this.home.x, this.home.y].map((c) => Math.round(c / step) * step);
    for (let k = -n; k <= n; k++)
      points.push(cx + k * step, cy - n * step, z, cx + k * step, cy + n * step, z,
        cx - n * step, cy + k * step, z, cx + n * step, cy + k * step, z);
    const material = new LineBasicMaterial({ transparent: true, depthWrite: false });
    this.onTheme(() => { material.color = this.colour("grid"); });
    const group = new LineSegments(geometry({ position: [points, 3] }), material);
    this.scene.add(group);
    return { group };
  }

  // A bead: spheres of radii `shells`, um, the outermost with a pattern that shows how it turns.
  // `body`, of one that is not a sphere: its surface, or none, where axes stick out of the sphere.
  bead(shells, body) {
    const group = new Group(), outer = shells.at(-1), surface = body?.surface && triangles(body.surface);
    const uniforms = {
      light: { value: new Color() }, dark: { value: new Color() }, rim: { value: new Color() }, size: { value: outer },
      far: { value: new Color() }, ends: { value: body ? 0.7 : 0 },
    };
    this.onTheme(() => {
      uniforms.light.value = this.colour("bead-light");
      uniforms.dark.value = this.colour("bead-dark");
      uniforms.rim.value = this.colour("bead-rim");
      uniforms.far.value = this.colour("bead-end");
    });
    const material = new ShaderMaterial({
      uniforms, vertexShader: BEAD_VERTEX, fragmentShader: BEAD, transparent: true, depthWrite: false, side: FrontSide,
    });
    const shape = surface ? geometry({ position: [surface.vertices, 3], normal: [surface.normals, 3] })
      : new SphereGeometry(outer, 40, 26);
    if (surface) {
      shape.setIndex(Array.from(surface.faces));
      // what the body itself hides is not drawn
      const depth = new Mesh(shape, new MeshBasicMaterial({ colorWrite: false, transparent: true }));
      depth.renderOrder = 3;
      group.add(depth);
    }
    const outside = new Mesh(shape, material);
    outside.renderOrder = 4;
    group.add(outside);
    if (body && !surface) group.add(this.axes(1.35 * outer));
    for (const radius of shells.slice(0, -1)) {
      const inside = new Mesh(new SphereGeometry(radius, 40, 24),
        new ShaderMaterial({ uniforms, vertexShader: BEAD_VERTEX, fragmentShader: CORE, transparent: true, depthWrite: false }));
      inside.renderOrder = 3;
      group.add(inside);
    }
    this.scene.add(group);
    return {
      group,
      // Euler parameters e0..e3 turn the frame of the bead to that of the picture.
      place: (position, euler) => {
        group.position.set(...position);
        if (euler) group.quaternion.copy(new Quaternion(euler[1], euler[2], euler[3], euler[0]).normalize());
      },
      at: () => group.getWorldPosition(new Vector3()).toArray(),
      // The axes of the bead, as columns.
      turned: () => new Matrix4().makeRotationFromQuaternion(group.quaternion).toArray(),
      // Where a vertex of the surface is, um.
      vertex: (k) => {
        group.updateMatrixWorld();
        return outside.localToWorld(new Vector3().fromBufferAttribute(shape.getAttribute("position"), k)).toArray();
      },
    };
  }

  // Bars from the origin along x, y and z, in their colours.
  axes(length) {
    const group = new Group(), thick = 0.03 * length;
    ["x", "y", "z"].forEach((name, k) => {
      const uniforms = { colour: { value: new Color() } };
      this.onTheme(() => { uniforms.colour.value = this.colour(name); });
      const bar = new Mesh(new CylinderGeometry(thick, thick, length, 12).translate(0, length / 2, 0),
        new ShaderMaterial({ uniforms, vertexShader: SOLID_VERTEX, fragmentShader: SOLID }));
      bar.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), new Vector3(...[0, 1, 2].map((i) => Number(i === k))));
      group.add(bar);
    });
    return group;
  }

  // The light of a beam about its focus, to a distance `length` from it, um.
  beam({ half_angle, wavelength, down }, length) {
    const waist = wavelength * 1e6 / (2 * Math.sin(half_angle));
    const rows = 19, columns = 48, points = [], normals = [], along = [], faces = [];
    const end = Math.max(length * Math.cos(half_angle), 1e-3 * length);
    for (let i = 0; i < rows; i++) {
      const part = (2 * i) / (rows - 1) - 1;
      const z = end * part * Math.abs(part) ** 0.5;
      const r = Math.hypot(waist, z * Math.tan(half_angle));
      const slope = (z * Math.tan(half_angle) ** 2) / r, tilt = Math.hypot(1, slope);
      for (let j = 0; j <= columns; j++) {
        const angle = (2 * Math.PI * j) / columns;
        points.push(r * Math.cos(angle), r * Math.sin(angle), z);
        normals.push(Math.cos(angle) / tilt, Math.sin(angle) / tilt, -slope / tilt);
        along.push(z / end);
        if (i && j) {
          const k = i * (columns + 1) + j;
          faces.push(k, k - 1, k - columns - 2, k, k - columns - 2, k - columns - 1);
        }
      }
    }
    const uniforms = { colour: { value: new Color() }, strength: { value: 1 }, full: { value: 1 } };
    this.onTheme(() => {
      uniforms.colour.value = this.colour("light");
      uniforms.full.value = this.shell.dark ? 0.5 : 0.42;
    });
    const shape = geometry({ position: [points, 3], normal: [normals, 3], along: [along, 1] });
    shape.setIndex(faces);
    const cone = new Mesh(shape, new ShaderMaterial({
      uniforms, vertexShader: CONE_VERTEX, fragmentShader: CONE, transparent: true, depthWrite: false, side: DoubleSide,
    }));
    cone.renderOrder = 1;
    const arm = 0.09 * this.reach, cross = [];
    for (let k = 0; k < 3; k++) for (const side of [-arm, arm]) cross.push(...[0, 1, 2].map((i) => (i === k ? side : 0)));
    const material = new LineBasicMaterial({ depthTest: false, transparent: true });
    this.onTheme(() => { material.color = this.colour("light-ink"); });
    const focus = new LineSegments(geometry({ position: [cross, 3] }), material);
    focus.renderOrder = 6;
    const group = new Group();
    if (down) group.rotation.x = Math.PI;
    group.add(cone, focus);
    this.scene.add(group);
    return {
      group,
      // factor: of the power at rest.
      place: (position, factor = 1) => {
        group.position.set(...position);
        uniforms.strength.value = Math.min(factor, 1.5);
      },
    };
  }

  // A plane that ends the fluid at z; `normal` leads along z from it to the bead, 1 or -1.
  wall(z, normal, words) {
    const size = 1.5 * this.reach, thick = 0.12 * this.reach;
    const material = new MeshBasicMaterial({ transparent: true, opacity: 0.15, depthWrite: false, side: DoubleSide });
    const edges = new LineBasicMaterial();
    this.onTheme(() => { material.color = this.colour("wall"); edges.color = this.colour("wall"); });
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([x, y]) => [this.home.x + size * x, this.home.y + size * y]);
    const lines = [];
    corners.forEach(([x, y], k) => {
      const [u, v] = corners[(k + 1) % 4], back = z - normal * thick;
      lines.push(x, y, z, u, v, z, x, y, back, u, v, back, x, y, z, x, y, back);
    });
    const group = new Group();
    for (const at of [z, z - normal * thick]) {
      const plane = new Mesh(new PlaneGeometry(2 * size, 2 * size), material);
      plane.position.set(this.home.x, this.home.y, at);
      plane.renderOrder = 0;
      group.add(plane);
    }
    group.add(new LineSegments(geometry({ position: [lines, 3] }), edges));
    this.scene.add(group);
    this.label(words, [this.home.x - 0.9 * this.reach, this.home.y - 0.5 * this.reach, z]);
    return { group };
  }

  // A path through positions (3 n) um, or its points, with colours (3 n) by `colour`.
  path(positions, joined) {
    return joined ? this.joined(positions) : this.points(positions);
  }

  // Four corners for each piece of the way, which the shader moves apart on the screen. What is
  // still to come is thin and pale. Moves that would not be seen are parts of the next piece.
  joined(positions) {
    const n = positions.length / 3, near = [], far = [], corner = [], order = [], faces = [];
    const at = (i) => Array.from(positions.subarray(3 * i, 3 * i + 3)), kept = [0];
    for (let i = 1; i < n; i++) {
      const from = kept.at(-1);
      const moved = Math.hypot(...[0, 1, 2].map((k) => positions[3 * i + k] - positions[3 * from + k]));
      if (moved > this.reach * UNSEEN || i === n - 1) kept.push(i);
    }
    const pieces = kept.length - 1;
    for (let j = 0; j < pieces; j++) {
      const here = at(kept[j]), there = at(kept[j + 1]);
      for (const [end, side] of [[0, -1], [0, 1], [1, -1], [1, 1]]) {
        near.push(...(end ? there : here));
        far.push(...(end ? here : there));
        corner.push(end, side);
        order.push(kept[j]);
      }
      faces.push(4 * j, 4 * j + 1, 4 * j + 2, 4 * j + 2, 4 * j + 1, 4 * j + 3);
    }
    const shape = geometry({ position: [near, 3], other: [far, 3], corner: [corner, 2], order: [order, 1] });
    shape.setIndex(faces);
    const uniforms = { now: { value: 0 }, screen: { value: this.screen }, ground: { value: new Color() } };
    this.onTheme(() => { uniforms.ground.value = this.colour("stage-low"); });
    const line = new Mesh(shape, new ShaderMaterial({
      uniforms, vertexShader: PATH_VERTEX, fragmentShader: PATH, side: DoubleSide,
    }));
    line.frustumCulled = false;
    this.scene.add(line);
    return {
      group: line,
      colour: (colours) => {
        const each = new Float32Array(12 * pieces);
        for (let j = 0; j < pieces; j++)
          for (let k = 0; k < 12; k++) each[12 * j + k] = colours[3 * kept[j + (k < 6 ? 0 : 1)] + (k % 3)];
        shape.setAttribute("colour", new BufferAttribute(each, 3));
      },
      upTo: (index) => { uniforms.now.value = index; },
    };
  }

  points(positions) {
    const shape = geometry({ position: [positions, 3] });
    const of = (opacity, size) => new Points(shape, new PointsMaterial({
      size, sizeAttenuation: false, vertexColors: true, transparent: true, opacity, depthWrite: false,
    }));
    const every = of(0.3, 2), last = of(1, 3);
    last.geometry = shape.clone();
    const group = new Group();
    group.add(every, last);
    this.scene.add(group);
    return {
      group,
      colour: (colours) => {
        for (const each of [every, last]) each.geometry.setAttribute("color", new BufferAttribute(Float32Array.from(colours), 3));
      },
      upTo: (index) => last.geometry.setDrawRange(0, index + 1),
    };
  }

  // A cloud: a disc for each of `n` beads, or a ring, `size` pixels across, colour of the style sheet.
  cloud(n, colour, size, ring = false) {
    const shape = geometry({ position: [new Float32Array(3 * n), 3] }), places = shape.getAttribute("position");
    const uniforms = { colour: { value: new Color() }, size: { value: size }, ring: { value: ring ? 1 : 0 } };
    this.onTheme(() => { uniforms.colour.value = this.colour(colour); });
    const points = new Points(shape, new ShaderMaterial({
      uniforms, vertexShader: CLOUD_VERTEX, fragmentShader: CLOUD, transparent: true, depthWrite: false,
    }));
    this.clouds.push({ size: uniforms.size, pixels: size });
    points.renderOrder = 5;
    points.frustumCulled = false;
    this.scene.add(points);
    return {
      group: points,
      places: places.array,
      // Draw the first `count` places, which have changed.
      set: (count) => {
        shape.setDrawRange(0, count);
        places.needsUpdate = true;
      },
    };
  }

  // Shells about a place along the axes, half as long as `lengths`.
  shells(colour, opacities) {
    const group = new Group();
    for (const [k, opacity] of opacities.entries()) {
      const material = new MeshBasicMaterial({ transparent: true, opacity, depthWrite: false });
      this.onTheme(() => { material.color = this.colour(colour); });
      const shell = new Mesh(new SphereGeometry(k + 1, 40, 24), material);
      shell.renderOrder = 5 - k;
      group.add(shell);
    }
    this.scene.add(group);
    return {
      group,
      set: (place, lengths) => {
        group.position.set(...place);
        group.scale.set(...lengths.map((x) => Math.max(x, 1e-6)));
      },
    };
  }

  // A slice: colours on a rectangle.
  sheet() {
    const shape = geometry({ position: [new Float32Array(12), 3], uv: [[0, 0, 1, 0, 1, 1, 0, 1], 2] });
    shape.setIndex([0, 1, 2, 0, 2, 3]);
    const material = new MeshBasicMaterial({ transparent: true, opacity: 0.78, side: DoubleSide, depthWrite: false });
    const mesh = new Mesh(shape, material);
    mesh.renderOrder = 0;
    mesh.frustumCulled = false;
    this.scene.add(mesh);
    return {
      group: mesh,
      // corners, um; colours (4 wide tall), 0 to 255, by rows from the first corner on.
      set: (corners, colours, wide, tall) => {
        shape.setAttribute("position", new BufferAttribute(Float32Array.from(corners.flat()), 3));
        material.map?.dispose();
        const texture = new DataTexture(new Uint8Array(colours), wide, tall, RGBAFormat);
        Object.assign(texture, { colorSpace: "srgb", magFilter: LinearFilter, minFilter: LinearFilter, needsUpdate: true });
        material.map = texture;
        material.needsUpdate = true;
        this.request();
      },
    };
  }

  // A rod in a colour of the style sheet.
  tether(colour) {
    const uniforms = { colour: { value: new Color() } };
    this.onTheme(() => { uniforms.colour.value = this.colour(colour); });
    const thick = 0.008 * this.reach, up = new Vector3(0, 1, 0);
    const rod = new Mesh(new CylinderGeometry(thick, thick, 1, 12).translate(0, 0.5, 0),
      new ShaderMaterial({ uniforms, vertexShader: SOLID_VERTEX, fragmentShader: SOLID }));
    rod.renderOrder = 2;
    this.scene.add(rod);
    let where = [];
    return {
      group: rod,
      ends: () => where,
      // From one end to the other, um.
      set: (from, to) => {
        where = [from, to];
        const way = new Vector3(...to).sub(new Vector3(...from)), length = way.length();
        rod.position.set(...from);
        rod.scale.y = Math.max(length, 1e-6);
        if (length > 0) rod.quaternion.setFromUnitVectors(up, way.divideScalar(length));
      },
    };
  }

  // An arrow in a colour of the style sheet.
  arrow(colour) {
    const uniforms = { colour: { value: new Color() } };
    this.onTheme(() => { uniforms.colour.value = this.colour(colour); });
    const material = new ShaderMaterial({ uniforms, vertexShader: SOLID_VERTEX, fragmentShader: SOLID, depthTest: false, transparent: true });
    const thick = 0.011 * this.reach;
    const shaft = new Mesh(new CylinderGeometry(thick, thick, 1, 12).translate(0, 0.5, 0), material);
    const head = new Mesh(new ConeGeometry(3 * thick, 1, 16).translate(0, -0.5, 0), material);
    const group = new Group();
    group.add(shaft, head);
    for (const part of [shaft, head]) part.renderOrder = 7;
    this.scene.add(group);
    const up = new Vector3(0, 1, 0), way = new Vector3();
    return {
      group,
      // From `position` by `vector`, um.
      set: (position, vector) => {
        const length = Math.hypot(...vector);
        group.visible = length > 0.004 * this.reach;
        if (!group.visible) return;
        const tip = Math.min(9 * thick, 0.5 * length);
        group.position.set(...position);
        group.quaternion.setFromUnitVectors(up, way.set(...vector).divideScalar(length));
        shaft.scale.set(1, length - 0.9 * tip, 1);
        head.position.set(0, length, 0);
        head.scale.set(Math.min(1, tip / (9 * thick) + 0.2), tip, Math.min(1, tip / (9 * thick) + 0.2));
      },
    };
  }
}

// The surface of a body: {vertices, normals, faces}, um.
export function triangles(surface) {
  const { vertices, normals, faces } = surface;
  return { vertices: unpack(vertices).map((x) => 1e6 * x), normals: unpack(normals), faces: unpack(faces) };
}

// A geometry with attributes {name: [numbers, size]}.
export function geometry(attributes) {
  const shape = new BufferGeometry();
  for (const [name, [numbers, size]] of Object.entries(attributes))
    shape.setAttribute(name, new BufferAttribute(Float32Array.from(numbers), size));
  return shape;
}

const PATH_VERTEX = `
attribute vec3 other, colour; attribute vec2 corner; attribute float order;
uniform vec2 screen; uniform float now; uniform vec3 ground;
varying vec3 shown;
void main() {
  float past = step(order + 0.5, now);
  shown = mix(mix(ground, colour, 0.45), colour, past);
  float width = mix(1.6, 3.4, past);
  vec4 here = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  vec4 there = projectionMatrix * modelViewMatrix * vec4(other, 1.0);
  vec2 way = (there.xy / there.w - here.xy / here.w) * screen;
  float far = length(way);
  vec2 along = far > 1e-6 ? way / far : vec2(1.0, 0.0);
  // the end of a piece reaches over the joint, by the half of the width
  vec2 across = vec2(-along.y, along.x) * corner.y * (1.0 - 2.0 * corner.x);
  here.xy += (across - 0.7 * along) * width / screen * here.w;
  here.z -= past * 1e-6 * here.w;
  gl_Position = here;
}`;
const PATH = `
varying vec3 shown;
void main() {
  gl_FragColor = vec4(shown, 1.0);
  #include <colorspace_fragment>
}`;
const BEAD_VERTEX = `
uniform float size;
varying vec3 place; varying vec3 facing; varying vec3 towards;
void main() {
  place = position / size;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  facing = normalMatrix * normal;
  towards = projectionMatrix[3][3] > 0.5 ? vec3(0.0, 0.0, 1.0) : -seen.xyz;
  gl_Position = projectionMatrix * seen;
}`;
// eight fields in two tones, and the three great circles between them; `ends`: how much of its colour the
// half of a body at negative z has, so that a body that has turned round does not look the same
const BEAD = `
const vec3 LAMP = vec3(-0.398, 0.697, 0.597), HALFWAY = vec3(-0.223, 0.390, 0.893);
uniform vec3 light, dark, rim, far; uniform float ends;
varying vec3 place; varying vec3 facing; varying vec3 towards;
void main() {
  vec3 n = normalize(facing), v = normalize(towards);
  float field = step(0.0, place.x * place.y * place.z);
  vec3 width = fwidth(place) * 1.2;
  vec3 edges = 1.0 - smoothstep(vec3(0.0), width + 0.006, abs(place));
  float circle = max(edges.x, max(edges.y, edges.z));
  float edge = 1.0 - abs(dot(n, v));
  float glow = 0.72 + 0.28 * max(dot(n, LAMP), 0.0);
  float outer = edge * edge;
  vec3 tone = mix(mix(dark, light, field), far, ends * step(place.z, 0.0));
  vec3 colour = mix(tone * glow, rim, max(0.55 * circle, outer * outer));
  float shine = smoothstep(0.97, 1.0, dot(n, HALFWAY));
  gl_FragColor = vec4(colour + 0.35 * shine, min(0.5 + 0.25 * circle + 0.45 * outer, 0.95));
  #include <colorspace_fragment>
}`;
const CORE = `
uniform vec3 light, dark, rim;
varying vec3 place; varying vec3 facing; varying vec3 towards;
void main() {
  float edge = 1.0 - abs(dot(normalize(facing), normalize(towards)));
  gl_FragColor = vec4(mix(dark, rim, edge), 0.25 + 0.6 * edge * edge);
  #include <colorspace_fragment>
}`;
const CONE_VERTEX = `
attribute float along;
varying vec3 facing; varying vec3 towards; varying float part;
void main() {
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  facing = normalMatrix * normal;
  towards = projectionMatrix[3][3] > 0.5 ? vec3(0.0, 0.0, 1.0) : -seen.xyz;
  part = along;
  gl_Position = projectionMatrix * seen;
}`;
// denser where it is seen along its surface, and fading away from the focus
const CONE = `
uniform vec3 colour; uniform float strength, full;
varying vec3 facing; varying vec3 towards; varying float part;
void main() {
  float edge = 1.0 - abs(dot(normalize(facing), normalize(towards)));
  float fade = (1.0 - abs(part)) * (1.0 - 0.4 * abs(part));
  gl_FragColor = vec4(colour, full * strength * fade * (0.28 + 0.72 * edge));
  #include <colorspace_fragment>
}`;
const CLOUD_VERTEX = `
uniform float size;
void main() { gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); gl_PointSize = size; }`;
const CLOUD = `
uniform vec3 colour; uniform float ring;
void main() {
  float away = length(gl_PointCoord - 0.5);
  if (away > 0.5 || (ring > 0.5 && away < 0.28)) discard;
  gl_FragColor = vec4(colour, ring > 0.5 ? 1.0 : 0.5);
  #include <colorspace_fragment>
}`;
const SOLID_VERTEX = `
varying vec3 facing;
void main() { facing = normalMatrix * normal; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`;
const SOLID = `
uniform vec3 colour; varying vec3 facing;
void main() {
  float glow = 0.75 + 0.25 * max(dot(normalize(facing), normalize(vec3(-0.4, 0.7, 0.6))), 0.0);
  gl_FragColor = vec4(colour * glow, 1.0);
  #include <colorspace_fragment>
}`;
