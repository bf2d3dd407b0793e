// The navigation of a phone's screen, by the keyboard: the theme opens it by labels, which are no
// stops. What is closed is hidden by extra.css, so that the keyboard does not walk through it.
const drawer = document.querySelector("#__drawer");
const sidebar = document.querySelector(".md-sidebar--primary");
const opener = document.querySelector(".md-header__button[for=__drawer]");
const folds = [...sidebar.querySelectorAll("label[for^=__nav], label[for=__toc]")];

const first = (within) => [...within.querySelectorAll("a[href], label[tabindex='0']")].find(
  (stop) => stop.checkVisibility({ visibilityProperty: true }));

// A label that is pressed like a button, and the focus where it leads.
function button(label, name, next) {
  const toggle = document.getElementById(label.htmlFor);
  label.setAttribute("role", "button");
  if (name) label.setAttribute("aria-label", name);
  label.addEventListener("keydown", (event) => {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    event.stopPropagation(); // the theme clicks the label that has the focus by then
    toggle.click();
    next(toggle.checked)?.focus({ preventScroll: true }); // it is on its way in
  });
}

button(opener, "Navigation", () => first(sidebar));
for (const label of folds) {
  const item = label.closest(".md-nav__item");
  const heading = item.querySelector(":scope > label");
  button(label, "", (open) => (open ? first(item.querySelector(".md-nav")) : heading));
}
sidebar.addEventListener("keydown", (event) => {
  if (event.key !== "Escape" || !drawer.checked) return;
  drawer.click();
  opener.focus();
});
sidebar.addEventListener("focusout", (event) => {
  if (drawer.checked && event.relatedTarget && !sidebar.contains(event.relatedTarget)) drawer.click();
});

// On a wide screen they are headings.
const narrow = matchMedia("(max-width: 76.234375em)");
const arrange = () => {
  for (const label of [opener, ...folds]) label.tabIndex = narrow.matches ? 0 : -1;
};
narrow.addEventListener("change", arrange);
arrange();

// The results of a search are reached by the arrows; their empty frame is no stop.
document.querySelector(".md-search__scrollwrap").removeAttribute("tabindex");

// A page that plays within this one is light or dark as this one is.
const plays = document.querySelector("iframe.plays");
if (plays) {
  const tell = () => plays.contentWindow.postMessage(
    { theme: document.body.dataset.mdColorScheme === "slate" ? "dark" : "light" }, "*");
  plays.addEventListener("load", tell);
  new MutationObserver(tell).observe(document.body, { attributeFilter: ["data-md-color-scheme"] });
  tell();
}
