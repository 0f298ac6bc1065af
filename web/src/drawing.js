// The dimensioned drawing: front and top view at the same scale, with the
// parameters that can be found in them on leader lines.
import { el, figure, svg } from "./dom.js";
import { ACCENT, MUTED } from "./colours.js";
import { number, quantity, unitName } from "./format.js";
import { dimensionsOf } from "./measures.js";
import { VIEWS, fit, sheetBounds, sketch, viewOf } from "./projection.js";

const FRAME = { width: 420, height: 360, margin: 34 };
const LABELS = 128;

/** Label positions down the right edge, in the order of their anchors, never closer than a line. */
function stack(anchors, height) {
  const step = 20;
  const sorted = anchors.map((anchor, index) => ({ ...anchor, index })).sort((a, b) => a.y - b.y);
  let next = 16;
  for (const label of sorted) {
    label.labelY = Math.max(next, label.y);
    next = label.labelY + step;
  }
  const overflow = Math.max(0, next - step - (height - 12));
  for (const label of sorted) label.labelY -= overflow;
  return sorted;
}

/** The arc between a line and the level or plumb line through its lower end. */
function arcOf({ from, to, what }) {
  const [low, high] = from[1] > to[1] ? [from, to] : [to, from];
  const length = Math.hypot(high[0] - low[0], high[1] - low[1]) || 1;
  const radius = Math.min(34, 0.6 * length);
  const line = [0, 1].map((k) => (high[k] - low[k]) / length);
  const other = what.includes("vertical") ? [0, -1] : [line[0] < 0 ? -1 : 1, 0];
  const point = (direction) => [0, 1].map((k) => low[k] + radius * direction[k]);
  const half = [0, 1].map((k) => line[k] + other[k]);
  const sweep = other[0] * line[1] - other[1] * line[0] > 0 ? 1 : 0;
  return { path: `M${low}L${point(other)}A${radius} ${radius} 0 0 ${sweep} ${point(line)}`, middle: point(half.map((v) => v / (Math.hypot(...half) || 1))) };
}

function annotation({ parameter, measure }, view, place) {
  const [from, to] = [measure.a, measure.b].map((p) => place(VIEWS[view].project(p)));
  const [x, y] = measure.angular ? arcOf({ from, to, what: measure.what }).middle : [0, 1].map((k) => (from[k] + to[k]) / 2);
  return { from, to, angular: measure.angular, x, y, text: parameter.name, value: quantity(parameter.value, unitName(parameter.unit)), what: measure.what };
}

/** A straight dimension with ticks at its ends. */
const straight = ({ from, to }) => svg("line", { x1: from[0], y1: from[1], x2: to[0], y2: to[1], stroke: ACCENT, "stroke-width": 1.4, "marker-start": "url(#tick)", "marker-end": "url(#tick)" });

function view(scene, name, found, scale) {
  const bounds = sheetBounds(scene, name);
  const half = [(FRAME.width - 2 * FRAME.margin) / scale / 2, (FRAME.height - 2 * FRAME.margin) / scale / 2];
  const cu = (bounds.left + bounds.right) / 2, cv = (bounds.low + bounds.high) / 2;
  const { place } = fit({ left: cu - half[0], right: cu + half[0], low: cv - half[1], high: cv + half[1] }, FRAME);
  const notes = stack(found.filter((f) => viewOf(f.measure) === name).map((f) => annotation(f, name, place)), FRAME.height);
  const edge = FRAME.width + 6;
  return figure(svg("svg", { viewBox: `0 0 ${FRAME.width + LABELS} ${FRAME.height}`, class: "drawing", role: "img", "aria-label": VIEWS[name].words },
    sketch(scene, name, place),
    notes.map((n) => svg("g", { class: "dimension" },
      svg("title", {}, `${n.text}: ${n.what}, ${n.value}`),
      n.angular ? svg("path", { d: arcOf(n).path, stroke: ACCENT, "stroke-width": 1.4, fill: "none" }) : straight(n),
      svg("path", { d: `M${n.x} ${n.y}L${edge - 8} ${n.labelY - 4}H${edge}`, stroke: MUTED, "stroke-width": 0.7, fill: "none", "stroke-dasharray": "3 2" }),
      svg("circle", { cx: n.x, cy: n.y, r: 2.2, fill: ACCENT }),
      svg("text", { x: edge + 3, y: n.labelY, class: "label" }, svg("tspan", { class: "name" }, n.text), ` ${n.value}`)))),
    VIEWS[name].words);
}

const tick = () => svg("svg", { width: 0, height: 0, class: "defs", "aria-hidden": "true" },
  svg("defs", {}, svg("marker", { id: "tick", viewBox: "-4 -4 8 8", markerWidth: 7, markerHeight: 7, orient: "auto" },
    svg("line", { x1: 0, y1: -4, x2: 0, y2: 4, stroke: ACCENT, "stroke-width": 1.4 }))));

/** The drawing of an entry, or null without a scene. */
export function drawing(entry) {
  if (!entry.scene?.segments?.length) return null;
  const { found, missing } = dimensionsOf(entry.scene, entry.parameters ?? []);
  const scale = Math.min(...["front", "top"].map((name) => fit(sheetBounds(entry.scene, name), FRAME).scale));
  return el("div", {}, tick(), el("div", { class: "views" }, ["front", "top"].map((name) => view(entry.scene, name, found, scale))),
    el("p", { class: "note" }, `Both views show the machine at home, at the same scale (1 mm on the machine is ${number(scale / 1e3, 2)} px in the drawing's own size). `,
      "Dimensions are drawn where their value is found again between points of the scheme; lengths are true lengths, also where the view shortens them.",
      missing.length > 0 && ` Only in the table: ${missing.map((p) => p.name).join(", ")}.`));
}
