// The live section: a setting, what the engine says of it, and its figures.

class Live {
  constructor(section) {
    this.section = section;
    this.presets = JSON.parse(document.getElementById("live-settings").textContent);
    this.find = (name) => section.querySelector(`[data-live="${name}"]`);
    // For scripts of readers and tests.
    section.live = this;
    this.plots = {};
    this.palette = new Palette(section);
    for (const name of ["phase", "curve", "circle", "map"]) this.plots[name] = new Plot(this.find(name), this.palette);
    this.frames = [];
    this.dirty = false;
    this.methods = null;
    // The form is there before the engine, so that nothing moves when it comes.
    this.choose(settingOfLink(location.hash) || parseSetting(this.presets[0].text));
    addEventListener("hashchange", () => {
      const linked = settingOfLink(location.hash);
      if (linked && linkOfSetting(linked) !== linkOfSetting(this.setting)) this.choose(linked);
    });
  }

  async begin() {
    this.engine = await loadEngine();
    this.methods = this.engine("methods\n").methods.split(" ");
    this.listMethods();
    this.change();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.palette.clear();
      this.change();
    });
    new ResizeObserver(() => this.change()).observe(this.section);
    this.listen();
    this.section.dataset.state = "ready";
  }

  /** Begins with another setting; ranges of sliders are around its numbers. */
  choose(setting) {
    this.setting = setting;
    this.map = null;
    this.axes = null;
    this.columns = null;
    this.limits = {};
    this.fitted = false;
    this.fill();
    this.change();
  }

  set(key, value) {
    this.setting.set(key, String(value));
    this.change();
  }

  /** Draws in the next frame. */
  change() {
    if (this.dirty || !this.engine) return;
    this.dirty = true;
    requestAnimationFrame(() => {
      this.dirty = false;
      const started = performance.now();
      this.draw();
      this.frames.push(performance.now() - started);
      if (this.frames.length > 60) this.frames.shift();
      this.section.dataset.frame = [...this.frames].sort((a, b) => a - b)[this.frames.length >> 1].toFixed(2);
    });
  }

  ask(kind, setting = this.setting) {
    return this.engine(`${kind}\n${settingText(setting)}`);
  }

  draw() {
    const view = this.ask("view");
    this.showError(view.error);
    if (view.error) return;
    this.view = view;
    this.names = view.states.split(" ");
    this.numbers();
    drawPhase(this);
    drawCurve(this);
    drawCircle(this);
    drawMap(this);
    clearTimeout(this.idle);
    this.idle = setTimeout(() => this.rest(), 120);
    this.section.dataset.drawn = String(Number(this.section.dataset.drawn || 0) + 1);
  }

  /** What takes longer than a frame, when nothing moves. */
  rest() {
    this.limits = this.ask("limits");
    this.limitsOf = settingText(this.setting);
    this.fit();
    this.numbers();
    drawCircle(this);
    this.linked();
    const fragment = linkOfSetting(this.setting);
    if (this.touched && location.hash !== fragment) history.replaceState(null, "", fragment);
  }

  /** Lets the latency reach twice the largest stable one, once for each choice of a setting. */
  fit() {
    const limit = single(this.limits, "latency.stable");
    const row = this.rows.find((row) => row.key === "latency");
    if (this.fitted || !row || !(limit > 0 && limit < Infinity)) return;
    this.fitted = true;
    const latency = Number(this.setting.get("latency"));
    row.scale = rangeOf("latency", latency, 2 * limit);
    row.place(latency);
    this.map = null;
    drawMap(this);
  }

  showError(error) {
    this.find("error").textContent = error ? `Error: ${error}` : "";
    this.find("equations").setAttribute("aria-invalid", String(Boolean(error)));
  }

  linked() {
    for (const [name, text] of [["command", commandOf], ["python", pythonOf]]) {
      this.find(`${name}-code`).textContent = text(this.setting);
    }
  }

  /** Verdict and numbers. */
  numbers() {
    // Until the setting rests, the limits are those of a moment ago.
    const { limits } = this;
    const { verdict, good } = judge(this.view, limits, this.setting);
    const line = this.find("verdict");
    if (line.textContent !== verdict) line.textContent = verdict;
    line.className = `live-verdict ${good ? "ok" : "bad"}`;
    const rows = numberRows(this.view, limits, this.setting);
    this.find("numbers").replaceChildren(
      ...rows.map((row) => make("tr", {}, ...row.map((text, i) => make("td", { className: i ? "num" : "", textContent: text })))),
    );
  }

  /** Makes the form for the setting. */
  fill() {
    const { setting } = this;
    this.rows = [];
    const numberRow = (key, holder) => {
      const number = Number(setting.get(key));
      const scale = rangeOf(key, number, 10 * Number(setting.get("period")));
      const row = new NumberRow(key.replace(/[^A-Za-z0-9]/g, "-") + this.rows.length, key, labelOf(key), scale, (x) => {
        this.touched = true;
        this.set(key, x);
      });
      row.show(number);
      this.rows.push(row);
      holder.append(row.element);
    };
    const keys = (prefix) => [...setting.keys()].filter((key) => key.startsWith(prefix));
    const parts = [];
    const parameters = keys("parameter.");
    if (parameters.length) {
      const holder = group("Parameters");
      parameters.forEach((key) => numberRow(key, holder));
      parts.push(holder);
    }
    const start = group("Start");
    keys("start.").forEach((key) => numberRow(key, start));
    if (start.children.length > 1) parts.push(start);
    const step = group("Step");
    const select = make("select", { id: "live-integrator" });
    this.integrator = select;
    this.listMethods();
    select.addEventListener("change", () => {
      this.touched = true;
      this.map = null;
      this.set("integrator", select.value);
    });
    step.append(make("label", { htmlFor: "live-integrator", textContent: "Integrator" }), select);
    ["dt", "horizon"].forEach((key) => numberRow(key, step));
    parts.push(step);
    parts.push(this.loopGroup(numberRow));
    this.find("numbers-form").replaceChildren(...parts);
    const system = new Map([...setting].filter(([key]) => isSystemKey(key)));
    this.find("equations").value = settingText(system);
    const chosen = this.presets.findIndex((preset) => parseSetting(preset.text).get("system") === setting.get("system"));
    this.find("system").value = String(chosen);
  }

  /** The names of the integrators; before the engine is there, that of the setting. */
  listMethods() {
    const own = this.setting.get("integrator");
    this.integrator.replaceChildren(...(this.methods || [own]).map((name) => make("option", { value: name, textContent: name })));
    this.integrator.value = own;
  }

  loopGroup(numberRow) {
    const { setting } = this;
    const holder = group("Control loop");
    if (!setting.get("inputs")) {
      holder.append(make("p", { className: "sub", textContent: "The equations have no inputs for commands." }));
      return holder;
    }
    const box = make("input", { type: "checkbox", id: "live-loop", checked: hasLoop(setting) });
    holder.append(make("div", {}, box, make("label", { htmlFor: "live-loop", textContent: " Feedback u = u₀ − K(x − x₀)" })));
    box.addEventListener("change", () => {
      this.touched = true;
      const next = new Map(setting);
      if (box.checked) this.design(next);
      else LOOP_KEYS.forEach((key) => next.delete(key));
      this.choose(next);
    });
    if (!hasLoop(setting)) return holder;
    for (const [key, value] of [["gain-factor", 1], ["period", 0.01], ["latency", 0], ["jitter", 0], ["skew", 0], ["loss", 0], ["seed", 0]]) {
      if (!setting.has(key)) setting.set(key, String(value));
    }
    const rows = setting.get("gain").split(";").map((row) => row.split(",").map(Number));
    const names = statesOf(setting);
    rows.forEach((row, i) =>
      row.forEach((gain, j) => {
        const label = `Gain of ${names[j] || j + 1}${rows.length > 1 ? ` on input ${i + 1}` : ""}`;
        const own = new NumberRow(`gain-${i}-${j}`, "gain", label, rangeOf("gain", gain), (x) => {
          this.touched = true;
          rows[i][j] = x;
          this.set("gain", rows.map((row) => row.join(",")).join(";"));
        });
        own.show(gain);
        holder.append(own.element);
      }),
    );
    ["gain-factor", "period", "latency", "jitter", "skew", "loss", "seed"].forEach((key) => numberRow(key, holder));
    const design = make("button", { type: "button", textContent: "Design gains (LQR)" });
    design.addEventListener("click", () => {
      this.touched = true;
      const next = new Map(setting);
      this.design(next);
      this.choose(next);
    });
    holder.append(design);
    return holder;
  }

  /** Gains of a linear-quadratic regulator with weights of 1. */
  design(setting) {
    if (!setting.get("period")) setting.set("period", setting.get("dt"));
    const designed = this.ask("design", new Map([...setting].filter(([key]) => key !== "gain").concat([["gain", "0"]])));
    this.showError(designed.error);
    if (designed.error) return;
    const rows = setting.get("inputs").split(",").length;
    const columns = designed.gain.length / rows;
    const texts = Array.from({ length: rows }, (_, i) =>
      [...designed.gain.slice(i * columns, (i + 1) * columns)].map((x) => Number(x.toPrecision(4))).join(","),
    );
    setting.set("gain", texts.join(";"));
  }

  listen() {
    const system = this.find("system");
    system.addEventListener("change", () => {
      const preset = this.presets[Number(system.value)];
      if (!preset) return;
      this.touched = true;
      this.choose(parseSetting(preset.text));
    });
    this.find("equations").addEventListener("input", () => {
      const system = parseSetting(this.find("equations").value);
      const rest = [...this.setting].filter(([key]) => !isSystemKey(key));
      let next = new Map([...system, ...rest]);
      // Gains of another system have another shape.
      if (hasLoop(next) && this.ask("view", next).error) next = new Map([...next].filter(([key]) => !LOOP_KEYS.includes(key)));
      const view = this.ask("view", next);
      this.showError(view.error);
      if (view.error) return;
      this.touched = true;
      const text = this.find("equations").value;
      this.choose(next);
      this.find("equations").value = text;
    });
    for (const [name, text] of [["command", commandOf], ["python", pythonOf], ["link", () => location.href.split("#")[0] + linkOfSetting(this.setting)]]) {
      this.find(`copy-${name}`).addEventListener("click", async () => {
        const said = this.find("copied");
        try {
          await navigator.clipboard.writeText(text(this.setting));
          said.textContent = "Copied.";
        } catch {
          said.textContent = "The browser refused to copy; the text is under “Commands”.";
        }
        setTimeout(() => (said.textContent = ""), 4000);
      });
    }
    follow(this.plots.phase, (x, y) => {
      const [first, second] = this.columns;
      this.setting.set(`start.${first}`, String(Number(x.toPrecision(4))));
      this.moved(`start.${second}`, y);
    });
    follow(this.plots.map, (x, y) => {
      this.setting.set(this.axes[0], String(Number(x.toPrecision(4))));
      this.moved(this.axes[1], y);
    });
    for (const name of ["columns", "x-axis", "y-axis"]) {
      this.find(name).addEventListener("change", () => {
        if (name === "columns") this.columns = this.find(name).value.split("|");
        else this.axes[name === "x-axis" ? 0 : 1] = this.find(name).value;
        this.change();
      });
    }
  }

  /** A pointer moved two entries. */
  moved(key, number) {
    this.touched = true;
    this.set(key, Number(number.toPrecision(4)));
    for (const row of this.rows) if (this.setting.has(row.key)) row.show(Number(this.setting.get(row.key)));
  }
}

/** Calls `moved` with the values under a pointer that is down. */
const follow = (plot, moved) => {
  const { canvas } = plot;
  canvas.addEventListener("pointerdown", (event) => {
    if (!plot.x) return;
    canvas.setPointerCapture(event.pointerId);
    moved(...plot.valueAt(event));
  });
  canvas.addEventListener("pointermove", (event) => {
    if (canvas.hasPointerCapture(event.pointerId)) moved(...plot.valueAt(event));
  });
};

const section = document.getElementById("live");
if (section && document.getElementById("live-engine")) {
  const live = new Live(section);
  const begin = () =>
    live.begin().catch((error) => {
      section.querySelector('[data-live="error"]').textContent = `The engine did not start: ${error.message}`;
    });
  // It starts when the section comes near, so that the page is there first.
  if (location.hash.startsWith("#live&")) section.scrollIntoView();
  new IntersectionObserver((entries, observer) => {
    if (entries.some((entry) => entry.isIntersecting)) {
      observer.disconnect();
      begin();
    }
  }, { rootMargin: "600px" }).observe(section);
}
