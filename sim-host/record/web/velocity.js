// The velocities permitted to a robot, drawn as in papers on ORCA: half-planes, preferred velocity,
// chosen velocity.

const CORNERS = 96;

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

export function drawVelocities(canvas, orca, velocity, colours) {
  const ratio = devicePixelRatio || 1;
  const size = canvas.clientWidth;
  if (!size) return;
  if (canvas.width !== Math.round(size * ratio)) canvas.width = canvas.height = Math.round(size * ratio);
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, size, size);
  const { max_speed_mps: fastest, lines, preferred_mps: preferred, chosen_mps: chosen } = orca;
  const reach = 1.3 * Math.max(fastest, 1e-6),
    middle = size / 2;
  const px = (v) => [middle + (v[0] / reach) * middle, middle - (v[1] / reach) * middle];
  const path = (points, close) => {
    context.beginPath();
    for (const point of points) context.lineTo(...px(point));
    if (close) context.closePath();
  };

  // Forbidden half-planes.
  const frame = [
    [-reach, -reach],
    [reach, -reach],
    [reach, reach],
    [-reach, reach],
  ];
  context.fillStyle = colours.forbidden;
  for (const { point, normal } of lines) {
    const gone = clipped(frame, { point, normal: [-normal[0], -normal[1]] });
    if (gone.length) {
      path(gone, true);
      context.fill();
    }
  }
  let allowed = Array.from({ length: CORNERS }, (_, i) => {
    const angle = (2 * Math.PI * i) / CORNERS;
    return [fastest * Math.cos(angle), fastest * Math.sin(angle)];
  });
  for (const line of lines) allowed = clipped(allowed, line);
  if (allowed.length) {
    path(allowed, true);
    context.fillStyle = colours.allowed;
    context.fill();
  }

  context.strokeStyle = colours.axis;
  context.lineWidth = 1;
  path([
    [-reach, 0],
    [reach, 0],
  ]);
  context.stroke();
  path([
    [0, -reach],
    [0, reach],
  ]);
  context.stroke();
  context.beginPath();
  context.arc(middle, middle, (fastest / reach) * middle, 0, 2 * Math.PI);
  context.strokeStyle = colours.muted;
  context.stroke();

  context.strokeStyle = colours.line;
  context.lineWidth = 1.25;
  for (const { point, normal } of lines) {
    const along = [-normal[1], normal[0]],
      far = 4 * reach;
    path([
      [point[0] - far * along[0], point[1] - far * along[1]],
      [point[0] + far * along[0], point[1] + far * along[1]],
    ]);
    context.stroke();
  }

  arrow(context, px([0, 0]), px(velocity), colours.muted, 1.5, true);
  arrow(context, px([0, 0]), px(preferred), colours.preferred, 1.75, false, [4, 3]);
  arrow(context, px([0, 0]), px(chosen), colours.chosen, 2.5, true);
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
