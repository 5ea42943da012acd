// A run as the page knows it: rows, paths and events in order of time, each lossless.
import { array } from "./decode.js";

// The order of a row's values: page.COLUMNS of the package.
export const COLUMNS = [
  "t", "x", "y", "yaw", "v", "w", "cmd_v", "cmd_w", "sent_v", "sent_w", "clearance", "cross_track",
  "goal", "status", "tick_ms", "plan_ms", "left", "right", "ex", "ey", "eyaw", "state",
];
export const C = Object.fromEntries(COLUMNS.map((name, i) => [name, i]));

export const wrap = (angle) => Math.atan2(Math.sin(angle), Math.cos(angle));
const mix = (a, b, s) => a + (b - a) * s;

/** The index of the last item whose time is at most `t`, or -1. */
export function lastAt(items, t, time = (item) => item.t) {
  let low = 0;
  let high = items.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (time(items[middle]) <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

export class Run {
  constructor(info = {}, n = 0, orders = null) {
    this.info = info;
    this.n = n;
    this.orders = orders; // The number of the run that orders carry.
    this.rows = [];
    this.paths = [];
    this.events = [];
    this.goals = (info.goals ?? []).slice();
    this.end = null;
  }

  get duration() {
    return this.rows.length ? this.rows[this.rows.length - 1][C.t] : 0;
  }

  /** Adds a part of the log; one that overlaps replaces what it repeats. */
  add({ from, rows = [], paths = [], events = [] }) {
    if (from === 0) {
      this.rows.length = 0;
      this.paths.length = 0;
      this.events.length = 0;
    } else if (from !== undefined && from < this.rows.length) this.rows.length = from;
    for (const row of rows) this.rows.push(row);
    for (const { t, points } of paths) this.paths.push({ t, points: array(points) });
    for (const event of events) this.events.push(event);
  }

  /** The state at time `t`, between two rows: pose, wheel angles, row, index, path. */
  at(t) {
    const { rows } = this;
    if (!rows.length) {
      const start = this.info.start;
      return { t: 0, index: -1, row: null, path: null, pose: start ?? null, wheels: [0, 0] };
    }
    const index = Math.max(0, lastAt(rows, t, (row) => row[C.t]));
    const a = rows[index];
    const b = rows[Math.min(index + 1, rows.length - 1)];
    const span = b[C.t] - a[C.t];
    const s = span > 0 ? Math.min(1, Math.max(0, (t - a[C.t]) / span)) : 0;
    const pose = [mix(a[C.x], b[C.x], s), mix(a[C.y], b[C.y], s), a[C.yaw] + wrap(b[C.yaw] - a[C.yaw]) * s];
    const wheels = [mix(a[C.left] ?? 0, b[C.left] ?? 0, s), mix(a[C.right] ?? 0, b[C.right] ?? 0, s)];
    const path = this.paths[lastAt(this.paths, t + 1e-9)]?.points ?? null;
    const held = (row) => Number.isFinite(row[C.ex]);
    const estimate = held(a) ? (held(b) ? [mix(a[C.ex], b[C.ex], s), mix(a[C.ey], b[C.ey], s), a[C.eyaw] + wrap(b[C.eyaw] - a[C.eyaw]) * s] : [a[C.ex], a[C.ey], a[C.eyaw]]) : null;
    return { t, index, row: a, path, pose, wheels, estimate };
  }

  /** Whether its localizer can look for the robot on the whole map: those that follow it cannot. */
  get canSearch() {
    return !["slam", "odometry"].includes(this.info.localizer);
  }

  /** Whether the robot has a localizer, which can be told where it is. */
  get isLocalized() {
    return (this.info.localizer ?? "none") !== "none";
  }
}

/** Whether an estimate is so far from the true pose that both can be seen. */
export const isApart = (pose, estimate) => Boolean(pose && estimate) && (Math.hypot(pose[0] - estimate[0], pose[1] - estimate[1]) > 0.04 || Math.abs(wrap(pose[2] - estimate[2])) > 0.04);

/** The time shown while a run is watched: it follows the newest row a little behind, at an even pace. */
export class Clock {
  constructor() {
    this.shown = 0;
    this.factor = 1;
  }

  advance(latest, seconds, paused, period = 0.05) {
    const lag = Math.max(0.02, period * Math.max(1, this.factor) * 1.5);
    const behind = latest - this.shown;
    if (paused || behind < 0 || behind > 10 * lag + 0.5) this.shown = latest;
    else {
      const pace = this.factor * (1 + Math.max(-0.5, Math.min(2, (behind - lag) / lag)));
      this.shown = Math.min(latest, this.shown + seconds * Math.max(0, pace));
    }
    return this.shown;
  }
}
