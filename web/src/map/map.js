// The 2D map: a canvas that pans and zooms by pointer, wheel, pinch and keys.
import { h } from "../dom.js";
import { say } from "../strings.js";
import { onTheme } from "../theme.js";
import { drawMap } from "./draw.js";

const MOST = 400; // Pixels a metre.
const LEAST = 2;

export class MapView {
  constructor(app, placing) {
    this.app = app;
    this.placing = placing;
    this.canvas = h("canvas", { id: "map", tabIndex: 0, role: "application", "aria-label": say("map") });
    const buttons = h(
      "div",
      { class: "map-buttons" },
      h("button", { type: "button", "aria-label": say("zoomIn"), title: say("zoomIn"), onclick: () => this.zoom(1.4) }, "+"),
      h("button", { type: "button", "aria-label": say("zoomOut"), title: say("zoomOut"), onclick: () => this.zoom(1 / 1.4) }, "−"),
      h("button", { type: "button", "aria-label": say("fit"), title: say("fit"), onclick: () => this.fit() }, "⤢"),
    );
    this.box = h("div", { class: "map-box" }, this.canvas);
    this.element = h("div", { class: "map" }, this.box, buttons);
    this.context = this.canvas.getContext("2d");
    this.view = { x: 0, y: 0, scale: 20 };
    this.pointers = new Map();
    this.fitted = true;
    new ResizeObserver(() => this.resize()).observe(this.box);
    placing.attach(this.canvas, (event) => this.pick(event));
    this.listen();
    onTheme(() => (app.dirty = true));
    app.on("scene", () => this.fit());
  }

  listen() {
    const { canvas } = this;
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(-event.deltaY * 0.0015), this.local(event));
    }, { passive: false });
    canvas.addEventListener("pointerdown", (event) => {
      if (this.app.tool) return;
      this.pointers.set(event.pointerId, this.local(event));
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => this.drag(event));
    for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, (event) => this.pointers.delete(event.pointerId));
    canvas.addEventListener("dblclick", () => this.fit());
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  local(event) {
    const box = this.canvas.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  drag(event) {
    const before = this.pointers.get(event.pointerId);
    if (!before) return;
    const now = this.local(event);
    if (this.pointers.size === 2) {
      const other = [...this.pointers].find(([id]) => id !== event.pointerId)[1];
      const apart = (point) => Math.hypot(point[0] - other[0], point[1] - other[1]);
      this.zoom(apart(now) / Math.max(1, apart(before)), [(now[0] + other[0]) / 2, (now[1] + other[1]) / 2]);
    }
    const share = 1 / this.pointers.size;
    this.pan((now[0] - before[0]) * share, (now[1] - before[1]) * share);
    this.pointers.set(event.pointerId, now);
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    const center = [this.view.x, this.view.y];
    const used = this.placing.key(event, center, 10 / this.view.scale) || this.move(event);
    if (!used) return;
    event.preventDefault();
    event.stopPropagation();
  }

  move(event) {
    const pan = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] }[event.key];
    if (pan) this.pan(...pan);
    else if (event.key === "+" || event.key === "=") this.zoom(1.25);
    else if (event.key === "-") this.zoom(0.8);
    else if (event.key === "0") this.fit();
    else return false;
    return true;
  }

  pan(dx, dy) {
    this.fitted = false;
    this.view.x -= dx / this.view.scale;
    this.view.y += dy / this.view.scale;
    this.app.dirty = true;
  }

  zoom(factor, at = [this.width / 2, this.height / 2]) {
    const before = this.world(at);
    this.view.scale = Math.min(MOST, Math.max(LEAST, this.view.scale * factor));
    const after = this.world(at);
    this.view.x += before[0] - after[0];
    this.view.y += before[1] - after[1];
    this.fitted = false;
    this.app.dirty = true;
  }

  fit() {
    const { grid, mapped, scene } = this.app;
    if (!scene || !this.width) return;
    let [x0, y0, , x1, y1] = scene.bounds;
    if (grid && !mapped && !grid.origin[2]) {
      [x0, y0] = grid.origin;
      [x1, y1] = [x0 + grid.width * grid.resolution, y0 + grid.height * grid.resolution];
    }
    const scale = Math.min(this.width / (x1 - x0), this.height / (y1 - y0)) * 0.97;
    this.view = { x: (x0 + x1) / 2, y: (y0 + y1) / 2, scale: Math.min(MOST, Math.max(LEAST, scale)) };
    this.fitted = true;
    this.app.dirty = true;
  }

  world([px, py]) {
    return [this.view.x + (px - this.width / 2) / this.view.scale, this.view.y - (py - this.height / 2) / this.view.scale];
  }

  pick(event) {
    return this.world(this.local(event));
  }

  resize() {
    const ratio = Math.min(devicePixelRatio, 2);
    this.width = this.box.clientWidth;
    this.height = this.box.clientHeight;
    this.canvas.width = Math.round(this.width * ratio);
    this.canvas.height = Math.round(this.height * ratio);
    this.ratio = ratio;
    if (this.fitted) this.fit();
    this.app.dirty = true;
  }

  draw(state) {
    if (!this.width || !this.app.scene) return;
    const { context, ratio, view } = this;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    drawMap(context, this.app, state, { ...view, width: this.width, height: this.height, ratio });
  }
}
