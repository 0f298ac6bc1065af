// Layouts that were rejected, by reason, with examples one can look at.
import { el } from "./dom.js";
import { count } from "./format.js";
import { thumbnail } from "./projection.js";

function card(example, selection) {
  const button = el("button", { class: "card", "data-layout": example.id, onclick: () => {
    selection.select(example.id);
    document.getElementById("machine")?.scrollIntoView({ block: "start" });
  } },
    example.scene?.segments ? thumbnail(example.scene) : null,
    el("span", {}, el("b", {}, example.title || example.known_as || example.id), el("br"),
      el("small", {}, [example.known_as, example.check?.verdict].filter(Boolean).join(" · ")),
      (example.reasons ?? []).slice(0, 2).map((reason) => el("small", { class: "reason" }, reason)),
      example.scene?.mode && el("small", { class: "hint" }, "▶ shows the freedom that is left")));
  selection.follow((entry) => button.classList.toggle("current", entry.id === example.id));
  return button;
}

/** Groups of the run; counts alone where no examples are stored. */
export function rejected(run, selection) {
  const groups = run.rejected?.length ? run.rejected
    : Object.entries(run.counts?.rejected ?? {}).map(([reason, n]) => ({ reason, count: n }));
  if (!groups.length) return null;
  const most = Math.max(...groups.map((group) => group.count ?? 0), 1);
  return groups.map((group) => el("div", { class: "group" },
    el("div", { class: "reason-line" }, el("b", {}, count(group.count)), el("span", { class: "long-bar" }, el("span", { style: { width: `${100 * (group.count ?? 0) / most}%` } })), el("span", {}, group.reason)),
    group.examples?.length ? el("div", { class: "cards" }, group.examples.map((example) => card(example, selection))) : null));
}
