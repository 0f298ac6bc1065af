// What the colours and forms of the scheme mean; only what this scheme contains.
import { el, svg } from "./dom.js";
import { BODY, JOINT, JOINT_WORDS } from "./colours.js";
import { OVERLAY } from "./overlay3d.js";

const ROLES = { guide: "guide", rod: "rod", strut: "strut (telescope)", link: "link", carriage: "carriage", platform: "platform", tool: "tool" };

const icon = (...shapes) => svg("svg", { width: 22, height: 14, viewBox: "0 0 22 14", "aria-hidden": "true" }, shapes);
const stroke = (colour, width = 3) => icon(svg("line", { x1: 2, y1: 7, x2: 20, y2: 7, stroke: colour, "stroke-width": width, "stroke-linecap": "round" }));

function jointIcon(type) {
  const colour = JOINT[type] ?? JOINT.revolute;
  if (type === "spherical") return icon(svg("circle", { cx: 11, cy: 7, r: 5, fill: colour }));
  if (type === "universal") return icon(svg("path", { d: "M4 7H18M11 1V13", stroke: colour, "stroke-width": 3.4 }));
  if (type === "prismatic") return icon(svg("rect", { x: 6, y: 2, width: 10, height: 10, fill: BODY.carriage }));
  return icon(svg("rect", { x: 4, y: 3, width: 14, height: 8, rx: 3, fill: colour }));
}

const driven = () => icon(svg("path", { d: "M2 7H20M6 3L2 7L6 11M16 3L20 7L16 11", stroke: JOINT.driven, "stroke-width": 2, fill: "none" }));

export function legend({ scene, workspace }, withWorkspace) {
  const roles = Object.keys(ROLES).filter((role) => scene.segments.some((s) => s.role === role));
  const types = [...new Set((scene.joints ?? []).map((j) => j.type))].filter((type) => JOINT_WORDS[type]);
  const item = (mark, words) => el("li", {}, mark, words);
  return el("ul", { class: "legend" },
    roles.map((role) => item(stroke(BODY[role], role === "rod" ? 2.4 : 4), ROLES[role])),
    types.map((type) => item(jointIcon(type), JOINT_WORDS[type])),
    (scene.joints ?? []).some((j) => j.driven) && item(driven(), "driven; the number is that of the slider"),
    withWorkspace && item(stroke(OVERLAY.outline, 1.6), "workspace outline"),
    withWorkspace && workspace.zone?.size && item(stroke(OVERLAY.zone, 1.6), "required zone"),
    withWorkspace && workspace.inscribed_cylinder && item(stroke(OVERLAY.cylinder, 1.6), "largest cylinder inside"));
}
