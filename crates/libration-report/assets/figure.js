// Every figure is drawn as SVG from the start. On request it becomes a drawing to look into.
(() => {
  "use strict";
  let ready;

  // The text of an element that holds it compressed, in base64.
  const decompressed = (id, format) => {
    const bytes = Uint8Array.from(atob(document.getElementById(id).textContent), (c) => c.charCodeAt(0));
    return new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream(format))).text();
  };

  // Plotly is part of the page and is decompressed once.
  const plotly = () => (ready ??= (async () => {
    const script = document.createElement("script");
    script.textContent = await decompressed("plotly", "gzip");
    document.head.append(script);
    return globalThis.Plotly;
  })());

  const probe = document.createElement("span");
  probe.hidden = true;

  // "var(--rk4)" and "var(--rk4)/0.16" become the colour that the stylesheet now gives,
  // "light(--rk4)" the one it gives in the light.
  const color = (text) => {
    const match = /^(var|light)\((--[\w-]+)\)(?:\/([\d.]+))?$/.exec(text);
    if (!match) return text;
    const [, kind, name, opacity] = match;
    probe.style.colorScheme = kind === "light" ? "light" : "";
    probe.style.color = `var(${name})`;
    const rgb = getComputedStyle(probe).color;
    return opacity ? rgb.replace(/^rgba?\(([^,]+,[^,]+,[^,)]+).*$/, `rgba($1, ${opacity})`) : rgb;
  };

  const LENGTHS = new Set(["size", "width", "height", "xshift", "yshift", "thickness", "len", "ticklen", "ticklabelstandoff", "ax", "ay"]);

  // The description for the colours and the width of now.
  const resolved = (value, scale, key) => {
    if (typeof value === "string") {
      if (key === "dash" && value.includes("px")) {
        return value.split(",").map((length) => `${parseFloat(length) * scale}px`).join(",");
      }
      return color(value);
    }
    if (typeof value === "number") return LENGTHS.has(key) ? value * scale : value;
    if (Array.isArray(value)) {
      return typeof value[0] === "object" && value[0] !== null && !Array.isArray(value[0])
        ? value.map((item) => resolved(item, scale)) : value;
    }
    if (value === null || typeof value !== "object") return value;
    return Object.fromEntries(Object.entries(value).map(([k, v]) => [k, resolved(v, scale, k)]));
  };

  class Figure {
    constructor(element) {
      this.element = element;
      this.canvas = element.querySelector(".canvas");
      this.svg = element.querySelector("svg.plot");
      this.tools = document.createElement("div");
      this.tools.className = "tools";
      this.title = this.svg.querySelector("title").textContent;
      this.toggle = this.button("Explore", () => (this.live ? this.leave() : this.enter()));
      this.reset = this.button("Reset", () => this.home());
      this.reset.hidden = true;
      this.reading = document.createElement("span");
      this.reading.className = "reading";
      this.reading.setAttribute("aria-live", "polite");
      this.tools.append(this.reading);
      this.canvas.after(this.tools);
    }

    button(text, act) {
      const button = document.createElement("button");
      button.type = "button";
      this.label(button, text);
      button.addEventListener("click", act);
      this.tools.append(button);
      return button;
    }

    // A page has many such buttons: read out, each says whose it is.
    label(button, text) {
      button.textContent = text;
      button.setAttribute("aria-label", `${text}: ${this.title}`);
    }

    // Where the window is narrower than the figure, the keys must be able to move it.
    fit() {
      const wider = this.canvas.scrollWidth > this.canvas.clientWidth;
      if (wider) {
        this.canvas.tabIndex = 0;
        this.canvas.setAttribute("role", "group");
        this.canvas.setAttribute("aria-label", `Scrolls sideways: ${this.title}`);
      } else {
        for (const name of ["tabindex", "role", "aria-label"]) this.canvas.removeAttribute(name);
      }
    }

    // The description, which is decompressed once.
    async load() {
      this.source ??= JSON.parse(await decompressed(`data-${this.element.dataset.figure}`, "deflate"));
    }

    // The drawing as wide as the SVG that it covers.
    drawing() {
      const { width } = this.svg.getBoundingClientRect();
      this.width = width;
      const scale = width / this.source.layout.width;
      const { data, layout } = resolved(this.source, scale);
      return { data, layout };
    }

    axes() {
      return Object.keys(this.start.layout).filter((key) => /^[xy]axis\d*$/.test(key));
    }

    async enter() {
      this.toggle.disabled = true;
      const [Plotly] = await Promise.all([plotly(), this.load()]);
      const live = document.createElement("div");
      live.className = "live";
      live.tabIndex = 0;
      live.setAttribute("role", "application");
      live.setAttribute("aria-label",
        `${this.title} Arrow keys step through points and lines, plus and minus zoom, 0 resets, Escape returns.`);
      this.canvas.append(live);
      this.start = this.drawing();
      const config = { displayModeBar: false, doubleClick: false, showTips: false, scrollZoom: false };
      await Plotly.newPlot(live, this.start.data, structuredClone(this.start.layout), config);
      this.live = live;
      this.element.classList.add("exploring");
      live.on("plotly_relayout", (change) => this.zoomed(change));
      live.on("plotly_doubleclick", () => this.home());
      live.addEventListener("keydown", (event) => this.key(event));
      this.label(this.toggle, "Done");
      this.toggle.disabled = false;
      this.say("Drag to zoom, double-click to reset.");
      live.focus({ preventScroll: true });
      this.point = null;
    }

    leave() {
      globalThis.Plotly.purge(this.live);
      this.live.remove();
      this.live = null;
      this.element.classList.remove("exploring");
      this.label(this.toggle, "Explore");
      this.reset.hidden = true;
      this.say("");
      this.toggle.focus({ preventScroll: true });
    }

    say(text) {
      this.reading.textContent = text;
    }

    // Ticks are those of the SVG until the reader zooms; then they follow.
    zoomed(change) {
      const ticks = {};
      for (const key of Object.keys(change)) {
        const axis = /^([xy]axis\d*)\.range/.exec(key)?.[1];
        if (!axis) continue;
        const { type, range: [low, high] } = this.live.layout[axis];
        const decades = type === "log" ? Math.abs(high - low) : 0;
        ticks[`${axis}.tickmode`] = decades > 1.5 ? "linear" : "auto";
        if (decades > 1.5) Object.assign(ticks, { [`${axis}.tick0`]: 0, [`${axis}.dtick`]: Math.ceil(decades / 9) });
        else ticks[`${axis}.dtick`] = null;
        // Plotly writes powers larger than the numbers beside them.
        const { size } = this.start.layout[axis].tickfont;
        ticks[`${axis}.tickfont.size`] = decades > 1.5 ? size / 1.25 : size;
      }
      if (Object.keys(ticks).length === 0) return;
      this.reset.hidden = false;
      globalThis.Plotly.relayout(this.live, ticks);
    }

    home() {
      const home = {};
      for (const axis of this.axes()) {
        home[`${axis}.tickmode`] = "array";
        home[`${axis}.dtick`] = null;
        home[`${axis}.tickfont.size`] = this.start.layout[axis].tickfont.size;
        home[`${axis}.range[0]`] = this.start.layout[axis].range[0];
        home[`${axis}.range[1]`] = this.start.layout[axis].range[1];
      }
      this.reset.hidden = true;
      this.live.removeAllListeners("plotly_relayout");
      globalThis.Plotly.relayout(this.live, home)
        .then(() => this.live?.on("plotly_relayout", (change) => this.zoomed(change)));
    }

    zoom(factor) {
      const change = {};
      for (const axis of this.axes()) {
        const [low, high] = this.live.layout[axis].range;
        const [middle, half] = [(low + high) / 2, ((high - low) / 2) * factor];
        change[`${axis}.range[0]`] = middle - half;
        change[`${axis}.range[1]`] = middle + half;
      }
      globalThis.Plotly.relayout(this.live, change);
    }

    key(event) {
      const moves = { ArrowRight: [0, 1], ArrowLeft: [0, -1], ArrowDown: [1, 0], ArrowUp: [-1, 0] };
      if (moves[event.key]) this.step(...moves[event.key]);
      else if (event.key === "+" || event.key === "=") this.zoom(0.7);
      else if (event.key === "-") this.zoom(1 / 0.7);
      else if (event.key === "0" || event.key === "Home") this.home();
      else if (event.key === "Escape") this.leave();
      else return;
      event.preventDefault();
    }

    // Reads the next point of the line, or the next line.
    step(lines, points) {
      const data = this.start.data;
      const usable = data.map((_, i) => i).filter((i) => data[i].type === "scatter" && data[i].hoverinfo !== "skip" && data[i].x.length);
      if (!usable.length) return;
      this.point ??= { line: 0, share: 0 };
      const at = this.point;
      at.line = (at.line + lines + usable.length) % usable.length;
      const curve = usable[at.line];
      const { x, y } = data[curve];
      let index = Math.round(at.share * (x.length - 1)) + points * Math.max(1, Math.round(x.length / 100));
      index = Math.min(x.length - 1, Math.max(0, index));
      at.share = x.length > 1 ? index / (x.length - 1) : 0;
      const subplot = data[curve].xaxis + data[curve].yaxis;
      globalThis.Plotly.Fx.hover(this.live, [{ curveNumber: curve, pointNumber: index }], [subplot]);
      const digits = (value) => (value === null ? "none" : Number(value.toPrecision(8)).toString());
      const name = new DOMParser().parseFromString(data[curve].name, "text/html").body.textContent;
      this.say(`${name}${name ? ": " : ""}x = ${digits(x[index])}, y = ${digits(y[index])}`);
    }

    // Other colours or another width: the same view, drawn again.
    redraw() {
      if (!this.live) return;
      const view = this.axes().map((axis) => {
        const { range, tickmode, tick0, dtick, tickfont } = this.live.layout[axis];
        const shrunk = tickfont.size / this.start.layout[axis].tickfont.size;
        return [axis, { range: [...range], tickmode, tick0, dtick }, shrunk];
      });
      this.start = this.drawing();
      const layout = structuredClone(this.start.layout);
      for (const [axis, kept, shrunk] of view) {
        Object.assign(layout[axis], kept);
        layout[axis].tickfont.size *= shrunk;
      }
      globalThis.Plotly.react(this.live, this.start.data, layout);
    }
  }

  document.body.append(probe);
  const figures = [...document.querySelectorAll("figure[data-figure]")].map((element) => {
    const figure = new Figure(element);
    const wide = new ResizeObserver(() => {
      figure.fit();
      if (figure.live && Math.abs(figure.svg.getBoundingClientRect().width - figure.width) > 0.5) figure.redraw();
    });
    wide.observe(figure.svg);
    wide.observe(figure.canvas);
    // Unpack while the reader is on the way to the button.
    element.addEventListener("pointerenter", () => void plotly(), { once: true });
    return figure;
  });
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => figures.forEach((f) => f.redraw()));
})();
