// The scheme with its controls: a slider per drive, views, workspace overlay and the
// motion of a freedom that is left.
import { onResize } from "./charts.js";
import { el } from "./dom.js";
import { driveValue, millimetres } from "./format.js";
import { legend } from "./legend.js";
import { homePosture, movable, postureAt, rodError } from "./posture.js";
import { thumbnail } from "./projection.js";
import { Scheme3d } from "./scheme3d.js";

const FRAME_MS = 60;

/** The panel; `show(entry)` swaps the machine. */
export class SchemePanel {
  constructor() {
    this.canvas = el("canvas", { tabindex: 0, "aria-label": "interactive kinematic scheme" });
    this.print = el("img", { class: "print-only", alt: "kinematic scheme" });
    this.status = el("p", { class: "status", role: "status" });
    this.stage = el("div", { class: "stage" }, this.canvas, this.print, this.status);
    this.side = el("div", { class: "controls" });
    this.legend = el("div", {});
    this.node = el("div", { class: "scheme" }, this.stage, this.side, this.legend);
    this.start();
  }

  start() {
    try {
      this.view = new Scheme3d(this.canvas);
    } catch {
      this.flat = el("div", { class: "flat" });  // no WebGL: the same scheme, drawn flat
      this.canvas.replaceWith(this.flat);
      return;
    }
    onResize(this.stage, () => this.resize());
    queueMicrotask(() => this.resize());
    window.addEventListener("beforeprint", () => this.picture());
  }

  resize() {
    const width = this.stage.clientWidth;
    if (!width || width === this.width || !this.view) return;
    this.width = width;
    const height = Math.round(Math.min(560, Math.max(300, width * 0.72)));
    this.canvas.style.height = `${height}px`;
    this.view.resize(width, height);
    if (this.entry) this.view.look("home");
    this.picture();
  }

  /** Keeps an image of the scene, because a canvas does not always print. */
  picture() {
    if (this.view && this.entry) this.print.src = this.view.picture().toDataURL();
  }

  show(entry) {
    this.stop();
    this.node.hidden = !entry.scene?.segments?.length;
    this.entry = this.node.hidden ? null : entry;
    if (!this.entry) return;
    this.values = (entry.scene.drives ?? []).map(() => 0);
    this.view?.show(entry.scene, entry.workspace);
    this.side.replaceChildren(...[this.viewButtons(), this.modePanel(), this.drivePanel()].filter(Boolean));
    this.legend.replaceChildren(legend(entry, false));
    this.apply(homePosture(entry.scene));
    this.picture();
  }

  viewButtons() {
    if (!this.view) return null;
    const button = (words, act) => el("button", { onclick: act }, words);
    const overlay = this.entry.workspace?.slices?.length && el("label", { class: "tick" },
      el("input", { type: "checkbox", onchange: ({ target }) => {
        this.view.setOverlay(target.checked);
        this.legend.replaceChildren(legend(this.entry, target.checked));
      } }), " workspace in the picture");
    return el("div", {}, el("div", { class: "buttons" },
      button("3D", () => this.view.look("home")), button("Front", () => this.view.look("front")), button("Side", () => this.view.look("side")),
      button("Top", () => this.view.look("top")), button("+", () => this.view.zoom(0.85)), button("−", () => this.view.zoom(1.18))), overlay || null);
  }

  drivePanel() {
    const { scene } = this.entry;
    if (!movable(scene)) return null;
    const outputs = [];
    this.sliders = scene.drives.map((drive, k) => {
      const low = drive.samples[0], high = drive.samples[drive.samples.length - 1];
      outputs[k] = el("output", {}, driveValue(drive, 0));
      return el("input", { type: "range", min: low, max: high, step: (high - low) / 400, value: 0, "aria-label": drive.name, oninput: (event) => {
        this.values[k] = Number(event.target.value);
        outputs[k].textContent = driveValue(drive, this.values[k]);
        this.drive();
      } });
    });
    this.outputs = outputs;
    const samples = scene.drives.map((d) => d.samples.length);
    const each = Math.min(...samples) === Math.max(...samples) ? samples[0] : `${Math.min(...samples)} to ${Math.max(...samples)}`;
    return el("div", { class: "drives" }, el("h4", {}, "Drives, measured from home"),
      this.sliders.map((slider, k) => el("label", { class: "drive" }, el("span", {}, el("b", {}, `${k + 1} `), scene.drives[k].name), outputs[k], slider)),
      el("button", { onclick: () => this.reset() }, "Back to home"),
      el("p", { class: "note" }, `Poses computed by the core at ${each} positions per drive, interpolated between.`));
  }

  reset() {
    this.values.fill(0);
    this.sliders?.forEach((slider, k) => {
      slider.value = 0;
      this.outputs[k].textContent = driveValue(this.entry.scene.drives[k], 0);
    });
    this.apply(homePosture(this.entry.scene));
  }

  /** Follows the sliders. */
  drive() {
    this.stop();
    const posture = postureAt(this.entry.scene, this.values);
    this.apply(posture);
    const error = posture ? rodError(this.entry.scene, posture) : 0;
    this.status.textContent = !posture ? "The machine cannot be assembled here." : error > 5e-4 ? `Between computed poses the rods are drawn up to ${millimetres(error, 2)} too long or short.` : "";
  }

  apply(posture) {
    this.status.textContent = "";
    this.stage.classList.toggle("broken", !posture);
    if (this.view) this.view.move(posture);
    else if (posture) this.flat.replaceChildren(thumbnail(this.entry.scene, { width: 640, height: 460, joints: true, weight: 1.6, posture }));
  }

  modePanel() {
    const { mode } = this.entry.scene;
    if (!mode?.frames?.length) return null;
    this.button = el("button", { class: "play", onclick: () => (this.timer ? this.stop() : this.play()) }, "▶ Play");
    return el("div", { class: "mode" }, el("h4", {}, "The freedom that is left"), el("p", {}, mode.about), mode.frames.length > 1 && this.button);
  }

  /** To one end of the motion, to the other and back, from the middle on, where home is. */
  play() {
    const { frames } = this.entry.scene.mode;
    const last = frames.length - 1;
    let step = Math.round(last / 2);
    this.button.textContent = "❚❚ Stop";
    this.timer = setInterval(() => {
      step = (step + 1) % (2 * last);
      this.apply(frames[step <= last ? step : 2 * last - step]);
    }, FRAME_MS);
  }

  stop() {
    if (!this.timer) return;
    clearInterval(this.timer);
    this.timer = null;
    this.button.textContent = "▶ Play";
    this.apply(homePosture(this.entry.scene));
  }
}
