// The 3D picture: one WebGL context for the whole page, whose machine is swapped.
import { AmbientLight, Color, DirectionalLight, GridHelper, Group, PerspectiveCamera, Scene, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

import { el } from "./dom.js";
import { workspaceOverlay } from "./overlay3d.js";
import { ends, extent, homePosture } from "./posture.js";
import { jointShape, lines, place, platformFace, release, segmentShape, stretch, word } from "./shapes3d.js";

const VIEW = { home: [-0.62, -1, 0.5], front: [0, -1, 0], side: [1, 0, 0], top: [0, -0.001, 1] };
const BACKGROUND = "#ffffff";
const BROKEN = "#f6dfd6";

export class Scheme3d {
  /** @throws when the browser offers no WebGL. */
  constructor(canvas) {
    this.renderer = new WebGLRenderer({ canvas, antialias: true });
    this.world = new Scene();
    this.world.add(new AmbientLight("#ffffff", 1.7));
    const sun = new DirectionalLight("#ffffff", 1.9);
    sun.position.set(-1, -2, 3);
    this.world.add(sun);
    this.camera = new PerspectiveCamera(28, 1.6, 0.001, 1000);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableZoom = false;  // else scrolling the page would stop here
    this.controls.addEventListener("change", () => this.render());
    canvas.addEventListener("focus", () => { this.controls.enableZoom = true; });
    canvas.addEventListener("blur", () => { this.controls.enableZoom = false; });
    this.machine = new Group();
    this.world.add(this.machine);
  }

  /** Builds a scene; `workspace` may be absent. */
  show(scene, workspace) {
    this.world.remove(this.machine);
    release(this.machine);
    this.scene = scene;
    this.extent = extent(scene);
    this.machine = new Group();
    this.bodies = scene.bodies.map(() => new Group());
    this.machine.add(...this.bodies);
    this.addSegments();
    this.addJoints();
    this.addGround();
    this.overlay = workspace ? workspaceOverlay(workspace, scene.tool) : new Group();
    this.overlay.visible = false;
    this.machine.add(this.overlay);
    this.world.add(this.machine);
    this.look("home");
    this.move(homePosture(scene));
  }

  addSegments() {
    const { size } = this.extent;
    this.spanning = [];
    for (const segment of this.scene.segments) {
      const mesh = segmentShape(segment.role, segment.from.at, segment.to.at, size);
      if (segment.from.body === segment.to.body) this.bodies[segment.from.body].add(mesh);
      else {
        this.machine.add(mesh);
        this.spanning.push({ segment, mesh });
      }
    }
    this.scene.bodies.forEach((_, body) => {
      const face = platformFace(this.scene.segments.filter((s) => s.role === "platform" && s.from.body === body && s.to.body === body));
      if (face) this.bodies[body].add(face);
    });
  }

  addJoints() {
    const { size } = this.extent;
    for (const joint of this.scene.joints ?? []) {
      this.bodies[joint.body].add(jointShape(joint, size));
      const drive = (this.scene.drives ?? []).findIndex((d) => d.name === joint.name) + 1;
      if (drive > 0) this.bodies[joint.body].add(word(String(drive), joint.at.map((v, k) => v + [0.03, 0.03, 0.045][k] * size), size * 0.075, "#00694d"));
    }
  }

  addGround() {
    const { lowest, highest, centre, size } = this.extent;
    const cell = 10 ** Math.floor(Math.log10(size / 2));
    const step = cell * (size / cell > 12 ? 2 : 1);
    const side = 2 * Math.ceil(Math.max(highest[0] - lowest[0], highest[1] - lowest[1]) * 0.65 / step) * step;
    const grid = new GridHelper(side, Math.round(side / step), "#c3ccd4", "#e3e8ec");
    grid.rotation.x = Math.PI / 2;
    grid.position.set(Math.round(centre[0] / step) * step, Math.round(centre[1] / step) * step, lowest[2] - 0.02 * size);
    const origin = [0, 0, grid.position.z + 1e-3 * size];  // below the origin of the base frame
    const reach = 0.14 * size;
    this.machine.add(grid);
    ["x", "y", "z"].forEach((name, k) => {
      const tip = origin.map((v, i) => v + (i === k ? reach : 0));
      const beyond = origin.map((v, i) => v + (i === k ? 1.15 * reach : 0));
      this.machine.add(lines([origin, tip], "#1d2733"), word(name, beyond, size * 0.075, "#1d2733"));
    });
  }

  /** Puts every body where `posture` says; null = cannot be assembled: stays and turns red. */
  move(posture) {
    this.world.background = new Color(posture ? BACKGROUND : BROKEN);
    if (posture) {
      this.bodies.forEach((group, index) => place(group, posture[index]));
      for (const { segment, mesh } of this.spanning) stretch(mesh, ...ends(segment, posture), mesh.userData.width);
    }
    this.render();
  }

  setOverlay(visible) {
    if (this.overlay) this.overlay.visible = visible;
    this.render();
  }

  look(name) {
    const { centre, size } = this.extent;
    const direction = new Vector3(...VIEW[name]).normalize();
    this.controls.target.set(...centre);
    this.camera.near = size / 100;
    this.camera.far = size * 20;
    this.camera.position.set(...centre).addScaledVector(direction, size * 1.75 * Math.max(1, 1.25 / this.camera.aspect));
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.render();
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.render();
  }

  resize(width, height) {
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.render();
  }

  render() {
    if (this.extent) this.renderer.render(this.world, this.camera);
  }

  /** The picture as it is now, on a plain canvas: for printing and for counting. */
  picture() {
    this.render();
    const source = this.renderer.domElement;
    const copy = el("canvas", { width: source.width, height: source.height });
    copy.getContext("2d", { willReadFrequently: true }).drawImage(source, 0, 0);
    return copy;
  }

  /** How many of the picture's pixels are not background: proof that something is drawn. */
  drawnPixels() {
    const copy = this.picture();
    const { data } = copy.getContext("2d").getImageData(0, 0, copy.width, copy.height);
    let drawn = 0;
    for (let i = 0; i < data.length; i += 4) if (data[i] + data[i + 1] + data[i + 2] < 600) drawn += 1;
    return drawn;
  }

  /** Number of shapes that stand for segments and joints. */
  get marks() {
    return this.scene ? this.scene.segments.length + (this.scene.joints ?? []).length : 0;
  }
}
