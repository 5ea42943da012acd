// The robots beside the first one in the 3D view, each with its path and trail.
import { Color, Group } from "three";
import { C } from "../run.js";
import { Ribbon } from "../scene/ribbon.js";
import { Robot } from "../scene/robot.js";
import { dispose } from "../scene/solids.js";
import { palette } from "../theme.js";

class Other {
  constructor(robot) {
    this.robot = new Robot(robot);
    this.path = new Ribbon({ width: 0.1, pixels: 2.5, height: 0.02, order: 2 });
    this.trail = new Ribbon({ width: 0.08, pixels: 3, height: 0.025, order: 3 });
    this.group = new Group();
    this.group.add(this.robot.group, this.path.mesh, this.trail.mesh);
  }

  show({ pose, wheels, path, rows }, layers) {
    this.robot.place(pose, wheels);
    if (path !== this.shownPath) {
      this.shownPath = path;
      this.path.set(path, new Color(palette().path).toArray());
    }
    if (rows !== this.rows) {
      this.rows = rows;
      this.trail.clear();
    }
    const color = new Color(palette().mover).toArray();
    for (let i = this.trail.count; i < rows.length; i++) this.trail.add(rows[i][C.x], rows[i][C.y], color);
    this.trail.show(rows.length);
    this.path.mesh.visible = layers.path;
    this.trail.mesh.visible = layers.trail;
  }
}

export class Others {
  constructor(app, stage) {
    this.app = app;
    this.stage = stage;
    this.shown = new Map();
    app.on("scene", () => this.keep(new Set()));
  }

  show(others) {
    this.keep(new Set(others.map(({ name }) => name)));
    for (const other of others) {
      if (!this.shown.has(other.name)) {
        const made = new Other(this.app.scene.robot);
        this.shown.set(other.name, made);
        this.stage.world.add(made.group);
      }
      this.shown.get(other.name).show(other, this.app.layers);
    }
  }

  keep(names) {
    for (const [name, other] of this.shown) {
      if (names.has(name)) continue;
      dispose(other.group);
      this.shown.delete(name);
    }
  }
}
