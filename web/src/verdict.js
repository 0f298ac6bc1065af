// How it was decided what a layout can do: reasons and the numbers behind them.
import { el, table } from "./dom.js";
import { motionWords, number } from "./format.js";

export const VERDICTS = {
  determinate: "With all drives held, the platform cannot move; with them free it moves as asked of the drives.",
  overdriven: "There are more drives than freedoms they control: the drives would work against each other.",
  "singular-home": "At home the platform can move a little with all drives held; at other postures it cannot.",
  uncertain: "With all drives held, the platform can still move: the machine has no certain position.",
  rigid: "The platform cannot move at all.",
};

/** [label, value, what it means] of everything the check states. */
function evidence(check) {
  const m = check.mobility ?? {}, p = check.platform ?? {}, d = check.drives ?? {};
  return [
    ["Motion of the platform", p.pattern && `${p.pattern}${p.axes ? ` (${p.axes})` : ""}`, `${motionWords(p)}; T counts translations, R rotations; A, B, C are rotations about x, y, z`],
    ["Freedoms of the platform", p.dof, p.home_dof === p.dof ? "the same at home" : `${p.home_dof} at home`],
    ["Freedoms of the whole mechanism", m.finite, "for real, finite motion near home"],
    ["… counted at home only", m.home, m.home === m.finite ? "no extra freedom at home" : "more at home than near it: home is a special posture"],
    ["Idle freedoms", m.idle, "rods spinning about themselves; they move no point of the platform"],
    ["Kutzbach's count", m.kutzbach, "the textbook formula, which knows nothing of directions"],
    ["Redundant constraints", m.redundant_constraints, m.redundant_constraints ? "constraints that repeat others: parts must be made exact, or the joints need play" : "none: assembles without force whatever the tolerances"],
    ["Drives", d.count, d.surplus ? `${d.surplus} more than the freedoms they control` : "as many as the freedoms they control"],
    ["Platform freedoms left with drives held", d.locked_platform, `at home ${d.home_locked_platform ?? "–"}; must be 0`],
    ["Rank gap", check.rank_gap === undefined ? undefined : number(check.rank_gap, 3), "how clearly the counts are decided: smallest ratio of a counted to a dropped singular value; safe above 1000"],
    ["Margin", check.margin === undefined ? undefined : number(check.margin, 3), "distance from a singular posture at home: smallest over largest singular value with drives held, 0 to 1"],
  ].filter(([, value]) => value !== undefined && value !== null && value !== "");
}

/** Branches of motion through home, where there are several. */
const branches = (check) => check.mobility?.branches?.length > 1 && el("p", {}, "Several motions meet at home: ",
  check.mobility.branches.map((b) => (typeof b === "object" ? `${b.pattern ?? ""} (${b.dimension} freedoms)` : String(b))).join("; "), ".");

export function verdict(entry) {
  const { check } = entry;
  if (!check) return null;
  const good = check.verdict === "determinate";
  return [
    el("p", {}, el("span", { class: `verdict ${good ? "good" : "bad"}` }, check.verdict), " ", VERDICTS[check.verdict] ?? ""),
    check.reasons?.length && el("ul", {}, [...new Set([...(entry.reasons ?? []), ...check.reasons])].map((reason) => el("li", {}, reason))),
    branches(check),
    table(["Evidence", "Value", "Meaning"], evidence(check).map(([label, value, words]) => [label, String(value), words]), { numeric: [1], className: "evidence" }),
  ];
}
