// What the tool reaches and how well it is controlled there.
import { bar, el, figure } from "./dom.js";
import { axis, draw } from "./charts.js";
import { ACCENT } from "./colours.js";
import { box, degrees, litres, millimetres, number, percent, point } from "./format.js";
import { colourScale, heatmapOption, smallMap } from "./heatmap.js";

/** The brightest colour's value, the same for every layout of a run so that maps compare. */
function topOf(run) {
  const best = (run.layouts ?? []).flatMap((layout) => (layout.workspace?.slices ?? []).flatMap((s) => s.values.flat())).reduce((most, v) => Math.max(most, v ?? 0), 0);
  return best > 0 ? Math.min(1, Math.ceil(best * 20) / 20) : 1;
}

function facts(w) {
  const c = w.conditioning ?? {}, cylinder = w.inscribed_cylinder, rotation = w.rotation_range;
  return [
    ["Volume", w.volume !== undefined && `${litres(w.volume)}${w.volume_bounds ? ` (bounds ${w.volume_bounds.map((v) => number(v * 1e3)).join(" and ")})` : ""}`],
    ["Largest cylinder inside", cylinder?.diameter && `Ø ${millimetres(cylinder.diameter)} × ${millimetres(cylinder.height)}, centre at ${point(cylinder.center)}`],
    ["Largest box inside", w.inscribed_box?.size && `${box(w.inscribed_box.size)}, centre at ${point(w.inscribed_box.center)}`],
    ["Required zone", w.zone?.size && `${box(w.zone.size)}, centre at ${point(w.zone.center ?? [0, 0, 0])}`],
    ["Conditioning 1/κ", c.global !== undefined && `mean ${number(c.global, 3)}, worst ${number(c.worst, 3)}, best ${number(c.best, 3)}`],
    ["Characteristic length", w.characteristic_length && `${millimetres(w.characteristic_length)} (makes turning and shifting comparable in κ)`],
    ["Turning range", rotation && `${rotation.axis} from ${degrees(rotation.min)} to ${degrees(rotation.max)}${rotation.at ? ` with the tool at ${point(rotation.at)}` : ""}`],
  ].filter(([, value]) => value);
}

function areaOption(w, slice) {
  const data = w.area_by_z.map(([z, area]) => [area * 1e4, z * 1e3]);
  const cylinder = w.inscribed_cylinder;
  const ends = cylinder?.height ? [-1, 1].map((side) => (cylinder.center[2] + side * cylinder.height / 2) * 1e3) : null;
  return {
    height: 330, grid: { left: 64, right: 24, top: 12, bottom: 50 },
    tooltip: { trigger: "item", confine: true, formatter: ({ value }) => `z ${number(value[1], 3)} mm<br>area ${number(value[0])} cm²` },
    xAxis: { ...axis("area of the horizontal slice (cm²)"), type: "value", min: 0 },
    yAxis: { ...axis("z from home (mm)", { nameGap: 46 }), type: "value", scale: true },
    series: [{
      type: "line", data, symbolSize: 4, lineStyle: { color: ACCENT, width: 2 }, itemStyle: { color: ACCENT },
      markArea: ends && { silent: true, itemStyle: { color: "#0b5c8f1c" }, data: [[{ yAxis: ends[0] }, { yAxis: ends[1] }]] },
      markLine: slice?.plane === "xy" ? { silent: true, symbol: "none", label: { formatter: "slice shown", position: "insideEndTop" }, lineStyle: { color: "#d55e00", type: "dashed" }, data: [{ yAxis: slice.at * 1e3 }] } : undefined,
    }],
  };
}

const LIMIT_WORDS = { reach: "rod cannot reach", stroke: "end of stroke", cone: "joint at its largest deflection", clearance: "bodies too near" };

/** Limits that bound the workspace, same kind on every leg added up, largest first. */
function limits(w) {
  const sums = new Map();
  for (const [name, share] of Object.entries(w.limits_hit ?? {})) {
    const kind = name.split(" ")[0];
    const words = LIMIT_WORDS[kind];
    const label = words ? `${words}: ${name.slice(kind.length + 1).replace(/(\D)\d+\./g, "$1.")}` : name;
    sums.set(label, (sums.get(label) ?? 0) + share);
  }
  const rows = [...sums].sort((a, b) => b[1] - a[1]);
  return rows.length ? el("table", { class: "limits" }, el("tbody", {}, rows.map(([label, share]) => el("tr", {}, el("td", {}, label), el("td", { class: "num" }, percent(share)), el("td", { class: "wide" }, bar(share)))))) : null;
}

const sliceName = (slice) => (slice.plane === "xz" ? `y = ${millimetres(slice.at, 3)}` : `z = ${millimetres(slice.at, 3)}`);

/** Draws the workspace of the selected layout; keeps its two charts for the next one. */
export class WorkspacePanel {
  constructor(run) {
    this.top = topOf(run);
    this.heat = el("div", { class: "chart heat" });
    this.area = el("div", { class: "chart area" });
  }

  render(entry) {
    const w = entry.workspace;
    this.workspace = w;
    if (!w) return null;
    const parts = [el("dl", { class: "pairs" }, facts(w).flatMap(([name, value]) => [el("dt", {}, name), el("dd", {}, value)]))];
    if (w.slices?.length) parts.push(this.slices(w));
    const side = [
      w.area_by_z?.length > 1 && figure(this.area, `Area by height${w.inscribed_cylinder ? "; the band is the height of the largest cylinder" : ""}.`),
      limits(w) && figure(limits(w), "What ends the workspace: share of its boundary made by each limit, all legs together."),
    ].filter(Boolean);
    parts.push(el("div", { class: "columns" }, side));
    this.choose(w.slices ? Math.floor((w.slices.filter((s) => s.plane === "xy").length || 1) / 2) : -1);
    return parts;
  }

  slices(w) {
    this.buttons = w.slices.map((slice, index) => el("button", { class: "slice", onclick: () => this.choose(index) }, smallMap(slice, this.top), el("small", {}, sliceName(slice))));
    return el("div", {},
      el("div", { class: "slices", role: "group", "aria-label": "slices" }, this.buttons),
      figure([el("b", { class: "slice-title" }), this.heat, colourScale(this.top)],
        "Conditioning 1/κ in a slice of the workspace: 1 means equal speed and accuracy in all directions, 0 a singular posture. Dashed line: largest cylinder inside; dotted line: required zone. All maps in this report use the same colours."));
  }

  choose(index) {
    const w = this.workspace;
    const slice = w.slices?.[index];
    this.buttons?.forEach((button, k) => button.classList.toggle("current", k === index));
    queueMicrotask(() => {
      if (slice && this.heat.isConnected) {
        this.heat.parentElement.querySelector(".slice-title").textContent = `Slice at ${sliceName(slice)}`;
        draw(this.heat, (width) => heatmapOption(w, slice, this.top, width));
      }
      if (this.area.isConnected) draw(this.area, () => areaOption(w, slice));
    });
  }
}
