// A recorded run that plays: the time shown, its pace, and what was seen around the robot then.
import { summed, unpack } from "../decode.js";
import { lastAt, Run } from "../run.js";
import { costRaster } from "../raster.js";

export class Player {
  constructor(app) {
    this.app = app;
    this.frames = [];
    this.costmaps = [];
    this.solids = [];
    this.time = 0;
    this.pace = 1;
    this.playing = false;
    this.costmapShown = -1;
  }

  async load(encoded, info, end) {
    const episode = (await unpack(encoded)) ?? {};
    const run = new Run(info, 1);
    run.add({ from: 0, rows: episode.rows, paths: episode.paths, events: episode.events });
    run.end = end ?? null;
    this.frames = episode.frames ?? [];
    for (const scan of this.frames.flatMap((frame) => frame.scans ?? [])) scan.points ??= summed(scan.deltas);
    this.costmaps = episode.costmaps ?? [];
    this.solids = episode.solids ?? [];
    this.goalChanges = run.events.filter((event) => event.goals);
    this.app.setRun(run);
    this.app.emit("log", { from: 0 });
    for (const solid of this.solids) this.app.emit("solid", solid);
    this.seek(0);
  }

  get duration() {
    return this.app.run.duration;
  }

  seek(time) {
    this.time = Math.min(this.duration, Math.max(0, time));
    const { app } = this;
    app.clock.shown = this.time;
    app.frame = this.frames[lastAt(this.frames, this.time + 1e-6)] ?? this.frames[0] ?? null;
    const change = this.goalChanges[lastAt(this.goalChanges, this.time + 1e-6)];
    app.run.goals = change?.goals ?? app.run.info.goals ?? [];
    this.showCostmap(lastAt(this.costmaps, this.time + 1e-6));
    app.emit("seek", this.time);
  }

  async showCostmap(index) {
    if (index === this.costmapShown) return;
    this.costmapShown = index;
    const encoded = this.costmaps[index];
    const costmap = encoded ? await costRaster(encoded, !this.app.scene.map, this.costmaps[encoded.base]) : null;
    if (index !== this.costmapShown) return;
    this.app.costmap = costmap;
    this.app.emit("costmap", costmap);
  }

  play(playing) {
    if (playing && this.time >= this.duration) this.seek(0);
    this.playing = playing;
    this.app.emit("play", playing);
  }

  advance(seconds) {
    if (!this.playing) return;
    this.seek(this.time + seconds * this.pace);
    if (this.time >= this.duration) this.play(false);
  }
}
