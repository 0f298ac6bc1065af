// Which drawn length or angle is which parameter. Nothing is assumed about a
// machine: lengths and angles are measured in the scene at home, and a parameter
// is annotated only where its value is found again.
import { distance } from "./posture.js";
import { shownShare, viewOf } from "./projection.js";

const PRECISION = 2e-6;  // relative; numbers in the page have seven digits

const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const leg = (name) => (name ?? "").split(".")[0];
const middle = (points) => [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);

/** A straight measure between two points of the scene, true length. */
const between = (what, words, a, b, view, source = "") => ({ what, words, value: distance(a, b), angular: false, a, b, view, source });

/** Distances of a point from an upright axis: radius, and along x and y. */
function fromAxis(what, words, p, axis, source) {
  const foot = [axis[0], axis[1], p[2]];
  const corner = [p[0], axis[1], p[2]];
  return [
    between(`${what}, radius`, [...words, "radius"], foot, p, "top", source),
    between(`${what}, along x`, words, foot, corner, "top", source),
    between(`${what}, along y`, words, corner, p, "top", source),
  ];
}

function guideMeasures(guide) {
  const a = guide.from.at, b = guide.to.at, d = minus(b, a), length = distance(a, b);
  if (length < 1e-9) return [];
  const words = ["guide", "column", "drive", "rail"];
  const source = leg(guide.name);
  const tilt = Math.asin(Math.min(1, Math.abs(d[2]) / length));
  const list = [
    between("guide length", [...words, "stroke", "length"], a, b, Math.abs(d[2]) > length / 2 ? "front" : "top", source),
    { what: "guide to the horizontal", words: [...words, "lean", "angle"], value: tilt, angular: true, a, b, view: "front", source },
    { what: "guide to the vertical", words: [...words, "lean", "angle"], value: Math.PI / 2 - tilt, angular: true, a, b, view: "front", source },
    ...fromAxis("guide end", words, a, [0, 0, 0], source), ...fromAxis("guide end", words, b, [0, 0, 0], source),
  ];
  if (Math.abs(d[2]) > 1e-9 * length) {
    const foot = [0, 1, 2].map((k) => a[k] - (a[2] / d[2]) * d[k]);
    list.push(...fromAxis("guide at the base plane", words, foot, [0, 0, 0], source));
  }
  return list;
}

function rodMeasures(rods, tool) {
  const list = rods.map((rod) => between(`${rod.role} length`, [rod.role, "length", rod.role === "link" ? "crank" : "rod"], rod.from.at, rod.to.at, "longest", leg(rod.name)));
  const legs = new Map();
  for (const rod of rods) legs.set(leg(rod.name), [...(legs.get(leg(rod.name)) ?? []), rod]);
  for (const [source, group] of legs) {
    for (const end of ["from", "to"]) {
      const points = group.map((rod) => rod[end].at);
      if (group.length === 2) list.push(between("spacing of the rods", ["spacing", "gap", "parallelogram", "width"], points[0], points[1], "longest", source));
      if (end === "to") for (const p of [middle(points), ...points]) list.push(...fromAxis("platform joint", ["platform"], p, tool, source));
    }
  }
  return list;
}

function pairwise(what, words, points, view) {
  return points.flatMap((p, i) => points.slice(i + 1).map((q) => between(what, words, p, q, view)));
}

/** Every measure a parameter may be. */
export function measures(scene) {
  const role = (...names) => scene.segments.filter((s) => names.includes(s.role));
  const tool = scene.tool ?? [0, 0, 0];
  const guides = role("guide");
  const rods = role("rod", "strut", "link");
  return [
    ...rodMeasures(rods, tool),
    ...guides.flatMap(guideMeasures),
    ...role("tool").map((s) => between("tool length", ["tool", "overhang"], s.from.at, s.to.at, "front")),
    ...role("platform").map((s) => between("platform edge", ["platform", "side", "edge"], s.from.at, s.to.at, "top")),
    ...pairwise("distance of guides", ["guide", "drive", "side", "distance"], guides.map((g) => g.from.at), "top"),
    ...(scene.joints ?? []).filter((joint) => joint.body === 0).flatMap((joint) => fromAxis("base joint", ["base", "motor", "pivot", "crank"], joint.at, [0, 0, 0], leg(joint.name))),
  ].filter((measure) => measure.value > 1e-9);
}

const SI = { mm: 1e-3, cm: 1e-2, m: 1, in: 0.0254, length: 1e-3, deg: Math.PI / 180, angle: Math.PI / 180, rad: 1 };

/** How well a measure's words fit a parameter's name and description. */
function affinity(measure, parameter) {
  const text = `${parameter.name} ${parameter.about ?? ""}`.toLowerCase();
  return measure.words.filter((word) => text.includes(word)).length;
}

/**
 * Parameters found in the drawing: [{parameter, measure}], and those that were not.
 * Of equal measures the one is taken that fits the description, lies on a leg
 * without a dimension yet, and is seen best.
 */
export function dimensionsOf(scene, parameters) {
  const all = measures(scene);
  const found = [], missing = [];
  for (const parameter of parameters) {
    const scale = SI[parameter.unit];
    const value = parameter.value * scale;
    const angular = ["deg", "rad", "angle"].includes(parameter.unit);
    const fits = scale ? all.filter((m) => m.angular === angular && Math.abs(m.value - value) <= PRECISION * Math.max(value, angular ? 1 : 0)) : [];
    const used = (measure) => found.filter((f) => f.measure.source === measure.source).length;
    fits.sort((a, b) => affinity(b, parameter) - affinity(a, parameter) || used(a) - used(b) || shownShare(b, viewOf(b)) - shownShare(a, viewOf(a)));
    if (fits.length && affinity(fits[0], parameter) > 0) found.push({ parameter, measure: fits[0] });
    else missing.push(parameter);
  }
  return { found, missing };
}
