// The engine: a WebAssembly module with two functions, and settings as lists of entries.

/** Compiles the module in the page. Returns a function from a request to its answer. */
const loadEngine = async () => {
  const text = document.getElementById("live-engine").textContent.trim();
  const packed = Uint8Array.from(atob(text), (character) => character.charCodeAt(0));
  const unpacked = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = await new Response(unpacked).arrayBuffer();
  const { instance } = await WebAssembly.instantiate(bytes, {});
  const { memory, request, answer } = instance.exports;
  return (text) => {
    const bytes = new TextEncoder().encode(text);
    const place = request(bytes.length);
    new Uint8Array(memory.buffer, place, bytes.length).set(bytes);
    const begin = answer();
    const length = new DataView(memory.buffer).getUint32(begin, true);
    return readAnswer(memory.buffer.slice(begin + 4, begin + 4 + length));
  };
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

/** A setting as a map from keys to texts, in order. */
const parseSetting = (text) =>
  new Map(
    text
      .split("\n")
      .filter((line) => line.includes("="))
      .map((line) => [line.slice(0, line.indexOf("=")).trim(), line.slice(line.indexOf("=") + 1).trim()]),
  );

const settingText = (setting) => [...setting].map(([key, value]) => `${key}=${value}`).join("\n");

/** The setting in the fragment of a link; null if the fragment is another. */
const settingOfLink = (fragment) => {
  if (!fragment.startsWith("#live&")) return null;
  const entries = [...new URLSearchParams(fragment.slice(6))].map(([key, value]) => [key, value.replace(/[\r\n]/g, " ")]);
  return entries.length ? new Map(entries) : null;
};

const linkOfSetting = (setting) => `#live&${new URLSearchParams([...setting])}`;

/** The names of the states: coordinates, velocities, and states of first order. */
const statesOf = (setting) => {
  const coordinates = (setting.get("coordinates") || "").split(",").map((name) => name.trim()).filter(Boolean);
  const rates = [...setting.keys()].filter((key) => key.startsWith("rate.")).map((key) => key.slice(5));
  return [...coordinates, ...coordinates.map((name) => `${name}'`), ...rates];
};

const LOOP_KEYS = ["gain", "gain-factor", "period", "latency", "jitter", "skew", "loss", "seed"];
const SECONDS = new Set(["dt", "horizon", "period", "latency"]);
const isSystemKey = (key) => /^(system|coordinates|inputs|energy)$|^(acceleration|rate|let|parameter|start)\./.test(key);

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
