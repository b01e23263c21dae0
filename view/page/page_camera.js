// SPDX-License-Identifier: Apache-2.0
// The camera, in the page's space, as lib/look/light/camera.h has it.

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const plus = (a, b, s = 1) => [a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]];
const unitVector = (a) => {
  const length = Math.hypot(...a) || 1;
  return a.map((v) => v / length);
};
const turned = (v, axis, angle) => {  // Rodrigues
  const c = Math.cos(angle), s = Math.sin(angle), along = dot(axis, v) * (1 - c), side = cross(axis, v);
  return [0, 1, 2].map((k) => v[k] * c + side[k] * s + axis[k] * along);
};

class Camera {
  constructor(data) {
    this.data = data;
    this.reset();
  }

  reset() {
    const { eye, target, up, fovy, ortho } = this.data.head.camera;
    this.eye = this.data.toPage(eye);
    this.target = this.data.toPage(target);
    this.up = unitVector(up);
    this.fovy = fovy;
    this.ortho = ortho / this.data.size;
  }

  // Looks from a side at the whole box, with the axis up that is up in the data; along it, what is y where z is up.
  lookFrom(direction) {
    const turned = { x: ([x, y, z]) => [z, y, -x], y: ([x, y, z]) => [x, z, -y], z: (v) => v }[this.data.head.up];
    const iso = direction.every((v) => v !== 0), axis = turned([0, 0, 1]);
    const d = unitVector(iso ? turned(direction) : direction), distance = 0.55 / Math.sin(this.fovy * Math.PI / 360);
    this.target = [0, 0, 0];
    this.eye = d.map((v) => v * distance);
    this.up = Math.abs(dot(d, axis)) > 0.99 ? turned([0, 1, 0]) : axis;
    if (this.ortho) this.ortho = 1.1;
  }

  axes() {
    const forward = unitVector(plus(this.target, this.eye, -1)), right = unitVector(cross(forward, this.up));
    return { right, up: cross(right, forward), forward };
  }

  // Turns about the target: by pixels of which a full turn has `whole`.
  orbit(dx, dy, whole) {
    const { right } = this.axes(), angle = 2 * Math.PI / whole;
    let offset = plus(this.eye, this.target, -1);
    offset = turned(offset, this.up, -dx * angle);
    const tilted = turned(offset, turned(right, this.up, -dx * angle), -dy * angle);
    if (Math.abs(dot(unitVector(tilted), this.up)) < 0.998) offset = tilted;
    this.eye = plus(this.target, offset);
  }

  pan(dx, dy, height) {
    const { right, up } = this.axes(), distance = Math.hypot(...plus(this.eye, this.target, -1));
    const pixel = this.ortho ? this.ortho / height : 2 * distance * Math.tan(this.fovy * Math.PI / 360) / height;
    const move = plus(right.map((v) => -v * dx * pixel), up, dy * pixel);
    this.eye = plus(this.eye, move);
    this.target = plus(this.target, move);
  }

  zoom(factor) {
    const offset = plus(this.eye, this.target, -1), least = 1e-3 / Math.hypot(...offset);
    this.eye = plus(this.target, offset, Math.max(factor, least));
    if (this.ortho) this.ortho *= factor;
  }

  // What drawing needs: axes, the eye, half the picture's width and height in slopes or offsets. A picture that is higher than
  // wide sees as far to the sides as a square one.
  view(width, height) {
    const tall = Math.max(1, height / width);
    const half = tall * (this.ortho ? this.ortho / 2 : Math.tan(this.fovy * Math.PI / 360));
    return { ...this.axes(), eye: this.eye, half: [half * width / height, half], width, height, perspective: !this.ortho };
  }
}

// The ray through a place in the picture (pixels from the top left): origin and direction for each unit of depth.
function rayThrough(view, x, y) {
  const a = (2 * x / view.width - 1) * view.half[0], b = (1 - 2 * y / view.height) * view.half[1];
  const offset = plus(view.right.map((v) => v * a), view.up, b);
  return view.perspective ? { origin: view.eye, direction: plus(view.forward, offset) }
                          : { origin: plus(view.eye, offset), direction: view.forward };
}
