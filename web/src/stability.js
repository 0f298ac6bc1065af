// Does the ranking depend on the weights? Ranks under other weightings, and two
// layouts held against each other.
import { bar, el, figure, table } from "./dom.js";
import { axis, draw } from "./charts.js";
import { MUTED, SERIES } from "./colours.js";
import { indexValue } from "./format.js";

const NAMED = 8;

function bumpOption(run, selection, current, width) {
  const { schemes, ranks } = run.stability;
  const ids = Object.keys(ranks).sort((a, b) => (selection.rankOf(a) ?? 1e9) - (selection.rankOf(b) ?? 1e9));
  const lowest = Math.max(...Object.values(ranks).flat().filter(Number.isFinite), 2);
  const narrow = width < 560;
  return {
    height: Math.min(640, 130 + 30 * lowest),
    grid: { left: 52, right: narrow ? 96 : 150, top: 12, bottom: narrow ? 110 : 56 },
    tooltip: { trigger: "item", confine: true, formatter: (item) => `${item.seriesName}<br>${item.name}: rank ${item.value}` },
    xAxis: { ...axis(""), type: "category", boundaryGap: true, offset: 14, axisLine: { show: false }, axisTick: { show: false }, data: schemes.map((s) => s.label), axisLabel: { ...axis("").axisLabel, interval: 0, rotate: narrow ? 60 : 0, width: narrow ? 100 : Math.max(60, (width - 220) / schemes.length - 8), overflow: narrow ? "truncate" : "break" } },
    yAxis: { ...axis("rank (1 is best)"), type: "value", inverse: true, min: 1, max: lowest, interval: Math.ceil(lowest / 12), nameGap: 30, axisLine: { show: false } },
    series: ids.map((id, index) => {
      const chosen = id === current?.id, named = index < NAMED || chosen;
      const colour = named ? SERIES[index % SERIES.length] : "#c5ccd3";
      return {
        type: "line", name: selection.shortName(id), data: ranks[id], symbol: "circle", symbolSize: chosen ? 11 : 8, z: chosen ? 5 : 2,
        lineStyle: { width: chosen ? 4 : 2, color: colour }, itemStyle: { color: colour }, emphasis: { focus: "series" },
        endLabel: { show: named, formatter: "{a}", color: chosen ? "#000" : MUTED, fontWeight: chosen ? "bold" : "normal", distance: 8 },
      };
    }),
  };
}

export function stability(run, selection) {
  const data = run.stability;
  if (!data?.schemes?.length || !data.ranks) return data?.statement ? el("p", {}, data.statement) : null;
  const host = el("div", { class: "chart bump" });
  selection.follow((entry) => queueMicrotask(() => draw(host, (width) => bumpOption(run, selection, entry, width))));
  return [data.statement && el("p", { class: "statement" }, data.statement),
    figure(host, "Rank of each layout when other weights are used. Level lines mean a ranking one can rely on; crossing lines mean that the choice depends on what matters to you.")];
}

function duelRow(run, row) {
  const index = (run.indices ?? []).find((i) => i.key === row.key) ?? { label: row.key };
  const comparable = typeof row.a === "number" && typeof row.b === "number";
  const better = !comparable || row.a === row.b ? null : (row.a > row.b) === (index.better !== "lower") ? "a" : "b";
  const most = Math.max(Math.abs(row.a ?? 0), Math.abs(row.b ?? 0)) || 1;
  const side = (key) => el("span", { class: better === key ? "winner" : null }, better === key ? "✓ " : "", indexValue(index, row[key]), bar(Math.abs(row[key] ?? 0) / most));
  return [el("span", {}, index.label, el("br"), el("small", {}, index.better === "lower" ? "lower is better" : "higher is better")), side("a"), side("b")];
}

export function duel(run) {
  const data = run.duel;
  if (!data?.rows?.length) return data?.statement ? el("p", {}, data.statement) : null;
  return [data.statement && el("p", { class: "statement" }, data.statement),
    table(["Index", data.a_label ?? data.a, data.b_label ?? data.b], data.rows.map((row) => duelRow(run, row)), { className: "duel" })];
}
