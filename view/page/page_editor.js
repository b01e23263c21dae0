// SPDX-License-Identifier: Apache-2.0
// The transfer function over the histogram: opacities are dragged as points, the ends of the colours as triangles.

class Editor {
  // changed: called with whether the opacities have changed
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.changed = changed;
    this.grabbed = null;
    canvas.addEventListener('pointerdown', (event) => this.grab(event));
    canvas.addEventListener('pointermove', (event) => this.drag(event));
    for (const kind of ['pointerup', 'pointercancel']) canvas.addEventListener(kind, () => { this.grabbed = null; });
    canvas.addEventListener('dblclick', (event) => this.remove(this.knotAt(this.place(event))));
    canvas.addEventListener('keydown', (event) => this.key(event));
    this.selected = 0;
  }

  // transfer: {color, opacity}, changed in place; colors: {scale, kind, bands, tips}, as of `spreadColors`, colours over [0,1]
  set(field, transfer, colors, colorRange, histogram) {
    Object.assign(this, { field, transfer, colors, colorRange, histogram });
    this.low = Math.min(field.min, transfer.opacity[0][0]);
    this.high = Math.max(field.max, transfer.opacity.at(-1)[0]);
    if (!(this.high > this.low)) this.high = this.low + 1;
    this.draw();
  }

  recolor() {
    const { scale, kind, bands, tips } = this.colors, positive = this.colorRange[0] > 0;
    this.transfer.color = spreadColors(scale, this.colorRange, kind === 'log' && !positive ? 'linear' : kind, bands, tips);
  }

  // Places in CSS pixels.
  layout() {
    const width = this.canvas.clientWidth, height = this.canvas.clientHeight;
    return { left: 12, right: width - 12, top: 10, bottom: height - 48, bar: height - 42, barEnd: height - 28, width, height };
  }
  xOf(v) { const l = this.layout(); return l.left + (v - this.low) / (this.high - this.low) * (l.right - l.left); }
  yOf(alpha) { const l = this.layout(); return l.bottom - alpha * (l.bottom - l.top); }
  place(event) {
    const box = this.canvas.getBoundingClientRect(), l = this.layout(), x = event.clientX - box.left, y = event.clientY - box.top;
    const clamp = (t) => Math.min(1, Math.max(0, t));
    return { x, y, value: this.low + clamp((x - l.left) / (l.right - l.left)) * (this.high - this.low),
      alpha: clamp((l.bottom - y) / (l.bottom - l.top)) };
  }
  knotAt({ x, y }) {
    const far = this.transfer.opacity.map(([v, a]) => Math.hypot(this.xOf(v) - x, this.yOf(a) - y));
    const nearest = far.indexOf(Math.min(...far));
    return far[nearest] < 16 ? nearest : -1;
  }

  grab(event) {
    this.canvas.focus({ preventScroll: true });
    this.canvas.setPointerCapture(event.pointerId);
    const at = this.place(event), l = this.layout();
    if (at.y > l.bottom + 4) {
      const ends = this.colorRange.map((v) => Math.abs(this.xOf(v) - at.x));
      this.grabbed = { end: ends[0] < ends[1] ? 0 : 1 };
    } else {
      let knot = this.knotAt(at);
      if (knot < 0) {
        knot = this.transfer.opacity.findIndex(([v]) => v > at.value);
        if (knot < 0) knot = this.transfer.opacity.length;
        this.transfer.opacity.splice(knot, 0, [at.value, at.alpha]);
      }
      this.selected = knot;
      this.grabbed = { knot };
    }
    this.drag(event);
  }

  drag(event) {
    if (!this.grabbed) {
      this.canvas.style.cursor = this.knotAt(this.place(event)) >= 0 ? 'grab' : 'crosshair';
      return;
    }
    const at = this.place(event);
    if (this.grabbed.knot !== undefined) {
      this.move(this.grabbed.knot, at.value, at.alpha);
      return;
    }
    const range = this.colorRange.slice(), least = 0.01 * (this.high - this.low);
    range[this.grabbed.end] = at.value;
    if (range[1] - range[0] < least) return;
    this.colorRange.splice(0, 2, ...range);
    this.recolor();
    this.draw();
    this.changed(false);
  }

  move(knot, value, alpha) {
    const knots = this.transfer.opacity;
    const low = knot > 0 ? knots[knot - 1][0] : this.low, high = knot + 1 < knots.length ? knots[knot + 1][0] : this.high;
    knots[knot] = [Math.min(high, Math.max(low, value)), alpha];
    this.draw();
    this.changed(true);
  }

  remove(knot) {
    if (knot < 0 || this.transfer.opacity.length < 3) return;
    this.transfer.opacity.splice(knot, 1);
    this.selected = 0;
    this.draw();
    this.changed(true);
  }

  key(event) {
    const knots = this.transfer.opacity, knot = Math.min(this.selected, knots.length - 1), step = (this.high - this.low) / 100;
    const [value, alpha] = knots[knot];
    const moves = { ArrowLeft: [value - step, alpha], ArrowRight: [value + step, alpha], ArrowUp: [value, Math.min(1, alpha + 0.02)],
      ArrowDown: [value, Math.max(0, alpha - 0.02)] };
    if (moves[event.key]) this.move(knot, ...moves[event.key]);
    else if (event.key === 'Delete' || event.key === 'Backspace') this.remove(knot);
    else if (event.key === 'n') this.selected = (knot + 1) % knots.length;
    else return;
    event.preventDefault();
    this.draw();
  }

  draw() {
    const l = this.layout(), scale = window.devicePixelRatio || 1, style = getComputedStyle(this.canvas);
    this.canvas.width = Math.round(l.width * scale);
    this.canvas.height = Math.round(l.height * scale);
    const c = this.canvas.getContext('2d'), ink = style.color, soft = style.getPropertyValue('--soft');
    c.scale(scale, scale);
    const bins = this.histogram, most = Math.max(...bins), width = (l.right - l.left) / bins.length;
    c.fillStyle = style.getPropertyValue('--line');
    const lowest = this.xOf(this.field.min), step = (this.xOf(this.field.max) - lowest) / bins.length || width;
    bins.forEach((n, i) => {  // the root shows small parts beside large ones
      const height = Math.sqrt(n / most) * (l.bottom - l.top);
      c.fillRect(lowest + i * step, l.bottom - height, Math.max(1, step), height);
    });
    for (let x = l.left; x < l.right; ++x) {
      c.fillStyle = cssColor(colorAt(this.transfer, this.low + (x - l.left) / (l.right - l.left) * (this.high - this.low)));
      c.fillRect(x, l.bar, 1.5, l.barEnd - l.bar);
    }
    c.fillStyle = soft;
    c.font = '11px system-ui, sans-serif';
    c.textAlign = 'center';
    const unit = this.field.unit ? ' ' + this.field.unit : '';
    const ends = [shortNumber(this.low), shortNumber(this.high) + unit].map((text) => c.measureText(text).width);
    const apart = (Math.max(...ends) + 24) / (l.right - l.left);
    for (const [v, number] of ticksWithEnds(this.low, this.high, 4, apart)) {
      const label = v === this.high ? number + unit : number;
      const x = this.xOf(v), half = c.measureText(label).width / 2;
      c.fillRect(x - 0.5, l.barEnd, 1, 4);
      c.fillText(label, Math.min(l.width - half - 1, Math.max(half + 1, x)), l.height - 10);
    }
    c.strokeStyle = ink;
    c.lineWidth = 1.5;
    c.beginPath();
    const knots = this.transfer.opacity;
    c.moveTo(l.left, this.yOf(knots[0][1]));
    for (const [v, a] of knots) c.lineTo(this.xOf(v), this.yOf(a));
    c.lineTo(l.right, this.yOf(knots.at(-1)[1]));
    c.stroke();
    knots.forEach(([v, a], i) => {
      c.beginPath();
      c.arc(this.xOf(v), this.yOf(a), 5.5, 0, 7);
      c.fillStyle = i === this.selected ? style.getPropertyValue('--link') : style.getPropertyValue('--paper');
      c.fill();
      c.stroke();
    });
    for (const v of this.colorRange) {
      const x = this.xOf(v);
      c.beginPath();
      c.moveTo(x, l.bar + 2);
      c.lineTo(x - 5, l.bar - 6);
      c.lineTo(x + 5, l.bar - 6);
      c.fillStyle = ink;
      c.fill();
    }
  }
}
