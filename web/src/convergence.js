// How tuning went: best objective so far against evaluations.
import { el, figure } from "./dom.js";
import { axis, draw } from "./charts.js";
import { ACCENT } from "./colours.js";
import { number } from "./format.js";

export function convergence(entry, host) {
  const points = entry.convergence ?? [];
  if (points.length < 2) return null;
  host ??= el("div", { class: "chart convergence" });
  queueMicrotask(() => draw(host, () => ({
    height: 240,
    grid: { left: 64, right: 20, top: 14, bottom: 48 },
    tooltip: { trigger: "axis", confine: true, formatter: ([p]) => `after ${p.value[0]} evaluations<br>best objective ${number(p.value[1])}` },
    xAxis: { ...axis("evaluations"), type: "value", min: "dataMin", max: "dataMax" },
    yAxis: { ...axis("best objective so far (no unit)", { nameGap: 46 }), type: "value", scale: true },
    series: [{ type: "line", step: "end", data: points, symbolSize: 5, lineStyle: { color: ACCENT, width: 2 }, itemStyle: { color: ACCENT } }],
  })));
  return figure(host, "A long level end means that more evaluations would hardly help.");
}
