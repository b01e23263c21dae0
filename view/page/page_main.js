// SPDX-License-Identifier: Apache-2.0
// The page: what its controls do, and when the picture is drawn.

const kFirstSheets = 1e9;  // as few sheets as there may be: something is soon to be seen, even without a GPU

const kCoarsest = 16, kFirstSide = 96;  // parts of a side; about how many pixels the sides of the first picture have

// A view for a picture of fewer pixels.
const smaller = (view, c) => {
  const size = (n) => Math.max(16, Math.round(n / c));
  return { ...view, width: size(view.width), height: size(view.height) };
};

const $ = (id) => document.getElementById(id);

function fail(error) {
  $('state').textContent = error.message || String(error);
  $('state').className = 'fault';
}

class Page {
  constructor(head, bytes) {
    this.data = new PageData(head, bytes);
    this.head = head;
    this.canvas = $('picture');
    this.gl = new Gl(this.canvas);
    this.painter = new Painter(this.gl, this.data);
    this.camera = new Camera(this.data);
    this.step = head.steps.length - 1;
    this.field = 0;
    this.look = head.look;
    this.clip = { on: false, normal: [1, 0, 0], at: 0 };
    this.transfers = head.fields.map((field) => this.given(field));
    this.token = 0;
    this.comparison = 0;
    this.coarseness = 8;
    this.editor = new Editor($('editor'), (opacities) => this.transferChanged(opacities));
    this.fillControls();
    this.setScene();
    this.listen();
    this.resize();
  }

  // The transfer function of the file: its colours over [0,1] without those of the tips, and their range.
  given(field) {
    const a = field.color[0][0], b = field.color.at(-1)[0] > a ? field.color.at(-1)[0] : a + 1, tips = tipsOf(field.color);
    const inner = field.color.slice(tips.below ? 1 : 0, tips.above ? -1 : undefined);
    return { transfer: { color: field.color.map((k) => k.slice()), opacity: field.opacity.map((k) => k.slice()) },
      colors: { scale: inner.map(([v, ...rgb]) => [(v - a) / (b - a), ...rgb]), kind: 'linear', bands: 0, tips }, range: [a, b] };
  }

  fillControls() {
    const options = (select, names) => names.forEach((name, i) => select.add(new Option(name, i)));
    options($('field'), this.head.fields.map((field) => field.name + (field.unit ? ' [' + field.unit + ']' : '')));
    options($('step'), this.head.steps.map((step, i) => step.label || String(i)));
    $('step').value = this.step;
    $('steps').max = this.head.steps.length - 1;
    $('steps').value = this.step;
    $('field-row').hidden = this.head.fields.length < 2;
    $('step-row').hidden = this.head.steps.length < 2;
    if (!this.head.solid) $('look').remove(0);
    $('look').value = this.look;
    $('colors').add(new Option('as in the file', ''));
    Object.keys(this.head.presets).forEach((name) => $('colors').add(new Option(name, name)));
    $('compare-row').hidden = !this.head.reference;
  }

  // A solid is opaque: where opacities show, instead of another look that nobody chose.
  tellOpacities() { $('opacity-note').hidden = this.look !== 'solid'; }

  setScene() {
    this.tellOpacities();
    this.painter.setScene(this.step, this.field);
    const current = this.transfers[this.field];
    this.editor.set(this.head.fields[this.field], current.transfer, current.colors, current.range, this.histogram());
    $('scale').value = current.colors.kind;
    $('bands').value = current.colors.bands;
    $('scale').options[1].disabled = !(current.range[0] > 0);
    this.painter.setTransfer(current.transfer, this.head.opacityUnit);
    this.drawLegend();
  }

  // How much of the volume has which value.
  histogram() {
    const { places, values } = this.painter.scene, bins = new Array(96).fill(0);
    for (let i = 0; i < places.count; ++i) {
      const r = places.roots.subarray(6 * i, 6 * i + 6);
      const volume = r[0] * (r[3] * r[5] - r[4] * r[4]) - r[1] * (r[1] * r[5] - r[4] * r[2]) + r[2] * (r[1] * r[4] - r[3] * r[2]);
      bins[Math.min(95, Math.max(0, Math.floor(96 * values[5 * i])))] += Math.abs(volume);
    }
    return bins;
  }

  listen() {
    const on = (id, kind, act) => $(id).addEventListener(kind, () => act($(id)));
    on('field', 'change', (e) => { this.field = Number(e.value); this.setScene(); this.leaveComparison(); this.refresh(); });
    const step = (e) => {
      this.step = Number(e.value);
      $('step').value = $('steps').value = this.step;
      this.setScene();
      this.leaveComparison();
      this.refresh();
    };
    on('step', 'change', step);
    on('steps', 'input', step);
    on('look', 'change', (e) => { this.look = e.value; this.tellOpacities(); this.leaveComparison(); this.drawLegend(); this.refresh(); });
    on('colors', 'change', (e) => {
      this.recolor({ scale: e.value ? this.head.presets[e.value] : this.given(this.head.fields[this.field]).colors.scale });
    });
    on('scale', 'change', (e) => this.recolor({ kind: e.value }));
    on('bands', 'change', (e) => this.recolor({ bands: Number(e.value) }));
    on('restore', 'click', () => {
      this.transfers[this.field] = this.given(this.head.fields[this.field]);
      $('colors').value = '';
      this.setScene();
      this.refresh();
    });
    on('clip', 'change', () => this.clipChanged());
    on('clip-side', 'change', () => this.clipChanged());
    on('clip-at', 'input', () => { $('clip').checked = true; this.clipChanged(); });
    document.querySelectorAll('[data-view]').forEach((button) => button.addEventListener('click', () => {
      if (button.dataset.view === 'first') this.camera.reset();
      else this.camera.lookFrom(button.dataset.view.split(',').map(Number));
      this.leaveComparison();
      this.refresh();
    }));
    on('compare', 'change', (e) => (e.checked ? this.enterComparison().catch(fail) : this.leaveComparison()));
    on('wipe', 'input', (e) => $('view').style.setProperty('--at', e.value + '%'));
    new ResizeObserver(() => this.resize()).observe($('view'));
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.editor.draw(); this.drawLegend(); this.refresh(); });
    this.listenToPointers();
    this.canvas.addEventListener('webglcontextlost', () => fail(new Error('The GPU was lost; please load the page again.')));
  }

  listenToPointers() {
    const pointers = new Map(), canvas = this.canvas;
    let moved = 0;
    canvas.addEventListener('pointerdown', (event) => {
      canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      moved = pointers.size > 1 ? 99 : 0;
    });
    canvas.addEventListener('pointermove', (event) => {
      const old = pointers.get(event.pointerId);
      if (!old) return;
      const now = [event.clientX, event.clientY], dx = now[0] - old[0], dy = now[1] - old[1];
      if (dx === 0 && dy === 0) return;
      moved += Math.abs(dx) + Math.abs(dy);
      if (moved < 4) return;
      const others = [...pointers].filter(([id]) => id !== event.pointerId).map(([, place]) => place);
      if (others.length) {  // two fingers: pinch and move
        const far = (place) => Math.hypot(place[0] - others[0][0], place[1] - others[0][1]) || 1;
        this.camera.zoom(far(old) / far(now));
        this.camera.pan(dx / 2, dy / 2, canvas.clientHeight);
      } else if (event.shiftKey || event.buttons & 6) {
        this.camera.pan(dx, dy, canvas.clientHeight);
      } else {
        this.camera.orbit(dx, dy, 2 * Math.min(canvas.clientWidth, canvas.clientHeight));
      }
      pointers.set(event.pointerId, now);
      this.leaveComparison();
      this.refresh();
    });
    canvas.addEventListener('pointerup', (event) => {
      if (moved < 4 && pointers.size === 1) this.pickAt(event);
      pointers.delete(event.pointerId);
    });
    canvas.addEventListener('pointercancel', (event) => pointers.delete(event.pointerId));
    canvas.addEventListener('contextmenu', (event) => event.preventDefault());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      this.camera.zoom(Math.exp(Math.sign(event.deltaY) * Math.min(60, Math.abs(event.deltaY)) * 0.002));
      this.leaveComparison();
      this.refresh();
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => {
      const turns = { ArrowLeft: [-24, 0], ArrowRight: [24, 0], ArrowUp: [0, -24], ArrowDown: [0, 24] };
      if (turns[event.key]) this.camera.orbit(...turns[event.key], 720);
      else if (event.key === '+' || event.key === '-') this.camera.zoom(event.key === '+' ? 0.9 : 1.1);
      else return;
      event.preventDefault();
      this.leaveComparison();
      this.refresh();
    });
  }

  // change: of the colours of the field that is shown
  recolor(change) {
    Object.assign(this.transfers[this.field].colors, change);
    this.editor.recolor();
    this.editor.draw();
    this.transferChanged(false);
  }

  transferChanged(opacities) {
    $('scale').options[1].disabled = !(this.transfers[this.field].range[0] > 0);
    this.painter.setTransfer(this.transfers[this.field].transfer, this.head.opacityUnit);
    this.leaveComparison();
    this.drawLegend();
    this.refresh();
  }

  clipChanged() {
    this.clip.on = $('clip').checked;
    this.leaveComparison();
    this.refresh();
  }

  // The clip plane in the page's space: normal and offset; what is on the normal's side goes.
  clipPlane() {
    if (!$('clip').checked) return null;
    const side = $('clip-side').value;
    const normal = side === 'view' ? this.camera.axes().forward.map((v) => -v) : side.split(',').map(Number);
    let low = Infinity, high = -Infinity;
    const { positions } = this.painter.scene.surface;
    for (let i = 0; i < positions.length; i += 3) {
      const d = normal[0] * positions[i] + normal[1] * positions[i + 1] + normal[2] * positions[i + 2];
      low = Math.min(low, d);
      high = Math.max(high, d);
    }
    return [...normal, high - Number($('clip-at').value) / 100 * (high - low)];
  }

  background() {
    if (this.look === 'xray') return [1, 1, 1];
    if (this.look === this.head.look) return this.head.background;
    return this.look === 'solid' ? [0.775, 0.791, 0.815] : [0, 0, 0];
  }

  resize() {
    const scale = Math.min(window.devicePixelRatio || 1, 2), box = $('view').getBoundingClientRect();
    const width = Math.max(16, Math.round(box.width * scale)), height = Math.max(16, Math.round(box.height * scale));
    this.editor.draw();
    this.drawLegend();
    if (this.firstSize && this.canvas.width === width && this.canvas.height === height) return;
    this.firstSize = true;
    this.canvas.width = width;
    this.canvas.height = height;
    this.refresh();
  }

  // Draws soon: first a coarse picture if a fine one takes long, then the fine one.
  refresh() {
    $('value').hidden = true;
    ++this.token;
    if (this.drawing) return;
    this.drawing = true;
    this.drawAll().catch(fail).finally(() => { this.drawing = false; });
  }

  async drawAll() {
    let token = -1;
    while (token !== this.token) {
      token = this.token;
      const view = this.camera.view(this.canvas.width, this.canvas.height), clip = this.clipPlane();
      if (this.look === 'solid') {
        this.painter.show(this.painter.drawSolid(view, clip, 2), this.background());
        await this.gl.done();
        this.shown();
        continue;
      }
      const slow = await this.drawCoarse(view, clip);
      // Where even a coarse picture takes long, finer ones come one after the other: each costs a part of the next.
      for (let c = this.coarseness / 2; slow && c >= 2 && token === this.token; c /= 2) {
        const better = await this.drawFine(smaller(view, c), clip, () => token !== this.token, c);
        if (better) this.painter.show(better, this.background());
      }
      if (token !== this.token) continue;
      const fine = await this.drawFine(view, clip, () => token !== this.token, 1);
      if (fine) this.painter.show(fine, this.background());
      if (fine) this.shown();
    }
  }

  // A picture of fewer pixels and sheets, as many as a fifteenth of a second allows. Returns whether it took long all the same.
  async drawCoarse(view, clip) {
    if (!this.firstPicture) this.coarseness = Math.max(8, Math.min(kCoarsest, Math.sqrt(view.width * view.height) / kFirstSide));
    const c = this.coarseness, sheets = this.firstPicture ? 1 + c / 2 : kFirstSheets;
    const start = performance.now(), work = this.painter.drawVolume(smaller(view, c), clip, sheets);
    let step = work.next();
    while (!step.done) step = work.next();
    this.painter.show(step.value, this.background());
    await this.gl.done();
    const milliseconds = performance.now() - start;
    if (milliseconds > 120) this.coarseness = Math.min(milliseconds > 480 ? kCoarsest : Math.max(8, c), c * 1.5);
    if (milliseconds < 40) this.coarseness = Math.max(1.01, c / 1.25);
    this.shown();
    return milliseconds > 480;
  }

  // Sheet after sheet, with pauses in which the page can react. Returns nothing if it was given up. coarser: fewer sheets
  async drawFine(view, clip, givenUp, coarser) {
    const work = this.painter.drawVolume(view, clip, coarser);
    let batch = 2, step = work.next();
    while (!step.done) {
      const start = performance.now();
      for (let i = 0; i < batch && !step.done; ++i) step = work.next();
      await this.gl.done();
      if (givenUp()) return null;
      const milliseconds = performance.now() - start;
      if (milliseconds < 25) batch = Math.min(256, batch * 2);
      else if (milliseconds > 80) batch = Math.max(1, batch >> 1);
      $('state').textContent = step.done ? '' : 'drawing ' + Math.round(100 * step.value) + ' %';
    }
    return step.value;
  }

  shown() {
    this.firstPicture ??= performance.now();
    $('state').textContent = '';
    document.documentElement.dataset.shown = this.token;
  }

  pickAt(event) {
    const box = this.canvas.getBoundingClientRect(), view = this.camera.view(box.width, box.height);
    const x = event.clientX - box.left, y = event.clientY - box.top, field = this.head.fields[this.field];
    const { transfer } = this.transfers[this.field], range = field.max > field.min ? field.max - field.min : 1;
    const extinction = (v) => -Math.log1p(-Math.min(alphaAt(transfer, field.min + v * range), 1 - 1e-6)) * this.data.size / this.head.opacityUnit;
    const found = pick(rayThrough(view, x, y), this.painter.scene, this.clipPlane(), this.look === 'solid', extinction);
    const label = $('value');
    label.hidden = !found || found.value === undefined;
    if (label.hidden) return;
    this.picked = { value: field.min + found.value * range, place: this.data.toWorld(found.place) };
    label.textContent = field.name + ' ' + shortNumber(this.picked.value) + (field.unit ? ' ' + field.unit : '') + '\nat ' +
      this.picked.place.map(shortNumber).join(', ');
    label.style.left = Math.min(x + 12, box.width - label.offsetWidth - 4) + 'px';
    label.style.top = Math.max(4, y - label.offsetHeight - 8) + 'px';
  }

  drawLegend() {
    const canvas = $('legend'), scale = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
    if (!width || !this.editor.transfer) return;
    canvas.width = Math.round(width * scale);
    canvas.height = Math.round(height * scale);
    const c = canvas.getContext('2d'), b = this.background(), field = this.head.fields[this.field], { transfer } = this.transfers[this.field];
    c.scale(scale, scale);
    c.font = '12px system-ui, sans-serif';
    c.fillStyle = 0.2126 * b[0] + 0.7152 * b[1] + 0.0722 * b[2] > 0.18 ? '#1c1c1c' : '#eee';
    const top = 30, bottom = height - 14, right = width - 10, left = right - 14, high = field.max > field.min ? field.max : field.min + 1;
    c.textAlign = 'right';
    c.fillText(field.name + (field.unit ? ' [' + field.unit + ']' : ''), right, 14, width - 12);
    for (const [v, label] of ticksWithEnds(field.min, high, 6, 16 / (bottom - top))) {
      const y = bottom - (v - field.min) / (high - field.min) * (bottom - top);
      c.fillRect(left - 4, y - 0.5, 4, 1);
      c.fillText(label, left - 7, y + 4);
    }
    for (let y = top; y < bottom; ++y) {
      c.fillStyle = cssColor(colorAt(transfer, field.min + (bottom - y) / (bottom - top) * (high - field.min)));
      c.fillRect(left, y, right - left, 1.5);
    }
    const tips = tipsOf(transfer.color), half = (right - left) / 2;
    for (const [rgb, y, out] of [[tips.below, bottom, 9], [tips.above, top, -9]]) {  // triangles in the colours beyond the range
      if (!rgb) continue;
      c.fillStyle = cssColor(rgb);
      c.beginPath();
      c.moveTo(left, y);
      c.lineTo(right, y);
      c.lineTo(left + half, y + out);
      c.fill();
    }
  }

  // The reference beside our picture: the same camera, field, step and colours.
  async enterComparison() {
    const comparison = ++this.comparison, left = () => comparison !== this.comparison;
    this.camera.reset();
    this.field = 0;
    this.step = this.head.steps.length - 1;
    this.transfers[0] = this.given(this.head.fields[0]);
    this.look = this.head.look;
    $('field').value = 0;
    $('step').value = $('steps').value = this.step;
    $('look').value = this.look;
    $('colors').value = '';
    $('clip').checked = false;
    this.setScene();
    this.refresh();
    const image = $('reference'), { png, width, height } = this.head.reference;
    image.src = 'data:image/png;base64,' + png;
    await image.decode();
    if (left()) return;
    $('view').classList.add('comparing');
    $('wipe-row').hidden = false;
    const ours = await this.picture(width, height);
    if (left()) return;
    $('compare-state').textContent = 'PSNR ' + this.psnr(image, ours).toFixed(1) + ' dB at ' + width + ' × ' + height + ', 8 bits';
  }

  // A comparison that waits for its pictures ends, too.
  leaveComparison() {
    ++this.comparison;
    $('compare').checked = false;
    $('view').classList.remove('comparing');
    $('wipe-row').hidden = true;
    $('compare-state').textContent = '';
  }

  psnr(image, { width, height, pixels }) {
    const canvas = Object.assign(document.createElement('canvas'), { width, height }), c = canvas.getContext('2d');
    c.drawImage(image, 0, 0);
    const right = c.getImageData(0, 0, width, height).data, b = this.background();
    let sum = 0;
    for (let i = 0; i < right.length; i += 4) {
      for (let k = 0; k < 3; ++k) {
        const light = Math.min(1, pixels[i + k] + (1 - pixels[i + 3]) * b[k]);
        sum += (Math.round(255 * srgbOfLinear(Math.max(0, light))) / 255 - right[i + k] / 255) ** 2;
      }
    }
    return -10 * Math.log10(Math.max(1e-12, sum / (right.length / 4 * 3)));
  }

  // The finished picture at a size, as linear premultiplied RGBA.
  async picture(width, height) {
    while (this.drawing) await new Promise((resolve) => setTimeout(resolve, 10));
    this.drawing = true;
    try {
      const view = this.camera.view(width, height), clip = this.clipPlane();
      const drawn = this.look === 'solid' ? this.painter.drawSolid(view, clip, 2) : await this.drawFine(view, clip, () => false, 1);
      return this.painter.pixels(drawn);
    } finally {
      this.drawing = false;
      this.refresh();
    }
  }
}

(async () => {
  const start = performance.now();
  const head = JSON.parse($('head').textContent), bytes = await inflated(bytesOfBase64($('bytes').textContent.trim()));
  window.subvolPage = new Page(head, bytes);
  window.subvolPage.unpacked = performance.now() - start;
})().catch(fail);
