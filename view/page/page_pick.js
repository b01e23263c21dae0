// SPDX-License-Identifier: Apache-2.0
// What is seen at a place of the picture: computed for one ray, without the GPU.

// Depths at which the ray enters (+1) and leaves (-1) the boundary, in order.
function crossings({ origin, direction }, { positions, corners }, values) {
  const found = [];
  for (let t = 0; t < corners.length; t += 3) {
    const i = 3 * corners[t], j = 3 * corners[t + 1], k = 3 * corners[t + 2];
    const ux = positions[j] - positions[i], uy = positions[j + 1] - positions[i + 1], uz = positions[j + 2] - positions[i + 2];
    const vx = positions[k] - positions[i], vy = positions[k + 1] - positions[i + 1], vz = positions[k + 2] - positions[i + 2];
    const [dx, dy, dz] = direction, px = dy * vz - dz * vy, py = dz * vx - dx * vz, pz = dx * vy - dy * vx;
    const det = ux * px + uy * py + uz * pz;
    if (det === 0) continue;
    const ox = origin[0] - positions[i], oy = origin[1] - positions[i + 1], oz = origin[2] - positions[i + 2];
    const b = (ox * px + oy * py + oz * pz) / det;
    if (b < 0 || b > 1) continue;
    const qx = oy * uz - oz * uy, qy = oz * ux - ox * uz, qz = ox * uy - oy * ux, c = (dx * qx + dy * qy + dz * qz) / det;
    if (c < 0 || b + c > 1) continue;
    const depth = (vx * qx + vy * qy + vz * qz) / det;
    const value = (1 - b - c) * values[corners[t]] + b * values[corners[t + 1]] + c * values[corners[t + 2]];
    if (depth > 1e-6) found.push({ depth, sign: det > 0 ? 1 : -1, value });
  }
  return found.sort((a, b) => a.depth - b.depth);
}

// The kernels near a ray: those that it goes through.
function kernelsOnRay({ origin, direction }, { centers, inverses, count }) {
  const ids = [];
  for (let i = 0; i < count; ++i) {
    const r = 6 * i, x = origin[0] - centers[3 * i], y = origin[1] - centers[3 * i + 1], z = origin[2] - centers[3 * i + 2];
    const times = (a, b, c) => [inverses[r] * a + inverses[r + 1] * b + inverses[r + 2] * c,
      inverses[r + 1] * a + inverses[r + 3] * b + inverses[r + 4] * c, inverses[r + 2] * a + inverses[r + 4] * b + inverses[r + 5] * c];
    const o = times(x, y, z), d = times(...direction), along = dot(o, d), dd = dot(d, d);
    if (dot(o, o) - along * along / dd < 1) ids.push(i);
  }
  return ids;
}

// The sum of kernels at a place; nothing where there is none.
function valueAt(x, ids, { centers, inverses }, values) {
  let weight = 0, sum = 0;
  for (const i of ids) {
    const r = 6 * i, dx = x[0] - centers[3 * i], dy = x[1] - centers[3 * i + 1], dz = x[2] - centers[3 * i + 2];
    const a = inverses[r] * dx + inverses[r + 1] * dy + inverses[r + 2] * dz;
    const b = inverses[r + 1] * dx + inverses[r + 3] * dy + inverses[r + 4] * dz;
    const c = inverses[r + 2] * dx + inverses[r + 4] * dy + inverses[r + 5] * dz, e = a * a + b * b + c * c;
    if (e >= 1) continue;
    const w = (1 - e) ** 3, v = 5 * i;
    weight += w;
    sum += w * (values[v] + values[v + 1] * a + values[v + 2] * b + values[v + 3] * c + values[v + 4] * e);
  }
  return weight > 0.02 ? sum / weight : undefined;
}

// The place and the value (in parts of the field's range) that are seen through a pixel: of a solid its surface; of a volume
// where half of the light that the ray meets has ended. Nothing beside the body.
function pick(ray, scene, clip, solid, extinction) {
  const hits = crossings(ray, scene.surface, scene.boundary), ids = kernelsOnRay(ray, scene.places);
  const place = (depth) => plus(ray.origin, ray.direction, depth);
  const beyond = (depth) => clip && dot(clip, place(depth)) - clip[3] > 0;
  let inside = -hits.reduce((sum, hit) => sum + hit.sign, 0), from = 0, entry;
  const parts = [];
  for (const hit of hits) {
    if (hit.sign > 0 && inside++ <= 0) {
      from = hit.depth;
      entry = hit.value;
    }
    if (hit.sign < 0 && --inside === 0 && hit.depth > from) parts.push({ from, to: hit.depth, entry });
  }
  if (clip) {
    const toward = dot(clip, ray.direction), cut = (clip[3] - dot(clip, ray.origin)) / toward;
    for (const part of parts) {
      if (toward < 0 && cut > part.from) Object.assign(part, { from: cut, entry: undefined });
      if (toward > 0) part.to = Math.min(part.to, cut);
    }
  }
  const left = parts.filter((part) => part.to > part.from && !beyond((part.from + part.to) / 2));
  if (left.length === 0) return undefined;
  const at = (depth, known) => ({ place: place(depth), value: known ?? valueAt(place(depth), ids, scene.places, scene.values) });
  if (solid) return at(left[0].from, left[0].entry);
  const steps = [];
  let passed = 0;
  for (const { from: a, to: b } of left) {
    for (let k = 0; k < 200; ++k) {
      const depth = a + (k + 0.5) / 200 * (b - a), value = valueAt(place(depth), ids, scene.places, scene.values);
      if (value === undefined) continue;
      passed += extinction(value) * (b - a) / 200 * Math.hypot(...ray.direction);
      steps.push([depth, passed]);
    }
  }
  if (steps.length === 0) return undefined;
  const half = (1 - Math.exp(-passed)) / 2, found = steps.find(([, depth]) => 1 - Math.exp(-depth) >= half) || steps[0];
  return at(found[0]);
}
