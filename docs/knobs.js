// The knobs of the landing page select one of the computed traps in knobs.json.
const traps = JSON.parse(document.getElementById("knob-values").textContent);
const knobs = [
  ["diameter", traps.diameter_um, (value) => `${value} µm`, 1],
  ["aperture", traps.numerical_aperture, (value) => value.toFixed(2), 1.25],
  ["power", traps.power_mW, (value) => `${value} mW`, 50],
].map(([name, values, text, initial]) => {
  const input = document.getElementById(`knob-${name}`);
  input.max = values.length - 1;
  input.value = values.indexOf(initial);
  input.addEventListener("input", answer);
  return { input, values, text, output: document.querySelector(`output[for=knob-${name}]`) };
});

const MEDIUM = 1.326; // refractive index of the medium in silica-1um
const sketch = document.getElementById("knob-sketch");

function answer() {
  for (const { input, values, text, output } of knobs) {
    output.textContent = text(values[input.value]);
    input.setAttribute("aria-valuetext", output.textContent);
  }
  const [diameter, aperture] = knobs.map(({ input, values }) => values[input.value]);
  const of = (table) => knobs.reduce((rows, { input }) => rows[input.value], traps[table]);
  const show = (name, value, unit) => {
    document.getElementById(`knob-${name}`).textContent = value === null ? "no trap" : `${value} ${unit}`;
  };
  show("lateral", of("lateral_pN_per_um"), "pN/µm");
  show("axial", of("axial_pN_per_um"), "pN/µm");
  show("depth", of("depth_kT"), "kT");
  show("equilibrium", of("equilibrium_z_um"), "µm");

  // light comes from below, as on the interactive page, with z upwards; lengths in µm
  const far = 2.4 * Math.tan(Math.asin(aperture / MEDIUM));
  const z = of("equilibrium_z_um");
  sketch.innerHTML = `<path class="light" d="M0 0 ${far} 2.4H${-far}ZM0 0 ${far} -2.4H${-far}Z"/>`
    + (z === null ? "" : `<circle cx="0" cy="${-z}" r="${diameter / 2}"/>`)
    + '<path class="scale" d="M1.2 2.2h1"/><text x="1.7" y="2.08">1 µm</text>';
}
answer();
