// Elements made in script: the page's policy allows no inline handlers and no style attributes.

/** A text that is read again when the language changes; `read` returns it. */
export class Said {
  constructor(read) {
    this.read = read;
  }

  /** Puts it into a text node, or into an attribute of an element. */
  put(node, attribute = "") {
    (node.said ??= {})[attribute] = this;
    if (attribute) node.setAttribute(attribute, this.read());
    else node.data = this.read();
    return node;
  }
}

/** Reads all texts of an element again. */
export function retell(root) {
  const walk = document.createTreeWalker(root, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT);
  for (let node = root; node; node = walk.nextNode()) {
    for (const [attribute, said] of Object.entries(node.said ?? {})) said.put(node, attribute);
  }
}

/** An element; keys of `props` that start with "on" are listeners, the rest attributes or properties. */
export function h(tag, props = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(props)) {
    if (value === undefined || value === null || value === false) continue;
    if (value instanceof Said) value.put(element, key);
    else if (key.startsWith("on")) element.addEventListener(key.slice(2), value);
    else if (key === "class") element.className = value;
    else if (key in element && !key.startsWith("aria") && key !== "list" && key !== "form") element[key] = value;
    else element.setAttribute(key, value === true ? "" : String(value));
  }
  const shown = children.filter((child) => child !== null && child !== undefined);
  element.append(...shown.map((child) => (child instanceof Said ? child.put(document.createTextNode("")) : child)));
  return element;
}

const SVG = "http://www.w3.org/2000/svg";
const ICONS = {
  pause: "M7 5v14M17 5v14",
  play: "M7 4l13 8-13 8z",
  step: "M5 5l9 7-9 7zM18 5v14",
  goal: "M12 21s7-6.5 7-12a7 7 0 0 0-14 0c0 5.5 7 12 7 12zM12 11.5a2.5 2.5 0 1 0 0-5 2.5 2.5 0 0 0 0 5z",
  pose: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM12 12l5-5M13 7h4v4",
  search: "M11 18a7 7 0 1 0 0-14 7 7 0 0 0 0 14zM16 16l5 5",
  restart: "M4 12a8 8 0 1 0 2.5-5.800M4 4v5h5",
  next: "M4 12h13M12 6l6 6-6 6",
  box: "M4 8l8-4 8 4v8l-8 4-8-4zM4 8l8 4 8-4M12 12v8",
  stop: "M6 6h12v12H6z",
  layers: "M12 4l9 5-9 5-9-5zM3 14l9 5 9-5",
  copy: "M9 9h11v11H9zM5 15H4V4h11v1",
  theme: "M12 3a9 9 0 1 0 9 9 7 7 0 0 1-9-9z",
  stick: "M12 21a9 9 0 1 0 0-18 9 9 0 0 0 0 18zM12 15a3 3 0 1 0 0-6 3 3 0 0 0 0 6z",
};

export function icon(name) {
  const svg = document.createElementNS(SVG, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(SVG, "path");
  path.setAttribute("d", ICONS[name]);
  svg.append(path);
  return svg;
}

export function button(name, label, onclick, props = {}) {
  return h("button", { type: "button", onclick, title: label, "aria-label": label, ...props }, icon(name));
}

/** A button with its name beside the icon; a style hides that where there is no room. */
export function namedButton(name, label, hint, onclick, props = {}) {
  return h("button", { type: "button", class: "named", onclick, title: hint, "aria-label": label, ...props }, icon(name), h("span", { class: "name" }, label));
}

/** Whether an element takes key presses itself: letters and arrows there are not for steering. */
export function takesKeys(element) {
  if (!element) return false;
  return element.isContentEditable || /^(INPUT|SELECT|TEXTAREA)$/.test(element.tagName);
}

export const reducedMotion = () => matchMedia("(prefers-reduced-motion: reduce)").matches;

export function remember(key, value) {
  try {
    localStorage.setItem(`trundle-${key}`, value);
  } catch {
    // A page opened from a file may have no storage: the choice then holds until it is closed.
  }
}

export function recall(key) {
  try {
    return localStorage.getItem(`trundle-${key}`);
  } catch {
    return null;
  }
}
