// The licences of the libraries inside this page, as their authors ask for.
import echarts from "../node_modules/echarts/LICENSE";
import notice from "../node_modules/echarts/NOTICE";
import three from "../node_modules/three/LICENSE";
import tslib from "../node_modules/tslib/LICENSE.txt";
import zrender from "../node_modules/zrender/LICENSE";

import { el } from "./dom.js";

const TEXTS = [["three", three], ["Apache ECharts", `${notice}\n\n${echarts}`], ["ZRender", zrender], ["tslib", tslib]];

export const licences = () => el("details", {}, el("summary", {}, "Licences of the libraries in this page"),
  TEXTS.map(([name, text]) => el("details", {}, el("summary", {}, name), el("pre", {}, text))));
