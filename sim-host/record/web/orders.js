// Orders from forms: parameters, radio, new runs, restarts and saving.

import { metres } from "staya/view.js";

const STEPS = 1000;
const WIDE = 50;

const element = (id) => document.getElementById(id);

export class Orders {
  constructor(app) {
    this.app = app;
    this.sliders = new Map();
    this.loss = 0;
    element("save").addEventListener("click", () => app.send({ do: "save" }));
    this.dialog("new", "new-run", () =>
      app.send({
        do: "new",
        robots: number("new-robots"),
        goals: number("new-goals"),
        obstacles: number("new-obstacles"),
        discs: element("new-places").value === "given" ? discs(element("new-discs").value) : null,
        avoidance: element("new-avoidance").value,
        tick_s: number("new-tick"),
        seed: number("new-seed"),
      }),
    );
    element("new-places").addEventListener("change", () => {
      const given = element("new-places").value === "given";
      element("new-listed").hidden = !given;
      element("new-obstacles").disabled = given;
    });
    this.dialog("restart", "restart", () => app.send({ do: "restart", seed: number("restart-seed") }));
    element("only-selected").addEventListener("change", () => this.robot());
    element("radio-on").addEventListener("change", () => {
      app.order({ kind: "radio", loss: element("radio-on").checked ? this.loss : 1 });
    });
    element("radio-loss").addEventListener("input", () => this.showRadio());
    element("radio-loss").addEventListener("change", () => {
      this.loss = number("radio-loss");
      element("radio-on").checked = this.loss < 1;
      app.order({ kind: "radio", loss: this.loss });
    });
    element("radio-range").addEventListener("input", () => this.showRadio());
    element("radio-range").addEventListener("change", () => app.order({ kind: "radio", range_m: this.range() }));
  }

  dialog(opener, id, action) {
    const dialog = element(id);
    element(`open-${opener}`).addEventListener("click", () => {
      if (id === "restart") element("restart-seed").value = this.app.scene?.seed ?? 0;
      dialog.returnValue = "";
      dialog.showModal();
    });
    dialog.addEventListener("close", () => {
      if (dialog.returnValue === "ok") action();
    });
  }

  scene() {
    const { scene } = this.app;
    this.sliders.clear();
    element("parameters").replaceChildren(...scene.parameters.map((parameter) => this.slider(parameter)));
    element("parameters-panel").hidden = scene.parameters.length === 0;
    const [x0, y0, x1, y1] = scene.bounds_m;
    this.farthest = Math.max(scene.radio.range_m ?? 0, 2 * Math.hypot(x1 - x0, y1 - y0));
    this.setRadio(scene.radio);
    this.robot();
  }

  state() {
    const { radio } = this.app.state;
    if (radio && !element("radio-panel").contains(document.activeElement)) this.setRadio(radio);
  }

  setRadio({ range_m: range, loss }) {
    element("radio-on").checked = loss < 1;
    if (loss < 1) this.loss = loss;
    element("radio-loss").value = loss;
    // Short and long ranges get equal parts of the slider.
    element("radio-range").value = range === null ? 1 : Math.sqrt(Math.min(range / this.farthest, 1));
    this.showRadio();
  }

  /** Metres; null for no limit. */
  range() {
    return number("radio-range") >= 1 ? null : Number((this.farthest * number("radio-range") ** 2).toPrecision(3));
  }

  showRadio() {
    element("radio-loss-value").textContent = `${Math.round(100 * number("radio-loss"))} %`;
    element("radio-range-value").textContent = this.range() === null ? "no limit" : metres(this.range());
  }

  slider({ name, unit, least, greatest, value, what }) {
    const label = document.createElement("label");
    label.className = "slider";
    const title = document.createElement("span");
    title.textContent = name.replace(/_(s|m|mps|mps2)$/, "").replace(/_/g, " ");
    const shown = document.createElement("output");
    const input = document.createElement("input");
    input.type = "range";
    input.min = 0;
    input.max = STEPS;
    const about = document.createElement("small");
    about.textContent = what;
    label.append(title, shown, input, about);
    // Ranges over several powers of ten have a logarithmic scale.
    const wide = least > 0 && greatest / least >= WIDE;
    const toValue = (share) => (wide ? least * (greatest / least) ** share : least + share * (greatest - least));
    const toShare = (at) =>
      wide ? Math.log(at / least) / Math.log(greatest / least) : (at - least) / (greatest - least);
    const current = () => Number(toValue(input.value / STEPS).toPrecision(3));
    const show = (at) => {
      shown.textContent = `${+at.toPrecision(4)}${unit && unit !== "1" ? ` ${unit}` : ""}`;
    };
    const set = (at) => {
      input.value = STEPS * toShare(at);
      show(at);
    };
    input.addEventListener("input", () => show(current()));
    input.addEventListener("change", () => {
      const order = { kind: "parameter", name, value: current() };
      if (this.only) order.robot = this.app.selected;
      else this.sliders.get(name).value = order.value;
      this.app.order(order);
    });
    set(value);
    this.sliders.set(name, { label, set, value });
    return label;
  }

  /** Whether the sliders apply to the selected robot only. */
  get only() {
    return this.app.selected !== null && element("only-selected").checked;
  }

  robot() {
    const { app } = this;
    element("parameters-one").hidden = app.selected === null;
    if (app.selected !== null)
      element("parameters-one").lastElementChild.textContent = `Only for robot ${app.idOf(app.selected)}`;
    const own = this.only ? app.robot?.parameters : null;
    for (const [name, { label, set, value }] of this.sliders) {
      label.hidden = Boolean(own) && own[name] === undefined;
      if (!label.contains(document.activeElement)) set(own?.[name] ?? value);
    }
  }
}

/** Rows of numbers; a word that is not a number becomes null, which the server refuses. */
function discs(text) {
  const rows = text.split("\n").filter((row) => row.trim());
  return rows.map((row) => row.split(/[\s,;]+/).filter(Boolean).map(Number));
}

function number(id) {
  return Number(element(id).value);
}
