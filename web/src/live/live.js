// A run as the server tells it: each kind of message brings one part of the page up to date.
import { array } from "../decode.js";
import { Run } from "../run.js";
import { costRaster, mapRaster } from "../raster.js";
import { Link } from "./link.js";

export class Live {
  constructor(app) {
    this.app = app;
    this.client = null;
    this.driver = null;
    this.asking = null;
    this.clients = 0;
    this.choices = {};
    this.link = new Link((message) => this.receive(message), (state, wait) => this.changed(state, wait));
    this.arrival = Promise.resolve();
  }

  get youDrive() {
    return this.client !== null && this.client === this.driver;
  }

  send(type, fields) {
    return this.link.send(type, fields);
  }

  // What the shown run is to do. The server refuses it where another one has begun by then.
  order(type, fields) {
    return this.send(type, { ...fields, run: this.app.run.orders });
  }

  changed(state, wait) {
    if (state === "closed") this.app.factor = null;
    this.app.emit("link", { state, wait });
  }

  receive(message) {
    const take = this[`on_${message.type}`];
    if (take) take.call(this, message);
  }

  on_hello(message) {
    Object.assign(this, { client: message.client, driver: message.driver, clients: message.clients, choices: message.choices ?? {} });
    this.app.lacks = new Set(message.lacks ?? []);
    this.state(message.state);
    this.app.emit("hello", message);
    this.app.emit("drivers", this);
  }

  async on_scene({ scene }) {
    const { app } = this;
    app.scene = scene;
    app.setRun(new Run());
    this.state("idle"); // Until a run follows.
    app.grid = null;
    app.mapped = null;
    app.costmap = null;
    app.emit("costmap", null);
    app.emit("scene", scene);
    if (scene.note) app.emit("remark", scene.note);
    if (!scene.map) return;
    const grid = await mapRaster(scene.map);
    if (app.scene !== scene) return;
    app.grid = grid;
    app.emit("scene_map", grid);
  }

  on_solid(message) {
    this.app.emit("solid", message);
  }

  on_run({ info, n, orders }) {
    const { app } = this;
    app.placed = {};
    app.setRun(new Run(info, n, orders));
    this.state("running");
  }

  on_log(message) {
    const { app } = this;
    app.run.add(message);
    app.emit("log", message);
  }

  on_frame(message) {
    const { app } = this;
    app.frame = message;
    app.factor = message.factor;
    app.clock.factor = message.factor || 1;
    if (message.goals) app.run.goals = message.goals;
    this.state(app.run.end ? "ended" : message.paused ? "paused" : message.waiting ? "waiting" : "running");
    app.emit("frame", message);
  }

  on_costmap(message) {
    const { app } = this;
    const run = app.run;
    this.arrival = this.arrival
      .then(() => costRaster(message, !(app.scene?.map || app.mapped)))
      .then((costmap) => {
        if (app.run !== run) return;
        app.costmap = costmap;
        app.emit("costmap", costmap);
      });
  }

  /** The map that the robot has made so far. */
  on_map(message) {
    const { app } = this;
    const run = app.run;
    this.arrival = this.arrival
      .then(() => mapRaster(message))
      .then((grid) => {
        if (app.run !== run) return;
        app.grid = grid;
        app.mapped = { poses: array(message.poses), loops: array(message.loops), corrections: message.corrections };
        app.emit("scene_map", grid);
      });
  }

  on_drivers({ driver, request, clients }) {
    Object.assign(this, { driver, clients, asking: request ?? null });
    this.app.emit("drivers", this);
  }

  on_end(message) {
    this.app.run.end = message;
    this.state("ended");
    this.app.emit("end", message);
  }

  on_error({ text }) {
    this.app.emit("error", text);
  }

  state(state) {
    const { app } = this;
    app.paused = state === "paused";
    if (state === app.state) return;
    app.state = state;
    app.emit("state", state);
  }
}
