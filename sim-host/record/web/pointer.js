// Mouse, pen and touch input: camera, selection and tools.

const CLICK_PIXELS = 5;
const HANDLE_PIXELS = 13;
const WHEEL = 0.0016;
const LEAST_WALL_PIXELS = 6;

const HINTS = {
  goal: "Drag from a robot to its goal, or click to set the goal of the selected robot",
  move: "Drag an obstacle",
  wall: "Drag a wall",
  circle: "Drag from the centre to the edge",
  polygon: "Click the corners, then the first one again or press Enter",
  erase: "Click an obstacle to remove it",
  paint: "Paint cells",
};

export class Pointer {
  constructor(app, canvas) {
    this.app = app;
    this.canvas = canvas;
    this.tool = "select";
    this.paintClass = 0;
    // Corners of the polygon being drawn.
    this.corners = [];
    this.pointers = new Map();
    this.drag = null;
    // Whether the click selected a robot.
    this.picked = false;
    // Whether the user has moved the camera.
    this.touched = false;
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.up(event));
    // Opened after the click, or the panel would move under the finger and take it.
    canvas.addEventListener("click", () => {
      if (this.picked && app.selected !== null) app.controls.showPanels();
      this.picked = false;
    });
    canvas.addEventListener("pointerleave", () => this.hover(null));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.touched = true;
        const lines = event.deltaMode === 1 ? 30 : 1;
        app.camera.zoom(Math.exp(-event.deltaY * lines * WHEEL), event.offsetX, event.offsetY);
      },
      { passive: false },
    );
    for (const button of document.querySelectorAll("[data-tool]")) {
      button.addEventListener("click", () => this.choose(button.dataset.tool));
    }
  }

  choose(tool) {
    const button = document.querySelector(`[data-tool="${tool}"]`);
    if (!this.app.live || (!button.offsetParent && tool !== "select")) return;
    this.tool = tool;
    this.corners = [];
    this.cancel();
    for (const each of document.querySelectorAll("[data-tool]")) each.setAttribute("aria-pressed", each === button);
    document.getElementById("tool-hint").hidden = tool === "select";
    document.getElementById("tool-text").textContent = HINTS[tool] ?? "";
    document.getElementById("paint-classes").hidden = tool !== "paint";
    document.getElementById("send-all").hidden = tool !== "goal";
    this.canvas.classList.toggle("drawing", tool !== "select" && tool !== "move");
    if (tool === "paint") this.offerClasses();
  }

  offerClasses() {
    const { app } = this;
    const buttons = Array.from({ length: app.scene.land.classes + 1 }, (_, class_) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = class_ === 0 ? "■" : class_;
      button.setAttribute("role", "radio");
      button.setAttribute("aria-label", class_ === 0 ? "wall" : `class ${class_}`);
      button.setAttribute("aria-checked", class_ === this.paintClass);
      button.addEventListener("click", () => {
        this.paintClass = class_;
        buttons.forEach((each, i) => each.setAttribute("aria-checked", i === class_));
      });
      return button;
    });
    document.getElementById("paint-classes").replaceChildren(...buttons);
  }

  /** Turns the measuring line on or off. */
  measure() {
    this.measures = !this.measures;
    this.app.view.ruler = null;
    this.app.dirty = true;
    document.getElementById("measure").setAttribute("aria-pressed", this.measures);
    this.canvas.classList.toggle("drawing", this.measures);
  }

  cancel() {
    this.drag = null;
    this.app.view.sketch = this.corners.length ? { kind: "polygon", points: this.corners } : null;
    this.canvas.classList.remove("dragging");
    this.app.dirty = true;
  }

  down(event) {
    const { app } = this;
    if (!app.scene) return;
    const at = [event.offsetX, event.offsetY];
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, at);
    if (this.pointers.size === 2) {
      this.cancel();
      this.drag = { kind: "pinch" };
      return;
    }
    if (this.pointers.size > 2) return;
    this.drag = { at, start: at, moved: false, ...this.begin(event, at) };
    this.sketch(at);
  }

  /** Starts the action of a press. */
  begin(event, at) {
    const { app } = this;
    const robot = app.pick(at[0], at[1]);
    const still = event.button === 1 || event.button === 2;
    if (this.measures && !still) return { kind: "measure", from: this.placeAt(at) };
    if (app.live && !still) {
      if ((event.shiftKey || this.tool === "goal") && robot !== null)
        return { kind: "goal", robot, heights: app.motion.place(robot, [0, 0, 0]) };
      if (this.tool === "goal") return { kind: "send" };
      if (this.tool === "select") {
        const goal = this.handle(at);
        if (goal) return goal;
      }
      const place = app.camera.unproject(at[0], at[1]);
      if (this.tool === "wall" || this.tool === "circle") return { kind: this.tool, from: place };
      if (this.tool === "polygon") return { kind: "polygon" };
      if (this.tool === "paint") return { kind: "paint", last: null };
      if (this.tool === "erase") return { kind: "erase" };
      if (this.tool === "move") {
        const solid = this.solidAt(at);
        if (solid) return { kind: "move", solid, from: place, shifted: [0, 0] };
      }
    }
    return { kind: app.camera.space && !event.shiftKey && !still ? "orbit" : "pan", click: event.button === 0 };
  }

  /** A draggable goal at a pixel. */
  handle(at) {
    const { app } = this;
    const near = (place) => {
      const seen = app.camera.project(place[0], place[1], place[2] ?? 0);
      return seen && Math.hypot(seen[0] - at[0], seen[1] - at[1]) < HANDLE_PIXELS;
    };
    const goal = (app.figures.goals ?? []).findIndex(near);
    if (goal >= 0) return { kind: "waypoint", goal, heights: app.figures.goals[goal] };
    const target = app.selected === null ? null : app.targetOf(app.selected);
    return target && near(target) ? { kind: "goal", robot: app.selected, heights: target } : null;
  }

  move(event) {
    const { app, drag } = this;
    const at = [event.offsetX, event.offsetY];
    if (!this.pointers.has(event.pointerId)) {
      this.hover(at);
      return;
    }
    this.showPlace(at);
    const before = this.pointers.get(event.pointerId);
    this.pointers.set(event.pointerId, at);
    if (!drag) return;
    if (drag.kind === "pinch") {
      this.pinch(event.pointerId, before, at);
      return;
    }
    if (!drag.moved && Math.hypot(at[0] - drag.start[0], at[1] - drag.start[1]) < CLICK_PIXELS) return;
    drag.moved = true;
    const [dx, dy] = [at[0] - drag.at[0], at[1] - drag.at[1]];
    drag.at = at;
    if (drag.kind === "pan" || drag.kind === "orbit") {
      this.touched = true;
      app.follow = drag.kind === "orbit" && app.follow;
      app.controls.follow();
      this.canvas.classList.add("dragging");
      app.camera[drag.kind](dx, dy);
    } else {
      this.sketch(at);
    }
  }

  pinch(id, before, at) {
    const { camera } = this.app;
    const other = [...this.pointers].find(([each]) => each !== id)?.[1];
    if (!other) return;
    this.touched = true;
    const span = (a) => Math.max(10, Math.hypot(a[0] - other[0], a[1] - other[1]));
    camera.pan((at[0] - before[0]) / 2, (at[1] - before[1]) / 2);
    camera.zoom(span(at) / span(before), (at[0] + other[0]) / 2, (at[1] + other[1]) / 2);
  }

  /** Previews the action; painting takes effect at once. */
  sketch(at) {
    const { app, drag } = this;
    const place = app.camera.unproject(at[0], at[1], drag.heights?.[2] ?? 0);
    if (!place) return;
    drag.place = place;
    app.dirty = true;
    switch (drag.kind) {
      case "measure":
        app.view.ruler = drag.from && drag.moved ? { from: drag.from, to: this.placeAt(at) } : null;
        break;
      case "goal":
      case "waypoint":
        if (drag.moved) app.view.sketch = { kind: "goal", robot: drag.robot ?? null, place };
        break;
      case "wall":
      case "circle":
        app.view.sketch = { kind: drag.kind, from: drag.from, to: place };
        break;
      case "move": {
        const by = [place[0] - drag.from[0], place[1] - drag.from[1]];
        shift(drag.solid, by[0] - drag.shifted[0], by[1] - drag.shifted[1]);
        drag.shifted = by;
        app.ground.changed();
        break;
      }
      case "paint":
        this.paint(place);
        break;
    }
  }

  paint(place) {
    const { app, drag, paintClass } = this;
    const { land } = app.scene;
    const cell = [0, 1].map((axis) => Math.floor((place[axis] - land.origin_m[axis]) / land.cell_m));
    // Also the cells between two pointer events.
    const from = drag.last ?? cell;
    const steps = Math.max(Math.abs(cell[0] - from[0]), Math.abs(cell[1] - from[1]), 1);
    for (let i = 0; i <= steps; i++) {
      const [x, y] = [0, 1].map((axis) => Math.round(from[axis] + ((cell[axis] - from[axis]) * i) / steps));
      if (x < 0 || y < 0 || x >= land.width || y >= land.height || app.cells[y * land.width + x] === paintClass)
        continue;
      app.cells[y * land.width + x] = paintClass;
      app.ground.cellChanged(x, y);
      app.order({ kind: "cell", cell: [x, y], class: paintClass });
    }
    drag.last = cell;
  }

  up(event) {
    const { app, drag } = this;
    if (!this.pointers.delete(event.pointerId)) return;
    if (!drag || drag.kind === "pinch") {
      if (this.pointers.size === 0) this.drag = null;
      return;
    }
    if (event.type === "pointerup") this.finish(drag, [event.offsetX, event.offsetY]);
    this.cancel();
  }

  finish(drag, at) {
    const { app } = this;
    const { place } = drag;
    switch (drag.kind) {
      case "pan":
      case "orbit":
        this.picked = !drag.moved && drag.click;
        if (this.picked) app.select(app.pick(at[0], at[1], 18));
        break;
      case "goal":
        if (drag.moved) app.order({ kind: "goal", robot: drag.robot, place_m: place });
        else app.select(drag.robot);
        break;
      case "waypoint":
        if (drag.moved) app.order({ kind: "waypoint", goal: drag.goal, place_m: place });
        break;
      case "send":
        if (document.getElementById("all-robots").checked) app.order({ kind: "goal", place_m: place });
        else if (app.selected !== null) app.order({ kind: "goal", robot: app.selected, place_m: place });
        else app.toast("Select a robot first, or drag from one.");
        break;
      case "wall":
        if (Math.hypot(at[0] - drag.start[0], at[1] - drag.start[1]) >= LEAST_WALL_PIXELS) {
          app.order({
            kind: "solid",
            solid: { kind: "segment", from_m: drag.from.slice(0, 2), to_m: place.slice(0, 2) },
          });
        }
        break;
      case "circle": {
        const radius = Math.hypot(place[0] - drag.from[0], place[1] - drag.from[1]);
        if (radius * app.camera.scale >= LEAST_WALL_PIXELS / 2) {
          app.order({ kind: "solid", solid: { kind: "circle", center_m: drag.from.slice(0, 2), radius_m: radius } });
        }
        break;
      }
      case "polygon":
        this.corner(place, at);
        break;
      case "move":
        if (drag.moved) app.order({ kind: "move", index: drag.solid.index, by_m: drag.shifted });
        break;
      case "erase": {
        const solid = this.solidAt(at);
        if (solid) app.order({ kind: "remove", index: solid.index });
        break;
      }
    }
  }

  /** Adds a corner or closes the polygon. */
  corner(place, at) {
    const { corners } = this;
    const near = (corner, pixels) => {
      const seen = corner && this.app.camera.project(corner[0], corner[1], 0);
      return seen && Math.hypot(seen[0] - at[0], seen[1] - at[1]) < pixels;
    };
    if (near(corners[0], HANDLE_PIXELS) && corners.length > 1) this.close();
    else if (place && !near(corners.at(-1), LEAST_WALL_PIXELS)) corners.push(place);
  }

  /** Creates an obstacle from the corners. */
  close() {
    const { app, corners } = this;
    if (corners.length >= 3) {
      app.order({ kind: "solid", solid: { kind: "polygon", points_m: corners.map((corner) => corner.slice(0, 2)) } });
    } else app.toast("A polygon needs at least three corners.");
    this.corners = [];
    this.cancel();
  }

  /** The centre of the robot at a pixel, else the point on the ground there; null for none. */
  placeAt([px, py]) {
    const { app } = this;
    const robot = app.pick(px, py, 1);
    return robot === null ? app.camera.unproject(px, py) : app.motion.place(robot, [0, 0, 0]);
  }

  /** Writes the scenario's coordinates at a pixel, and the cell. */
  showPlace(at) {
    const { scene, camera } = this.app;
    const place = at && camera.unproject(...at);
    let text = "";
    if (place) {
      const digits = Math.max(0, Math.min(3, Math.round(Math.log10(camera.pixelsPerMetre(camera.space ? camera.distance : 1)))));
      const [x, y] = [0, 1].map((axis) => (place[axis] + scene.origin_m[axis]).toFixed(digits));
      text = `x ${x}, y ${y} m${camera.space ? " on the ground" : ""}`;
      const { land } = scene;
      const cell = land && [0, 1].map((axis) => Math.floor((place[axis] - land.origin_m[axis]) / land.cell_m));
      if (cell && cell[0] >= 0 && cell[1] >= 0 && cell[0] < land.width && cell[1] < land.height)
        text += `\ncell ${cell.join(", ")}`;
    }
    document.getElementById("pointer-place").textContent = text;
  }

  hover(at) {
    const { app } = this;
    if (!app.scene) return;
    this.showPlace(at);
    if (this.corners.length) {
      const place = at && app.camera.unproject(at[0], at[1]);
      app.view.sketch = { kind: "polygon", points: place ? [...this.corners, place] : this.corners };
      app.dirty = true;
    }
    const robot = at && app.pick(at[0], at[1], 8);
    if (robot !== app.view.hovered) {
      app.view.hovered = robot;
      app.dirty = true;
    }
    const handle = at && app.live && this.tool === "select" && this.handle(at);
    const solid = at && this.tool === "move" && this.solidAt(at);
    this.canvas.classList.toggle("pointing", robot !== null && this.tool !== "paint");
    this.canvas.classList.toggle("moving", Boolean(handle || solid));
  }

  solidAt([px, py]) {
    const { app } = this;
    const place = app.camera.unproject(px, py);
    const near = HANDLE_PIXELS / 2 / app.camera.scale;
    return (
      place &&
      app.solids.findLast((solid) => {
        if (solid.center_m)
          return Math.hypot(place[0] - solid.center_m[0], place[1] - solid.center_m[1]) <= solid.radius_m + near;
        const points = solid.points_m ?? [solid.from_m, solid.to_m];
        return (
          points.some((point, i) => i > 0 && toSegment(place, points[i - 1], point) <= near) ||
          (solid.points_m && (inside(place, points) || toSegment(place, points[points.length - 1], points[0]) <= near))
        );
      })
    );
  }
}

function shift(solid, dx, dy) {
  const moved = ([x, y, ...z]) => [x + dx, y + dy, ...z];
  for (const name of ["center_m", "from_m", "to_m"]) if (solid[name]) solid[name] = moved(solid[name]);
  if (solid.points_m) solid.points_m = solid.points_m.map(moved);
}

function toSegment([x, y], [x0, y0], [x1, y1]) {
  const [dx, dy] = [x1 - x0, y1 - y0];
  const t = Math.max(0, Math.min(1, ((x - x0) * dx + (y - y0) * dy) / Math.max(dx * dx + dy * dy, 1e-12)));
  return Math.hypot(x - x0 - t * dx, y - y0 - t * dy);
}

function inside([x, y], points) {
  let odd = false;
  points.forEach(([x1, y1], i) => {
    const [x0, y0] = points[(i + points.length - 1) % points.length];
    if (y0 > y !== y1 > y && x < ((x1 - x0) * (y - y0)) / (y1 - y0) + x0) odd = !odd;
  });
  return odd;
}
