// What was asked and whether it is met.
import { el, table } from "./dom.js";

const MARKS = { met: "✓ met", "not met": "✗ not met" };

export function requirements(run) {
  if (!run.requirements?.length) return null;
  return table(["Requirement", "Asked", "Result", "How it was judged"], run.requirements.map((row) => [
    row.name, row.asked,
    el("span", { class: `verdict ${row.verdict === "met" ? "good" : row.verdict === "not met" ? "bad" : ""}` }, MARKS[row.verdict] ?? row.verdict ?? ""),
    row.note ?? "",
  ]));
}
