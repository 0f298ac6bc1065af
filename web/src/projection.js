// Flat views of a scene as SVG: thumbnails, the dimensioned drawing, and what
// remains where WebGL is missing.
import { svg } from "./dom.js";
import { BODY, JOINT } from "./colours.js";
import { ends, homePosture, transform } from "./posture.js";

const ISO = Math.PI / 6;

/** Base frame -> sheet (right, up). */
export const VIEWS = {
  front: { words: "Front view (x to the right, z up)", project: ([x, , z]) => [x, z] },
  top: { words: "Top view (x to the right, y up)", project: ([x, y]) => [x, y] },
  oblique: { words: "Oblique view", project: ([x, y, z]) => [(x - y) * Math.cos(ISO), z + (x + y) * Math.sin(ISO) * 0.7] },
};

const WIDTH = { guide: 2.6, rod: 1.5, strut: 2, link: 2.2, carriage: 3, platform: 2.2, tool: 2.6 };
const ORDER = ["guide", "link", "strut", "rod", "carriage", "platform", "tool"];

/** Bounds of the projected scene as {left, right, low, high}, sheet coordinates in metres. */
export function sheetBounds(scene, view, posture = homePosture(scene)) {
  const points = scene.segments.flatMap((s) => ends(s, posture)).map(VIEWS[view].project);
  const u = points.map((p) => p[0]), v = points.map((p) => p[1]);
  return { left: Math.min(...u), right: Math.max(...u), low: Math.min(...v), high: Math.max(...v) };
}

/** Share of a measure's length that a view shows, 0 to 1. */
export function shownShare({ a, b }, view) {
  const [p, q] = [a, b].map(VIEWS[view].project);
  return Math.hypot(p[0] - q[0], p[1] - q[1]) / Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

/** The view in which a measure is drawn: its own, or the one that shortens it less. */
export function viewOf(measure) {
  if (measure.view !== "longest") return measure.view;
  return shownShare(measure, "front") >= 0.98 * shownShare(measure, "top") ? "front" : "top";
}

/** Lines and joint marks of a scene; `place` maps sheet metres to pixels. */
export function sketch(scene, view, place, { posture = homePosture(scene), joints = true, weight = 1 } = {}) {
  const at = (p) => place(VIEWS[view].project(p));
  const sorted = [...scene.segments].sort((a, b) => ORDER.indexOf(a.role) - ORDER.indexOf(b.role));
  const lines = sorted.map((s) => {
    const [[x1, y1], [x2, y2]] = ends(s, posture).map(at);
    return svg("line", { x1, y1, x2, y2, stroke: BODY[s.role] ?? BODY.link, "stroke-width": (WIDTH[s.role] ?? 1.5) * weight, "stroke-linecap": "round" });
  });
  const marks = (joints ? scene.joints ?? [] : []).map((joint) => {
    const [cx, cy] = at(transform(posture[joint.body], joint.at));
    const colour = joint.driven ? JOINT.driven : JOINT[joint.type] ?? JOINT.revolute;
    if (joint.type === "spherical") return svg("circle", { cx, cy, r: 3.2 * weight, fill: "#fff", stroke: colour, "stroke-width": 1.6 * weight });
    if (joint.type === "universal") {
      const r = 3.6 * weight;
      return svg("path", { d: `M${cx - r} ${cy - r}L${cx + r} ${cy + r}M${cx - r} ${cy + r}L${cx + r} ${cy - r}`, stroke: colour, "stroke-width": 1.8 * weight });
    }
    const r = 3 * weight;
    return svg("rect", { x: cx - r, y: cy - r, width: 2 * r, height: 2 * r, fill: joint.driven ? colour : "#fff", stroke: colour, "stroke-width": 1.4 * weight });
  });
  return svg("g", {}, lines, marks);
}

/** A mapping that fits `bounds` into a frame, y up turned into y down; with its scale [px/m]. */
export function fit(bounds, { width, height, margin }) {
  const scale = Math.min((width - 2 * margin) / Math.max(1e-9, bounds.right - bounds.left), (height - 2 * margin) / Math.max(1e-9, bounds.high - bounds.low));
  const cu = (bounds.left + bounds.right) / 2, cv = (bounds.low + bounds.high) / 2;
  const place = ([u, v]) => [width / 2 + (u - cu) * scale, height / 2 - (v - cv) * scale].map((p) => Math.round(p * 10) / 10);
  return { place, scale };
}

/** A small oblique picture of a scene. */
export function thumbnail(scene, { width = 96, height = 76, joints = false, weight = 0.75, posture } = {}) {
  const { place } = fit(sheetBounds(scene, "oblique", posture), { width, height, margin: 5 });
  return svg("svg", { viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": "kinematic scheme" },
    sketch(scene, "oblique", place, { posture, joints, weight }));
}
