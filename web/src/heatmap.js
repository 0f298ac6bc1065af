// One slice of the workspace as a heat map of 1/κ, in true proportion, with the
// required zone and the inscribed cylinder drawn over it.
import { axis } from "./charts.js";
import { ACCENT, INK, MUTED, VIRIDIS, viridis } from "./colours.js";
import { el } from "./dom.js";
import { number } from "./format.js";

const MM = 1e3;
const halfCell = (grid) => (grid.length > 1 ? (grid[1] - grid[0]) / 2 : 5e-4);

/** A shape cut by a slice: its rectangle in sheet metres, or null where the slice misses it. */
function cut(slice, center, size) {
  const [across, up, through] = slice.plane === "xz" ? [0, 2, 1] : [0, 1, 2];
  if (Math.abs(slice.at - center[through]) > size[through] / 2 + 1e-9) return null;
  return { u: center[across], v: center[up], width: size[across], height: size[up] };
}

/** The cylinder in a slice: a disc seen from above, a rectangle from the side. */
function cylinderCut(slice, { diameter, height, center }) {
  if (slice.plane === "xy") {
    const shape = cut(slice, center, [diameter, diameter, height]);
    return shape && { ...shape, round: true };
  }
  const off = slice.at - center[1];
  const chord = diameter * diameter - 4 * off * off;
  return chord > 0 ? { u: center[0], v: center[2], width: Math.sqrt(chord), height } : null;
}

function overlaySeries(name, shape, colour, dash) {
  return shape && {
    type: "custom", name, silent: true, z: 4, data: [[shape.u * MM, shape.v * MM]], clip: true,
    renderItem: (_, api) => {
      const [x, y] = api.coord([shape.u * MM, shape.v * MM]);
      const [w, h] = api.size([shape.width * MM, shape.height * MM]);
      const style = { fill: "none", stroke: colour, lineWidth: dash ? 2 : 4, lineDash: dash };
      return shape.round ? { type: "ellipse", shape: { cx: x, cy: y, rx: w / 2, ry: h / 2 }, style }
        : { type: "rect", shape: { x: x - w / 2, y: y - h / 2, width: w, height: h }, style };
    },
  };
}

const colourAt = (value, top) => `rgb(${viridis(value / top).join(",")})`;

function cellSeries(slice, top) {
  const { u, v, values } = slice;
  const du = halfCell(u), dv = halfCell(v);
  const data = [];
  values.forEach((row, j) => row.forEach((value, i) => {
    if (value !== null) data.push([u[i] * MM, v[j] * MM, value]);
  }));
  return {
    type: "custom", name: "1/κ", data, encode: { x: 0, y: 1 }, clip: true,
    renderItem: (_, api) => {
      const [x1, y1] = api.coord([api.value(0) - du * MM, api.value(1) + dv * MM]);
      const [x2, y2] = api.coord([api.value(0) + du * MM, api.value(1) - dv * MM]);
      return { type: "rect", shape: { x: x1, y: y1, width: x2 - x1, height: y2 - y1 }, style: { fill: colourAt(api.value(2), top) } };
    },
  };
}

/** ECharts option of a slice; `top` is the value of the brightest colour. */
export function heatmapOption(workspace, slice, top, width) {
  const { u, v } = slice;
  const span = (grid) => [grid[0] - halfCell(grid), grid[grid.length - 1] + halfCell(grid)].map((x) => x * MM);
  const [left, right] = span(u), [low, high] = span(v);
  const grid = { left: 64, top: 16 };
  const room = { width: width - grid.left - 20, height: 470 };
  const scale = Math.min(room.width / (right - left), room.height / (high - low));
  grid.width = (right - left) * scale;
  grid.height = (high - low) * scale;
  grid.left += (room.width - grid.width) / 2;
  const vertical = slice.plane === "xz" ? "z" : "y";
  const zone = workspace.zone?.size && cut(slice, workspace.zone.center ?? [0, 0, 0], workspace.zone.size);
  const cylinder = workspace.inscribed_cylinder?.diameter && cylinderCut(slice, workspace.inscribed_cylinder);
  const tidy = (limit) => Number(number(limit, 3).replace("−", "-").replace(/\s/g, ""));
  const bounds = (min, max) => ({ type: "value", min, max, splitLine: { show: false }, axisLine: { onZero: false, show: true, lineStyle: { color: MUTED } }, axisLabel: { ...axis("").axisLabel, hideOverlap: true, showMinLabel: false, showMaxLabel: false, formatter: (x) => String(tidy(x)) } });
  return {
    height: grid.height + 74, grid,
    tooltip: { trigger: "item", confine: true, formatter: ({ value }) => `x ${number(value[0], 3)} mm, ${vertical} ${number(value[1], 3)} mm<br>1/κ ${number(value[2], 3)} (κ ${number(1 / value[2], 3)})` },
    xAxis: { ...axis("tool displacement from home, x (mm)"), ...bounds(left, right) },
    yAxis: { ...axis(`${vertical} (mm)`, { nameGap: 44 }), ...bounds(low, high) },
    series: [cellSeries(slice, top), overlaySeries("largest cylinder inside", cylinder, "#ffffff"),
      overlaySeries("largest cylinder inside", cylinder, ACCENT, [7, 4]), overlaySeries("required zone", zone, "#ffffff"), overlaySeries("required zone", zone, "#d55e00", [2, 3])].filter(Boolean),
  };
}

/** A slice as a small picture, one pixel per grid point. */
export function smallMap(slice, top) {
  const { u, v, values } = slice;
  const canvas = el("canvas", { width: u.length, height: v.length, "aria-hidden": "true" });
  const pen = canvas.getContext("2d");
  const image = pen.createImageData(u.length, v.length);
  values.forEach((row, j) => row.forEach((value, i) => {
    if (value === null) return;
    image.data.set([...viridis(value / top), 255], 4 * ((v.length - 1 - j) * u.length + i));
  }));
  pen.putImageData(image, 0, 0);
  const aspect = (u[u.length - 1] - u[0]) / Math.max(1e-9, v[v.length - 1] - v[0]);
  canvas.style.aspectRatio = String(aspect);
  return el("img", { src: canvas.toDataURL(), alt: "", style: { aspectRatio: String(aspect), maxHeight: "84px" } });
}

/** The colour scale with its end values. */
export const colourScale = (top) => el("div", { class: "scale" }, el("span", {}, "0 (singular)"),
  el("i", { style: { background: `linear-gradient(to right, ${VIRIDIS.join(",")})` } }), el("span", {}, `1/κ = ${number(top, 2)}`),
  el("span", { class: "swatch", style: { color: INK } }, "white: not reachable"));
