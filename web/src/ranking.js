// The ranking: one row per layout, one bar per criterion; a click selects the layout.
import { bar, el } from "./dom.js";
import { indexValue, number } from "./format.js";
import { thumbnail } from "./projection.js";

const SHOWN = 12;

/** Share of the best value, so that the longest bar is the best in its column. */
function shares(rows, index) {
  const values = rows.map((row) => row.objectives?.[index.key]).filter((v) => typeof v === "number" && v > 0);
  const best = index.better === "lower" ? Math.min(...values) : Math.max(...values);
  return (value) => (typeof value !== "number" || value <= 0 ? 0 : index.better === "lower" ? best / value : value / best);
}

function row(entry, selection, columns, bestScore) {
  const stored = selection.entries.get(entry.layout);
  const scene = stored?.scene ?? entry.scene;
  const line = el("tr", { "data-layout": entry.layout, tabindex: stored ? 0 : null, class: stored ? "choice" : null,
    title: stored ? "Show this layout below" : "No details are stored for this layout" },
    el("td", { class: "num rank" }, String(entry.rank)),
    el("td", { class: "thumb" }, scene ? thumbnail(scene) : null),
    el("td", { class: "name" }, el("b", {}, entry.title || stored?.title || entry.layout), el("br"),
      el("small", {}, [entry.known_as, entry.layout].filter(Boolean).join(" · "))),
    el("td", {}, number(entry.score, 3), bar(entry.score / bestScore, "score"),
      typeof entry.initial_score === "number" && el("small", {}, "before\u00a0", number(entry.initial_score, 3))),
    columns.map(({ index, share }) => el("td", {}, indexValue(index, entry.objectives?.[index.key]), bar(share(entry.objectives?.[index.key])))));
  if (stored) {
    const choose = () => selection.select(entry.layout);
    line.addEventListener("click", choose);
    line.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); choose(); } });
  }
  return line;
}

export function ranking(run, selection) {
  const rows = run.ranking ?? [];
  if (!rows.length) return null;
  const indices = (run.indices ?? []).filter((index) => rows.some((entry) => entry.objectives?.[index.key] !== undefined));
  const columns = indices.map((index) => ({ index, share: shares(rows, index) }));
  const bestScore = Math.max(...rows.map((entry) => entry.score ?? 0)) || 1;
  const lines = rows.map((entry) => row(entry, selection, columns, bestScore));
  lines.slice(SHOWN).forEach((line) => { line.hidden = true; });
  selection.follow((entry) => lines.forEach((line) => {
    const current = line.dataset.layout === entry.id;
    line.classList.toggle("current", current);
    if (line.tabIndex >= 0) line.setAttribute("aria-selected", current);
  }));
  const more = lines.length > SHOWN && el("button", { class: "more", onclick: () => {
    lines.forEach((line) => { line.hidden = false; });
    more.remove();
  } }, `Show all ${lines.length} layouts`);
  return [
    el("div", { class: "scroll" }, el("table", { class: "ranking" },
      el("thead", {}, el("tr", {}, ["Rank", "", "Layout", "Score"].map((word) => el("th", {}, word)),
        indices.map((index) => el("th", { title: index.about }, index.label, el("small", {}, index.better === "lower" ? "lower is better" : "higher is better"))))),
      el("tbody", {}, lines))),
    more || null,
    el("p", { class: "note" }, "In every column the longest bar is the best value.", el("span", { class: "screen-only" }, " Click a row to see that layout in all parts below.")),
    indices.some((index) => index.about) && el("dl", { class: "words" }, indices.filter((index) => index.about)
      .flatMap((index) => [el("dt", {}, index.label), el("dd", {}, index.about)])),
  ];
}
