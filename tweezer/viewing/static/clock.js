// Time: what is shown now, playing, the slider.
import { locate, scaled, text } from "tweezer/arrays";
import { make } from "tweezer/shell";

// Seconds that a run plays for at the speed the page begins with, about
const PLAYS = 10;
// Time between words for screen readers while it plays, ms
const TELLS = 1000;

export class Clock {
  // times: ascending, s.
  constructor(shell, times) {
    this.shell = shell;
    this.times = times;
    this.first = times[0];
    this.last = times[times.length - 1];
    this.time = this.first;
    this.playing = false;
    this.loop = true;
    this.listeners = [];
    this.told = -TELLS;
    const length = this.last - this.first || 1;
    this.shown = scaled(Math.max(Math.abs(this.first), Math.abs(this.last)) || 1, "s");
    this.speeds = [0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10].map((part) => nice(length / PLAYS) * part);
    this.speed = this.speeds[5];
    this.build();
  }

  // Call `act(time)` now and whenever the time changes.
  listen(act) {
    this.listeners.push(act);
    act(this.time);
  }

  build() {
    const { shell } = this;
    this.button = make("button", { type: "button", class: "play", onclick: () => this.toggle() });
    this.slider = make("input", {
      type: "range", min: 0, max: 1, step: "any", value: 0, "aria-label": "Time",
      oninput: () => this.seek(this.first + this.slider.value * (this.last - this.first)),
    });
    this.output = make("output", { class: "now", "aria-label": "Time shown", "aria-live": "off" });
    this.select = make("select", {
      "aria-label": "Speed: time shown in a second", onchange: () => { this.speed = Number(this.select.value); },
    }, ...this.speeds.map((speed) => {
      const { factor, unit } = scaled(speed, "s");
      return make("option", { value: speed, ...(speed === this.speed && { selected: true }) },
        `${text(factor * speed, 2)} ${unit} per s`);
    }));
    this.looped = make("input", { type: "checkbox", checked: true, onchange: () => { this.loop = this.looped.checked; } });
    shell.clock.append(
      this.button, this.slider, this.output, this.select,
      make("label", { class: "loop" }, this.looped, " loop"));
    shell.key([" ", "k"], "play or pause", () => this.toggle());
    const within = [shell.clock, shell.plots];
    for (const [key, does, act] of [
      ["ArrowLeft", "one sample back; with shift fifty", (event) => this.step(event.shiftKey ? -50 : -1)],
      ["ArrowRight", "one sample on; with shift fifty", (event) => this.step(event.shiftKey ? 50 : 1)],
      ["Home", "to the start", () => this.seek(this.first, true)],
      ["End", "to the end", () => this.seek(this.last, true)],
    ]) shell.key(key, `${does} (clock or plot in focus)`, act, within);
    shell.key(["-", "+"], "slower, faster", (event) => this.faster(event.key === "+" ? 1 : -1));
    shell.key("l", "loop or not", () => { this.loop = this.looped.checked = !this.loop; });
    this.label();
    this.listen(() => this.show());
    shell.onReset(() => this.seek(this.first));
    shell.remember("time", () => this.time, (time) => {
      if (Number.isFinite(Number(time))) this.seek(Number(time));
    });
  }

  // Record the canvas of the picture while time goes from the first to the last, as a video file.
  film(canvas) {
    const type = ["video/mp4", "video/webm"].find((each) => MediaRecorder.isTypeSupported(each));
    const recorder = new MediaRecorder(canvas.captureStream(30), { mimeType: type, videoBitsPerSecond: 8e6 });
    const parts = [], { loop } = this;
    recorder.ondataavailable = ({ data }) => parts.push(data);
    recorder.onstop = () => {
      this.loop = loop;
      this.shell.download(new Blob(parts, { type }), type.split("/")[1]);
    };
    this.seek(this.first);
    this.loop = false;
    this.ended = () => recorder.stop();
    recorder.start();
    this.play();
  }

  faster(by) {
    const at = Math.min(Math.max(this.select.selectedIndex + by, 0), this.speeds.length - 1);
    this.select.selectedIndex = at;
    this.speed = this.speeds[at];
    this.shell.say(`${this.select.options[at].text}`);
  }

  label() {
    this.button.textContent = this.playing ? "Pause" : "Play";
    this.button.classList.toggle("playing", this.playing);
  }

  toggle() {
    if (this.playing) this.pause(); else this.play();
  }

  play() {
    if (this.playing) return;
    if (this.time >= this.last) this.time = this.first;
    this.playing = true;
    this.label();
    let before = null;
    const advance = (now) => {
      if (!this.playing) return;
      if (before !== null) {
        // a page that was hidden goes on where it was
        let time = this.time + Math.min((now - before) / 1e3, 0.25) * this.speed;
        if (time >= this.last) {
          if (this.loop) time = this.first;
          else { this.set(this.last); this.pause(); return; }
        }
        this.set(time);
      }
      before = now;
      requestAnimationFrame(advance);
    };
    requestAnimationFrame(advance);
  }

  pause() {
    this.playing = false;
    this.label();
    this.show();
    this.shell.say(`Paused at ${this.words()}`);
    this.ended?.();
    this.ended = null;
  }

  // Go to a time; `told` to screen readers if it was a jump.
  seek(time, told = false) {
    if (this.playing) this.pause();
    this.set(Math.min(Math.max(time, this.first), this.last));
    if (told) this.shell.say(this.words());
  }

  step(by) {
    const [index, part] = locate(this.times, this.time);
    const from = by < 0 && part > 0 ? index + 1 : index;
    const to = Math.min(Math.max(from + by, 0), this.times.length - 1);
    this.seek(this.times[to], true);
  }

  set(time) {
    this.time = time;
    for (const act of this.listeners) act(time);
  }

  words() {
    const { factor, unit } = this.shown;
    return `${(factor * this.time).toFixed(decimals(factor * this.last))} ${unit}`;
  }

  show() {
    const words = this.words();
    this.output.textContent = words;
    this.slider.value = (this.time - this.first) / (this.last - this.first || 1);
    // while it plays a screen reader is not to be told every frame
    if (this.playing && performance.now() < this.told + TELLS) return;
    this.told = performance.now();
    this.slider.setAttribute("aria-valuetext", words);
  }
}

function decimals(size) {
  return Math.max(0, 3 - Math.floor(Math.log10(size || 1)));
}

// The nearest of 1, 2, 5 times a power of ten.
export function nice(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  const rest = value / power;
  return power * (rest < 1.5 ? 1 : rest < 3.5 ? 2 : rest < 7.5 ? 5 : 10);
}
