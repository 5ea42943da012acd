// What a loop of one's own has shown: several robots, each with its trail, between the two newest frames.
import { array } from "../decode.js";
import { lastAt, Run, wrap } from "../run.js";

const MOST_FRAMES = 40;

const mix = (a, b, s) => a + (b - a) * s;

/** Where a robot is between two frames: there or gone, it does not fade. */
function between(a, b, s) {
  if (!a) return b;
  return [mix(a[0], b[0], s), mix(a[1], b[1], s), a[2] + wrap(b[2] - a[2]) * s];
}

export class ViewRun extends Run {
  constructor(info, robot) {
    super(info, 0);
    this.robot = robot;
    this.frames = []; // {t, poses: Map of name to pose, wheels: Map of name to [left, right]}
    this.trails = new Map();
    this.lines = new Map();
    this.believes = false;
  }

  get duration() {
    return this.frames.at(-1)?.t ?? 0;
  }

  add({ from, rows }) {
    if (from === 0) this.trails.clear();
    for (const row of rows) {
      const name = row[5];
      if (!this.trails.has(name)) this.trails.set(name, []);
      this.trails.get(name).push(row);
    }
  }

  /** Whether the loop tells what its robot believes: then it can be told its pose. */
  get isLocalized() {
    return this.believes;
  }

  addFrame({ t, robots, belief }) {
    this.believes ||= Boolean(belief);
    const before = this.frames.at(-1);
    const poses = new Map(robots.map(([name, ...pose]) => [name, pose]));
    const wheels = new Map([...poses].map(([name, pose]) => [name, this.turned(before?.wheels.get(name), before?.poses.get(name), pose)]));
    this.frames.push({ t, poses, wheels });
    if (this.frames.length > MOST_FRAMES) this.frames.shift();
  }

  setPaths(paths) {
    this.lines = new Map(Object.entries(paths).map(([name, points]) => [name, array(points)]));
  }

  // Angles of the left and right wheels after a motion from one pose to the next, without slip.
  turned(angles, from, to) {
    if (!angles || !from) return [0, 0];
    const middle = from[2] + wrap(to[2] - from[2]) / 2;
    const along = (to[0] - from[0]) * Math.cos(middle) + (to[1] - from[1]) * Math.sin(middle);
    const apart = (wrap(to[2] - from[2]) * this.robot.track) / 2;
    const radius = this.robot.wheel_radius || 0.1;
    return [angles[0] + (along - apart) / radius, angles[1] + (along + apart) / radius];
  }

  /** The state at time `t`: that of the first robot, and "others" with those of the rest. */
  at(t) {
    const index = Math.max(0, lastAt(this.frames, t));
    const a = this.frames[index];
    if (!a) return { t: 0, index: -1, row: null, path: null, pose: null, wheels: [0, 0], others: [] };
    const b = this.frames[index + 1] ?? a;
    const s = b.t > a.t ? Math.min(1, Math.max(0, (t - a.t) / (b.t - a.t))) : 0;
    const [first, ...others] = [...b.poses].map(([name, pose]) => {
      const rows = this.trails.get(name) ?? [];
      const [left, right] = a.wheels.get(name) ?? [0, 0];
      const after = b.wheels.get(name);
      return {
        name, rows, pose: between(a.poses.get(name), pose, s), path: this.lines.get(name) ?? null,
        wheels: [mix(left, after[0], s), mix(right, after[1], s)],
      };
    });
    this.rows = first.rows; // Of which the views draw the trail.
    return { ...first, t, index: first.rows.length - 1, row: null, others };
  }
}
