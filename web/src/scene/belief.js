// What the robot believes of its pose in 3D: particles and ellipse on the floor, faint robots where it may be.
import { Group, LineBasicMaterial, LineSegments } from "three";
import { otherPlaces, particleDashes } from "../belief.js";
import { isApart } from "../run.js";
import { palette } from "../theme.js";
import { Buffer } from "./buffer.js";

const CORNERS = 64;

export class Belief {
  constructor(app) {
    this.app = app;
    this.group = new Group();
    const color = palette().belief;
    this.particles = new Buffer(LineSegments, new LineBasicMaterial({ color, transparent: true, opacity: 0.7 }), 1024);
    this.ellipse = new Buffer(LineSegments, new LineBasicMaterial({ color, depthTest: false }), 2 * CORNERS);
    this.ellipse.object.renderOrder = 4;
    this.group.add(this.particles.object, this.ellipse.object);
    this.ghosts = [];
    this.shown = null;
  }

  setRobot(robot) {
    for (const ghost of this.ghosts) {
      this.group.remove(ghost);
      ghost.material.dispose();
    }
    this.ghosts = [];
    this.robot = robot;
  }

  show(state) {
    const { layers, frame } = this.app;
    const belief = frame?.belief ?? null;
    if (belief !== this.shown) {
      this.shown = belief;
      const ends = particleDashes(belief, 0.12);
      const points = [];
      for (let i = 0; i < ends.length; i += 2) points.push(ends[i], ends[i + 1], 0.04);
      this.particles.set(points);
    }
    const estimate = state.estimate ?? belief?.pose;
    this.showEllipse(belief?.ellipse, estimate);
    this.particles.object.visible = layers.particles && this.particles.filled;
    this.ellipse.object.visible = layers.estimate && this.ellipse.filled;
    const places = layers.estimate ? otherPlaces(belief) : [];
    if (layers.estimate && isApart(state.pose, estimate)) places.push([...estimate, 1]);
    this.showGhosts(places);
  }

  showEllipse(ellipse, at) {
    const points = [];
    if (ellipse && at) {
      const [a, b, angle] = ellipse;
      const [c, s] = [Math.cos(angle), Math.sin(angle)];
      const corner = (i) => {
        const [x, y] = [a * Math.cos((2 * Math.PI * i) / CORNERS), b * Math.sin((2 * Math.PI * i) / CORNERS)];
        return [at[0] + c * x - s * y, at[1] + s * x + c * y, 0.03];
      };
      for (let i = 0; i < CORNERS; i++) points.push(...corner(i), ...corner(i + 1));
    }
    this.ellipse.set(points);
  }

  showGhosts(places) {
    while (this.robot && this.ghosts.length < places.length) {
      this.ghosts.push(this.robot.ghost(palette().belief));
      this.group.add(this.ghosts.at(-1));
    }
    this.ghosts.forEach((ghost, i) => {
      ghost.visible = i < places.length;
      if (!ghost.visible) return;
      const [x, y, yaw, weight] = places[i];
      ghost.position.set(x, y, 0);
      ghost.rotation.z = yaw;
      ghost.material.opacity = 0.15 + 0.35 * weight;
    });
  }
}
