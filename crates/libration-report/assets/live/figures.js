// The figures of the live section, and its sentences.

/** Columns that are shown against each other: a coordinate and its velocity, or two states. */
const pairsOf = (names) => {
  const pairs = names.filter((name) => names.includes(`${name}'`)).map((name) => [name, `${name}'`]);
  const others = names.filter((name) => !name.endsWith("'") && !names.includes(`${name}'`));
  for (let i = 0; i + 1 < others.length; i++) pairs.push([others[i], others[i + 1]]);
  if (!pairs.length) pairs.push([names[0], names[names.length - 1]]);
  return pairs;
};

const options = (select, entries, value) => {
  const text = entries.map(([value, label]) => `${value}\n${label}`).join("\n");
  if (select.dataset.text !== text) {
    select.dataset.text = text;
    select.replaceChildren(...entries.map(([value, label]) => make("option", { value, textContent: label })));
  }
  select.value = value;
};

const drawPhase = (live) => {
  const { view, names, plots } = live;
  const pairs = pairsOf(names);
  if (!live.columns || !live.columns.every((name) => names.includes(name))) live.columns = pairs[0];
  options(live.find("columns"), pairs.map((pair) => [pair.join("|"), pair.join(" and ")]), live.columns.join("|"));
  const [first, second] = live.columns;
  const of = (prefix) => [view[`${prefix}${first}`] || [], view[`${prefix}${second}`] || []];
  const own = of("x.");
  const other = of(view.kind === "loop" ? "ideal.x." : "reference.");
  const shown = other[0].length ? other : own;
  // A motion that runs away must not make the reference a point; while a pointer drags, the axes stand still.
  const within = (axis) => {
    const [low, high] = extent([shown[axis]], 0.35);
    const wide = extent([own[axis]]);
    const span = high - low;
    return [Math.max(wide[0], low - span), Math.min(wide[1], high + span)].map((end, i) => (i ? Math.max(end, high) : Math.min(end, low)));
  };
  const plot = plots.phase;
  const held = plot.canvas.matches(":active") && plot.x;
  plot.begin(held ? plot.x : new Scale(within(0)), held ? plot.y : new Scale(within(1)), [first, second]);
  if (other[0].length) plot.line(...other, "--neutral", 2.5);
  plot.line(...own, "--accent-0", 1.4);
  plot.dot(own[0][0], own[1][0], "--accent-1", 5);
  plot.canvas.setAttribute("aria-label", `Phase portrait of ${first} and ${second}, from ${format(own[0][0])}, ${format(own[1][0])}.`);
};

const drawCurve = (live) => {
  const { view, names } = live;
  const plot = live.plots.curve;
  const caption = live.find("curve-caption");
  if (view.kind === "motion" && view.energy.length) {
    const predicted = single(view, "energy.predicted");
    const bounds = Number.isFinite(predicted) ? [[predicted, -predicted], view.energy] : [view.energy];
    plot.begin(new Scale(extent([view.time], 0)), new Scale(extent(bounds)), ["t (s)", "ΔE/E₀"]);
    for (const side of [1, -1]) plot.line(extent([view.time], 0), [side * predicted, side * predicted], "--theory", 1.2, [6, 4]);
    plot.line(view.time, view.energy, "--accent-0");
    caption.textContent = "Relative change of the energy; dashed the largest change, predicted from shorter steps.";
    return;
  }
  const name = live.columns[0];
  const ideal = view.kind === "loop";
  const [times, values] = ideal ? [view["ideal.time"], view[`ideal.x.${name}`]] : [view.time, view[`reference.${name}`] || []];
  const range = extent([values.length ? values : view[`x.${name}`]], 0.5);
  const own = extent([view[`x.${name}`]]);
  const span = range[1] - range[0];
  plot.begin(new Scale(extent([view.time], 0)), new Scale([Math.max(Math.min(own[0], range[0]), range[0] - span), Math.min(Math.max(own[1], range[1]), range[1] + span)]), ["t (s)", name]);
  plot.line(times, values, "--neutral", 2.5);
  plot.line(view.time, view[`x.${name}`], "--accent-0");
  caption.textContent = ideal ? "The loop as it is; gray with perfect timing." : "The motion in these steps; gray in short steps of order 8.";
  plot.canvas.setAttribute("aria-label", `${names[0]} over time.`);
};

const drawCircle = (live) => {
  const { view } = live;
  const plot = live.plots.circle;
  const own = view["eigenvalues.re"].map((re, i) => Math.hypot(re, view["eigenvalues.im"][i]));
  const most = Math.min(3, Math.max(1.25, 1.15 * Math.max(...own, 0)));
  const { clientWidth: width, clientHeight: height } = plot.canvas;
  const wide = (most * Math.max(1, width - 62)) / Math.max(1, height - 58);
  plot.begin(new Scale([-wide, wide]), new Scale([-most, most]), ["Re λ", "Im λ"]);
  const turn = Array.from({ length: 121 }, (_, i) => (i * Math.PI) / 60);
  plot.line(turn.map(Math.cos), turn.map(Math.sin), "--theory", 1.2);
  plot.clip(() => {
    view["exact.re"].forEach((re, i) => plot.dot(re, view["exact.im"][i], "--neutral", 7, true));
    view["eigenvalues.re"].forEach((re, i) => plot.dot(re, view["eigenvalues.im"][i], own[i] > 1 + 1e-9 ? "--bad" : "--good", 4));
  });
  const radius = Math.max(...own, 0);
  plot.canvas.setAttribute("aria-label", `Eigenvalues in the unit circle; the largest has size ${format(radius)}.`);
  const beside = Math.abs(radius - 1) < 1e-12 ? "1" : `1 ${radius < 1 ? "−" : "+"} ${format(Math.abs(radius - 1))}`;
  const [of, exact] = view.kind === "loop" ? ["period", "steps"] : ["step", "flow"];
  live.find("circle-caption").textContent = `Eigenvalues of a ${of}; rings: exact ${exact}. Spectral radius ${beside}.`;
};

const MAP = { columns: 48, rows: 32, chunk: 12 };

/** The numbers that can be axes of the map. */
const axesOf = (setting) => {
  const keys = hasLoop(setting) ? ["latency", "period", "gain-factor", "jitter", "loss", "skew"] : ["dt"];
  const parameters = [...setting.keys()].filter((key) => key.startsWith("parameter."));
  return [...keys, ...parameters];
};

const drawMap = (live) => {
  const { setting, rows } = live;
  const keys = axesOf(setting);
  const plot = live.plots.map;
  const figure = plot.canvas.closest("figure");
  figure.hidden = keys.length < 2;
  if (figure.hidden) return;
  if (!live.axes || !live.axes.every((key) => keys.includes(key)) || live.axes[0] === live.axes[1]) live.axes = [keys[0], keys[1]];
  const [x, y] = live.axes;
  const labels = keys.map((key) => [key, labelOf(key)]);
  options(live.find("x-axis"), labels.filter(([key]) => key !== y), x);
  options(live.find("y-axis"), labels.filter(([key]) => key !== x), y);
  const scale = (key) => rows.find((row) => row.key === key).scale;
  const others = new Map([...setting].filter(([key]) => key !== x && key !== y && key !== "horizon" && !key.startsWith("start.")));
  const name = `${x} ${y} ${settingText(others)}`;
  if (!live.map || live.map.name !== name) {
    // Rows in an order in which each half of them covers the map.
    const order = [...Array(MAP.rows).keys()].sort((a, b) => reversed(a) - reversed(b));
    live.map = { name, x: scale(x), y: scale(y), order, cells: new Float64Array(MAP.columns * MAP.rows).fill(NaN), done: 0 };
    cancelAnimationFrame(live.mapFrame);
    computeMap(live, live.map);
  }
  paintMap(live);
};

const reversed = (row) => [0, 1, 2, 3, 4].reduce((sum, bit) => sum + (((row >> bit) & 1) << (4 - bit)), 0);

/** Computes cells for a few milliseconds of each frame. */
const computeMap = (live, map) => {
  const setting = new Map(live.setting);
  const [x, y] = live.axes;
  const chunks = MAP.columns / MAP.chunk;
  const work = () => {
    if (live.map !== map) return;
    const until = performance.now() + 8;
    while (map.done < MAP.rows * chunks && performance.now() < until) {
      const row = map.order[Math.floor(map.done / chunks)];
      const first = (map.done % chunks) * MAP.chunk;
      const values = Array.from({ length: MAP.chunk }, (_, i) => map.x.value((first + i + 0.5) / MAP.columns));
      const answer = live.ask(`map ${x} ${values.join(",")} ${y} ${map.y.value((row + 0.5) / MAP.rows)}`, setting);
      if (answer.growth) map.cells.set(answer.growth, row * MAP.columns + first);
      map.done++;
    }
    paintMap(live);
    if (map.done < MAP.rows * chunks) live.mapFrame = requestAnimationFrame(work);
    else live.section.dataset.map = map.name;
  };
  live.mapFrame = requestAnimationFrame(work);
};

const paintMap = (live) => {
  const { map, setting } = live;
  const plot = live.plots.map;
  const [x, y] = live.axes;
  plot.begin(map.x, map.y, [labelOf(x), labelOf(y)]);
  const { left, top, right, bottom } = plot.box;
  // Whole pixels, so that cells neither overlap nor leave seams.
  const lines = (count, begin, end) => Array.from({ length: count + 1 }, (_, i) => Math.round(begin + ((end - begin) * i) / count));
  const [lefts, bottoms] = [lines(MAP.columns, left, right), lines(MAP.rows, bottom, top)];
  const inks = { stable: plot.ink("--accent-3"), unstable: plot.ink("--accent-4") };
  // A row that is not there yet looks like the one below it that is.
  const known = new Set(map.order.slice(0, Math.ceil((map.done * MAP.chunk) / MAP.columns)));
  plot.clip(() => {
    for (let row = 0; row < MAP.rows; row++) {
      let source = row;
      while (source > 0 && !known.has(source)) source--;
      for (let column = 0; column < MAP.columns; column++) {
        const growth = map.cells[source * MAP.columns + column];
        if (Number.isNaN(growth)) continue;
        const stable = growth <= 1e-9;
        plot.context.fillStyle = stable ? inks.stable : inks.unstable;
        plot.context.globalAlpha = stable ? 0.22 + 0.4 * Math.min(1, Math.log10(1 + Math.abs(growth)) / 2) : 0.85;
        const [x, y] = [lefts[column], bottoms[row + 1]];
        plot.context.fillRect(x, y, lefts[column + 1] - x, bottoms[row] - y);
      }
    }
    plot.context.globalAlpha = 1;
  });
  plot.dot(Number(setting.get(x)), Number(setting.get(y)), "--page", 7);
  plot.dot(Number(setting.get(x)), Number(setting.get(y)), "--accent-1", 5);
  plot.canvas.setAttribute("aria-label", `Map of stability over ${labelOf(x)} and ${labelOf(y)}; the point is at ${format(Number(setting.get(x)))}, ${format(Number(setting.get(y)))}.`);
};

const times = (rate) => (rate < 0 ? `halve every ${short(Math.LN2 / -rate)} s` : `double every ${short(Math.LN2 / rate)} s`);

/** The verdict on a setting, in a sentence or two. */
const judge = (view, limits, setting) => {
  const [growth, exact] = [single(view, "growth.predicted"), single(view, "growth.exact")];
  if (Number.isNaN(growth)) return { verdict: "No growth is predicted: the step or the plant is not finite here.", good: false };
  if (view.kind === "loop") {
    const limit = single(limits, "latency.stable");
    const more = Number.isNaN(limit) ? "" : limit > 0 ? ` Without jitter and losses it is stable up to a latency of ${short(limit)} s.` : " Without jitter and losses it is unstable without any latency.";
    const state = growth < 0 ? `Stable: deviations ${times(growth)}` : `Unstable: deviations ${times(growth)}`;
    const ideal = single(view, "growth.ideal");
    const beside = Number.isNaN(ideal) ? "." : `; with perfect timing they ${times(ideal)}.`;
    return { verdict: state + beside + more, good: growth < 0 };
  }
  const dt = Number(setting.get("dt"));
  const grows = growth * dt > 1e-9;
  const where = view.point.startsWith("equilibrium") ? "the equilibrium" : "the start";
  if (grows && exact * dt > 1e-9) {
    return { verdict: `Deviations from ${where} grow by nature: they ${times(exact)}; in these steps they ${times(growth)}.`, good: true };
  }
  const limit = single(limits, "dt.stable");
  const share = limit === Infinity ? " No step up to 100 radians is unstable." : limit > 0 ? ` The largest stable step is ${short(limit)} s; this is ${short((100 * dt) / limit)} % of it.` : limit === 0 ? " No step of this integrator is stable here." : "";
  if (grows) return { verdict: `Unstable: deviations from ${where} ${times(growth)}, though those of the exact motion do not grow.${share}`, good: false };
  return { verdict: `Stable: no deviation from ${where} grows.${share}`, good: true };
};

/** Rows of a quantity with its prediction and its measurement. */
const numberRows = (view, limits, setting) => {
  const get = (name) => format(single(view, name));
  const error = single(view, "growth.error");
  const measured = get("growth.measured") + (error > 0 ? ` ± ${error.toPrecision(1)}` : "");
  const rows = [["growth of small deviations (1/s)", get("growth.predicted"), measured]];
  if (view.kind === "motion") {
    rows.push(["largest change of the energy", get("energy.predicted"), get("energy.largest")]);
    if (limits["dt.stable"]) rows.push(["largest stable step (s)", format(single(limits, "dt.stable")), "—"]);
  } else {
    if (limits["latency.stable"]) rows.push(["stable up to a latency of (s)", format(single(limits, "latency.stable")), "—"]);
    if (limits["cost.rise"]) rows.push(["rise of the mean square of the states under noise", format(single(limits, "cost.rise")), "—"]);
  }
  rows.push(["evaluations of the forces per simulated second", get("evaluations"), "—"]);
  const [asked, shown] = [Number(setting.get("horizon")), single(view, "horizon")];
  if (shown < 0.99 * asked) rows.push(["time shown, of the time asked for (s)", "—", `${format(shown)} of ${format(asked)}`]);
  return rows;
};
