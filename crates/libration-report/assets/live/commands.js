// A setting as a file, as commands and as Python.

// Whatever a link brought: texts are quoted for the language that they stand in, and all else is a number or a known name.

const quote = (text) => JSON.stringify(text);
const numberOf = (setting, key) => String(Number(setting.get(key) ?? 0));
const nameOf = (setting) => setting.get("integrator").replace(/[^a-z0-9-]/g, "");
/** A text between triple quotes of Python. */
const pythonText = (text) => `"""${text.replaceAll("\\", "\\\\").replaceAll('"', '\\"')}"""`;
const tomlKey = (name) => (/^[A-Za-z0-9_-]+$/.test(name) ? name : quote(name));

/** The file of the system. */
const systemFile = (setting) => {
  const lines = ["[system]", `name = ${quote(setting.get("system") || "system")}`];
  const tables = { parameter: [], start: [] };
  for (const [key, value] of setting) {
    const [table, name] = [key.slice(0, key.indexOf(".")), key.slice(key.indexOf(".") + 1)];
    if (key === "coordinates" || key === "inputs") {
      lines.push(`${key} = [${value.split(",").filter(Boolean).map((own) => quote(own.trim())).join(", ")}]`);
    } else if (key === "energy") {
      lines.push(`energy = ${quote(value)}`);
    } else if (["acceleration", "rate", "let"].includes(table)) {
      lines.push(`${table}.${tomlKey(name)} = ${quote(value)}`);
    } else if (table in tables) {
      tables[table].push(`${tomlKey(name)} = ${Number(value)}`);
    }
  }
  if (tables.parameter.length) lines.push(`parameters = { ${tables.parameter.join(", ")} }`);
  if (tables.start.length) lines.push(`start = { ${tables.start.join(", ")} }`);
  return `${lines.join("\n")}\n`;
};

const gainRows = (setting) => {
  const factor = Number(setting.get("gain-factor") ?? 1);
  return setting.get("gain").split(";").map((row) => row.split(",").map((x) => Number(x) * factor));
};

const hasLoop = (setting) => Boolean(setting.get("gain"));

/** The longest step that is taken: that of the setting, and in a loop at most a period, at whose ends commands change. */
const stepTaken = (setting) => {
  const [dt, period] = ["dt", "period"].map((key) => Number(setting.get(key) ?? LOOP_DEFAULTS[key]));
  return hasLoop(setting) ? Math.min(dt, period) : dt;
};

/** Why a time step is not taken as it stands; empty if it is. */
const stepProblem = (setting) => {
  const taken = stepTaken(setting);
  return Number(setting.get("dt")) > taken ? `longer than the period; the loop takes steps of ${taken} s` : "";
};

/** Whole numbers of a motion or a loop. */
const stepsOf = (setting, step) => Math.min(1e9, Math.max(1, Math.round(Number(setting.get("horizon")) / Number(setting.get(step)))));

/** The commands that compute the same in a terminal. */
const commandOf = (setting) => {
  const number = (key) => numberOf(setting, key);
  const file = `cat > system.toml <<'END'\n${systemFile(setting)}END\n`;
  const step = `--integrator ${nameOf(setting)} --dt ${stepTaken(setting)}`;
  if (!hasLoop(setting)) {
    return (
      `${file}libration analyze --system system.toml ${step}\n` +
      `libration simulate --system system.toml ${step} --steps ${stepsOf(setting, "dt")} --output motion.csv\n`
    );
  }
  const rows = gainRows(setting).map((row) => row.join(",")).join(";");
  const some = (key, option) => (number(key) === "0" ? "" : ` ${option}${number(key)}`);
  const timing =
    `--gain="${rows}" --period ${number("period")} --latency ${number("latency")}` +
    some("jitter", "--jitter gaussian:") +
    some("loss", "--loss ");
  const advise = `libration advise --system system.toml ${timing}${some("skew", "--skew=")}\n`;
  // The simulation of one loop has no skew.
  if (number("skew") !== "0") return file + advise;
  return (
    `${file}${advise}libration simulate --system system.toml ${timing} ${step}` +
    ` --seed ${number("seed")} --steps ${stepsOf(setting, "period")} --output loop.csv\n`
  );
};

/** The same in Python. */
const pythonOf = (setting) => {
  const number = (key) => numberOf(setting, key);
  const begin =
    `import libration\n\nwith open("system.toml", "w") as file:\n    file.write(${pythonText(systemFile(setting))})\n` +
    `system = libration.System.from_toml("system.toml")\n`;
  if (!hasLoop(setting)) {
    const call = `system, integrator=${quote(nameOf(setting))}, dt=${number("dt")}`;
    return (
      `${begin}print(libration.analyze(${call}))\n` +
      `motion = libration.simulate(${call}, steps=${stepsOf(setting, "dt")})\n`
    );
  }
  const rows = gainRows(setting).map((row) => `[${row.join(", ")}]`).join(", ");
  const some = (key, text) => (number(key) === "0" ? "" : `, ${text(number(key))}`);
  return (
    `${begin}advice = libration.advise(\n    system, libration.StateFeedback([${rows}]), period=${number("period")}, latency=${number("latency")}` +
    `${some("jitter", (x) => `jitter=("gaussian", ${x})`)}${some("skew", (x) => `skew=${x}`)}${some("loss", (x) => `loss=${x}`)},\n)\nprint(advice)\n`
  );
};
