// The claims of the paper's figure that the scenario belongs to, beside recorded and present values.

/** Values of this run by the name of a measure; null if it does not have one yet. */
const LIVE = {
  arrived: ({ figures, robots }) => (figures.arrived === undefined ? null : `${figures.arrived} of ${robots}`),
  collisions: ({ figures }) => figures.collisions ?? null,
  least_gap_m: ({ plots, motion }) => {
    const least = plots.least("Smallest gap", motion.current?.tick ?? 0);
    return least === null ? null : `${+least.toPrecision(4)} m`;
  },
};

/** Creates an element with a class and children; strings become text. */
function make(tag, className, ...children) {
  const made = document.createElement(tag);
  if (className) made.className = className;
  made.append(...children);
  return made;
}

export class Claims {
  constructor(app) {
    this.app = app;
    this.panel = document.getElementById("claims-panel");
    this.body = document.getElementById("claims");
    this.live = [];
  }

  scene() {
    const claims = this.app.scene.claims ?? [];
    this.panel.hidden = claims.length === 0;
    const key = JSON.stringify(claims);
    if (key === this.key) return;
    this.key = key;
    this.live = [];
    this.body.replaceChildren(...claims.map((claim) => this.row(claim)));
  }

  row({ claim, paper, measure, condition, measured, judgement, fails }) {
    const facts = make("dl", "grid-facts");
    const fact = (name, text) => {
      const value = make("dd", "", text);
      facts.append(make("dt", "", name), value);
      return value;
    };
    if (paper) fact("paper", paper);
    fact("measured", measured || "not recorded");
    if (LIVE[measure]) this.live.push({ of: LIVE[measure], value: fact("this run", "–") });
    const verdict = make("span", "verdict", judgement || "no verdict");
    verdict.dataset.is = judgement;
    const part = make("section", "claim", make("p", "", claim, " ", verdict), facts);
    if (fails) part.append(make("small", "", fails));
    if (condition) part.append(make("small", "", condition));
    return part;
  }

  /** Fills in the values of this run. */
  update() {
    for (const { of, value } of this.live) {
      const text = String(of(this.app) ?? "–");
      if (value.textContent !== text) value.textContent = text;
    }
  }
}
