// SPDX-License-Identifier: Apache-2.0
// Draws the volume: as render/sheets does, one sheet buffer after the other.

const kSheetsPerReach = 4, kFewestSheets = 64, kMostSheets = 2048;  // as of render/splat/splat_scene.cpp

class Painter {
  constructor(gl, data) {
    this.gl = gl;
    this.data = data;
    this.scene = null;
    this.table = null;
  }

  // Puts a field of a step onto the GPU.
  setScene(step, field) {
    const gl = this.gl.gl, places = this.data.places(step), { values, boundary } = this.data.values(step, field);
    const surface = this.data.boundary(step), rows = Math.max(1, Math.ceil(places.count / 512));
    const texels = new Float32Array(4 * 2048 * rows);
    for (let i = 0; i < places.count; ++i) {
      const c = 3 * i, r = 6 * i, v = 5 * i, inverse = places.inverses;
      texels.set([places.centers[c], places.centers[c + 1], places.centers[c + 2], inverse[r], inverse[r + 1], inverse[r + 2],
        inverse[r + 3], inverse[r + 4], inverse[r + 5], values[v + 4], values[v], 0, values[v + 1], values[v + 2], values[v + 3], 0],
      16 * i);
    }
    this.kernels = this.gl.texture(2048, rows, gl.RGBA32F, texels, this.kernels);
    if (!this.scene || this.scene.surface !== surface) this.uploadSurface(surface);
    const spread = new Float32Array(surface.corners.length);
    for (let i = 0; i < spread.length; ++i) spread[i] = boundary[surface.corners[i]];
    gl.bindBuffer(gl.ARRAY_BUFFER, this.fieldBuffer);
    gl.bufferData(gl.ARRAY_BUFFER, spread, gl.STATIC_DRAW);
    this.scene = { step, field, places, values, surface, boundary };
  }

  uploadSurface(surface) {
    const gl = this.gl.gl, n = surface.corners.length, positions = new Float32Array(3 * n);
    for (let i = 0; i < n; ++i) positions.set(surface.positions.subarray(3 * surface.corners[i], 3 * surface.corners[i] + 3), 3 * i);
    for (const buffer of this.buffers || []) gl.deleteBuffer(buffer);
    if (this.triangles) gl.deleteVertexArray(this.triangles);
    this.triangles = gl.createVertexArray();
    gl.bindVertexArray(this.triangles);
    this.buffers = [this.gl.buffer(gl.ARRAY_BUFFER, positions)];
    gl.enableVertexAttribArray(0);
    gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
    this.buffers.push(this.gl.buffer(gl.ARRAY_BUFFER, surface.normals));
    gl.enableVertexAttribArray(1);
    gl.vertexAttribPointer(1, 3, gl.FLOAT, false, 0, 0);
    this.fieldBuffer = gl.createBuffer();
    this.buffers.push(this.fieldBuffer);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.fieldBuffer);
    gl.enableVertexAttribArray(2);
    gl.vertexAttribPointer(2, 1, gl.FLOAT, false, 0, 0);
    this.listed = gl.createBuffer();
    this.buffers.push(this.listed);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.listed);
    gl.bindVertexArray(null);
    if (!this.instances) {
      this.instances = gl.createVertexArray();
      this.ids = gl.createBuffer();
      gl.bindVertexArray(this.instances);
      gl.bindBuffer(gl.ARRAY_BUFFER, this.ids);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribDivisor(0, 1);
    }
  }

  setTransfer(transfer, unit) {
    const gl = this.gl.gl, table = makeTable(transfer, unit / this.data.size), { min, max } = this.data.head.fields[this.scene.field];
    const old = this.table || {}, range = max > min ? max - min : 1;
    const put = (name) => this.gl.texture(kTableWidth, table.rows, gl.RGBA32F, table[name], old[name]);
    const scale = kCells / (table.max - table.min);
    this.table = { prefix: put('prefix'), mean: put('mean'), bend: put('bend'), colors: put('colors'),
      toCells: [range * scale, (min - table.min) * scale] };
    this.light = this.data.head.light[isPlain(transfer) ? 'plain' : 'colors'];
  }

  tables() {
    const { prefix, mean, bend, colors, toCells } = this.table;
    return { prefixes: prefix, table_means: mean, bends: bend, table_colors: colors, to_cells: toCells };
  }

  // Depths of the boundary, from the nearest that is seen; whether the eye, or its plane in parallel views, is that near to it.
  depths(view) {
    const { positions } = this.scene.surface;
    let low = Infinity, high = -Infinity;
    for (let i = 0; i < positions.length; i += 3) {
      const z = view.forward[0] * positions[i] + view.forward[1] * positions[i + 1] + view.forward[2] * positions[i + 2];
      low = Math.min(low, z);
      high = Math.max(high, z);
    }
    const eye = dot(view.forward, view.eye), least = view.perspective ? 1e-4 : 0;
    const front = Math.max(low - eye, least);
    return { front, back: Math.max(high - eye, front + 1e-6), inside: low - eye < least };
  }

  // The camera, for shaders.
  uniforms(view, depths, clip) {
    return { right: view.right, up: view.up, forward: view.forward, eye: view.eye, half_size: view.half, perspective: view.perspective,
      size: [view.width, view.height], clip: clip || [0, 0, 0, 1], ...this.light,
      near_far: view.perspective ? [Math.max(1e-3, 0.9 * depths.front), 0] : [depths.front - 0.01, depths.back + 0.01] };
  }

  sheetsNeeded(view, depths) {
    const { roots, count } = this.scene.places, reaches = new Float32Array(count), f = view.forward;
    for (let i = 0; i < count; ++i) reaches[i] = this.reach(roots, i, f);
    const finest = reaches.slice().sort()[Math.floor(0.05 * (count - 1))];
    const needed = kSheetsPerReach * (depths.back - depths.front) / Math.max(finest, 1e-6);
    return { reaches, count: Math.min(kMostSheets, Math.max(kFewestSheets, Math.ceil(needed) + 1)) };
  }

  // How far a kernel reaches along a direction: |S^(1/2) n|.
  reach(roots, i, n) {
    const r = 6 * i, x = roots[r] * n[0] + roots[r + 1] * n[1] + roots[r + 2] * n[2];
    const y = roots[r + 1] * n[0] + roots[r + 3] * n[1] + roots[r + 4] * n[2];
    const z = roots[r + 2] * n[0] + roots[r + 4] * n[1] + roots[r + 5] * n[2];
    return Math.sqrt(x * x + y * y + z * z);
  }

  // Lists what touches each of `count` bins: of item i the bins first(i) to last(i). Returns offsets and numbers of items.
  lists(items, count, first, last) {
    const offsets = new Uint32Array(count + 1), from = new Int32Array(items), to = new Int32Array(items);
    for (let i = 0; i < items; ++i) {
      from[i] = Math.max(0, first(i));
      to[i] = Math.min(count - 1, last(i));
      for (let k = from[i]; k <= to[i]; ++k) ++offsets[k + 1];
    }
    for (let k = 0; k < count; ++k) offsets[k + 1] += offsets[k];
    const next = offsets.slice(), numbers = new Uint32Array(offsets[count]);
    for (let i = 0; i < items; ++i) {
      for (let k = from[i]; k <= to[i]; ++k) numbers[next[k]++] = i;
    }
    return { offsets, numbers };
  }

  drawTriangles(first, count) {
    const gl = this.gl.gl;
    gl.bindVertexArray(this.triangles);
    gl.drawElements(gl.TRIANGLES, 3 * count, gl.UNSIGNED_INT, 12 * first);
  }

  drawAllTriangles() {
    const gl = this.gl.gl;
    gl.bindVertexArray(this.triangles);
    gl.drawArrays(gl.TRIANGLES, 0, this.scene.surface.corners.length);
  }

  // Adds kernels, of the ids in the buffer, on a plane.
  drawKernels(first, count, camera, plane, along, across, offset) {
    const gl = this.gl.gl;
    if (count === 0) return;
    this.gl.use(this.gl.kernel, { ...camera, kernels: this.kernels, plane, along, across, offset });
    gl.bindVertexArray(this.instances);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.ids);
    gl.vertexAttribIPointer(0, 1, gl.UNSIGNED_INT, 0, 4 * first);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  }

  blend(equation, ...factors) {
    const gl = this.gl.gl;
    gl.enable(gl.BLEND);
    gl.blendEquation(equation);
    if (factors.length === 2) gl.blendFunc(...factors);
    else gl.blendFuncSeparate(...factors);
  }

  // The number of shells that each pixel's ray is in where it begins: at the eye, or at the clip plane if the eye is beyond it.
  countShells(target, camera) {
    const gl = this.gl.gl;
    this.gl.bind(target);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.COLOR, 1, [0, 0, 0, 0]);
    this.blend(gl.FUNC_REVERSE_SUBTRACT, gl.ONE, gl.ONE);
    gl.colorMask(false, false, false, true);
    this.gl.use(this.gl.hits, { ...camera, front: 0, back: 1e30, from_depth: 0, per_depth: 1 });
    this.drawAllTriangles();
    gl.colorMask(true, true, true, true);
  }

  // The opaque, lit boundary, cut by the clip plane; with the eye inside, the material there, without light (Shading).
  // `samples` a side for each pixel.
  drawSolid(whole, clip, samples) {
    const gl = this.gl.gl, view = { ...whole, width: whole.width * samples, height: whole.height * samples };
    const depths = this.depths(view), camera = this.uniforms(view, depths, clip);
    const surface = this.gl.target('surface', view.width, view.height, [gl.RGBA32F], true);
    gl.disable(gl.BLEND);
    this.gl.bind(surface);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.CULL_FACE);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    gl.clearBufferfv(gl.DEPTH, 0, [1]);
    this.gl.use(this.gl.solid, camera);
    this.drawAllTriangles();
    gl.disable(gl.DEPTH_TEST);
    gl.disable(gl.CULL_FACE);
    let shells = surface, face_sums = surface, eye_sums = surface;
    if (clip || depths.inside) {
      shells = this.gl.target('hits', view.width, view.height, [gl.RGBA32F, gl.RGBA32F]);
      this.countShells(shells, camera);
    }
    if (clip) {
      face_sums = this.gl.target('sums0', view.width, view.height, [gl.RG32F]);
      this.drawFace(face_sums, camera, clip);
    }
    if (depths.inside) {
      eye_sums = this.gl.target('sums1', view.width, view.height, [gl.RG32F]);
      this.drawFace(eye_sums, camera, [...view.forward, dot(view.forward, view.eye) + depths.front]);
    }
    const picture = this.gl.target('picture', view.width, view.height, [gl.RGBA32F]);
    this.gl.bind(picture);
    gl.disable(gl.BLEND);
    this.gl.use(this.gl.shade, { ...camera, ...this.tables(), clipped: !!clip, inside: depths.inside, nearest: depths.inside ? depths.front : 0,
      surface: surface.textures[0], shells: shells.textures[0], face_sums: face_sums.textures[0], eye_sums: eye_sums.textures[0] });
    this.gl.screen();
    return { target: picture, samples, transmits: false };
  }

  // Sums on a plane.
  drawFace(target, camera, plane) {
    const gl = this.gl.gl, normal = plane.slice(0, 3), { centers, roots, count } = this.scene.places, ids = new Uint32Array(count);
    let n = 0;
    for (let i = 0; i < count; ++i) {
      const away = normal[0] * centers[3 * i] + normal[1] * centers[3 * i + 1] + normal[2] * centers[3 * i + 2] - plane[3];
      if (Math.abs(away) < this.reach(roots, i, normal)) ids[n++] = i;
    }
    gl.bindBuffer(gl.ARRAY_BUFFER, this.ids);
    gl.bufferData(gl.ARRAY_BUFFER, ids.subarray(0, n), gl.STREAM_DRAW);
    const along = unitVector(cross(normal, Math.abs(normal[0]) < 0.6 ? [1, 0, 0] : [0, 1, 0])), across = cross(normal, along);
    this.gl.bind(target);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    this.blend(gl.FUNC_ADD, gl.ONE, gl.ONE);
    this.drawKernels(0, n, camera, normal, along, across, plane[3]);
    gl.disable(gl.BLEND);
  }

  // The part of the picture that the volume may cover, as the scissor's box.
  window(view) {
    const { positions } = this.scene.surface, box = [Infinity, Infinity, -Infinity, -Infinity];
    const [low, high] = this.data.head.bounds.map((corner) => this.data.toPage(corner));
    for (let k = 0; k < 8; ++k) {
      const d = plus([k & 1 ? high[0] : low[0], k & 2 ? high[1] : low[1], k & 4 ? high[2] : low[2]], view.eye, -1);
      const z = view.perspective ? dot(d, view.forward) : 1;
      if (z < 1e-3) return [0, 0, view.width, view.height];
      [dot(d, view.right) / z / view.half[0], dot(d, view.up) / z / view.half[1]].forEach((v, c) => {
        const px = (v + 1) / 2 * (c ? view.height : view.width);
        box[c] = Math.min(box[c], Math.floor(px) - 1);
        box[c + 2] = Math.max(box[c + 2], Math.ceil(px) + 1);
      });
    }
    const x = Math.max(0, box[0]), y = Math.max(0, box[1]);
    return positions.length ? [x, y, Math.max(0, Math.min(view.width, box[2]) - x), Math.max(0, Math.min(view.height, box[3]) - y)]
                            : [0, 0, 0, 0];
  }

  // A generator: draws the transparent volume sheet by sheet, and yields after each. `coarser`: fewer sheets.
  *drawVolume(view, clip, coarser) {
    const gl = this.gl.gl, depths = this.depths(view), camera = this.uniforms(view, depths, clip);
    const unclipped = { ...camera, clip: [0, 0, 0, 1] }, { reaches, count: needed } = this.sheetsNeeded(view, depths);
    const count = Math.max(24, Math.round(needed / coarser)), distance = (depths.back - depths.front) / (count - 1);
    const { centers, count: kernels } = this.scene.places, { positions, corners } = this.scene.surface;
    const eye = dot(view.forward, view.eye), f = view.forward;
    const depth = (array, i) => f[0] * array[i] + f[1] * array[i + 1] + f[2] * array[i + 2] - eye;
    const sheet = (z) => (z - depths.front) / distance;
    const ofKernels = this.lists(kernels, count, (i) => Math.ceil(sheet(depth(centers, 3 * i) - reaches[i])),
      (i) => Math.floor(sheet(depth(centers, 3 * i) + reaches[i])));
    const pointDepths = new Float32Array(positions.length / 3);
    for (let i = 0; i < pointDepths.length; ++i) pointDepths[i] = depth(positions, 3 * i);
    const ends = (i, pick) => pick(pointDepths[corners[3 * i]], pointDepths[corners[3 * i + 1]], pointDepths[corners[3 * i + 2]]);
    const margin = 1e-3;  // rounding must not lose a triangle
    const ofTriangles = this.lists(corners.length / 3, count - 1, (i) => Math.floor(sheet(ends(i, Math.min)) - margin),
      (i) => Math.floor(sheet(ends(i, Math.max)) + margin));
    const expanded = new Uint32Array(3 * ofTriangles.numbers.length);
    for (let i = 0; i < ofTriangles.numbers.length; ++i) {
      for (let k = 0; k < 3; ++k) expanded[3 * i + k] = 3 * ofTriangles.numbers[i] + k;
    }
    gl.bindVertexArray(this.triangles);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.listed);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, expanded, gl.STREAM_DRAW);
    gl.bindVertexArray(null);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.ids);
    gl.bufferData(gl.ARRAY_BUFFER, ofKernels.numbers, gl.STREAM_DRAW);

    const { width, height } = view, name = coarser > 1 ? 'coarse ' : '';
    const hits = this.gl.target(name + 'hits', width, height, [gl.RGBA32F, gl.RGBA32F]);
    const sums = [0, 1].map((k) => this.gl.target(name + 'sums' + k, width, height, [gl.RG32F]));
    const beams = this.gl.target(name + 'beams', width, height, [gl.RGBA32F]);
    const window = this.window(view);
    if (depths.inside) {
      this.countShells(hits, unclipped);
    } else {
      this.gl.bind(hits);
      gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
    }
    this.gl.bind(beams);
    gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 1]);
    const tables = this.tables(), at = (k) => depths.front + k * distance;
    for (let k = 0; k < count; ++k) {
      gl.enable(gl.SCISSOR_TEST);
      gl.scissor(...window);
      this.gl.bind(sums[k % 2]);
      gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
      this.blend(gl.FUNC_ADD, gl.ONE, gl.ONE);
      this.drawKernels(ofKernels.offsets[k], ofKernels.offsets[k + 1] - ofKernels.offsets[k], unclipped, f, view.right, view.up,
        eye + at(k));
      if (k > 0) {
        this.gl.bind(hits);
        gl.colorMask(true, true, true, false);
        gl.clearBufferfv(gl.COLOR, 0, [0, 0, 0, 0]);
        gl.colorMask(true, true, true, true);
        gl.clearBufferfv(gl.COLOR, 1, [0, 0, 0, 0]);
        const first = ofTriangles.offsets[k - 1], triangles = ofTriangles.offsets[k] - first;
        if (triangles > 0) {
          const nearest = depths.inside ? depths.front : -1e30;
          this.gl.use(this.gl.hits, { ...unclipped, front: k === 1 ? nearest : at(k - 1), back: k === count - 1 ? 1e30 : at(k),
            from_depth: at(k - 1), per_depth: 1 / distance });
          this.drawTriangles(first, triangles);
        }
        this.gl.bind(beams);
        this.blend(gl.FUNC_ADD, gl.DST_ALPHA, gl.ONE, gl.ZERO, gl.SRC_ALPHA);
        this.gl.use(this.gl.composite, { ...camera, ...tables, front_sums: sums[(k + 1) % 2].textures[0],
          back_sums: sums[k % 2].textures[0], entries: hits.textures[0], exits: hits.textures[1], front: at(k - 1), back: at(k) });
        this.gl.screen();
      }
      gl.disable(gl.BLEND);
      gl.disable(gl.SCISSOR_TEST);
      yield (k + 1) / count;
    }
    return { target: beams, samples: 1, transmits: true };
  }

  // Shows a picture on the canvas.
  show({ target, samples, transmits }, background) {
    const gl = this.gl.gl;
    this.gl.bind(null);
    gl.disable(gl.BLEND);
    this.gl.use(this.gl.show, { picture: target.textures[0], size: [gl.canvas.width, gl.canvas.height], samples, transmits, background });
    this.gl.screen();
  }

  // The picture as linear, premultiplied RGBA, rows from the top.
  pixels({ target, samples, transmits }) {
    const gl = this.gl.gl, fine = new Float32Array(4 * target.width * target.height);
    this.gl.bind(target);
    gl.readPixels(0, 0, target.width, target.height, gl.RGBA, gl.FLOAT, fine);
    const width = target.width / samples, height = target.height / samples, pixels = new Float32Array(4 * width * height);
    for (let y = 0; y < target.height; ++y) {
      for (let x = 0; x < target.width; ++x) {
        const to = 4 * ((height - 1 - Math.floor(y / samples)) * width + Math.floor(x / samples)), from = 4 * (y * target.width + x);
        for (let c = 0; c < 4; ++c) {
          const v = transmits && c === 3 ? 1 - fine[from + c] : fine[from + c];
          pixels[to + c] += v / (samples * samples);
        }
      }
    }
    return { width, height, pixels };
  }
}
