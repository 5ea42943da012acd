// The messages of a loop of one's own: as those of a run, but with several robots and with paths that are replaced.
import { Live } from "../live/live.js";
import { ViewRun } from "./run.js";

export class ViewLive extends Live {
  on_run({ info }) {
    const { app } = this;
    app.setRun(new ViewRun(info, app.scene.robot));
    this.state("running");
  }

  on_log(message) {
    const { app } = this;
    const anew = message.from === 0 && app.run.trails.size > 0;
    app.run.add(message);
    if (anew) app.emit("run", app.run); // Trails that were thinned are drawn anew.
    app.emit("log", message);
  }

  on_frame(message) {
    const { app } = this;
    app.run.addFrame(message);
    app.frame = message;
    app.run.goals = message.goals;
    app.emit("frame", message);
  }

  on_paths({ paths }) {
    this.app.run.setPaths(paths);
    this.app.dirty = true;
  }

  on_costmap(message) {
    if (message.png) return super.on_costmap(message);
    this.arrival = this.arrival.then(() => {
      this.app.costmap = null;
      this.app.emit("costmap", null);
    });
  }

  on_end(message) {
    this.link.stop(); // The address of another loop has another token.
    super.on_end(message);
  }
}
