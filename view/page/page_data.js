// SPDX-License-Identifier: Apache-2.0
// The data of the page: arrays of rounded numbers, deflated, in base64 (page_arrays.cpp writes them).

function bytesOfBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const binary = atob(text), bytes = new Uint8Array(binary.length);
  for (let i = 0; i < binary.length; ++i) bytes[i] = binary.charCodeAt(i);
  return bytes;
}

async function inflated(bytes) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

class PageData {
  constructor(head, bytes) {
    this.head = head;
    this.bytes = bytes;
    this.cache = new Map();
    const [low, high] = head.bounds;
    this.middle = low.map((v, c) => (v + high[c]) / 2);
    this.size = Math.hypot(...low.map((v, c) => high[c] - v)) || 1;
  }

  // World to the page's space: the middle of the box is 0, its diagonal 1.
  toPage(x) { return x.map((v, c) => (v - this.middle[c]) / this.size); }
  toWorld(x) { return x.map((v, c) => v * this.size + this.middle[c]); }

  // The whole numbers of an array, one component after the other.
  whole(number) {
    const { at, count, components, bytes } = this.head.arrays[number], n = count * components;
    const numbers = new Uint32Array(n), mask = bytes === 4 ? 0xffffffff : (1 << (8 * bytes)) - 1;
    for (let byte = 0; byte < bytes; ++byte) {
      for (let i = 0, from = at + byte * n; i < n; ++i) numbers[i] |= this.bytes[from + i] << (8 * byte);
    }
    for (let i = 1; i < n; ++i) numbers[i] = (numbers[i] + numbers[i - 1]) & mask;
    return numbers;
  }

  // An array as planes of numbers.
  planes(number) {
    if (this.cache.has(number)) return this.cache.get(number);
    const { count, components, low, step } = this.head.arrays[number], whole = this.whole(number), planes = [];
    for (let c = 0; c < components; ++c) {
      const plane = new Float64Array(count);
      for (let i = 0; i < count; ++i) plane[i] = low[c] + step[c] * whole[c * count + i];
      planes.push(plane);
    }
    this.cache.set(number, planes);
    return planes;
  }

  // Kernels of a step in the page's space: centers (3 numbers each), roots and their inverses (xx xy xz yy yz zz).
  places(step) {
    const number = this.head.steps[step].places, key = 'places' + number;
    if (this.cache.has(key)) return this.cache.get(key);
    const planes = this.planes(number), count = planes[0].length;
    const centers = new Float32Array(3 * count), roots = new Float32Array(6 * count), inverses = new Float32Array(6 * count);
    for (let i = 0; i < count; ++i) {
      for (let c = 0; c < 3; ++c) centers[3 * i + c] = (planes[c][i] - this.middle[c]) / this.size;
      const trace = Math.pow(2, planes[3][i]) / this.size;
      const [xx, xy, xz, yy, yz, zz] = [4, 5, 6, 7, 8, 9].map((k) => planes[k][i] * trace);
      roots.set([xx, xy, xz, yy, yz, zz], 6 * i);
      const cxx = yy * zz - yz * yz, cxy = xz * yz - xy * zz, cxz = xy * yz - xz * yy, det = xx * cxx + xy * cxy + xz * cxz;
      inverses.set([cxx, cxy, cxz, xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy].map((v) => v / det), 6 * i);
    }
    const places = { count, centers, roots, inverses };
    this.cache.set(key, places);
    this.cache.delete(number);
    return places;
  }

  // Values of a field: five numbers for each kernel, in parts of the field's range from its minimum.
  values(step, field) {
    const { kernels, surface } = this.head.steps[step].values[field], key = 'values' + kernels;
    if (this.cache.has(key)) return this.cache.get(key);
    const { min, max } = this.head.fields[field], range = max > min ? max - min : 1;
    const planes = this.planes(kernels), on = this.planes(surface)[0], count = planes[0].length;
    const values = new Float32Array(5 * count), boundary = new Float32Array(on.length);
    for (let i = 0; i < count; ++i) {
      values[5 * i] = (planes[0][i] - min) / range;
      for (let c = 1; c < 5; ++c) values[5 * i + c] = planes[c][i] / range;
    }
    for (let i = 0; i < on.length; ++i) boundary[i] = (on[i] - min) / range;
    const result = { values, boundary };
    this.cache.set(key, result);
    return result;
  }

  // The boundary of a step: points in the page's space, corners of triangles, a normal at each corner of each triangle.
  boundary(step) {
    const { points, triangles } = this.head.steps[step].boundary, key = 'boundary' + points + ',' + triangles;
    if (this.cache.has(key)) return this.cache.get(key);
    const planes = this.planes(points), count = planes[0].length, positions = new Float32Array(3 * count);
    for (let i = 0; i < count; ++i) {
      for (let c = 0; c < 3; ++c) positions[3 * i + c] = (planes[c][i] - this.middle[c]) / this.size;
    }
    const whole = this.whole(triangles), n = whole.length / 3, corners = new Uint32Array(3 * n);
    for (let i = 0; i < n; ++i) {
      for (let k = 0; k < 3; ++k) corners[3 * i + k] = whole[k * n + i];
    }
    const result = { positions, corners, normals: cornerNormals(positions, corners) };
    this.cache.set(key, result);
    return result;
  }
}

// Normals that are smooth except at creases of more than 40 degrees, as in render/splat/corner_normals.cpp.
function cornerNormals(positions, corners) {
  const triangles = corners.length / 3, flat = new Float32Array(3 * triangles), angles = new Float32Array(3 * triangles);
  const points = positions.length / 3, begin = new Uint32Array(points + 1);
  const edge = (a, b, to) => {
    for (let c = 0; c < 3; ++c) to[c] = positions[3 * b + c] - positions[3 * a + c];
  };
  const u = [0, 0, 0], v = [0, 0, 0];
  for (let t = 0; t < triangles; ++t) {
    for (let k = 0; k < 3; ++k) {
      const a = corners[3 * t + k];
      edge(a, corners[3 * t + (k + 1) % 3], u);
      edge(a, corners[3 * t + (k + 2) % 3], v);
      const dot = u[0] * v[0] + u[1] * v[1] + u[2] * v[2], long = Math.hypot(...u) * Math.hypot(...v);
      angles[3 * t + k] = long > 0 ? Math.acos(Math.min(1, Math.max(-1, dot / long))) : 0;
      if (k === 0) {
        const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        const length = Math.hypot(...n) || 1;
        for (let c = 0; c < 3; ++c) flat[3 * t + c] = n[c] / length;
      }
      ++begin[a + 1];
    }
  }
  for (let p = 0; p < points; ++p) begin[p + 1] += begin[p];
  const fans = new Uint32Array(3 * triangles), next = begin.slice();
  for (let i = 0; i < 3 * triangles; ++i) fans[next[corners[i]]++] = i;
  const normals = new Float32Array(9 * triangles);
  for (let i = 0; i < 3 * triangles; ++i) {
    const t = (i / 3) | 0, p = corners[i];
    let x = 0, y = 0, z = 0;
    const nx = flat[3 * t], ny = flat[3 * t + 1], nz = flat[3 * t + 2];
    for (let at = begin[p]; at < begin[p + 1]; ++at) {
      const o = 3 * ((fans[at] / 3) | 0);
      if (nx * flat[o] + ny * flat[o + 1] + nz * flat[o + 2] > 0.766) {
        const angle = angles[fans[at]];
        x += angle * flat[o];
        y += angle * flat[o + 1];
        z += angle * flat[o + 2];
      }
    }
    const length = Math.hypot(x, y, z) || 1;
    normals[3 * i] = x / length;
    normals[3 * i + 1] = y / length;
    normals[3 * i + 2] = z / length;
  }
  return normals;
}
