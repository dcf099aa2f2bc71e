// The form: a slider and a text for each number of a setting.

const LABELS = {
  dt: "Time step (s)",
  horizon: "Time shown (s)",
  "gain-factor": "Factor of all gains",
  period: "Period (s)",
  latency: "Latency (s)",
  jitter: "Jitter (rms, part of the period)",
  skew: "Skew (part of the period)",
  loss: "Probability of a loss",
  seed: "Seed",
};
const labelOf = (key) => LABELS[key] || key.replace(/^parameter\.|^start\./, "");

/** The range of a slider, around the number with which the page began; of a latency up to `latest`. */
const rangeOf = (key, number, latest) => {
  switch (key) {
    case "jitter": return new Scale([0, 1 / 3]);
    case "skew": return new Scale([-0.2, 0.2]);
    case "loss": return new Scale([0, 0.9]);
    case "latency": return new Scale([0, Math.max(latest, 1.5 * number)]);
    case "gain-factor": return new Scale([0, 4]);
    case "seed": return new Scale([0, 100]);
  }
  if (SECONDS.has(key)) return new Scale([number / 30, number * 30], true);
  if (key.startsWith("start.")) return new Scale([-2, 2].map((part) => part * Math.max(1, Math.abs(number))));
  if (key.startsWith("parameter.") && number > 0) return new Scale([number / 20, number * 20], true);
  return new Scale([-3, 3].map((part) => part * (Math.abs(number) || 1)));
};

const make = (tag, properties = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), properties);
  element.append(...children);
  return element;
};

/** Why a text is no value of a number, and what is; empty if it is one. */
const problemOf = (text, key) => {
  const number = parseNumber(text, key);
  const isTime = SECONDS.has(key);
  const expected = isTime ? "seconds such as 0.01 or 10ms" : "a number such as 0.5 or 2e-3";
  if (!Number.isFinite(number)) return `not a number; expected ${expected}`;
  return isTime && number < 0 ? `below 0; expected ${expected}` : "";
};

/** A row with a label, a text and a slider. `changed` receives the number. */
class NumberRow {
  constructor(id, key, label, scale, changed) {
    [this.key, this.scale] = [key, scale];
    this.text = make("input", { type: "text", id: `live-${id}`, inputMode: "decimal", autocomplete: "off" });
    this.slider = make("input", { type: "range", min: 0, max: 1000, step: "any" });
    this.slider.setAttribute("aria-label", label);
    this.problem = make("span", { className: "live-problem", id: `${this.text.id}-problem` });
    this.problem.setAttribute("role", "status");
    this.text.setAttribute("aria-describedby", this.problem.id);
    this.element = make("div", { className: "live-row" }, make("label", { htmlFor: this.text.id, textContent: label }), this.text, this.problem, this.slider);
    this.slider.addEventListener("input", () => {
      let number = Number(this.scale.value(this.slider.value / 1000).toPrecision(3));
      if (key === "seed") number = Math.round(number);
      this.text.value = String(number);
      this.judge("");
      changed(number);
    });
    this.text.addEventListener("input", () => {
      const problem = problemOf(this.text.value, key);
      this.judge(problem);
      if (problem) return;
      const number = parseNumber(this.text.value, key);
      this.place(number);
      changed(number);
    });
  }
  place(number) {
    const part = this.scale.part(number);
    this.slider.value = 1000 * Math.min(1, Math.max(0, Number.isFinite(part) ? part : 0));
    this.slider.setAttribute("aria-valuetext", format(number));
  }
  show(number) {
    if (document.activeElement !== this.text) this.text.value = String(Number(number.toPrecision(6)));
    this.judge("");
    this.place(number);
  }
  /** Marks the text as wrong and says why, or neither. */
  judge(problem) {
    this.text.setAttribute("aria-invalid", String(Boolean(problem)));
    if (this.problem.textContent !== problem) this.problem.textContent = problem;
  }
}

const group = (title, ...children) => make("fieldset", {}, make("legend", { textContent: title }), ...children);
