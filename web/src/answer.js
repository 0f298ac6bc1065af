// The one-sentence answer and the way there in numbers.
import { el } from "./dom.js";
import { count, indexValue, number } from "./format.js";

/** The best layout in one sentence. */
export function answer(run, selection) {
  if (run.answer) return run.answer;
  const best = run.ranking?.[0];
  if (!best) return run.kind === "design" ? "No layout satisfies the brief; the reasons are below." : "This run holds no ranking.";
  const name = `“${best.title || selection.shortName(best.layout)}”${best.known_as ? ` (${best.known_as})` : ""}`;
  const facts = (run.indices ?? []).filter((index) => best.objectives?.[index.key] !== undefined)
    .map((index) => `${index.label.toLowerCase()} ${indexValue(index, best.objectives[index.key])}`);
  const tail = facts.length ? `: ${facts.join(", ")}` : "";
  if (run.kind === "study") {
    const gain = best.initial_score && best.score ? `, objective ${number(best.initial_score)} before and ${number(best.score)} after tuning` : "";
    return `The tuned layout is ${name}${tail}${gain}.`;
  }
  return `The best of ${count(run.ranking.length)} ranked layouts is ${name}${tail}.`;
}

const STEPS = [
  ["raw", "ways to combine the choices"], ["distinct", "distinct layouts"], ["determinate", "kinematically determinate"],
  ["tuned", "tuned"], ["poses", "poses evaluated"],
];

/** Counts from raw combinations to tuned layouts. */
export function funnel(run) {
  const counts = { ...run.counts, determinate: run.counts?.by_verdict?.determinate };
  const steps = STEPS.filter(([key]) => typeof counts[key] === "number");
  if (!steps.length) return null;
  return el("dl", { class: "facts" }, steps.map(([key, words]) => el("div", {}, el("dt", {}, words), el("dd", {}, count(counts[key])))));
}
