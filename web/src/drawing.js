// The dimensioned drawing: front and top view at the same scale, with the
// parameters that can be found in them on leader lines.
import { el, figure, svg } from "./dom.js";
import { ACCENT, MUTED } from "./colours.js";
import { number, quantity, unitName } from "./format.js";
import { dimensionsOf } from "./measures.js";
import { VIEWS, fit, sheetBounds, sketch } from "./projection.js";

const FRAME = { width: 420, height: 360, margin: 34 };
const LABELS = 128;

/** The view in which a measure is seen in its true length, or nearly. */
function viewOf(measure) {
  if (measure.view !== "longest") return measure.view;
  const length = (view) => {
    const [a, b] = [measure.a, measure.b].map(VIEWS[view].project);
    return Math.hypot(a[0] - b[0], a[1] - b[1]);
  };
  return length("front") >= length("top") * 0.98 ? "front" : "top";
}

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

function annotation({ parameter, measure }, view, place) {
  const [[x1, y1], [x2, y2]] = [measure.a, measure.b].map((p) => place(VIEWS[view].project(p)));
  return { x1, y1, x2, y2, x: (x1 + x2) / 2, y: (y1 + y2) / 2, text: parameter.name, value: quantity(parameter.value, unitName(parameter.unit)), what: measure.what };
}

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
      svg("line", { x1: n.x1, y1: n.y1, x2: n.x2, y2: n.y2, stroke: ACCENT, "stroke-width": 1.4, "marker-start": "url(#tick)", "marker-end": "url(#tick)" }),
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
