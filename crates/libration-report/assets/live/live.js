// The live section: a setting, what the engine says of it, and its figures.

class Live {
  constructor(section) {
    this.section = section;
    // For scripts of readers and tests.
    section.live = this;
    this.presets = JSON.parse(document.getElementById("live-settings").textContent);
    this.find = (name) => section.querySelector(`[data-live="${name}"]`);
    this.palette = new Palette(section);
    this.plots = {};
    for (const name of ["phase", "curve", "circle", "map"]) this.plots[name] = new Plot(this.find(name), this.palette);
    this.frames = [];
    this.methods = null;
    // The form is there before the engine, so that nothing moves when it comes.
    const linked = settingOfLink(location.hash);
    this.choose(linked ? linked.setting : parseSetting(this.presets[0].text), linked?.error);
    addEventListener("hashchange", () => {
      const linked = settingOfLink(location.hash);
      if (linked && linkOfSetting(linked.setting) !== linkOfSetting(this.setting)) this.choose(linked.setting, linked.error);
    });
    this.listen();
  }

  async begin() {
    const bytes = await loadModule();
    // Maps and limits may take long, and must not keep the figures waiting.
    [this.engine, this.slow] = [new Engine(bytes), new Engine(bytes)];
    const late = `no answer within ${FIRST_PATIENCE / 1000} s; reload the page to try again`;
    const first = await this.engine.ask("methods\n", FIRST_PATIENCE, late);
    if (first.error) throw new Error(first.error);
    this.methods = first.methods.split(" ");
    this.listMethods();
    this.change();
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.palette.clear();
      this.change();
    });
    let width = this.section.clientWidth;
    new ResizeObserver(() => {
      if (width === this.section.clientWidth) return;
      width = this.section.clientWidth;
      this.change();
    }).observe(this.section);
    this.section.dataset.state = "ready";
  }

  /** Begins with another setting; ranges of sliders are around its numbers. `error` says what is wrong with its source. */
  choose(setting, error = "") {
    this.setting = setting;
    [this.sourceError, this.editError] = [error, ""];
    [this.view, this.map, this.axes, this.columns] = [null, null, null, null];
    clearTimeout(this.idle);
    this.limits = {};
    this.limitsOf = "";
    this.fitted = false;
    this.fill();
    this.change();
  }

  set(key, value) {
    this.setting.set(key, String(value));
    this.showRows();
    this.touch();
  }

  /** Shows the setting in all rows but the one that a reader types in. */
  showRows() {
    for (const row of this.rows) if (this.setting.has(row.key) && row.key !== "gain") row.show(Number(this.setting.get(row.key)));
  }

  /** The setting changed by other means than its equations, whose last right text returns. */
  touch() {
    if (this.editError) {
      this.editError = "";
      this.find("equations").value = this.systemText();
    }
    this.change();
  }

  systemText() {
    return settingText(new Map([...this.setting].filter(([key]) => isSystemKey(key))));
  }

  ask(kind, setting = this.setting, engine = this.engine) {
    return engine.ask(`${kind}\n${settingText(setting)}`);
  }

  /** Draws as soon as the engine has answered. While it works, only the last change counts. */
  async change() {
    this.changed = true;
    if (this.working || !this.engine) return;
    this.working = true;
    try {
      await this.follow();
    } finally {
      this.working = false;
    }
  }

  /** Shows the setting until it no longer changes. */
  async follow() {
    while (this.changed) {
      this.changed = false;
      const started = performance.now();
      const text = settingText(this.setting);
      const view = await this.engine.ask(`view\n${text}`);
      if (this.editError || (text !== settingText(this.setting) && view.error)) continue;
      this.show(view);
      this.frames.push(performance.now() - started);
      if (this.frames.length > 60) this.frames.shift();
      this.section.dataset.frame = [...this.frames].sort((a, b) => a - b)[this.frames.length >> 1].toFixed(2);
      await new Promise(requestAnimationFrame);
    }
  }

  show(view) {
    const error = view.error || this.sourceError;
    this.find("error").textContent = error ? `Error: ${error}` : "";
    this.find("equations").setAttribute("aria-invalid", String(Boolean(error)));
    // Figures of another setting than the one in the form are faint.
    this.section.classList.toggle("stale", Boolean(view.error));
    this.failed = Boolean(view.error);
    if (view.error) {
      clearTimeout(this.idle);
      this.find("verdict").textContent = "";
      this.find("numbers").replaceChildren();
      this.linked();
      return;
    }
    this.view = view;
    this.names = view.states.split(" ");
    this.numbers();
    drawPhase(this);
    drawCurve(this);
    drawCircle(this);
    drawMap(this);
    clearTimeout(this.idle);
    this.idle = setTimeout(() => this.rest(), 120);
  }

  /** What takes longer than a frame, when nothing moves. */
  async rest() {
    const text = settingText(this.setting);
    const limits = await this.slow.ask(`limits\n${text}`);
    if (!this.view || this.failed || text !== settingText(this.setting)) return;
    [this.limits, this.limitsOf] = [limits, text];
    this.fit();
    this.numbers();
    this.linked();
    const fragment = linkOfSetting(this.setting);
    if (this.touched && location.hash !== fragment) history.replaceState(null, "", fragment);
  }

  /** Lets the latency reach twice the largest stable one, once for each choice of a setting. */
  fit() {
    const latency = Number(this.setting.get("latency"));
    const window = latencyWindow(this.limits, latency);
    const row = this.rows.find((row) => row.key === "latency");
    if (this.fitted || !row || !window || !Number.isFinite(window[1])) return;
    this.fitted = true;
    row.scale = rangeOf("latency", latency, Math.min(2 * window[1], single(this.limits, "latency.tried")));
    row.place(latency);
    this.map = null;
    drawMap(this);
  }

  /** The texts to copy; none where the setting has an error, unless `always`. */
  texts(always = false) {
    if (this.failed && !always) return { command: "", python: "", link: "" };
    const link = location.href.split("#")[0] + linkOfSetting(this.setting);
    return { command: commandOf(this.setting), python: pythonOf(this.setting), link };
  }

  linked() {
    const { command, python } = this.texts();
    this.find("command-code").textContent = command;
    this.find("python-code").textContent = python;
    for (const name of ["command", "python", "link"]) this.find(`copy-${name}`).disabled = !command;
  }

  /** Says beside the time step that a longer one than a period is not taken. */
  judgeStep() {
    const row = this.rows.find((row) => row.key === "dt");
    const problem = stepProblem(this.setting);
    if (!row) return;
    if (problem || row.isLong) row.judge(problem);
    row.isLong = Boolean(problem);
  }

  /** Verdict and numbers. */
  numbers() {
    this.judgeStep();
    // Limits of another setting are not shown.
    const limits = this.limitsOf === settingText(this.setting) ? this.limits : {};
    const { verdict, mark } = judge(this.view, limits, this.setting);
    const line = this.find("verdict");
    if (line.textContent !== verdict) line.textContent = verdict;
    line.className = `live-verdict ${mark}`;
    const rows = numberRows(this.view, limits, this.setting);
    this.find("numbers").replaceChildren(
      ...rows.map((row) => make("tr", {}, ...row.map((text, i) => make("td", { className: i ? "num" : "", textContent: text })))),
    );
  }

  /** Makes the form for the setting. */
  fill() {
    this.rows = [];
    const parts = [
      this.numberGroup("Parameters", "parameter."),
      this.numberGroup("Start", "start."),
      this.stepGroup(),
      this.loopGroup(),
    ];
    this.find("numbers-form").replaceChildren(...parts.filter(Boolean));
    this.find("equations").value = this.systemText();
    const chosen = this.presets.findIndex((preset) => parseSetting(preset.text).get("system") === this.setting.get("system"));
    this.find("system").value = String(chosen);
    this.linked();
  }

  numberGroup(title, prefix) {
    const keys = [...this.setting.keys()].filter((key) => key.startsWith(prefix));
    return keys.length ? group(title, ...keys.map((key) => this.numberRow(key))) : null;
  }

  numberRow(key) {
    const number = Number(this.setting.get(key));
    const scale = rangeOf(key, number, 10 * Number(this.setting.get("period")));
    const id = key.replace(/[^A-Za-z0-9]/g, "-") + this.rows.length;
    const row = new NumberRow(id, key, labelOf(key), scale, (x) => {
      this.touched = true;
      this.set(key, x);
    });
    row.show(number);
    this.rows.push(row);
    return row.element;
  }

  stepGroup() {
    this.integrator = make("select", { id: "live-integrator" });
    this.listMethods();
    this.integrator.addEventListener("change", () => {
      this.touched = true;
      this.set("integrator", this.integrator.value);
    });
    const label = make("label", { htmlFor: "live-integrator", textContent: "Integrator" });
    return group("Step", label, this.integrator, ...["dt", "horizon"].map((key) => this.numberRow(key)));
  }

  /** The names of the integrators; before the engine is there, that of the setting. */
  listMethods() {
    const own = this.setting.get("integrator");
    this.integrator.replaceChildren(...(this.methods || [own]).map((name) => make("option", { value: name, textContent: name })));
    this.integrator.value = own;
  }

  loopGroup() {
    const { setting } = this;
    if (!setting.get("inputs")) {
      return group("Control loop", make("p", { className: "sub", textContent: "The equations have no inputs for commands." }));
    }
    const box = make("input", { type: "checkbox", id: "live-loop", checked: hasLoop(setting) });
    box.addEventListener("change", () => {
      const next = new Map([...setting].filter(([key]) => !LOOP_KEYS.includes(key)));
      if (box.checked) this.design(next);
      else this.choose(next);
    });
    const holder = group("Control loop", make("div", {}, box, make("label", { htmlFor: "live-loop", textContent: " Feedback u = u₀ − K(x − x₀)" })));
    if (!hasLoop(setting)) return holder;
    for (const [key, value] of Object.entries(LOOP_DEFAULTS)) if (!setting.has(key)) setting.set(key, value);
    holder.append(...this.gainRows(), ...Object.keys(LOOP_DEFAULTS).map((key) => this.numberRow(key)));
    const design = make("button", { type: "button", textContent: "Design gains (LQR)" });
    design.addEventListener("click", () => this.design(new Map(this.setting)));
    holder.append(design);
    return holder;
  }

  gainRows() {
    const rows = this.setting.get("gain").split(";").map((row) => row.split(",").map(Number));
    const names = statesOf(this.setting);
    const rowOf = (gain, i, j) => {
      const label = `Gain of ${names[j] || j + 1}${rows.length > 1 ? ` on input ${i + 1}` : ""}`;
      const own = new NumberRow(`gain-${i}-${j}`, "gain", label, rangeOf("gain", gain), (x) => {
        this.touched = true;
        rows[i][j] = x;
        this.set("gain", rows.map((row) => row.join(",")).join(";"));
      });
      own.show(gain);
      return own.element;
    };
    return rows.flatMap((row, i) => row.map((gain, j) => rowOf(gain, i, j)));
  }

  /** Chooses the setting with the gains of a linear-quadratic regulator with weights of 1. */
  async design(setting) {
    this.touched = true;
    if (!setting.get("period")) setting.set("period", setting.get("dt"));
    const designed = await this.ask("design", new Map([...setting].filter(([key]) => key !== "gain").concat([["gain", "0"]])));
    if (designed.error) {
      this.choose(new Map([...setting].filter(([key]) => !LOOP_KEYS.includes(key))), designed.error);
      return;
    }
    const rows = setting.get("inputs").split(",").length;
    const columns = designed.gain.length / rows;
    const texts = Array.from({ length: rows }, (_, i) =>
      [...designed.gain.slice(i * columns, (i + 1) * columns)].map((x) => Number(x.toPrecision(4))).join(","),
    );
    setting.set("gain", texts.join(";"));
    this.choose(setting);
  }

  /** Takes the system that a reader types, as soon as it has no error. */
  async edit() {
    const field = this.find("equations");
    const text = field.value;
    const rest = [...this.setting].filter(([key]) => !isSystemKey(key));
    const { setting, error } = settingOf([...entriesOf(text), ...rest]);
    let next = setting;
    let problem = error;
    if (!problem) {
      const view = await this.ask("view", next);
      // Gains of another system have another shape.
      if (view.error && hasLoop(next)) next = new Map([...next].filter(([key]) => !LOOP_KEYS.includes(key)));
      problem = hasLoop(setting) && !hasLoop(next) ? (await this.ask("view", next)).error : view.error;
    }
    if (field.value !== text) return;
    this.touched = true;
    this.editError = problem || "";
    if (problem) {
      this.show({ error: problem });
      return;
    }
    this.choose(next);
    field.value = text;
  }

  listen() {
    const system = this.find("system");
    system.addEventListener("change", () => {
      const preset = this.presets[Number(system.value)];
      if (!preset) return;
      this.touched = true;
      this.choose(parseSetting(preset.text));
    });
    this.find("equations").addEventListener("input", () => this.engine && this.edit());
    for (const name of ["command", "python", "link"]) {
      this.find(`copy-${name}`).addEventListener("click", async () => {
        const said = this.find("copied");
        try {
          await navigator.clipboard.writeText(this.texts()[name]);
          said.textContent = "Copied.";
        } catch {
          said.textContent = "The browser refused to copy; the text is under “Commands”.";
        }
        setTimeout(() => (said.textContent = ""), 4000);
      });
    }
    follow(this.plots.phase, (x, y) => this.moved([`start.${this.columns[0]}`, x], [`start.${this.columns[1]}`, y]));
    follow(this.plots.map, (x, y) => this.moved([this.axes[0], x], [this.axes[1], y]));
    for (const name of ["columns", "x-axis", "y-axis"]) {
      this.find(name).addEventListener("change", () => {
        if (name === "columns") this.columns = this.find(name).value.split("|");
        else this.axes[name === "x-axis" ? 0 : 1] = this.find(name).value;
        this.change();
      });
    }
  }

  /** A pointer moved two entries. */
  moved(...entries) {
    this.touched = true;
    for (const [key, number] of entries) this.setting.set(key, String(Number(number.toPrecision(4))));
    this.showRows();
    this.touch();
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
