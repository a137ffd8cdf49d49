// The velocities permitted to a robot, drawn as in papers on ORCA: half-planes, preferred velocity,
// chosen velocity; in the panel, and around the robot in the picture.

const CORNERS = 96;
// Edges of the round tip of a velocity obstacle.
const EDGES = 12;

/** The part of a convex polygon on the permitted side. */
function clipped(polygon, { point, normal }) {
  const side = ([x, y]) => (x - point[0]) * normal[0] + (y - point[1]) * normal[1];
  const kept = [];
  polygon.forEach((corner, i) => {
    const next = polygon[(i + 1) % polygon.length];
    const a = side(corner),
      b = side(next);
    if (a >= 0) kept.push(corner);
    if (a >= 0 !== b >= 0) {
      const t = a / (a - b);
      kept.push([corner[0] + t * (next[0] - corner[0]), corner[1] + t * (next[1] - corner[1])]);
    }
  });
  return kept;
}

/** A regular polygon around the origin, as a circle of this radius. */
export function circle(radius) {
  return Array.from({ length: CORNERS }, (_, i) => {
    const angle = (2 * Math.PI * i) / CORNERS;
    return [radius * Math.cos(angle), radius * Math.sin(angle)];
  });
}

/** The permitted velocities as a polygon, empty if there are none. */
export function permitted({ max_speed_mps: fastest, lines }) {
  return lines.reduce(clipped, circle(fastest));
}

/** The velocities up to `reach` that lead to a collision within `horizonS` seconds with a body at
    `offset` that keeps its velocity (Fiorini and Shiller): a cone with a round tip, as a polygon. */
export function velocityObstacle(offset, velocity, radii, horizonS, reach) {
  const far = Math.hypot(...offset);
  if (far <= radii) return [];
  const [middle, tangent] = [Math.atan2(offset[1], offset[0]), Math.acos(radii / far)];
  const edges = Array.from({ length: EDGES + 1 }, (_, i) => {
    const angle = middle + Math.PI + tangent * ((2 * i) / EDGES - 1);
    const out = [Math.cos(angle), Math.sin(angle)];
    const point = [0, 1].map((k) => velocity[k] + (offset[k] + radii * out[k]) / horizonS);
    return { point, normal: [-out[0], -out[1]] };
  });
  return edges.reduce(clipped, circle(reach));
}

/** Draws velocities; `px` maps a velocity to pixels, `outer` is the polygon that is filled. */
export function drawVelocities(context, orca, velocity, colours, px, outer) {
  const { max_speed_mps: fastest, lines, preferred_mps: preferred, chosen_mps: chosen } = orca;
  const path = (...polygons) => {
    context.beginPath();
    for (const points of polygons.filter((points) => points.length)) {
      points.forEach((point, i) => context[i ? "lineTo" : "moveTo"](...px(point)));
      if (points.length > 2) context.closePath();
    }
  };
  // The other direction of the inner border makes it a hole.
  path(outer, lines.reduce(clipped, outer).reverse());
  context.fillStyle = colours.forbidden;
  if (lines.length) context.fill();
  path(permitted(orca));
  context.fillStyle = colours.allowed;
  context.fill();
  context.lineWidth = 1;
  context.strokeStyle = colours.muted;
  path(circle(fastest));
  context.stroke();
  context.strokeStyle = colours.line;
  context.globalAlpha = 0.6;
  const reach = Math.max(...outer.map((corner) => Math.hypot(...corner)));
  for (const { point, normal } of lines) {
    const off = point[0] * normal[0] + point[1] * normal[1];
    const half = Math.sqrt(reach * reach - off * off);
    if (!(half > 0)) continue;
    path([-half, half].map((t) => [off * normal[0] - t * normal[1], off * normal[1] + t * normal[0]]));
    context.stroke();
  }
  context.globalAlpha = 1;
  arrow(context, px([0, 0]), px(velocity), colours.muted, 1.5, true);
  arrow(context, px([0, 0]), px(preferred), colours.preferred, 1.75, false, [4, 3]);
  arrow(context, px([0, 0]), px(chosen), colours.chosen, 2.5, true);
}

/** Draws the plot of the panel, with axes and the greatest speed. */
export function plotVelocities(canvas, orca, velocity, colours) {
  const ratio = devicePixelRatio || 1;
  const size = canvas.clientWidth;
  if (!size) return;
  if (canvas.width !== Math.round(size * ratio)) canvas.width = canvas.height = Math.round(size * ratio);
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, size, size);
  const { max_speed_mps: fastest } = orca;
  const reach = 1.3 * Math.max(fastest, 1e-6),
    middle = size / 2;
  context.strokeStyle = colours.axis;
  context.lineWidth = 1;
  for (const [x, y] of [[middle, 0], [0, middle]]) {
    context.beginPath();
    context.moveTo(middle - x, middle - y);
    context.lineTo(middle + x, middle + y);
    context.stroke();
  }
  const px = (v) => [middle + (v[0] / reach) * middle, middle - (v[1] / reach) * middle];
  const square = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map((corner) => corner.map((at) => at * reach));
  drawVelocities(context, orca, velocity, colours, px, square);
  context.fillStyle = colours.muted;
  context.font = "10.5px system-ui, sans-serif";
  context.textAlign = "right";
  context.fillText(`${+fastest.toPrecision(3)} m/s`, px([fastest, 0])[0] - 4, middle - 4);
}

function arrow(context, [x0, y0], [x1, y1], colour, width, filled, dash = []) {
  const length = Math.hypot(x1 - x0, y1 - y0);
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = width;
  if (length < 3) {
    context.beginPath();
    context.arc(x1, y1, 3, 0, 2 * Math.PI);
    context[filled ? "fill" : "stroke"]();
    return;
  }
  const ux = (x1 - x0) / length,
    uy = (y1 - y0) / length,
    head = Math.min(8, length);
  context.setLineDash(dash);
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1 - ux * head * 0.7, y1 - uy * head * 0.7);
  context.stroke();
  context.setLineDash([]);
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x1 - ux * head - uy * head * 0.42, y1 - uy * head + ux * head * 0.42);
  context.lineTo(x1 - ux * head + uy * head * 0.42, y1 - uy * head - ux * head * 0.42);
  context.closePath();
  context[filled ? "fill" : "stroke"]();
}
