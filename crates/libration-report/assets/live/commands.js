// A setting as a file, as commands and as Python.

const quote = (text) => JSON.stringify(text);
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
      tables[table].push(`${tomlKey(name)} = ${value}`);
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

/** Whole numbers of a motion or a loop. */
const stepsOf = (setting, step) => Math.max(1, Math.round(Number(setting.get("horizon")) / Number(setting.get(step))));

/** The commands that compute the same in a terminal. */
const commandOf = (setting) => {
  const get = (key) => setting.get(key);
  const file = `cat > system.toml <<'END'\n${systemFile(setting)}END\n`;
  const step = `--integrator ${get("integrator")} --dt ${get("dt")}`;
  if (!hasLoop(setting)) {
    return (
      `${file}libration analyze --system system.toml ${step}\n` +
      `libration simulate --system system.toml ${step} --steps ${stepsOf(setting, "dt")} --output motion.csv\n`
    );
  }
  const rows = gainRows(setting).map((row) => row.join(",")).join(";");
  const positive = (key, option, text = (x) => x) => (Number(get(key) ?? 0) === 0 ? "" : ` ${option} ${text(get(key))}`);
  const timing =
    `--gain="${rows}" --period ${get("period")} --latency ${get("latency") ?? 0}` +
    positive("jitter", "--jitter", (x) => `gaussian:${x}`) +
    positive("loss", "--loss");
  const skew = positive("skew", "--skew=").replace("= ", "=");
  // A slow clock makes periods longer, and latencies and simulations with them.
  const simulated = Number(get("skew") ?? 0) === 0 ? `libration simulate --system system.toml ${timing} ${step}` +
    ` --seed ${get("seed") ?? 0} --steps ${stepsOf(setting, "period")} --output loop.csv\n` : "";
  return `${file}libration advise --system system.toml ${timing}${skew}\n${simulated}`;
};

/** The same in Python. */
const pythonOf = (setting) => {
  const get = (key) => setting.get(key);
  const begin =
    `import libration\n\nwith open("system.toml", "w") as file:\n    file.write('''${systemFile(setting)}''')\n` +
    `system = libration.System.from_toml("system.toml")\n`;
  if (!hasLoop(setting)) {
    const call = `system, integrator=${quote(get("integrator"))}, dt=${get("dt")}`;
    return (
      `${begin}print(libration.analyze(${call}))\n` +
      `motion = libration.simulate(${call}, steps=${stepsOf(setting, "dt")})\n`
    );
  }
  const rows = gainRows(setting).map((row) => `[${row.join(", ")}]`).join(", ");
  const some = (key, name, text = (x) => x) => (Number(get(key) ?? 0) === 0 ? "" : `, ${name}=${text(get(key))}`);
  return (
    `${begin}plant = libration.LinearPlant.from_system(system)\n` +
    `advice = libration.advise(plant, gain=[${rows}], period=${get("period")}, latency=${get("latency") ?? 0}` +
    `${some("jitter", "jitter", (x) => `("gaussian", ${x})`)}${some("skew", "skew")}${some("loss", "loss")})\nprint(advice)\n`
  );
};
