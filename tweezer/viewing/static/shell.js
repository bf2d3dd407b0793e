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
    this.unpacked = {};
    this.sayer = make("p", { class: "unseen", "aria-live": "polite" });
    this.picture = make("section", { class: "picture", "aria-label": "Picture" });
    this.plots = make("section", { class: "plots", "aria-label": "Plots" });
    this.clock = make("section", { class: "clock", "aria-label": "Time" });
    this.board = make("div", { class: "board" }, this.picture, this.plots, this.clock);
    this.help = make("dialog", { "aria-labelledby": "keys" });
    this.themeButton = make("button", { type: "button", onclick: () => this.turnTheme() });
    document.body.append(
      make("main", {},
        make("div", { class: "screen" },
          make("header", {},
            make("div", {}, make("h1", {}, content.title), this.sub()),
            make("div", { class: "buttons" },
              make("button", { type: "button", onclick: () => this.showHelp() }, "Keys"), this.themeButton)),
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
    window.tweezer = { content };
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
