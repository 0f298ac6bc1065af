// The workspace drawn into the 3D scheme: outlines of its slices, the asked zone
// and the largest inscribed cylinder. Workspace positions count from the tool at home.
import { Group } from "three";

import { ACCENT } from "./colours.js";
import { lines } from "./shapes3d.js";

export const OVERLAY = { outline: "#21918c", zone: "#d55e00", cylinder: ACCENT };

/** Edges between a reachable cell and one that is not, as pairs of points. */
function outline(slice, tool) {
  const { u, v, values } = slice;
  const du = (u[1] - u[0]) / 2, dv = (v[1] - v[0]) / 2;
  const inside = (i, j) => values[j]?.[i] !== null && values[j]?.[i] !== undefined;
  const at = (a, b) => (slice.plane === "xz" ? [a + tool[0], slice.at + tool[1], b + tool[2]] : [a + tool[0], b + tool[1], slice.at + tool[2]]);
  const points = [];
  for (let j = 0; j < v.length; j += 1) for (let i = 0; i < u.length; i += 1) {
    if (!inside(i, j)) continue;
    for (const [di, dj] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
      if (inside(i + di, j + dj)) continue;
      const a = u[i] + di * du, b = v[j] + dj * dv;
      points.push(at(di ? a : u[i] - du, di ? v[j] - dv : b), at(di ? a : u[i] + du, di ? v[j] + dv : b));
    }
  }
  return points;
}

function boxEdges({ size, center }, tool) {
  const corner = (sx, sy, sz) => [sx, sy, sz].map((s, k) => center[k] + tool[k] + s * size[k] / 2);
  const points = [];
  for (const a of [-1, 1]) for (const b of [-1, 1]) {
    points.push(corner(-1, a, b), corner(1, a, b), corner(a, -1, b), corner(a, 1, b), corner(a, b, -1), corner(a, b, 1));
  }
  return points;
}

function cylinderEdges({ diameter, height, center }, tool) {
  const at = (step, side) => {
    const angle = step * Math.PI / 24;
    return [center[0] + tool[0] + Math.cos(angle) * diameter / 2, center[1] + tool[1] + Math.sin(angle) * diameter / 2, center[2] + tool[2] + side * height / 2];
  };
  const points = [];
  for (let step = 0; step < 48; step += 1) {
    for (const side of [-1, 1]) points.push(at(step, side), at(step + 1, side));
    if (step % 12 === 0) points.push(at(step, -1), at(step, 1));
  }
  return points;
}

/** The overlay of a workspace. */
export function workspaceOverlay(workspace, tool = [0, 0, 0]) {
  const group = new Group();
  const add = (points, colour) => points.length && group.add(lines(points, colour));
  add((workspace.slices ?? []).filter((s) => s.plane === "xy").flatMap((slice) => outline(slice, tool)), OVERLAY.outline);
  if (workspace.zone?.size) add(boxEdges(workspace.zone, tool), OVERLAY.zone);
  if (workspace.inscribed_cylinder?.diameter) add(cylinderEdges(workspace.inscribed_cylinder, tool), OVERLAY.cylinder);
  return group;
}
