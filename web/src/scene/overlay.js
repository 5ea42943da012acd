// What the run adds to the world: path, trail, goals, lidar, movers, costmap, rollouts, contacts.
import {
  BufferGeometry, CanvasTexture, Color, Group, LineBasicMaterial, LineLoop, LineSegments, Mesh,
  MeshBasicMaterial, NearestFilter, PlaneGeometry, Points, PointsMaterial, RingGeometry, Shape, ShapeGeometry,
  SRGBColorSpace, Vector3,
} from "three";
import { array } from "../decode.js";
import { C } from "../run.js";
import { palette, speedColor } from "../theme.js";
import { Belief } from "./belief.js";
import { Buffer } from "./buffer.js";
import { buildSolids, dispose } from "./solids.js";
import { Ribbon } from "./ribbon.js";

/** A disc with a pointer for the heading, on the floor. */
export class Marker {
  constructor(color, radius = 0.32) {
    this.group = new Group();
    const material = new MeshBasicMaterial({ color, transparent: true, depthTest: false });
    this.group.visible = false;
    const ring = new Mesh(new RingGeometry(radius * 0.72, radius, 40), material);
    const disc = new Mesh(new RingGeometry(0, radius * 0.18, 20), material);
    const tip = new Shape();
    tip.moveTo(radius * 1.75, 0);
    tip.lineTo(radius * 1.08, radius * 0.42);
    tip.lineTo(radius * 1.08, -radius * 0.42);
    this.pointer = new Mesh(new ShapeGeometry(tip), material);
    this.group.add(ring, disc, this.pointer);
    for (const part of [ring, disc, this.pointer]) part.renderOrder = 4;
    this.group.position.z = 0.03;
  }

  place(pose) {
    this.group.visible = Boolean(pose);
    if (!pose) return;
    this.group.position.setX(pose[0]).setY(pose[1]);
    this.group.rotation.z = pose[2] ?? 0;
    this.pointer.visible = pose[2] !== null && pose[2] !== undefined;
  }
}

export class Overlay {
  constructor(app) {
    this.app = app;
    this.group = new Group();
    const look = palette();
    this.path = new Ribbon({ width: 0.1, pixels: 2.5, height: 0.02, order: 2 });
    this.trail = new Ribbon({ width: 0.08, pixels: 3, height: 0.025, order: 3 });
    this.scan = new Buffer(Points, new PointsMaterial({ color: look.scan, size: 0.06, sizeAttenuation: true }));
    this.rollouts = new Buffer(LineSegments, new LineBasicMaterial({ color: look.path, transparent: true, opacity: 0.35 }));
    this.contacts = new Buffer(Points, new PointsMaterial({ color: look.contact, size: 9, sizeAttenuation: false, depthTest: false }), 16);
    this.tracks = new Buffer(LineSegments, new LineBasicMaterial({ color: look.mover }), 64);
    this.footprint = new LineLoop(new BufferGeometry(), new LineBasicMaterial({ color: look.goal }));
    this.movers = new Map();
    this.goals = [];
    this.draft = new Marker(look.goal);
    this.belief = new Belief(app);
    this.start = new Marker(look.path);
    this.costmap = null;
    this.group.add(
      this.path.mesh, this.trail.mesh, this.scan.object, this.rollouts.object, this.contacts.object, this.tracks.object,
      this.footprint, this.draft.group, this.start.group, this.belief.group,
    );
  }

  setScene(scene) {
    this.top = scene.robot?.limits?.v || 1;
    const corners = (scene.robot?.footprint ?? []).map(([x, y]) => new Vector3(x, y, 0.03));
    this.footprint.geometry.setFromPoints(corners);
    for (const mesh of this.movers.values()) dispose(mesh);
    this.movers.clear();
    for (const mover of scene.movers ?? []) {
      const mesh = buildSolids({ ...mover, bounds: scene.bounds });
      mesh.visible = false;
      this.movers.set(mover.name, mesh);
      this.group.add(mesh);
    }
    this.setRun();
  }

  setRun() {
    this.trail.clear();
    this.path.clear();
    this.shownPath = null;
    this.shownFrame = null;
  }

  setCostmap(costmap) {
    if (this.costmap) {
      this.costmap.material.map.dispose();
      this.costmap.material.dispose();
      this.costmap.geometry.dispose();
      this.group.remove(this.costmap);
      this.costmap = null;
    }
    if (!costmap) return;
    const [width, height] = [costmap.width * costmap.resolution, costmap.height * costmap.resolution];
    const map = new CanvasTexture(costmap.canvas);
    map.colorSpace = SRGBColorSpace;
    map.magFilter = NearestFilter;
    map.generateMipmaps = false;
    map.minFilter = NearestFilter;
    const material = new MeshBasicMaterial({ map, transparent: true, depthWrite: false });
    const plane = new PlaneGeometry(width, height).translate(width / 2, height / 2, 0);
    this.costmap = new Mesh(plane, material);
    const [x, y, yaw] = costmap.origin;
    this.costmap.position.set(x, y, 0.008);
    this.costmap.rotation.z = yaw ?? 0;
    this.group.add(this.costmap);
  }

  /** Brings everything to the state shown. */
  show(state) {
    const { app } = this;
    const { layers, run } = app;
    this.showTrail(state);
    if (state.path !== this.shownPath) {
      this.shownPath = state.path;
      this.path.set(state.path, new Color(palette().path).toArray());
    }
    if (app.frame !== this.shownFrame) {
      this.shownFrame = app.frame;
      this.showFrame(app.frame ?? {});
    }
    this.path.mesh.visible = layers.path;
    this.trail.mesh.visible = layers.trail;
    this.scan.object.visible = layers.scan && this.scan.filled;
    this.rollouts.object.visible = layers.rollouts && this.rollouts.filled;
    this.contacts.object.visible = layers.contacts && this.contacts.filled;
    this.tracks.object.visible = layers.tracks && this.tracks.filled;
    this.footprint.visible = layers.footprint && Boolean(state.pose);
    if (this.costmap) this.costmap.visible = layers.costmap;
    if (state.pose) {
      this.footprint.position.set(state.pose[0], state.pose[1], 0);
      this.footprint.rotation.z = state.pose[2];
    }
    this.showGoals(app.goalsShown);
    this.start.place(app.isSettingUp ? app.placed.start : null);
    this.draft.place(app.draft);
    this.belief.show(state);
  }

  showTrail({ index }) {
    const { rows } = this.app.run;
    for (let i = this.trail.count; i <= index && i < rows.length; i++) {
      const row = rows[i];
      const color = new Color().setRGB(...speedColor(Math.abs(row[C.v]) / this.top).map((value) => value / 255), SRGBColorSpace);
      this.trail.add(row[C.x], row[C.y], color.toArray());
    }
    this.trail.show(index + 1);
  }

  showGoals(poses) {
    while (this.goals.length < poses.length) {
      const marker = new Marker(palette().goal);
      this.goals.push(marker);
      this.group.add(marker.group);
    }
    this.goals.forEach((marker, i) => marker.place(this.app.layers.goals ? poses[i] : null));
  }

  showFrame({ scans = [], movers = [], tracks = [], rollouts = [], contacts = [] }) {
    const points = [];
    for (const { pose: [x, y, z, yaw], points: encoded } of scans) {
      const local = array(encoded);
      const [c, s] = [Math.cos(yaw), Math.sin(yaw)];
      for (let i = 0; i + 1 < local.length; i += 2) {
        const [px, py] = [local[i] / 100, local[i + 1] / 100];
        points.push(x + c * px - s * py, y + s * px + c * py, z);
      }
    }
    this.scan.set(points);
    const lines = [];
    for (const line of rollouts) for (let i = 0; i + 1 < line.length; i++) lines.push(...line[i].slice(0, 2), 0.03, ...line[i + 1].slice(0, 2), 0.03);
    this.rollouts.set(lines);
    this.contacts.set(contacts.flat());
    const arrows = [];
    for (const [x, y, vx, vy] of tracks) arrows.push(x, y, 0.1, x + vx, y + vy, 0.1);
    this.tracks.set(arrows);
    for (const mesh of this.movers.values()) mesh.visible = false;
    for (const [name, x, y, yaw] of movers) {
      const mesh = this.movers.get(name);
      if (!mesh) continue;
      mesh.visible = this.app.layers.movers;
      mesh.position.set(x, y, 0);
      mesh.rotation.z = yaw;
    }
  }
}
