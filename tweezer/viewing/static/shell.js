// What every page has: its frame, the table of the summary, notes, themes, keys.
import { text, unpack } from "tweezer/arrays";

// An element: make("a", {href: "..."}, child, "text", ...); `class` and `on...` as attributes.
export function make(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (value === true) element.setAttribute(key, "");
    else if (value !== false && value !== null) element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

// Set the words of an element; those that it has already cost nothing.
export function write(element, words) {
  if (element.textContent !== words) element.textContent = words;
}

// The frame of a page. A page's module fills `picture` and `plots`, and `clock` if it has a time.
export class Shell {
  constructor(content) {
    this.content = content;
    this.keys = [];
    this.themed = [];
    this.resets = [];
    this.remembered = {};
    this.unpacked = {};
    this.sayer = make("p", { class: "unseen", "aria-live": "polite" });
    this.picture = make("section", { class: "picture", "aria-label": "Picture" });
    this.plots = make("section", { class: "plots", "aria-label": "Plots" });
    this.clock = make("section", { class: "clock", "aria-label": "Time" });
    this.board = make("div", { class: "board" }, this.picture, this.plots, this.clock);
    this.help = make("dialog", { "aria-labelledby": "keys" });
    this.themeButton = make("button", { type: "button", onclick: () => this.turnTheme() });
    this.buttons = make("div", { class: "buttons" },
      make("button", { type: "button", onclick: () => this.showHelp() }, "Keys"), this.themeButton);
    document.body.append(
      make("main", {},
        make("div", { class: "screen" },
          make("header", {},
            make("div", {}, make("h1", {}, content.title), this.sub()),
            this.buttons),
          ...(content.warning ? [make("p", { class: "warning", role: "alert" }, content.warning)] : []),
          this.board),
        make("div", { class: "words" }, this.summary(), this.notes())),
      this.sayer, this.help,
    );
    this.key("?", "this list of keys", () => this.showHelp());
    this.key("t", "light or dark", () => this.turnTheme());
    document.addEventListener("keydown", (event) => this.pressed(event));
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.retheme());
    // a page around this one is light or dark by its own switch
    addEventListener("message", ({ data }) => {
      if (data?.theme !== "light" && data?.theme !== "dark") return;
      this.theme = data.theme;
      this.retheme();
    });
    this.retheme();
    window.tweezer = { content, link: () => this.here };
    this.remember("theme", () => this.theme ?? "", (theme) => {
      this.theme = theme;
      this.retheme();
    });
    if (document.fullscreenEnabled)
      this.offer("Full screen", "fill the screen, or not", () => this.fillScreen());
    if (location.protocol !== "about:")
      this.offer("Link", "copy a link to this page as it is now", () => this.link());
    this.offer("Reset", "show all as at first", () => { for (const act of this.resets) act(); });
  }

  // ---- buttons of the page

  // A button in the head of the page.
  offer(name, does, act) {
    this.buttons.prepend(make("button", { type: "button", title: does, onclick: act }, name));
  }

  // Call `act` when the page is to show all as at first.
  onReset(act) {
    this.resets.push(act);
  }

  // A part of what a link keeps: `words()` now, and `act(words)` where a link brings them.
  remember(name, words, act) {
    this.remembered[name] = words;
    const found = new URLSearchParams(location.hash.slice(1)).get(name);
    if (found) act(found);
  }

  // The address of the page as it is now.
  get here() {
    const kept = Object.entries(this.remembered).map(([name, words]) => [name, String(words())]).filter(([, words]) => words);
    return `${location.href.split("#")[0]}#${new URLSearchParams(kept)}`;
  }

  async link() {
    try {
      await navigator.clipboard.writeText(this.here);
      this.say("The link is copied");
    } catch {
      location.hash = new URL(this.here).hash;
      this.say("The address of this page is now the link");
    }
  }

  fillScreen() {
    if (document.fullscreenElement) document.exitFullscreen(); else document.documentElement.requestFullscreen();
  }

  // Save a file, named after the page.
  download(blob, ending) {
    const address = URL.createObjectURL(blob), name = this.content.title.replace(/[^\p{L}\p{N}._-]+/gu, "-");
    const anchor = make("a", { href: address, download: `${name}.${ending}` });
    anchor.click();
    setTimeout(() => URL.revokeObjectURL(address), 60e3);
    this.say(`Saved ${anchor.download}`);
  }

  // Save columns {heading: values} of equal length as a CSV file.
  downloadTable(columns) {
    const rows = [Object.keys(columns).join(",")], each = Object.values(columns);
    for (let i = 0; i < each[0].length; i++) rows.push(each.map((values) => Number(values[i].toPrecision(7))).join(","));
    this.download(new Blob([`${rows.join("\n")}\n`], { type: "text/csv" }), "csv");
  }

  // Boxes that hide and show parts of the picture, {name: [things with a group]}; those hidden at first
  // are not checked.
  layers(parts, redraw) {
    const boxes = Object.entries(parts).map(([name, given]) => [name, given.filter((thing) => thing?.group)])
      .filter(([, things]) => things.length).map(([name, things]) => {
        const box = make("input", { type: "checkbox", checked: things[0].group.visible, onchange: () => {
          for (const { group } of things) group.visible = box.checked;
          redraw();
        } });
        this.onReset(() => { if (box.checked !== box.defaultChecked) box.click(); });
        return make("label", {}, box, name);
      });
    return make("fieldset", { class: "layers" }, make("legend", {}, "Show"), ...boxes);
  }

  // Pictures of the light over the pupil: hue is the phase, brightness the amplitude.
  pupils() {
    return (this.content.facts.pupils ?? []).map(({ name, image }) => make("figure", { class: "pupil" },
      make("img", { src: image, alt: `${name}: hue is the phase of the light, brightness its amplitude` }),
      make("figcaption", { title: "hue: phase; brightness: amplitude" }, name)));
  }

  // Values of an array of the content, unpacked once.
  array(name) {
    const packed = this.content.arrays[name];
    if (!packed) return null;
    return (this.unpacked[name] ??= unpack(packed));
  }

  sub() {
    return make("p", { class: "sub" }, [this.content.shows, this.content.facts.subtitle].filter(Boolean).join(": ") +
      ` · page by tweezer ${this.content.version}`);
  }

  // What a key does, listed in the help. `key` as of a KeyboardEvent, or several of them. `within`:
  // elements of which one has the focus; elsewhere such a key scrolls.
  key(key, does, act, within = null) {
    this.keys.push({ keys: [key].flat(), does, act, within });
  }

  pressed(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || this.help.open) return;
    const at = event.target;
    // lists and fields take keys of their own; so does a button that space presses
    if (at.matches("select, input:not([type=range]):not([type=checkbox]), textarea")) return;
    if (event.key === " " && at.matches("button, summary, a, input")) return;
    const found = this.keys.find(({ keys, within }) =>
      keys.includes(event.key) && (!within || within.some((element) => element.contains(at))));
    if (!found) return;
    event.preventDefault();
    found.act(event);
  }

  showHelp() {
    const rows = this.keys.map(({ keys, does }) =>
      make("tr", {}, make("th", { scope: "row" },
        ...keys.flatMap((key, i) => [i ? " " : "", make("kbd", {}, NAMES[key] ?? key)])),
        make("td", {}, does)));
    this.help.replaceChildren(
      make("h2", { id: "keys" }, "Keys"), make("table", {}, make("tbody", {}, ...rows)),
      make("p", {}, "Drag the picture to turn it, with two fingers or the right button to move it; " +
        "the wheel or a pinch makes it larger. Click or drag in a plot to go to a time."),
      make("form", { method: "dialog" }, make("button", {}, "Close")));
    this.help.showModal();
  }

  // A sentence for screen readers.
  say(sentence) {
    this.sayer.textContent = sentence;
  }

  get dark() {
    return this.theme ? this.theme === "dark" : matchMedia("(prefers-color-scheme: dark)").matches;
  }

  turnTheme() {
    this.theme = this.dark ? "light" : "dark";
    this.retheme();
  }

  retheme() {
    document.documentElement.dataset.theme = this.dark ? "dark" : "light";
    this.themeButton.textContent = this.dark ? "Light" : "Dark";
    for (const act of this.themed) act();
  }

  // Call `act` now, and whenever the theme changes.
  onTheme(act) {
    this.themed.push(act);
    act();
  }

  // A colour of the style sheet, such as colour("ink").
  colour(name) {
    return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  }

  // Say below the picture where walls are that it does not show.
  outside(walls) {
    if (!walls.length) return;
    const each = walls.map(({ z, normal, name }) => `the ${name} at z = ${text(1e6 * z, 3)} µm, ${normal > 0 ? "below" : "above"}`);
    this.picture.append(make("p", { class: "outside" }, `Outside the picture: ${each.join("; ")}`));
  }

  summary() {
    const rows = this.content.summary.map(({ name, value, error, trusted }) =>
      make("tr", trusted ? {} : { class: "doubtful" },
        make("th", { scope: "row" }, name), make("td", {}, value),
        make("td", {}, error),
        make("td", {}, trusted ? "" : "not to be trusted")));
    return make("section", { "aria-labelledby": "summary" },
      make("h2", { id: "summary" }, "Summary"),
      make("table", { class: "found" },
        make("thead", {}, make("tr", {}, ...["quantity", "value", "error", "judgement"].map(
          (heading) => make("th", { scope: "col" }, heading)))),
        make("tbody", {}, ...rows)));
  }

  notes() {
    const rounded = Object.entries(this.content.arrays).filter(([, packed]) => packed.rounding > 0);
    const rows = rounded.map(([name, { type, unit, rounding, largest }]) =>
      make("tr", {}, make("th", { scope: "row" }, name.replaceAll("_", " ")),
        make("td", {}, `${text(rounding, 2)} ${unit === "1" ? "" : unit}`),
        make("td", {}, text(rounding / largest, 2)), make("td", {}, type)));
    const numbers = rows.length ? [
      make("h3", { id: "rounding" }, "What rounding for this page changes, at most"),
      make("div", { class: "scrolls", tabindex: "0", role: "region", "aria-labelledby": "rounding" },
        make("table", {},
          make("thead", {}, make("tr", {}, ...["numbers", "by", "of the largest", "kept as"].map(
            (heading) => make("th", { scope: "col" }, heading)))),
          make("tbody", {}, ...rows)))] : [];
    return make("section", { "aria-labelledby": "notes" },
      make("h2", { id: "notes" }, "Notes"),
      make("ul", {}, ...this.content.notes.map((note) => make("li", {}, note))), ...numbers);
  }
}

const NAMES = {
  " ": "space", ArrowLeft: "←", ArrowRight: "→", ArrowUp: "↑", ArrowDown: "↓",
};
