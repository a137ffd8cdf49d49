// The ground: map, grid, obstacles, and the route costs in the selected robot's window. The canvas
// is redrawn only when they or the camera change.

import { fromBase64 } from "staya/frame.js";

const IMAGE_PIXELS = 1200000;
const FINEST = 8;
const CRISP_PIXELS = 5;
const SHADE = 0.55;
const COST_PIXELS = 30;
// From low to high cost, in colours for all kinds of colour vision.
const COSTS = [
  [68, 1, 84],
  [59, 82, 139],
  [33, 145, 140],
  [94, 201, 98],
  [253, 231, 37],
];

/** A round step up to `metres`: 1, 2 or 5 times a power of ten. */
export function niceStep(metres) {
  const power = 10 ** Math.floor(Math.log10(metres));
  const factor = metres / power;
  return power * (factor < 1.5 ? 1 : factor < 3.5 ? 2 : factor < 7.5 ? 5 : 10);
}

export class Ground {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d", { alpha: false });
    this.land = null;
    this.solids = [];
    this.window = null;
    this.relief = true;
    this.version = 0;
    this.drawn = "";
  }

  setScene(scene, cells, solids) {
    this.land = scene.land && { ...scene.land, cells };
    this.solids = solids;
    this.bounds = scene.bounds_m;
    this.image = null;
    this.version++;
  }

  changed() {
    this.version++;
  }

  /** Sets the route window of the selected robot, with its encoded `costs`; null for none. */
  setWindow(window) {
    if (!window && !this.window) return;
    this.window = window && { ...window, costs: new Float32Array(fromBase64(window.costs).buffer) };
    this.version++;
  }

  /** Repaints the surroundings of a changed cell. */
  cellChanged(cx, cy) {
    if (this.image) this.paint(cx - 2, cy - 2, cx + 3, cy + 3);
    this.version++;
  }

  setLook(relief, colours) {
    if (relief !== this.relief || colours !== this.colours) this.image = null;
    this.relief = relief;
    this.colours = colours;
    this.version++;
  }

  resize(width, height, ratio) {
    this.ratio = ratio;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    this.version++;
  }

  draw(camera, showGrid) {
    const key = `${camera.version}:${this.version}:${showGrid}`;
    if (key === this.drawn) return;
    this.drawn = key;
    const { context } = this;
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.fillStyle = this.colours.paper;
    context.fillRect(0, 0, camera.width, camera.height);
    if (camera.space) return;
    if (this.land) this.drawLand(camera);
    if (showGrid) this.drawGrid(camera);
    if (this.land && this.window) this.drawWindow(camera);
    for (const solid of this.solids) this.drawSolid(camera, solid);
  }

  drawLand(camera) {
    const { context, land } = this;
    if (!this.image) {
      const fine = this.relief ? Math.sqrt(IMAGE_PIXELS / (land.width * land.height)) : 1;
      this.fine = Math.max(1, Math.min(FINEST, Math.floor(fine)));
      this.image = document.createElement("canvas");
      this.image.width = land.width * this.fine;
      this.image.height = land.height * this.fine;
      this.paint(0, 0, land.width, land.height);
    }
    const [left, top] = camera.project(land.origin_m[0], land.origin_m[1] + land.height * land.cell_m);
    const width = land.width * land.cell_m * camera.scale,
      height = land.height * land.cell_m * camera.scale;
    context.imageSmoothingEnabled = this.relief;
    context.drawImage(this.image, left, top, width, height);
    if (this.relief && land.cell_m * camera.scale >= CRISP_PIXELS) this.drawWalls(camera);
    context.strokeStyle = this.colours.border;
    context.lineWidth = 1;
    context.strokeRect(left - 0.5, top - 0.5, width + 1, height + 1);
  }

  /** Draws blocked cells with sharp edges, one run at a time. */
  drawWalls(camera) {
    const {
      context,
      land: { width, height, cells, cell_m: cell, origin_m: origin },
    } = this;
    const [west, north] = camera.unproject(0, 0),
      [east, south] = camera.unproject(camera.width, camera.height);
    const from = (metres, o) => Math.max(0, Math.floor((metres - o) / cell));
    const x0 = from(west, origin[0]),
      x1 = Math.min(width, from(east, origin[0]) + 1);
    const y0 = from(south, origin[1]),
      y1 = Math.min(height, from(north, origin[1]) + 1);
    context.beginPath();
    for (let y = y0; y < y1; y++) {
      for (let x = x0; x < x1; x++) {
        if (cells[y * width + x] !== 0) continue;
        const start = x;
        while (x + 1 < x1 && cells[y * width + x + 1] === 0) x++;
        const [left, top] = camera.project(origin[0] + start * cell, origin[1] + (y + 1) * cell);
        context.rect(left - 0.3, top - 0.3, (x + 1 - start) * cell * camera.scale + 0.6, cell * camera.scale + 0.6);
      }
    }
    context.fillStyle = this.colours.wall;
    context.fill();
  }

  /** Paints the image of some cells. */
  paint(x0, y0, x1, y1) {
    const {
      land: { width, height, cells, classes },
      fine,
      relief,
    } = this;
    x0 = Math.max(0, x0);
    y0 = Math.max(0, y0);
    x1 = Math.min(width, x1);
    y1 = Math.min(height, y1);
    const [low, high, wall] = ["landLow", "landHigh", "wall"].map((name) => rgb(this.colours[name]));
    const columns = (x1 - x0) * fine,
      rows = (y1 - y0) * fine;
    const picture = new ImageData(columns, rows),
      { data } = picture;
    const span = Math.max(1, classes - 1);
    const level = (x, y) => {
      const at = Math.max(0, Math.min(height - 1, y)) * width + Math.max(0, Math.min(width - 1, x));
      return cells[at] === 0 ? 1.35 : (cells[at] - 1) / span;
    };
    // Heights between cell centres, rounded to gentle terraces.
    const smooth = (t) => t * t * (3 - 2 * t);
    const surface = (x, y) => {
      const cx = Math.floor(x),
        cy = Math.floor(y),
        tx = smooth(x - cx),
        ty = smooth(y - cy);
      return (
        (level(cx, cy) * (1 - tx) + level(cx + 1, cy) * tx) * (1 - ty) +
        (level(cx, cy + 1) * (1 - tx) + level(cx + 1, cy + 1) * tx) * ty
      );
    };
    for (let row = 0; row < rows; row++) {
      const y = y1 - (row + 0.5) / fine;
      for (let column = 0; column < columns; column++) {
        const x = x0 + (column + 0.5) / fine;
        const class_ = cells[Math.floor(y) * width + Math.floor(x)];
        let value = (class_ - 1) / span,
          light = 1;
        if (relief && fine > 1) {
          const here = surface(x - 0.5, y - 0.5);
          // Light from the north-west.
          const slope = surface(x - 0.1, y - 0.5) - here - (surface(x - 0.5, y - 0.1) - here);
          value = Math.min(1, here);
          light = 1 - SHADE * Math.max(-0.6, Math.min(0.6, slope * 1.4));
        }
        const at = 4 * (row * columns + column);
        for (let i = 0; i < 3; i++) {
          data[at + i] = class_ === 0 ? wall[i] : (low[i] + (high[i] - low[i]) * value) * light;
        }
        data[at + 3] = 255;
      }
    }
    this.image.getContext("2d").putImageData(picture, x0 * fine, (height - y1) * fine);
  }

  drawWindow(camera) {
    const {
      context,
      land,
      colours,
      window: { corner, side, costs },
    } = this;
    const cell = land.cell_m * camera.scale;
    const finite = costs.filter(Number.isFinite);
    const low = Math.min(...finite),
      span = Math.max(...finite) - low;
    const [left, bottom] = camera.project(
      land.origin_m[0] + corner[0] * land.cell_m,
      land.origin_m[1] + corner[1] * land.cell_m,
    );
    context.font = "500 10px system-ui, sans-serif";
    context.textAlign = "center";
    for (let y = 0; y < side; y++) {
      for (let x = 0; x < side; x++) {
        const cost = costs[y * side + x];
        if (!Number.isFinite(cost)) continue;
        context.fillStyle = costColour(span > 0 ? (cost - low) / span : 0, 0.55);
        context.fillRect(left + x * cell, bottom - (y + 1) * cell, cell, cell);
        if (cell < COST_PIXELS) continue;
        context.fillStyle = colours.label;
        context.fillText(
          cost < 100 ? cost.toFixed(1) : cost.toFixed(0),
          left + (x + 0.5) * cell,
          bottom - (y + 0.08) * cell,
        );
      }
    }
    context.strokeStyle = colours.selected;
    context.lineWidth = 1.5;
    context.strokeRect(left, bottom - side * cell, side * cell, side * cell);
  }

  drawGrid(camera) {
    const { context, land, colours } = this;
    const step = land ? land.cell_m : niceStep(45 / camera.scale);
    const pixels = step * camera.scale;
    if (pixels < (land ? 12 : 4)) return;
    const [west, north] = camera.unproject(0, 0),
      [east, south] = camera.unproject(camera.width, camera.height);
    const [ox, oy] = land ? land.origin_m : [0, 0];
    context.lineWidth = 1;
    for (const [every, colour] of land
      ? [[1, colours.gridOnLand]]
      : [
          [1, colours.grid],
          [5, colours.gridStrong],
        ]) {
      context.beginPath();
      for (let i = Math.ceil((west - ox) / step / every) * every; ox + i * step <= east; i += every) {
        if (land && (i < 0 || i > land.width)) continue;
        const x = Math.round(camera.project(ox + i * step, 0)[0]) + 0.5;
        const [top, bottom] = land ? this.landSpan(camera, 1) : [0, camera.height];
        context.moveTo(x, top);
        context.lineTo(x, bottom);
      }
      for (let i = Math.ceil((south - oy) / step / every) * every; oy + i * step <= north; i += every) {
        if (land && (i < 0 || i > land.height)) continue;
        const y = Math.round(camera.project(0, oy + i * step)[1]) + 0.5;
        const [left, right] = land ? this.landSpan(camera, 0) : [0, camera.width];
        context.moveTo(left, y);
        context.lineTo(right, y);
      }
      context.strokeStyle = colour;
      context.stroke();
    }
  }

  landSpan(camera, axis) {
    const {
      origin_m: [x, y],
      width,
      height,
      cell_m: cell,
    } = this.land;
    const a = camera.project(x, y + height * cell)[axis],
      b = camera.project(x + width * cell, y)[axis];
    return [a, b];
  }

  drawSolid(camera, solid) {
    const { context, colours } = this;
    context.fillStyle = colours.solid;
    context.strokeStyle = colours.solidEdge;
    context.lineWidth = 1.5;
    context.lineCap = "round";
    context.beginPath();
    if (solid.center_m) {
      const [x, y] = camera.project(solid.center_m[0], solid.center_m[1]);
      context.arc(x, y, Math.max(1, solid.radius_m * camera.scale), 0, 2 * Math.PI);
      context.fill();
      context.stroke();
      return;
    }
    const points = solid.points_m ?? [solid.from_m, solid.to_m];
    points.forEach((point, i) => {
      const [x, y] = camera.project(point[0], point[1]);
      if (i === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    });
    if (solid.points_m) {
      context.closePath();
      context.fill();
    } else {
      context.lineWidth = 3.5;
      context.strokeStyle = this.land ? colours.wall : colours.fence;
    }
    context.stroke();
  }
}

function costColour(share, alpha) {
  const at = Math.min(share, 0.9999) * (COSTS.length - 1),
    i = Math.floor(at),
    t = at - i;
  const [r, g, b] = COSTS[i].map((part, k) => Math.round(part + (COSTS[i + 1][k] - part) * t));
  return `rgb(${r} ${g} ${b} / ${alpha})`;
}

/** Red, green and blue of `#rrggbb`. */
export function rgb(hex) {
  return [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
}
