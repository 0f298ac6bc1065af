// Building HTML and SVG without markup strings: text from a run stays text.

const SVG = "http://www.w3.org/2000/svg";

function fill(node, attributes, children) {
  for (const [key, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (key.startsWith("on")) node.addEventListener(key.slice(2), value);
    else if (key === "style" && typeof value === "object") Object.assign(node.style, value);
    else node.setAttribute(key, value === true ? "" : value);
  }
  node.append(...children.flat(3).filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

/** An HTML element: el("p", {class: "note"}, "text", el("b", {}, "more")). */
export const el = (name, attributes, ...children) => fill(document.createElement(name), attributes, children);

/** The same for SVG. */
export const svg = (name, attributes, ...children) => fill(document.createElementNS(SVG, name), attributes, children);

/** A table of rows (arrays of cells: text or nodes). Numeric columns are right-aligned. */
export function table(head, rows, { numeric = [], caption, className } = {}) {
  const cell = (tag) => (content, index) => el(tag, { class: numeric.includes(index) ? "num" : null }, content);
  return el("div", { class: "scroll" }, el("table", { class: className },
    caption && el("caption", {}, caption),
    head && el("thead", {}, el("tr", {}, head.map(cell("th")))),
    el("tbody", {}, rows.map((row) => el("tr", {}, row.map(cell("td")))))));
}

/** A titled figure with its explanation underneath. */
export const figure = (content, caption) =>
  el("figure", {}, content, caption && el("figcaption", {}, caption));

/** A bar of `share` (0..1) of its cell's width. */
export const bar = (share, className = "") =>
  el("span", { class: `bar ${className}`, "aria-hidden": "true" },
    el("span", { style: { width: `${(100 * Math.min(1, Math.max(0, share || 0))).toFixed(1)}%` } }));
