// The engine: a WebAssembly module in a worker, and settings as lists of entries.

/** The time in ms after which an answer is given up. */
const PATIENCE = 4000;
/** The same for the first answer, before which the browser compiles the engine. */
const FIRST_PATIENCE = 20000;

/** What the worker runs: it answers one request after the other. */
const workerProgram = () => {
  let engine;
  onmessage = async ({ data }) => {
    if (data.bytes) {
      engine = WebAssembly.instantiate(data.bytes, {}).then(({ instance }) => instance.exports);
      return;
    }
    const { memory, request, answer } = await engine;
    const bytes = new TextEncoder().encode(data.text);
    const place = request(bytes.length);
    new Uint8Array(memory.buffer, place, bytes.length).set(bytes);
    const begin = answer();
    const length = new DataView(memory.buffer).getUint32(begin, true);
    const reply = memory.buffer.slice(begin + 4, begin + 4 + length);
    postMessage({ number: data.number, reply }, [reply]);
  };
};

/** An engine in a worker of its own. Whatever it computes, the page stays awake; what takes too long is given up. */
class Engine {
  constructor(bytes) {
    this.bytes = bytes;
    this.waiting = new Map();
    this.count = 0;
    this.start();
  }
  start() {
    const source = URL.createObjectURL(new Blob([`(${workerProgram})()`], { type: "text/javascript" }));
    this.worker = new Worker(source);
    URL.revokeObjectURL(source);
    this.worker.onmessage = ({ data }) => this.settle(data.number, readAnswer(data.reply));
    // A request that fails in the engine is answered, too.
    this.worker.onerror = () => this.restart("the engine failed on this setting");
    this.worker.postMessage({ bytes: this.bytes });
  }
  restart(error) {
    this.worker.terminate();
    this.start();
    for (const number of [...this.waiting.keys()]) this.settle(number, { error });
  }
  settle(number, answer) {
    const own = this.waiting.get(number);
    if (!own) return;
    clearTimeout(own.timer);
    this.waiting.delete(number);
    own.done(answer);
  }
  /** The answer to a request; one with an `error` if it takes too long. */
  ask(text, patience = PATIENCE, late = "this setting takes too long for a page; the commands below have no such limit") {
    return new Promise((done) => {
      const number = ++this.count;
      const timer = setTimeout(() => this.restart(late), patience);
      this.waiting.set(number, { done, timer });
      this.worker.postMessage({ number, text });
    });
  }
}

/** The module in the page. */
const loadModule = async () => {
  const text = document.getElementById("live-engine").textContent.trim();
  const packed = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(unpacked).arrayBuffer();
};

/** Texts, and columns of numbers, by their names. */
const readAnswer = (bytes) => {
  const length = new DataView(bytes).getUint32(0, true);
  const head = new TextDecoder().decode(new Uint8Array(bytes, 4, length));
  const numbers = new Float64Array(bytes, 4 + length);
  const answer = { bytes };
  let begin = 0;
  for (const line of head.split("\n")) {
    const [kind, name, ...rest] = line.split(" ");
    if (kind === "text") answer[name] = rest.join(" ");
    if (kind === "column") {
      answer[name] = numbers.subarray(begin, begin + Number(rest[0]));
      begin += Number(rest[0]);
    }
  }
  return answer;
};

/** The number of a column of one; NaN without it. */
const single = (answer, name) => (answer[name] && answer[name].length ? answer[name][0] : NaN);

const SYSTEM_KEY = /^(system|coordinates|inputs|energy)$|^(acceleration|rate|let|parameter|start)\.[A-Za-z_][A-Za-z0-9_]*'?$/;
const isSystemKey = (key) => SYSTEM_KEY.test(key);
const NUMBER_KEY = /^(dt|horizon|gain-factor|period|latency|jitter|skew|loss|seed)$|^(parameter|start)\./;
const STEP_KEYS = { integrator: "velocity-verlet", dt: "0.01", horizon: "10" };

/** A setting as a map from keys to texts, in order, and what is wrong with its lines. Missing numbers have their defaults. */
const settingOf = (entries) => {
  const setting = new Map();
  let error = "";
  for (const [key, text] of entries) {
    const value = text.replace(/[\r\n]/g, " ").trim();
    const known = isSystemKey(key) || key in STEP_KEYS || LOOP_KEYS.includes(key);
    const number = NUMBER_KEY.test(key) ? Number(value) : 0;
    if (!known) error ||= `unknown key \`${key}\``;
    else if (!Number.isFinite(number) || value === "") error ||= `${key} = ${value}; expected a number`;
    else if (setting.has(key)) error ||= `\`${key}\` is given twice`;
    else setting.set(key, value);
  }
  for (const [key, value] of Object.entries(STEP_KEYS)) if (!setting.has(key)) setting.set(key, value);
  return { setting, error };
};

/** The entries of lines `key=value`; a line that is none has the whole of it as its key. */
const entriesOf = (text) =>
  text
    .split("\n")
    .filter((line) => line.trim())
    .map((line) => {
      const end = line.indexOf("=");
      return end < 0 ? [line.trim(), ""] : [line.slice(0, end).trim(), line.slice(end + 1).trim()];
    });

const parseSetting = (text) => settingOf(entriesOf(text)).setting;

const settingText = (setting) => [...setting].map(([key, value]) => `${key}=${value}`).join("\n");

/** The setting in the fragment of a link, and what is wrong with it; null if the fragment is another. */
const settingOfLink = (fragment) => {
  if (!fragment.startsWith("#live&")) return null;
  const entries = [...new URLSearchParams(fragment.slice(6))];
  return entries.length ? settingOf(entries) : null;
};

const linkOfSetting = (setting) => `#live&${new URLSearchParams([...setting])}`;

/** The names of the states: coordinates, velocities, and states of first order. */
const statesOf = (setting) => {
  const coordinates = (setting.get("coordinates") || "").split(",").map((name) => name.trim()).filter(Boolean);
  const rates = [...setting.keys()].filter((key) => key.startsWith("rate.")).map((key) => key.slice(5));
  return [...coordinates, ...coordinates.map((name) => `${name}'`), ...rates];
};

const LOOP_KEYS = ["gain", "gain-factor", "period", "latency", "jitter", "skew", "loss", "seed"];
const LOOP_DEFAULTS = { "gain-factor": "1", period: "0.01", latency: "0", jitter: "0", skew: "0", loss: "0", seed: "0" };
const SECONDS = new Set(["dt", "horizon", "period", "latency"]);

/** A number with three digits, for sentences. */
const short = (x) => format(x, 3);

/** A number with so many digits. */
const format = (x, digits = 4) => {
  if (Number.isNaN(x)) return "—";
  if (x === Infinity) return "∞";
  const size = Math.abs(x);
  if (x !== 0 && (size < 1e-3 || size >= 1e5)) return x.toExponential(2).replace("e+", "e");
  return String(Number(x.toPrecision(digits)));
};

/** An upper limit with so many digits, not above itself: cut off behind the twelve digits that a search has. */
const below = (limit, digits = 4) => {
  if (!Number.isFinite(limit) || limit === 0) return limit;
  const [mantissa, exponent] = limit.toExponential(11).split("e");
  return Number(`${mantissa.slice(0, digits + 1 + (limit < 0 ? 1 : 0))}e${exponent}`);
};

/** A lower limit above zero with so many digits, not below itself. */
const above = (limit, digits = 4) => {
  const cut = below(limit, digits);
  if (!Number.isFinite(limit) || limit <= 0 || limit - cut <= 1e-11 * limit) return cut;
  return Number((cut + 10 ** (Math.floor(Math.log10(limit)) + 1 - digits)).toPrecision(digits));
};

/** A number, of seconds also with a unit as in 2ms or 500Hz; NaN if it is none. */
const parseNumber = (text, key) => {
  const match = /^\s*([-+]?[\d.]+(?:e[-+]?\d+)?)\s*([a-zµ]*)\s*$/i.exec(text);
  if (!match) return NaN;
  const number = Number(match[1]);
  if (!match[2]) return number;
  if (!SECONDS.has(key)) return NaN;
  const parts = { ns: 1e9, us: 1e6, µs: 1e6, ms: 1e3, s: 1, min: 1 / 60, h: 1 / 3600 };
  const rates = { hz: 1, khz: 1e3 };
  const unit = match[2].toLowerCase();
  if (unit in parts) return number / parts[unit];
  return unit in rates ? 1 / (number * rates[unit]) : NaN;
};
