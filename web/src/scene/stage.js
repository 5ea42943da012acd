// The 3D view: renderer, light, floor and camera; draws when something has changed.
import {
  AmbientLight, Color, DirectionalLight, Group, HemisphereLight, Mesh, MeshLambertMaterial, PerspectiveCamera, Plane,
  Raycaster, Scene, Vector2, Vector3, WebGLRenderer,
} from "three";
import { h } from "../dom.js";
import { say } from "../strings.js";
import { onTheme, palette } from "../theme.js";
import { buildSolids, cutaway, dispose } from "./solids.js";
import { Cameras } from "./cameras.js";
import { Overlay } from "./overlay.js";
import { merged } from "./merge.js";
import { perPixel } from "./ribbon.js";
import { Robot } from "./robot.js";

const SLOW_MS = 60; // A picture that takes longer than this on average is drawn with fewer pixels.

function renderer() {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("webgl2", { antialias: true, alpha: true, powerPreference: "high-performance" });
  if (!context) throw new Error("no WebGL");
  const made = new WebGLRenderer({ canvas, context });
  made.debug.checkShaderErrors = false; // Asking for them holds up the first picture.
  const info = context.getExtension("WEBGL_debug_renderer_info");
  const name = info ? String(context.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  return { made, software: /swiftshader|llvmpipe|software|basic render/i.test(name) };
}

export class Stage {
  /** Throws where the browser has no WebGL. */
  constructor(app) {
    this.app = app;
    const { made, software } = renderer();
    this.renderer = made;
    this.ratio = software ? 0.75 : Math.min(devicePixelRatio, 2);
    this.slowest = software ? 0.5 : 0.75;
    this.canvas = made.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    say("scene").put(this.canvas, "aria-label");
    this.element = h("div", { id: "scene", class: "scene" }, this.canvas);
    this.world = new Scene();
    this.camera = new PerspectiveCamera(50, 1, 0.05, 500);
    this.camera.up.set(0, 0, 1);
    this.cameras = new Cameras(this.camera, this.canvas, app);
    this.overlay = new Overlay(app);
    this.extra = new Group();
    this.sun = new DirectionalLight(0xffffff, 1.7);
    this.sun.position.set(0.4, -0.6, 1);
    this.world.add(new HemisphereLight(0xffffff, 0x9aa2ad, 1.5), new AmbientLight(0xffffff, 0.25), this.sun, this.overlay.group, this.extra);
    this.paint();
    onTheme(() => this.paint());
    new ResizeObserver(() => this.resize()).observe(this.element);
    this.canvas.addEventListener("webglcontextlost", (event) => event.preventDefault());
    this.canvas.addEventListener("webglcontextrestored", () => (app.dirty = true));
    app.on("scene", (scene) => this.setScene(scene));
    app.on("solid", (part) => this.extra.add(buildSolids({ ...part, bounds: app.scene.bounds })));
    app.on("run", (run) => this.startRun(run));
    app.on("costmap", (costmap) => this.overlay.setCostmap(costmap));
  }

  paint() {
    this.world.background = new Color(palette().sky);
    this.app.dirty = true;
  }

  setScene(scene) {
    for (const group of [this.solids, this.floor, this.robot?.group]) if (group) dispose(group);
    for (const child of [...this.extra.children]) dispose(child);
    this.solids = buildSolids(scene);
    const [x0, y0, , x1, y1] = scene.bounds;
    const slab = { shape: "box", pose: [(x0 + x1) / 2, (y0 + y1) / 2, -0.05, 1, 0, 0, 0], size: [x1 - x0, y1 - y0, 0.1] };
    this.floor = new Mesh(merged([{ ...slab, color: scene.floor.color }]), new MeshLambertMaterial({ vertexColors: true }));
    this.floor.renderOrder = -1;
    this.robot = new Robot(scene.robot);
    this.robot.group.visible = false;
    this.world.add(this.floor, this.solids, this.robot.group);
    this.paint();
    this.overlay.setScene(scene);
    this.overlay.belief.setRobot(this.robot);
    this.cameras.setScene(scene);
  }

  startRun(run) {
    this.overlay.setRun();
    for (const child of [...this.extra.children]) dispose(child);
    if (run.n) this.cameras.startRun();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.renderer.setPixelRatio(this.ratio);
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    perPixel.value = (2 * Math.tan((this.camera.fov * Math.PI) / 360)) / height;
    this.app.dirty = true;
  }

  /** The point of the floor under a pointer, or null where it points at the sky. */
  pick(event) {
    const box = this.canvas.getBoundingClientRect();
    const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new Raycaster();
    ray.setFromCamera(at, this.camera);
    const hit = ray.ray.intersectPlane(new Plane(new Vector3(0, 0, 1), 0), new Vector3());
    return hit && hit.distanceTo(this.camera.position) < 400 ? [hit.x, hit.y] : null;
  }

  draw(state, seconds) {
    if (!this.app.scene) return false;
    this.robot.group.visible = Boolean(state.pose);
    if (state.pose) this.robot.place(state.pose, state.wheels);
    if (this.solids) this.solids.visible = this.extra.visible = this.app.layers.solids;
    this.overlay.show(state);
    const moving = this.cameras.update(state, seconds);
    if (state.pose) cutaway.robot.value.set(state.pose[0], state.pose[1], 0.25);
    cutaway.on.value = state.pose && this.cameras.mode === "follow" ? 1 : 0;
    this.renderer.render(this.world, this.camera);
    this.adapt(seconds);
    return moving;
  }

  // Where pictures come slowly, as with GL in software, fewer pixels keep the page responsive.
  adapt(seconds) {
    this.pace = (this.pace ?? 16) * 0.9 + Math.min(500, seconds * 1000) * 0.1;
    if (this.pace > SLOW_MS && this.ratio > this.slowest) {
      this.ratio = Math.max(this.slowest, this.ratio * 0.8);
      this.pace = 16;
      this.resize();
    }
  }
}
