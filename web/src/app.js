// What every part of the page shares: the scene, the run, the newest frame, and who listens to changes.
import { Run, Clock } from "./run.js";

export const LAYERS = [
  "map", "costmap", "solids", "path", "trail", "scan", "footprint", "clearance", "goals", "movers", "tracks",
  "rollouts", "contacts", "estimate", "particles", "graph",
];
export const OF_LOCALIZER = ["estimate", "particles", "graph"];

export class App {
  constructor(mode) {
    this.mode = mode;
    this.scene = null;
    this.grid = null; // The map's picture, decoded.
    this.mapped = null; // Poses, loops and corrections of a map that the robot makes.
    this.run = new Run();
    this.frame = null;
    this.costmap = null;
    this.clock = new Clock();
    this.layers = Object.fromEntries(LAYERS.map((name) => [name, name !== "clearance"]));
    this.state = "idle";
    this.lacks = new Set(); // what this server cannot do
    this.paused = false;
    this.factor = null;
    this.placed = {}; // The start and goal chosen before a run.
    this.tool = null; // What a click sets: "goal", "start", "box", "pose" or nothing.
    this.draft = null; // The pose a press is choosing.
    this.dirty = true;
    this.listeners = {};
  }

  on(name, listener) {
    (this.listeners[name] ??= []).push(listener);
  }

  emit(name, value) {
    this.dirty = true;
    for (const listener of this.listeners[name] ?? []) listener(value);
  }

  setRun(run) {
    this.run = run;
    this.clock.shown = 0;
    this.frame = null;
    this.emit("run", run);
  }

  /** Whether a run is in progress. */
  get isGoing() {
    return this.state === "running" || this.state === "paused" || this.state === "waiting";
  }

  /** Whether a start and a goal can be chosen, as nothing is driving. */
  get isSettingUp() {
    return this.mode === "live" && (this.state === "idle" || this.state === "ended");
  }

  get goalsShown() {
    const { start, goal } = this.placed;
    if (this.isSettingUp && (start || goal)) return goal ? [goal] : [];
    return this.run.goals;
  }

  setTool(tool) {
    this.tool = tool;
    this.draft = null;
    this.emit("tool", tool);
  }
}
