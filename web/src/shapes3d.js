// Solid shapes of the 3D scheme. Every kind of joint has its own form as well as
// its own colour.
import {
  BoxGeometry, BufferGeometry, CanvasTexture, ConeGeometry, CylinderGeometry, DoubleSide, Float32BufferAttribute, Group, LineBasicMaterial,
  LineSegments, Mesh, MeshLambertMaterial, Quaternion, SphereGeometry, SRGBColorSpace, Sprite, SpriteMaterial, TorusGeometry, Vector3,
} from "three";

import { BODY, JOINT } from "./colours.js";

const UP = new Vector3(0, 1, 0);
const materials = new Map();

/** One shared material per colour. */
function material(colour, opacity = 1) {
  const key = `${colour}/${opacity}`;
  if (!materials.has(key)) {
    materials.set(key, new MeshLambertMaterial({ color: colour, transparent: opacity < 1, opacity, side: opacity < 1 ? DoubleSide : 0, depthWrite: opacity === 1 }));
  }
  return materials.get(key);
}

const ROUND = new CylinderGeometry(1, 1, 1, 14);
const BALL = new SphereGeometry(1, 20, 14);
const CUBE = new BoxGeometry(1, 1, 1);
const TIP = new ConeGeometry(1, 1, 16);
const TURN = 1.5 * Math.PI;
const RING = new TorusGeometry(1, 0.1, 8, 32, TURN);

/** Puts a y-aligned shape of length 1 between two points. */
export function stretch(mesh, a, b, width) {
  const from = new Vector3(...a), to = new Vector3(...b);
  const along = to.clone().sub(from);
  const length = along.length();
  mesh.position.copy(from).addScaledVector(along, 0.5);
  mesh.quaternion.setFromUnitVectors(UP, length > 1e-12 ? along.divideScalar(length) : UP);
  mesh.scale.set(width, Math.max(length, 1e-9), width);
}

const THICKNESS = { guide: 0.007, rod: 0.0042, strut: 0.0055, link: 0.006, carriage: 0.0085, platform: 0.006, tool: 0.005 };

/** A segment's shape, lying between `a` and `b`; `size` is that of the whole machine. */
export function segmentShape(role, a, b, size) {
  const mesh = new Mesh(role === "carriage" ? CUBE : role === "tool" ? TIP : ROUND, material(BODY[role] ?? BODY.link));
  const width = (THICKNESS[role] ?? 0.005) * size * (role === "carriage" ? 2 : role === "tool" ? 1.8 : 1);
  // A cone points along +y: let the tool's tip be at its far end.
  stretch(mesh, a, b, width);
  mesh.userData.width = width;
  return mesh;
}

function pin(axis, length, radius, colour) {
  const mesh = new Mesh(ROUND, material(colour));
  const half = axis.map((v) => v * length / 2);
  stretch(mesh, half.map((v) => -v), half, radius);
  return mesh;
}

/** An arrow both ways along a driven slide. */
function slideArrow(axis, size) {
  const group = new Group();
  group.add(pin(axis, size * 0.09, size * 0.0035, JOINT.driven));
  for (const sign of [1, -1]) {
    const tip = new Mesh(TIP, material(JOINT.driven));
    const at = (s) => axis.map((v) => sign * v * s * size);
    stretch(tip, at(0.042), at(0.06), size * 0.008);
    group.add(tip);
  }
  group.position.copy(sideways(axis, size * 0.024));
  return group;
}

/** An arrow around a driven hinge: most of a ring, with a tip at its end. */
function turnArrow(axis, size) {
  const group = new Group();
  const ring = new Mesh(RING, material(JOINT.driven));
  ring.scale.setScalar(size * 0.032);
  const tip = new Mesh(TIP, material(JOINT.driven));
  tip.scale.set(size * 0.008, size * 0.018, size * 0.008);
  tip.rotation.z = TURN;
  tip.position.set(Math.cos(TURN), Math.sin(TURN), 0).multiplyScalar(size * 0.032);
  group.add(ring, tip);
  group.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), new Vector3(...axis));
  return group;
}

/** The mark of a joint, at its place in its body's frame. */
export function jointShape(joint, size) {
  const group = new Group();
  const colour = JOINT[joint.type] ?? JOINT.revolute;
  const axes = joint.axes?.length ? joint.axes : [[0, 0, 1]];
  if (joint.type === "spherical") {
    const ball = new Mesh(BALL, material(colour));
    ball.scale.setScalar(size * 0.0095);
    group.add(ball);
  } else if (joint.type === "universal") {
    for (const axis of axes.slice(0, 2)) group.add(pin(axis, size * 0.038, size * 0.0052, colour));
  } else if (joint.type === "prismatic") {
    const block = new Mesh(CUBE, material(joint.driven ? BODY.carriage : colour));
    stretch(block, axes[0].map((v) => -v * size * 0.016), axes[0].map((v) => v * size * 0.016), size * 0.026);
    group.add(block);
  } else if (joint.type !== "weld") {
    group.add(pin(axes[0], size * 0.04, size * 0.0085, joint.driven ? JOINT.driven : colour));
  }
  if (joint.driven) group.add(joint.type === "prismatic" ? slideArrow(axes[0], size) : turnArrow(axes[0], size));
  group.position.set(...joint.at);
  return group;
}

function sideways(axis, by) {
  const other = Math.abs(axis[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  return new Vector3(...axis).cross(new Vector3(...other)).normalize().multiplyScalar(by);
}

/** The platform's face: its edges joined to their middle. */
export function platformFace(segments) {
  const points = segments.flatMap((s) => [s.from.at, s.to.at]);
  if (points.length < 6) return null;
  const middle = [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(segments.flatMap((s) => [...s.from.at, ...s.to.at, ...middle]), 3));
  geometry.computeVertexNormals();
  return new Mesh(geometry, material(BODY.platform, 0.35));
}

/** Straight lines between pairs of points. */
export function lines(points, colour) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points.flat(), 3));
  return new LineSegments(geometry, new LineBasicMaterial({ color: colour }));
}

/** A word that faces the viewer. */
export function word(text, at, size, colour) {
  const canvas = document.createElement("canvas");
  canvas.width = 128;
  canvas.height = 64;
  const pen = canvas.getContext("2d");
  pen.font = "bold 44px sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  pen.lineWidth = 8;
  pen.strokeStyle = "#ffffff";
  pen.strokeText(text, 64, 32);
  pen.fillStyle = colour;
  pen.fillText(text, 64, 32);
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  const sprite = new Sprite(new SpriteMaterial({ map: texture, depthTest: false }));
  sprite.position.set(...at);
  sprite.scale.set(size, size / 2, 1);
  return sprite;
}

/** Sets a group's pose to a transform [q, t]. */
export function place(group, [w, x, y, z, tx, ty, tz]) {
  group.quaternion.copy(new Quaternion(x, y, z, w));
  group.position.set(tx, ty, tz);
}

/** Frees what a removed object holds on the graphics card, except what is shared. */
export function release(object) {
  object.traverse((node) => {
    const shared = [ROUND, BALL, CUBE, TIP, RING].includes(node.geometry);
    if (node.geometry && !shared && !node.isSprite) node.geometry.dispose();
    if (node.isSprite || node.isLineSegments) {
      node.material.map?.dispose();
      node.material.dispose();
    }
  });
}
