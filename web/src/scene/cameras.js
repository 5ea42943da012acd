// Orbit, follow and top: one camera that the pointer turns, and what it looks at.
import { Spherical, Vector3 } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { reducedMotion } from "../dom.js";

export const CAMERAS = ["orbit", "follow", "top"];

export class Cameras {
  constructor(camera, canvas, app) {
    this.camera = camera;
    this.app = app;
    this.turned = false; // Whether the reader has turned the view while following.
    this.mode = "orbit";
    this.chosen = false;
    this.controls = new OrbitControls(camera, canvas);
    Object.assign(this.controls, { maxPolarAngle: Math.PI / 2 - 0.03, minDistance: 0.5, maxDistance: 200, zoomToCursor: true });
    this.controls.enableDamping = !reducedMotion();
    this.controls.addEventListener("start", () => (this.turned = true));
    this.controls.addEventListener("change", () => (app.dirty = true));
    canvas.addEventListener("keydown", (event) => this.key(event));
    app.on("tool", (tool) => (this.controls.enabled = !tool));
  }

  // Plus and minus zoom, Shift with an arrow turns; plain arrows drive the robot.
  key(event) {
    const zoom = { "+": 0.85, "=": 0.85, "-": 1.18 }[event.key];
    const turn = event.shiftKey ? { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key] : null;
    if (!zoom && !turn) return;
    event.preventDefault();
    const offset = this.camera.position.clone().sub(this.controls.target);
    if (zoom) offset.multiplyScalar(zoom);
    else if (this.mode !== "top") {
      const around = new Spherical().setFromVector3(new Vector3(offset.x, offset.z, -offset.y));
      around.theta += turn[0];
      around.phi = Math.min(this.controls.maxPolarAngle, Math.max(0.05, around.phi + turn[1]));
      const turned = new Vector3().setFromSpherical(around);
      offset.set(turned.x, -turned.z, turned.y);
    }
    this.camera.position.copy(this.controls.target).add(offset);
    this.app.dirty = true;
  }

  setScene({ bounds }) {
    this.bounds = bounds;
    this.overview();
  }

  startRun() {
    this.heading = null;
    if (!this.chosen) this.set("follow");
    this.placed = false;
  }

  /** Chooses "orbit", "follow" or "top"; a choice of the reader's stays for the next run. */
  choose(mode) {
    this.chosen = true;
    this.set(mode);
  }

  set(mode) {
    this.mode = mode;
    this.placed = this.turned = false;
    this.heading = null;
    this.controls.enableRotate = mode !== "top";
    this.controls.zoomToCursor = mode !== "follow";
    if (mode === "orbit") this.overview();
    if (mode === "top") this.above();
    this.app.emit("camera", mode);
  }

  size() {
    const [x0, y0, , x1, y1] = this.bounds;
    const aspect = Math.max(0.5, this.camera.aspect);
    return { x: (x0 + x1) / 2, y: (y0 + y1) / 2, reach: Math.max((x1 - x0) / aspect, y1 - y0) };
  }

  overview() {
    if (!this.bounds) return;
    const { x, y, reach } = this.size();
    this.controls.target.set(x, y, 0);
    this.camera.position.set(x - reach * 0.16, y - reach * 1.02, reach * 0.82);
    this.controls.update();
  }

  above() {
    if (!this.bounds) return;
    const { x, y, reach } = this.size();
    this.controls.target.set(x, y, 0);
    this.camera.position.set(x, y - 1e-3, reach * 1.15);
    this.controls.update();
  }

  /** Moves with the robot where it is followed; true while the camera has not come to rest. */
  update({ pose }, seconds) {
    if (this.mode === "follow" && pose) this.follow(pose, seconds);
    return this.controls.update();
  }

  follow([x, y, yaw], seconds) {
    const { camera, controls } = this;
    const jumped = this.last && Math.hypot(x - this.last[0], y - this.last[1]) > 1.5;
    this.last = [x, y];
    if (!this.placed || (jumped && !this.turned)) {
      controls.target.set(x, y, 0.3);
      camera.position.set(x - 4.8 * Math.cos(yaw), y - 4.8 * Math.sin(yaw), 4);
      this.placed = true;
      this.heading = yaw;
    }
    const offset = camera.position.clone().sub(controls.target);
    const turn = Math.atan2(Math.sin(yaw - this.heading), Math.cos(yaw - this.heading));
    const share = reducedMotion() ? 0 : 1 - Math.exp(-Math.min(seconds, 0.2) / 1.2);
    offset.applyAxisAngle(new Vector3(0, 0, 1), turn * share);
    this.heading += turn * share;
    controls.target.set(x, y, 0.3);
    camera.position.copy(controls.target).add(offset);
  }
}
