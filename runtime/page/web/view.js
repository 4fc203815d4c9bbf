// SPDX-License-Identifier: Apache-2.0
// The camera, and how the mouse or the fingers move it. The numbers of a view are those of runtime/scene/placement.cpp.
"use strict";

const add = (a, b) => a.map((x, i) => x + b[i]);
const subtract = (a, b) => a.map((x, i) => x - b[i]);
const scaled = (a, factor) => a.map((x) => x * factor);
const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const normalize = (a) => scaled(a, 1 / Math.hypot(...a));
const radians = (degrees) => (degrees * Math.PI) / 180;

/// Unit vectors in world space.
function axesOf(camera) {
  const back = normalize(subtract(camera.position, camera.target));
  const right = normalize(cross(camera.up, back));
  return { right, up: cross(back, right), back };
}

/// The product of two matrices of 4 columns of 4.
function multiply(a, b) {
  const product = new Array(16).fill(0);
  for (let c = 0; c < 4; ++c)
    for (let r = 0; r < 4; ++r)
      for (let i = 0; i < 4; ++i) product[4 * c + r] += a[4 * i + r] * b[4 * c + i];
  return product;
}

/// A matrix of 4 columns of 3 as one of 4 columns of 4.
function affine(m) {
  return [m[0], m[1], m[2], 0, m[3], m[4], m[5], 0, m[6], m[7], m[8], 0, m[9], m[10], m[11], 1];
}

/// The parts of a view record (view_word) for a picture of this size.
function viewOf(camera, width, height) {
  const { right, up, back } = axesOf(camera);
  const perspective = camera.projection === "perspective";
  const aspect = width / height;
  const axes = [right, up, back];
  const none = [0, 0, 0];
  const tangent = Math.tan(radians(camera.fov) / 2);
  const half = perspective ? tangent : camera.height / 2;
  const across = scaled(right, half * aspect);
  const down = scaled(up, -half);
  const depth = camera.far - camera.near;
  const projection = new Array(16).fill(0);
  projection[0] = 1 / (half * aspect);
  projection[5] = 1 / half;
  if (perspective) {
    projection[11] = -1;
    projection[14] = camera.near;
  } else {
    projection[10] = 1 / depth;
    projection[14] = camera.far / depth;
    projection[15] = 1;
  }
  const pixel = (2 * half) / height;
  return {
    eye: perspective ? [...camera.position, 1] : [...back, 0],
    view: [0, 1, 2].flatMap((c) => axes.map((axis) => axis[c])).concat(axes.map((axis) => -dot(axis, camera.position))),
    inverse_view: [...right, ...up, ...back, ...camera.position],
    projection,
    pixel_size: perspective ? [0, pixel] : [pixel, 0],
    camera_position: camera.position,
    camera_direction: scaled(back, -1),
    view_ray: [...scaled(back, -1), ...(perspective ? [...across, ...down] : [...none, ...none])],
    ray_origin: [...none, ...(perspective ? [...none, ...none] : [...across, ...down])],
    depth_numerator: perspective ? [camera.near, 0] : [camera.far, -depth],
    depth_denominator: perspective ? [0, 1] : [1, 0],
  };
}

/// The vector turned about a unit axis.
function turned(vector, axis, angle) {
  const along = scaled(axis, dot(axis, vector) * (1 - Math.cos(angle)));
  return add(add(scaled(vector, Math.cos(angle)), scaled(cross(axis, vector), Math.sin(angle))), along);
}

/// Moves the camera around the point that it looks at.
class Orbit {
  constructor(canvas, camera, redraw) {
    this.initial = structuredClone(camera);
    this.camera = structuredClone(camera);
    this.moved = false;
    this.redraw = redraw;
    const pointers = new Map();
    canvas.addEventListener("pointerdown", (event) => {
      pointers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
    canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const now = [event.clientX, event.clientY];
      const [dx, dy] = scaled(subtract(now, before), 1 / canvas.clientHeight);
      if (pointers.size === 2) {
        const [, other] = [...pointers].find(([id]) => id !== event.pointerId);
        this.zoom(Math.hypot(...subtract(before, other)) / Math.max(1, Math.hypot(...subtract(now, other))));
        this.pan(dx / 2, dy / 2);
      } else if (event.shiftKey || event.buttons & 6) {
        this.pan(dx, dy);
      } else {
        this.turn(dx, dy);
      }
      pointers.set(event.pointerId, now);
    });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(Math.max(-1, Math.min(1, event.deltaY / 500))));
    }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-0.05, 0], ArrowRight: [0.05, 0], ArrowUp: [0, -0.05], ArrowDown: [0, 0.05] }[event.key];
      if (step) this.turn(...step);
      if (event.key === "+") this.zoom(0.9);
      if (event.key === "-") this.zoom(1 / 0.9);
      if (step || event.key === "+" || event.key === "-") event.preventDefault();
    });
  }

  /// By fractions of the picture's height. Stays below the pole of `up`.
  turn(dx, dy) {
    const { position, target, up } = this.camera;
    const pole = normalize(up);
    let arm = turned(subtract(position, target), pole, -4 * dx);
    const height = Math.acos(Math.max(-1, Math.min(1, dot(normalize(arm), pole))));
    const angle = Math.max(0.02, Math.min(Math.PI - 0.02, height - 4 * dy)) - height;
    arm = turned(arm, normalize(cross(pole, arm)), angle);
    this.move({ position: add(target, arm) });
  }
  pan(dx, dy) {
    const { position, target, projection, fov, height } = this.camera;
    const { right, up } = axesOf(this.camera);
    const distance = Math.hypot(...subtract(position, target));
    const size = projection === "perspective" ? 2 * distance * Math.tan(radians(fov) / 2) : height;
    const shift = add(scaled(right, -dx * size), scaled(up, dy * size));
    this.move({ position: add(position, shift), target: add(target, shift) });
  }
  zoom(factor) {
    const { position, target, projection, height } = this.camera;
    if (projection === "perspective") this.move({ position: add(target, scaled(subtract(position, target), factor)) });
    else this.move({ height: height * factor });
  }
  move(change) {
    for (const [key, value] of Object.entries(change))
      this.camera[key] = Array.isArray(value) ? value.map(Math.fround) : Math.fround(value);
    this.moved = true;
    this.redraw();
  }
  reset() {
    this.camera = structuredClone(this.initial);
    this.moved = false;
    this.redraw();
  }
  /// "camera.position=1,2,3" for what differs from the scene's camera.
  settings() {
    if (!this.moved) return [];
    return ["position", "target", "height"]
      .filter((key) => String(this.camera[key]) !== String(this.initial[key]))
      .map((key) => `camera.${key}=${[this.camera[key]].flat().map(floatText).join(",")}`);
  }
}
