// Plots over time with uPlot: the last half minute of a live run, or the whole of a recorded one.
import uPlot from "uplot";
import { h } from "./dom.js";
import { C } from "./run.js";
import { say, saying, t } from "./strings.js";
import { onTheme, palette } from "./theme.js";

const WINDOW_S = 30;
const MOST_POINTS = 1500;
const EVERY_MS = 250;

const PLOTS = [
  { title: "v [m/s]", series: [["commanded", C.sent_v, "soft"], ["measured", C.v, "path"]] },
  { title: "ω [rad/s]", series: [["commanded", C.sent_w, "soft"], ["measured", C.w, "path"]] },
  { title: ["clearance", "[m]"], series: [["clearance", C.clearance, "goal"]], zero: true },
  { title: ["crossTrack", "[m]"], series: [["crossTrack", C.cross_track, "mover"]], zero: true },
  { title: "[ms]", series: [["planning", C.plan_ms, "scan"], ["tick", C.tick_ms, "path"]], zero: true },
];

const named = (title) => (Array.isArray(title) ? `${t(title[0])} ${title[1]}` : title);

class Plot {
  constructor(spec, height, seek) {
    this.spec = spec;
    this.height = height;
    this.seek = seek;
    this.cursor = null;
    const keys = spec.series.map(([name, , color]) => h("span", { class: `key key-${color}` }, say(name)));
    this.holder = h("div", { class: "plot-area" });
    const label = saying(() => `${named(spec.title)}: ${spec.series.map(([name]) => t(name)).join(", ")}`);
    this.element = h("figure", { class: "plot", role: "img", "aria-label": label }, h("figcaption", {}, h("span", {}, saying(() => named(spec.title))), ...keys), this.holder);
  }

  make(width) {
    this.plot?.destroy();
    const look = palette();
    const axis = { stroke: look.soft, grid: { stroke: look.line, width: 1 }, ticks: { show: false }, font: "11px system-ui, sans-serif" };
    this.plot = new uPlot(
      {
        width,
        height: this.height,
        legend: { show: false },
        cursor: { show: Boolean(this.seek), x: true, y: false, drag: { x: false, y: false }, points: { show: false } },
        scales: { x: { time: false }, y: { range: (_, low, high) => this.range(low, high) } },
        axes: [{ ...axis, size: 22, space: 60, values: (_, ticks) => ticks.map((value) => `${value}`) }, { ...axis, size: 44, space: 24 }],
        series: [{}, ...this.spec.series.map(([, , color]) => ({ stroke: look[color], width: 1.6, spanGaps: false, points: { show: false } }))],
        hooks: { draw: [(plot) => this.drawCursor(plot, look)] },
      },
      this.data ?? [[], ...this.spec.series.map(() => [])],
      this.holder,
    );
    if (this.seek) this.plot.over.addEventListener("click", () => this.seek(this.plot.posToVal(this.plot.cursor.left, "x")));
    this.width = width;
  }

  range(low, high) {
    if (!Number.isFinite(low) || !Number.isFinite(high)) return [0, 1];
    const margin = Math.max((high - low) * 0.08, 0.02);
    return [this.spec.zero ? 0 : low - margin, high + margin];
  }

  drawCursor(plot, look) {
    if (this.cursor === null || !plot.data[0].length) return;
    const x = plot.valToPos(this.cursor, "x", true);
    plot.ctx.fillStyle = look.ink;
    plot.ctx.fillRect(x, plot.bbox.top, devicePixelRatio, plot.bbox.height);
  }

  show(data, window) {
    this.data = data;
    const width = Math.floor(this.holder.clientWidth);
    if (!width) return;
    if (!this.plot || width !== this.width) this.make(width);
    this.plot.setData(data, false);
    this.plot.setScale("x", { min: window[0], max: window[1] });
  }

  mark(time) {
    if (time === this.cursor) return;
    this.cursor = time;
    this.plot?.redraw(false, false);
  }
}

/** The columns of some rows, thinned to what a plot can show; the largest excursions of a stretch are kept. */
function columns(rows, from, to, indices) {
  const every = Math.max(1, Math.ceil((to - from) / MOST_POINTS));
  const out = [[], ...indices.map(() => [])];
  for (let i = from; i < to; i += every) {
    out[0].push(rows[i][C.t]);
    indices.forEach((column, k) => {
      let kept = rows[i][column] ?? null;
      for (let j = i + 1; j < Math.min(i + every, to); j++) {
        const value = rows[j][column];
        if (value !== null && value !== undefined && (kept === null || Math.abs(value) > Math.abs(kept))) kept = value;
      }
      out[k + 1].push(kept);
    });
  }
  return out;
}

export class Plots {
  constructor(app, { height = 110, seek = null } = {}) {
    this.app = app;
    this.whole = seek !== null;
    this.drawn = 0;
    this.plots = PLOTS.map((spec) => new Plot(spec, height, seek));
    this.element = h("div", { class: "plots" }, ...this.plots.map((plot) => plot.element));
    onTheme(() => {
      for (const plot of this.plots) plot.width = null;
      this.stale = true;
    });
    new ResizeObserver(() => (this.stale = true)).observe(this.element);
    this.stale = true;
  }

  /** Draws the plots where it is time to; `state` is what the page shows. */
  show(state, now) {
    const rows = this.app.run.rows;
    if (this.whole) for (const plot of this.plots) plot.mark(state.t);
    const due = this.stale || (!this.whole && rows.length !== this.count && now - this.drawn > EVERY_MS);
    if (!due) return;
    this.drawn = now;
    this.count = rows.length;
    this.stale = false;
    const end = rows.length ? rows[rows.length - 1][C.t] : 0;
    const window = this.whole ? [0, Math.max(end, 1)] : [Math.max(0, end - WINDOW_S), Math.max(end, WINDOW_S)];
    let from = rows.length;
    while (from > 0 && rows[from - 1][C.t] >= window[0]) from--;
    for (const plot of this.plots) plot.show(columns(rows, from, rows.length, plot.spec.series.map(([, column]) => column)), window);
  }
}
