// Where every body of a scene is for given drive values. The poses were computed by
// the core at sample positions of the drives; between them this interpolates.
// A transform is [qw, qx, qy, qz, x, y, z]: point -> R point + (x, y, z).

export const IDENTITY = [1, 0, 0, 0, 0, 0, 0];

export function rotate([w, x, y, z], [a, b, c]) {
  const tx = 2 * (y * c - z * b), ty = 2 * (z * a - x * c), tz = 2 * (x * b - y * a);
  return [a + w * tx + y * tz - z * ty, b + w * ty + z * tx - x * tz, c + w * tz + x * ty - y * tx];
}

export function transform(t, p) {
  const r = rotate(t, p);
  return [r[0] + t[4], r[1] + t[5], r[2] + t[6]];
}

export const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/** Cell of `samples` that holds `value`: lower index and share of the upper one. */
function locate(samples, value) {
  if (samples.length < 2) return [0, 0];
  let low = 0;
  while (low < samples.length - 2 && value >= samples[low + 1]) low += 1;
  const share = (value - samples[low]) / (samples[low + 1] - samples[low]);
  return [low, Math.min(1, Math.max(0, share))];
}

/** Corners of the interpolation cell: [index into poses, weight], zero weights left out. */
function corners(drives, values) {
  let list = [[0, 1]];
  drives.forEach((drive, d) => {
    const [low, share] = locate(drive.samples, values[d]);
    list = list.flatMap(([index, weight]) => [[low, 1 - share], [low + 1, share]]
      .filter(([, w]) => w > 1e-9)
      .map(([sample, w]) => [index * drive.samples.length + sample, weight * w]));
  });
  return list;
}

/** The transform of table body `slot` in one stored pose (flat or one list per body). */
const stored = (pose, slot) => (Array.isArray(pose[slot]) ? pose[slot] : pose.slice(7 * slot, 7 * slot + 7));

/** Weighted mean of transforms; `centre` is a point of the body, whose path is interpolated. */
function blend(transforms, weights, centre) {
  const q = [0, 0, 0, 0], c = [0, 0, 0];
  transforms.forEach((t, i) => {
    const sign = t[0] * transforms[0][0] + t[1] * transforms[0][1] + t[2] * transforms[0][2] + t[3] * transforms[0][3] < 0 ? -1 : 1;
    for (let k = 0; k < 4; k += 1) q[k] += sign * weights[i] * t[k];
    transform(t, centre).forEach((value, k) => { c[k] += weights[i] * value; });
  });
  const norm = Math.hypot(...q) || 1;
  const unit = q.map((value) => value / norm);
  const turned = rotate(unit, centre);
  return [...unit, c[0] - turned[0], c[1] - turned[1], c[2] - turned[2]];
}

/** Mean of a body's drawn points at home; interpolating it keeps errors local. */
function bodyCentre(scene, body) {
  const points = [...scene.segments.flatMap((s) => [s.from, s.to]), ...(scene.joints ?? [])]
    .filter((end) => end.body === body).map((end) => end.at);
  return points.length ? [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length) : [0, 0, 0];
}

/** Whether the scene can be moved by its drives. */
export const movable = (scene) => Boolean(scene?.drives?.length && scene.poses?.length);

/** The scene at home. */
export const homePosture = (scene) => scene.bodies.map(() => IDENTITY);

/**
 * Transforms of all bodies at drive `values` (from home), or null where the machine
 * cannot be assembled at one of the surrounding samples.
 */
export function postureAt(scene, values) {
  if (!movable(scene)) return homePosture(scene);
  const cell = corners(scene.drives, values);
  if (cell.some(([index]) => !scene.poses[index])) return null;
  const weights = cell.map(([, weight]) => weight);
  let slot = -1;
  return scene.bodies.map((body, index) => {
    const { motion } = body;
    if (motion === "table") {
      slot += 1;
      const own = slot;
      return blend(cell.map(([pose]) => stored(scene.poses[pose], own)), weights, bodyCentre(scene, index));
    }
    if (motion && typeof motion === "object") {
      return [1, 0, 0, 0, ...motion.direction.map((d) => d * values[motion.drive])];
    }
    return IDENTITY;
  });
}

/** Segment ends [a, b] in the base frame. */
export const ends = (segment, posture) =>
  [transform(posture[segment.from.body], segment.from.at), transform(posture[segment.to.body], segment.to.at)];

/** Largest change of a rod's drawn length against home: the interpolation error one sees [m]. */
export function rodError(scene, posture) {
  return Math.max(0, ...scene.segments.filter((s) => s.role === "rod").map((s) => {
    const [a, b] = ends(s, posture);
    return Math.abs(distance(a, b) - distance(s.from.at, s.to.at));
  }));
}

/** Lowest and highest corner of everything drawn at home. */
export function extent(scene) {
  const points = [...scene.segments.flatMap((s) => [s.from.at, s.to.at]), ...(scene.joints ?? []).map((j) => j.at), ...(scene.tool ? [scene.tool] : [])];
  const lowest = [Infinity, Infinity, Infinity], highest = [-Infinity, -Infinity, -Infinity];
  for (const p of points) for (let k = 0; k < 3; k += 1) {
    lowest[k] = Math.min(lowest[k], p[k]);
    highest[k] = Math.max(highest[k], p[k]);
  }
  return { lowest, highest, centre: lowest.map((v, k) => (v + highest[k]) / 2), size: Math.max(1e-6, distance(lowest, highest)) };
}
