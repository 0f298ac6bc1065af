// The dimension table: name, meaning, tuned value, where it started, and its bounds.
import { el, table } from "./dom.js";
import { number, unitName } from "./format.js";
import { drawing } from "./drawing.js";

/** Where a value lies between its bounds, as a mark on a short line. */
function position({ value, initial, min, max }) {
  if (!(max > min)) return el("small", {}, "fixed");
  const at = (v) => `${(100 * Math.min(1, Math.max(0, (v - min) / (max - min)))).toFixed(1)}%`;
  const near = Math.min(value - min, max - value) < 1e-3 * (max - min);
  return el("span", { class: "track-cell" },
    el("span", { class: "track", "aria-hidden": "true" },
      typeof initial === "number" && el("i", { class: "was", style: { left: at(initial) } }),
      el("i", { class: "now", style: { left: at(value) } })),
    near && el("small", {}, "at its bound"));
}

export function dimensions(entry) {
  const parameters = entry.parameters ?? [];
  if (!parameters.length) return drawing(entry);
  const rows = parameters.map((p) => [
    el("code", {}, p.name), p.about ?? "", number(p.value, 5), typeof p.initial === "number" ? number(p.initial, 5) : "–",
    p.max > p.min ? `${number(p.min)} … ${number(p.max)}` : "–", unitName(p.unit) || "–", position(p),
  ]);
  return [
    drawing(entry),
    table(["Name", "Meaning", "Value", "Before tuning", "Bounds", "Unit", "Between the bounds"], rows, { numeric: [2, 3, 4], className: "dimensions" }),
    el("p", { class: "note" }, "On the short line the filled mark is the value, the open mark where tuning started. Where tuning ran into a bound, a wider one may give a better machine."),
  ];
}
