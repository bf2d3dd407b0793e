// The force on a bead at any place, from the tables of cubic B-splines that `of_trap.py` packs.
import { locate } from "tweezer/arrays";

export class Field {
  constructor(content, shell) {
    const { facts, arrays } = content;
    this.weight = facts.weight;
    this.lights = facts.lights;
    this.tables = facts.tables.map((table, i) => ({
      ...table, values: shell.array(`table_${i}`), shape: arrays[`table_${i}`].shape,
      errors: shell.array(`errors_${i}`), cells: arrays[`errors_${i}`].shape,
    }));
    this.heights = shell.array("heights");
    this.ofWalls = shell.array("wall_force");
  }

  // Force at a place, m, in N: of light, weight and walls.
  force(place) {
    const force = [...this.weight];
    for (const { focus, factor, down, table } of this.lights) {
      const turn = down ? -1 : 1;
      const [x, y, z] = [place[0] - focus[0], turn * (place[1] - focus[1]), turn * (place[2] - focus[2])];
      if (this.tables[table].cells.length === 3) {
        const along = this.inBox(this.tables[table], [x, y, z]);
        force[0] += factor * along[0];
        force[1] += turn * factor * along[1];
        force[2] += turn * factor * along[2];
        continue;
      }
      const rho = Math.hypot(x, y), cosine = rho > 0 ? x / rho : 1, sine = rho > 0 ? y / rho : 0;
      const [outward, around, along] = this.about(this.tables[table], rho, z, cosine, sine);
      force[0] += factor * (cosine * outward - sine * around);
      force[1] += turn * factor * (sine * outward + cosine * around);
      force[2] += turn * factor * along;
    }
    if (this.heights) {
      const [i, part] = locate(this.heights, place[2]), next = Math.min(i + 1, this.heights.length - 1);
      force[2] += this.ofWalls[i] + part * (this.ofWalls[next] - this.ofWalls[i]);
    }
    return force;
  }

  // Components outward, around the axis and along it, at a distance from the axis and a height.
  about({ step, low, values, shape }, rho, z, cosine, sine) {
    const [harmonics, , tall, wide] = shape;
    const u = Math.min(rho / step + 1, wide - 2.001), v = Math.min(Math.max((z - low) / step, 1), tall - 2.001);
    const i = Math.floor(u), j = Math.floor(v), a = weights(u - i), b = weights(v - j);
    const turns = [1, 2 * cosine * cosine - 1, 2 * sine * cosine], found = [0, 0, 0];
    for (let h = 0; h < harmonics; h++)
      for (let c = 0; c < 3; c++) {
        let sum = 0;
        for (let n = 0; n < 4; n++) {
          const k = ((h * 3 + c) * tall + j - 1 + n) * wide + i - 1;
          sum += b[n] * (a[0] * values[k] + a[1] * values[k + 1] + a[2] * values[k + 2] + a[3] * values[k + 3]);
        }
        found[c] += turns[h] * sum;
      }
    return found;
  }

  // Components along x, y and z, from a table over a box.
  inBox({ step, low, values, shape }, place) {
    const [, tall, deep, wide] = shape, sizes = [wide, deep, tall];
    const at = place.map((x, k) => Math.min(Math.max((x - low[k]) / step, 1), sizes[k] - 2.001));
    const [i, j, k] = at.map(Math.floor), [a, b, c] = at.map((u) => weights(u - Math.floor(u)));
    return [0, 1, 2].map((component) => {
      let sum = 0;
      for (let n = 0; n < 4; n++)
        for (let m = 0; m < 4; m++) {
          const first = ((component * tall + k - 1 + n) * deep + j - 1 + m) * wide + i - 1;
          sum += c[n] * b[m] * (a[0] * values[first] + a[1] * values[first + 1] + a[2] * values[first + 2] + a[3] * values[first + 3]);
        }
      return sum;
    });
  }

  // How far the force there may be off what the tables stand for, N.
  off(place) {
    let sum = 0;
    for (const { focus, factor, down, table } of this.lights) {
      const { step, low, block, errors, cells } = this.tables[table], turn = down ? -1 : 1;
      if (cells.length === 3) {
        const at = [0, 1, 2].map((k) => {
          const x = (k ? turn : 1) * (place[k] - focus[k]);
          return Math.min(Math.max(Math.floor((x - low[k]) / (step * block)), 0), cells[2 - k] - 1);
        });
        sum += Math.abs(factor) * errors[(at[2] * cells[1] + at[1]) * cells[2] + at[0]];
        continue;
      }
      const rho = Math.hypot(place[0] - focus[0], place[1] - focus[1]), z = turn * (place[2] - focus[2]);
      const i = Math.min(Math.floor(rho / step), cells[1] - 1), j = Math.min(Math.max(Math.floor((z - low) / step - 1), 0), cells[0] - 1);
      sum += Math.abs(factor) * errors[j * cells[1] + i];
    }
    return sum;
  }

  // Work against the force on the straight way between two places, J, by Gauss's rule with two
  // nodes on each of `panels` parts.
  work(from, to, panels) {
    const way = to.map((x, k) => x - from[k]), half = 0.5 / panels, node = half / Math.sqrt(3);
    let sum = 0;
    for (let i = 0; i < panels; i++)
      for (const side of [-1, 1]) {
        const part = (2 * i + 1) * half + side * node;
        const force = this.force(from.map((x, k) => x + part * way[k]));
        sum -= half * (force[0] * way[0] + force[1] * way[1] + force[2] * way[2]);
      }
    return sum;
  }
}

// Of cubic B-splines at a part of the way between two nodes, of the four next to it.
function weights(t) {
  const s = 1 - t;
  return [(s * s * s) / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, (t * t * t) / 6];
}
