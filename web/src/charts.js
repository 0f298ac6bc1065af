// ECharts, only the parts used, drawn as SVG: sharp in print, no WebGL context.
import { BarChart, CustomChart, LineChart } from "echarts/charts";
import { GridComponent, LegendComponent, MarkAreaComponent, MarkLineComponent, TooltipComponent, VisualMapComponent } from "echarts/components";
import * as echarts from "echarts/core";
import { SVGRenderer } from "echarts/renderers";

import { GRID, INK, MUTED } from "./colours.js";

echarts.use([BarChart, CustomChart, LineChart, GridComponent, LegendComponent, MarkAreaComponent, MarkLineComponent, TooltipComponent, VisualMapComponent, SVGRenderer]);

const FONT = { fontFamily: "inherit", color: INK, fontSize: 12 };

/** An axis in the house style; `name` states quantity and unit. */
export const axis = (name, extra = {}) => ({
  name, nameLocation: "middle", nameGap: 30, nameTextStyle: { ...FONT, color: MUTED },
  axisLabel: { ...FONT, color: MUTED }, axisLine: { show: true, onZero: false, lineStyle: { color: MUTED } },
  splitLine: { show: true, lineStyle: { color: GRID } }, ...extra,
});

/** Calls `act` in the frame after `node` changed its size, so that what it changes is no loop. */
export const onResize = (node, act) => new ResizeObserver(() => requestAnimationFrame(act)).observe(node);

const drawn = new Map();

/** Draws `optionFor(width)` into `host` and again whenever its width changes. */
export function draw(host, optionFor) {
  const old = drawn.get(host);
  if (old) old.optionFor = optionFor;
  else {
    const chart = echarts.init(host, null, { renderer: "svg" });
    drawn.set(host, { chart, optionFor });
    onResize(host, () => refresh(host));
  }
  refresh(host, true);
  return drawn.get(host).chart;
}

function refresh(host, force = false) {
  const entry = drawn.get(host);
  const width = host.clientWidth;
  if (!width || (!force && width === entry.width)) return;
  entry.width = width;
  const option = entry.optionFor(width);
  if (option.height) host.style.height = `${option.height}px`;
  entry.chart.resize({ width, height: host.clientHeight });
  entry.chart.setOption({ animation: false, textStyle: FONT, ...option, height: undefined }, { notMerge: true });
  entry.chart.getZr().flush();
  host.querySelector("svg")?.setAttribute("viewBox", `0 0 ${width} ${host.clientHeight}`);  // scales in print
}
