/* What keeps a reader from a page, as Lighthouse and axe ask it; a list of plain lines.
   Contrast is WCAG 2.2's (1.4.3), the size of what is pressed 2.5.8's, with its exceptions. */
(() => {
  const found = new Set();
  const shown = element => element.checkVisibility({opacityProperty: true, visibilityProperty: true})
    && element.getClientRects().length > 0;
  const brief = text => text.trim().replace(/\s+/g, " ").slice(0, 40);
  const path = element => element.tagName.toLowerCase()
    + (element.className && element.className.split ? "." + element.className.split(/\s+/)[0] : "");

  // the head
  if (!document.documentElement.lang) found.add("no language");
  if (!document.title.trim()) found.add("no title");
  if (!document.querySelector("meta[name=description]")?.content) found.add("no description");
  if (!document.querySelector("meta[name=viewport]")) found.add("no viewport");

  // the outline
  const headings = [...document.querySelectorAll("h1, h2, h3, h4, h5, h6")].filter(shown);
  const levels = headings.map(heading => Number(heading.tagName[1]));
  if (levels.filter(level => level === 1).length !== 1) found.add("not one h1");
  levels.forEach((level, at) => {
    if (at && level > levels[at - 1] + 1) found.add(`h${levels[at - 1]} before h${level}: ${brief(headings[at].textContent)}`);
  });
  if (!document.querySelector("main, [role=main]")) found.add("no main part");
  const ids = [...document.querySelectorAll("[id]")].map(element => element.id);
  const twice = ids.filter((id, at) => ids.indexOf(id) !== at);
  if (twice.length) found.add(`twice the id ${twice[0]}`);

  // names
  const named = element => [
    element.getAttribute("aria-label"), element.getAttribute("title"), element.textContent,
    element.value && element.type === "submit" ? element.value : "",
    ...[...element.querySelectorAll("img[alt], svg[aria-label]")].map(
      image => image.alt || image.getAttribute("aria-label")),
    ...(element.getAttribute("aria-labelledby") || "").split(" ").map(
      id => id && document.getElementById(id)?.textContent),
    ...[...(element.labels || [])].map(label => label.textContent || label.title),
  ].some(name => name && name.trim());
  const pressed = [...document.querySelectorAll(
    "a[href], button, input:not([type=hidden]), select, textarea, summary, [tabindex]")];
  for (const element of pressed.filter(shown)) {
    if (element.tabIndex > 0) found.add(`out of the order of the page: ${path(element)}`);
    if (element.tabIndex >= 0 && !element.matches("[tabindex]:not(a, button, input, select)") && !named(element))
      found.add(`no name: ${path(element)}`);
  }
  for (const image of document.querySelectorAll("img:not([alt]), img[alt='']"))
    if (shown(image) && image.getAttribute("role") !== "presentation") found.add(`no alt text: ${image.src.slice(-60)}`);
  for (const frame of document.querySelectorAll("iframe:not([title])"))
    if (shown(frame)) found.add(`no title: ${frame.src}`);
  for (const canvas of document.querySelectorAll("canvas:not([aria-label], [aria-hidden], [role=presentation])"))
    if (shown(canvas)) found.add(`no label: ${path(canvas)}`);

  // contrast of text with what is painted behind it
  const canvas = document.createElement("canvas").getContext("2d", {willReadFrequently: true});
  const kept = new Map();
  const colour = text => {
    if (!kept.has(text)) {
      canvas.clearRect(0, 0, 1, 1);
      canvas.fillStyle = text;
      canvas.fillRect(0, 0, 1, 1);
      const [red, green, blue, alpha] = canvas.getImageData(0, 0, 1, 1).data;
      kept.set(text, alpha ? [red, green, blue, alpha / 255] : [0, 0, 0, 0]);
    }
    return kept.get(text);
  };
  const over = (above, below) => above.slice(0, 3).map(
    (part, at) => part * above[3] + below[at] * (1 - above[3])).concat(1);
  const behind = new Map();
  const background = element => {
    if (!element) return colour(getComputedStyle(document.documentElement).colorScheme.includes("dark")
      ? "rgb(18,18,18)" : "white");
    if (!behind.has(element)) {
      const own = colour(getComputedStyle(element).backgroundColor);
      behind.set(element, own[3] === 1 ? own : over(own, background(element.parentElement)));
    }
    return behind.get(element);
  };
  const luminance = of => of.slice(0, 3).map(part => part / 255).map(
    part => part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4
  ).reduce((sum, part, at) => sum + part * [0.2126, 0.7152, 0.0722][at], 0);
  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const seen = new Set();
  while (texts.nextNode()) {
    const element = texts.currentNode.parentElement;
    if (!texts.currentNode.data.trim() || seen.has(element)) continue;
    seen.add(element);
    if (element.closest("script, style, noscript, [aria-hidden=true], [disabled]") || !shown(element)) continue;
    const style = getComputedStyle(element);
    const below = background(element);
    const [light, dark] = [over(colour(style.color), below), below].map(luminance).sort((a, b) => b - a);
    const ratio = (light + 0.05) / (dark + 0.05);
    const size = parseFloat(style.fontSize);
    const large = size >= 24 || (size >= 18.66 && Number(style.fontWeight) >= 700);
    if (ratio < (large ? 3 : 4.5) - 0.005)
      found.add(`contrast ${ratio.toFixed(2)}: ${path(element)} "${brief(texts.currentNode.data)}" ${style.color} on ${below.map(Math.round)}`);
  }

  // what is pressed with a finger: 24 pixels, unless in a line of text or with room about it
  const boxes = pressed.filter(element => shown(element) && element.tabIndex >= 0 && element.matches("a, button, input, select, summary"))
    .map(element => [element, element.getBoundingClientRect()]);
  for (const [element, box] of boxes) {
    if (Math.min(box.width, box.height) >= 23.5) continue;
    const inline = getComputedStyle(element).display === "inline" && element.parentElement.textContent.trim() !== element.textContent.trim();
    if (inline || element.closest("p, li, td, th, figcaption, dd, .doc") ) continue;
    const middle = [box.x + box.width / 2, box.y + box.height / 2];
    const crowded = boxes.some(([other, near]) => other !== element && !element.contains(other) && !other.contains(element)
      && near.left < middle[0] + 12 && near.right > middle[0] - 12 && near.top < middle[1] + 12 && near.bottom > middle[1] - 12);
    if (crowded) found.add(`small and crowded: ${path(element)} "${brief(element.textContent)}" ${box.width.toFixed(0)} x ${box.height.toFixed(0)}`);
  }

  // where the keyboard is
  const look = element => {
    const style = getComputedStyle(element);
    return [style.outlineStyle === "none" ? "" : style.outlineWidth + style.outlineColor, style.boxShadow,
      style.backgroundColor, style.color, style.textDecoration, style.borderColor].join();
  };
  const kinds = new Set();
  const still = document.createElement("style");
  still.textContent = "*, *::before, *::after { transition: none !important; }";
  document.head.append(still);
  for (const element of pressed.filter(element => shown(element) && element.tabIndex >= 0)) {
    if (kinds.has(path(element))) continue;
    kinds.add(path(element));
    const label = element.labels?.[0];
    const before = look(element) + (label ? look(label) : "");
    element.focus({preventScroll: true, focusVisible: true});
    if (document.activeElement === element && look(element) + (label ? look(label) : "") === before)
      found.add(`focus not seen: ${path(element)} "${brief(element.textContent)}"`);
    // a box or a button of choice is drawn by its label
    const {left, right, width, height} = element.getBoundingClientRect();
    const drawn = width * height > 0 || element.matches("[type=checkbox], [type=radio]");
    if (document.activeElement === element && (!drawn || right <= 0 || left >= innerWidth))
      found.add(`focus off the screen: ${path(element)} "${brief(element.textContent)}"`);
    element.blur();
  }
  still.remove();
  return [...found];
})
