// The camera: a map from above, or an orbit in space. Pixels are CSS pixels from the top left
// corner.

const FIELD_OF_VIEW = 0.8;
const FOCUS = 1 / Math.tan(FIELD_OF_VIEW / 2);
const ZOOM_OUT = 4;
const STEEPEST = 1.553;

export class Camera {
  constructor() {
    this.space = false;
    this.width = this.height = 1;
    this.target = [0, 0, 0];
    this.scale = 1;
    this.yaw = -0.6;
    this.pitch = 0.6;
    this.distance = 10;
    this.extent = 1;
    this.matrix = new Float32Array(16);
    // Incremented by each change, so that layers redraw only then.
    this.version = 0;
  }

  /** Fits `bounds` (x0, y0, x1, y1) and `heights` (z0, z1) between `insets` in pixels: left, top, right, bottom. */
  fit(bounds, heights, space, insets) {
    const [left, top, right, bottom] = insets;
    const [x0, y0, x1, y1] = bounds;
    const [z0, z1] = heights;
    const spanX = Math.max(x1 - x0, 0.01),
      spanY = Math.max(y1 - y0, 0.01);
    const freeX = Math.max(this.width - left - right, 50),
      freeY = Math.max(this.height - top - bottom, 50);
    this.space = space;
    this.extent = Math.hypot(spanX, spanY, space ? z1 - z0 : 0);
    this.target = [(x0 + x1) / 2, (y0 + y1) / 2, space ? (z0 + z1) / 2 : 0];
    this.scale = 0.94 * Math.min(freeX / spanX, freeY / spanY);
    this.distance = 0.5 * this.extent * FOCUS * Math.max(1, this.height / freeY, this.height / freeX);
    if (!space) {
      this.target[0] += (right - left) / 2 / this.scale;
      this.target[1] -= (bottom - top) / 2 / this.scale;
    }
    this.update();
  }

  resize(width, height) {
    this.width = width;
    this.height = height;
    this.update();
  }

  update() {
    const {
      matrix: m,
      target: [x, y, z],
      width,
      height,
    } = this;
    this.version++;
    if (!this.space) {
      const sx = (2 * this.scale) / width,
        sy = (2 * this.scale) / height;
      m.set([sx, 0, 0, 0, 0, sy, 0, 0, 0, 0, 0, 0, -x * sx, -y * sy, 0, 1]);
      return;
    }
    const [cosYaw, sinYaw, cosPitch, sinPitch] = [
      Math.cos(this.yaw),
      Math.sin(this.yaw),
      Math.cos(this.pitch),
      Math.sin(this.pitch),
    ];
    // Right, up and back vectors of the camera.
    const r = [cosYaw, sinYaw, 0];
    const u = [sinPitch * -sinYaw, sinPitch * cosYaw, cosPitch];
    const b = [cosPitch * sinYaw, -cosPitch * cosYaw, sinPitch];
    this.axes = { r, u, b };
    const eye = [x + b[0] * this.distance, y + b[1] * this.distance, z + b[2] * this.distance];
    const dot = (v) => v[0] * eye[0] + v[1] * eye[1] + v[2] * eye[2];
    const near = this.distance / 200,
      far = this.distance + 20 * this.extent;
    const fx = (FOCUS * height) / width,
      depth = (far + near) / (near - far),
      offset = (2 * far * near) / (near - far);
    for (let i = 0; i < 3; i++) {
      m[4 * i] = fx * r[i];
      m[4 * i + 1] = FOCUS * u[i];
      m[4 * i + 2] = depth * b[i];
      m[4 * i + 3] = -b[i];
    }
    m[12] = -fx * dot(r);
    m[13] = -FOCUS * dot(u);
    m[14] = -depth * dot(b) + offset;
    m[15] = dot(b);
  }

  /** Pixels and the depth by which lengths shrink; null behind the camera. */
  project(x, y, z = 0) {
    const m = this.matrix;
    const w = m[3] * x + m[7] * y + m[11] * z + m[15];
    if (w <= 0) return null;
    return [
      (((m[0] * x + m[4] * y + m[8] * z + m[12]) / w + 1) / 2) * this.width,
      ((1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) / 2) * this.height,
      w,
    ];
  }

  /** Pixels per metre at the depth `w` of `project`. */
  pixelsPerMetre(w = 1) {
    return this.space ? ((this.height / 2) * FOCUS) / w : this.scale;
  }

  /** The point at height `z` under a pixel; null if the plane is not visible there. */
  unproject(px, py, z = 0) {
    const nx = (2 * px) / this.width - 1,
      ny = 1 - (2 * py) / this.height;
    if (!this.space) {
      return [
        this.target[0] + (nx * this.width) / 2 / this.scale,
        this.target[1] + (ny * this.height) / 2 / this.scale,
        0,
      ];
    }
    const { r, u, b } = this.axes;
    const across = (nx * this.width) / this.height / FOCUS,
      up = ny / FOCUS;
    const ray = [0, 1, 2].map((i) => across * r[i] + up * u[i] - b[i]);
    const eyeZ = this.target[2] + b[2] * this.distance;
    const far = (z - eyeZ) / ray[2];
    if (!(far > 0 && far < 1e4 * this.distance)) return null;
    return [
      this.target[0] + b[0] * this.distance + far * ray[0],
      this.target[1] + b[1] * this.distance + far * ray[1],
      z,
    ];
  }

  pan(dx, dy) {
    if (this.space) {
      const { r, u } = this.axes;
      const metres = 1 / this.pixelsPerMetre(this.distance);
      for (let i = 0; i < 3; i++) this.target[i] += (-dx * r[i] + dy * u[i]) * metres;
    } else {
      this.target[0] -= dx / this.scale;
      this.target[1] += dy / this.scale;
    }
    this.update();
  }

  orbit(dx, dy) {
    this.yaw -= 0.006 * dx;
    this.pitch = Math.max(-0.1, Math.min(STEEPEST, this.pitch + 0.006 * dy));
    this.update();
  }

  /** Zooms by `factor` around a pixel. */
  zoom(factor, px = this.width / 2, py = this.height / 2) {
    if (this.space) {
      this.distance = Math.max(this.extent / 500, Math.min(ZOOM_OUT * 3 * this.extent, this.distance / factor));
      this.update();
      return;
    }
    const [x, y] = this.unproject(px, py);
    const least = Math.min(this.width, this.height) / (ZOOM_OUT * this.extent);
    this.scale = Math.max(least, Math.min(20000, this.scale * factor));
    this.target[0] = x - (px - this.width / 2) / this.scale;
    this.target[1] = y + (py - this.height / 2) / this.scale;
    this.update();
  }

  centre(x, y, z) {
    this.target = [x, y, this.space ? z : 0];
    this.update();
  }
}
