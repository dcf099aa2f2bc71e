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
  const { view } = live;
  const plot = live.plots.curve;
  // A motion that ends early leaves the rest of the time empty.
  const time = [0, single(view, "horizon")];
  const caption = live.find("curve-caption");
  if (view.kind === "motion" && view.energy.length) {
    const predicted = single(view, "energy.predicted");
    const bounds = Number.isFinite(predicted) ? [[predicted, -predicted], view.energy] : [view.energy];
    plot.begin(new Scale(time), new Scale(extent(bounds)), ["t (s)", "ΔE/E₀"]);
    for (const side of [1, -1]) plot.line(time, [side * predicted, side * predicted], "--theory", 1.2, [6, 4]);
    plot.line(view.time, view.energy, "--accent-0");
    plot.canvas.setAttribute("aria-label", `Relative change of the energy over time, at most ${format(single(view, "energy.largest"))}.`);
    caption.textContent = "Relative change of the energy; dashed the largest change, predicted from shorter steps.";
    return;
  }
  const name = live.columns[0];
  const ideal = view.kind === "loop";
  const [times, values] = ideal ? [view["ideal.time"], view[`ideal.x.${name}`]] : [view.time, view[`reference.${name}`] || []];
  const range = extent([values.length ? values : view[`x.${name}`]], 0.5);
  const own = extent([view[`x.${name}`]]);
  const span = range[1] - range[0];
  plot.begin(new Scale(time), new Scale([Math.max(Math.min(own[0], range[0]), range[0] - span), Math.min(Math.max(own[1], range[1]), range[1] + span)]), ["t (s)", name]);
  plot.line(times, values, "--neutral", 2.5);
  plot.line(view.time, view[`x.${name}`], "--accent-0");
  caption.textContent = ideal ? "The loop as it is; gray with perfect timing." : "The motion in these steps; gray in short steps of order 8.";
  plot.canvas.setAttribute("aria-label", `${name} over time.`);
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
  const span = Number(live.setting.get(view.kind === "loop" ? "period" : "dt"));
  const beside = Math.abs(radius - 1) < Math.max(1e-12, 1e-9 * span) ? "1" : `1 ${radius < 1 ? "−" : "+"} ${format(Math.abs(radius - 1))}`;
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
  figure.hidden = keys.length < 2 || !live.view;
  if (figure.hidden) return;
  if (!live.axes || !live.axes.every((key) => keys.includes(key)) || live.axes[0] === live.axes[1]) live.axes = [keys[0], keys[1]];
  const [x, y] = live.axes;
  const labels = keys.map((key) => [key, labelOf(key)]);
  options(live.find("x-axis"), labels.filter(([key]) => key !== y), x);
  options(live.find("y-axis"), labels.filter(([key]) => key !== x), y);
  const scale = (key) => rows.find((row) => row.key === key).scale;
  const others = new Map([...setting].filter(([key]) => key !== x && key !== y && key !== "horizon" && key !== "seed" && !key.startsWith("start.")));
  // The start matters only where it decides which point is linearised.
  const name = `${x} ${y} ${x.startsWith("parameter") || y.startsWith("parameter") ? "" : live.view.point} ${settingText(others)}`;
  if (!live.map || live.map.name !== name) {
    // Rows in an order in which each half of them covers the map.
    const order = [...Array(MAP.rows).keys()].sort((a, b) => reversed(a) - reversed(b));
    live.map = { name, x: scale(x), y: scale(y), order, cells: new Float64Array(MAP.columns * MAP.rows).fill(NaN), known: new Set() };
    computeMap(live, live.map);
  }
  paintMap(live);
};

const reversed = (row) => [0, 1, 2, 3, 4].reduce((sum, bit) => sum + (((row >> bit) & 1) << (4 - bit)), 0);

/** The time in ms that a request for cells may take; what takes longer is asked for in smaller parts, and ten times that long not at all. */
const MAP_TIME = 150;

/** Computes the cells of a map, one request after the other. */
const computeMap = async (live, map) => {
  const setting = new Map(live.setting);
  const [x, y] = live.axes;
  let chunk = MAP.chunk;
  for (const row of map.order) {
    for (let first = 0; first < MAP.columns; first += chunk) {
      const count = Math.min(chunk, MAP.columns - first);
      const values = Array.from({ length: count }, (_, i) => map.x.value((first + i + 0.5) / MAP.columns));
      const started = performance.now();
      const answer = await live.ask(`map ${x} ${values.join(",")} ${y} ${map.y.value((row + 0.5) / MAP.rows)}`, setting, live.slow);
      if (live.map !== map) return;
      if (answer.growth) map.cells.set(answer.growth, row * MAP.columns + first);
      const time = performance.now() - started;
      if (time / count > 10 * MAP_TIME) {
        map.slow = true;
        paintMap(live);
        return;
      }
      chunk = Math.max(1, Math.min(MAP.columns, Math.round((count * MAP_TIME) / Math.max(time, 1))));
    }
    map.known.add(row);
    paintMap(live);
  }
  live.section.dataset.map = map.name;
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
  const { known } = map;
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
  if (map.slow) plot.context.fillText("too slow for a page: see the commands", left + 12, top + 24);
  // A point beyond the map is shown open, at its edge.
  const at = [[map.x, x], [map.y, y]].map(([scale, key]) => Math.min(1, Math.max(0, scale.part(Number(setting.get(key))))));
  const beyond = [[map.x, x], [map.y, y]].some(([scale, key]) => Math.abs(scale.part(Number(setting.get(key))) - 0.5) > 0.5 + 1e-9);
  plot.dot(map.x.value(at[0]), map.y.value(at[1]), "--page", 7);
  plot.dot(map.x.value(at[0]), map.y.value(at[1]), "--accent-1", 5, beyond);
  plot.canvas.setAttribute("aria-label", `Map of stability over ${labelOf(x)} and ${labelOf(y)}; the point is at ${format(Number(setting.get(x)))}, ${format(Number(setting.get(y)))}.`);
};

/** A growth rate; one of rounding is 0. */
const growthOf = (rate) => (Math.abs(rate) < 1e-9 ? 0 : rate);

const times = (rate) => (rate < 0 ? `halve every ${short(Math.LN2 / -rate)} s` : `double every ${short(Math.LN2 / rate)} s`);

/** The verdict on a setting, in a sentence or two, and its mark: `ok`, `bad` or `neutral`. */
const judge = (view, limits, setting) => {
  const growth = single(view, "growth.predicted");
  if (Number.isNaN(growth)) return { verdict: "No growth is predicted: the step or the plant is not finite here.", mark: "bad" };
  return view.kind === "loop" ? judgeLoop(view, limits, setting, growth) : judgeMotion(view, limits, setting, growth);
};

/** The latencies at which a loop is stable around one that is given, or the first: a pair, of NaN if they are unknown; null if there are none. */
const latencyWindow = (limits, latency) => {
  const windows = [...(limits["latency.from"] || [])].map((from, i) => [from, limits["latency.to"][i]]);
  return windows.find(([from, to]) => from <= latency && latency <= to) || windows[0] || null;
};

const latencyText = (limits, latency) => {
  const [window, tried] = [latencyWindow(limits, latency), single(limits, "latency.tried")];
  if (!window) return "none";
  if (Number.isNaN(window[0])) return "unknown";
  const to = window[1] === Infinity ? `above ${short(below(tried, 3))}` : short(below(window[1], 3));
  return window[0] > 0 ? `${short(above(window[0], 3))} to ${to}` : to;
};

const judgeLoop = (view, limits, setting, growth) => {
  const [latency, number] = [Number(setting.get("latency")), (key) => Number(setting.get(key) ?? 0)];
  const random = number("jitter") > 0 || number("loss") > 0;
  const without = random ? " Without jitter and losses it" : " It";
  let more = "";
  if (limits["latency.from"]) {
    const window = latencyWindow(limits, latency);
    if (window && Number.isNaN(window[0])) more = "";
    else if (!window) more = `${without} is unstable with every latency from 0 to ${short(single(limits, "latency.tried"))} s.`;
    else if (window[0] > 0) more = `${without} is stable with latencies of ${latencyText(limits, latency)} s, not below.`;
    else more = `${without} is stable up to a latency of ${latencyText(limits, latency)} s.`;
  }
  const marginal = Math.abs(growth) * number("period") < 1e-9;
  if (marginal) return { verdict: `At the edge: deviations from the ${view.point} neither grow nor decay exponentially.`, mark: "bad" };
  const ideal = single(view, "growth.ideal");
  const perfect = !random && latency === 0 && number("skew") === 0;
  const beside = perfect || Number.isNaN(ideal) || Math.abs(ideal) < 1e-9 ? "." : `; with perfect timing they ${times(ideal)}.`;
  const state = growth < 0 ? "Stable" : "Unstable";
  return { verdict: `${state}: deviations from the ${view.point} ${times(growth)}${beside}${more}`, mark: growth < 0 ? "ok" : "bad" };
};

const judgeMotion = (view, limits, setting, growth) => {
  const [exact, dt, limit] = [single(view, "growth.exact"), Number(setting.get("dt")), single(limits, "dt.stable")];
  const grows = growth * dt > 1e-9;
  if (exact * dt > 1e-9) {
    // The step is right where it grows as the system does: neither a success nor a fault.
    const own = grows ? times(growth) : "do not grow";
    return { verdict: `Unstable by nature: deviations from the ${view.point} ${times(exact)}; in these steps they ${own}.`, mark: grows ? "neutral" : "bad" };
  }
  let share = "";
  if (limit === Infinity) share = " No step up to 100 radians of the fastest mode is unstable.";
  else if (limit > 0 && dt <= limit) share = ` The largest stable step of ${setting.get("integrator")} is ${short(below(limit, 3))} s; this is ${short((100 * dt) / limit)} % of it.`;
  else if (limit > 0) share = ` Steps of ${setting.get("integrator")} are stable up to ${short(below(limit, 3))} s${grows ? "" : ", and again here"}.`;
  else if (limit === 0) share = " No step of this integrator is stable here.";
  if (grows) return { verdict: `Unstable: deviations from the ${view.point} ${times(growth)}, though those of the exact motion do not grow.${share}`, mark: "bad" };
  const away = leaves(view);
  return { verdict: `Stable: no deviation from the ${view.point} grows exponentially.${away}${share}`, mark: away ? "bad" : "ok" };
};

/** A sentence if the motion from the start runs away from the reference; empty else. */
const leaves = (view) => {
  const reference = Math.max(...view.states.split(" ").map((name) => Math.max(0, ...[...(view[`reference.${name}`] || [])].map(Math.abs))));
  const size = single(view, "size");
  const cut = single(view, "horizon") > 1.5 * (view.time[view.time.length - 1] || 0) + 2 * (view.time[1] || 0);
  return cut || (reference > 0 && size > 10 * reference) ? " But this motion, from its start, runs away." : "";
};

/** Rows of a quantity with its prediction and its measurement. */
const numberRows = (view, limits, setting) => {
  const get = (name) => format(single(view, name));
  const random = Number(setting.get("jitter")) > 0 || Number(setting.get("loss")) > 0;
  const error = single(view, "growth.error");
  const growth = (name) => format(growthOf(single(view, name)));
  const measured = growth("growth.measured") + (growthOf(error) > 0 ? ` ± ${error.toPrecision(1)}` : "");
  const of = view.kind === "loop" && random ? "growth of the rms deviation of many loops; measured with 128 (1/s)" : "growth of small deviations (1/s)";
  const rows = [[of, growth("growth.predicted"), measured]];
  if (view.kind === "motion") {
    if (view.energy.length) rows.push(["largest change of the energy", get("energy.predicted"), get("energy.largest")]);
    const limit = single(limits, "dt.stable");
    // A page may have another largest step: that of the simulator itself.
    const largest = `largest stable step of ${setting.get("integrator")} (s)`;
    const natural = single(view, "growth.exact") > 1e-9;
    if (!limits["dt.stable"]) rows.push([largest, "…", "—"]);
    else if (!Number.isNaN(limit) && !(natural && limit === 0)) rows.push([largest, limit === 0 ? "none" : format(below(limit)), "—"]);
  } else {
    const fresh = limits["latency.from"];
    rows.push(["stable up to a latency of (s)", fresh ? latencyText(limits, Number(setting.get("latency"))) : "…", "—"]);
    rows.push(["rise of the mean square of the states under noise", fresh ? format(single(limits, "cost.rise")) : "…", "—"]);
    rows.push(["steps in a period", "—", get("steps")]);
  }
  rows.push(["evaluations of the forces per simulated second, each step alone", get("evaluations"), "—"]);
  const [asked, shown] = [Number(setting.get("horizon")), single(view, "horizon")];
  if (shown < 0.5 * asked) rows.push(["time shown, of the time asked for (s)", "—", `${format(shown)} of ${format(asked)}`]);
  return rows;
};
