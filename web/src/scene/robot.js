// The robot: its parts as they are, wheels that turn, and a soft shadow that grounds it.
import {
  CanvasTexture, Color, DoubleSide, Group, Mesh, MeshBasicMaterial, MeshLambertMaterial, PlaneGeometry, Quaternion,
  SRGBColorSpace, Vector3,
} from "three";
import { meshOf, shapes } from "./solids.js";

function shadow(size) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const context = canvas.getContext("2d");
  const fade = context.createRadialGradient(32, 32, 6, 32, 32, 32);
  fade.addColorStop(0, "rgba(0,0,0,0.38)");
  fade.addColorStop(1, "rgba(0,0,0,0)");
  context.fillStyle = fade;
  context.fillRect(0, 0, 64, 64);
  const material = new MeshBasicMaterial({ map: new CanvasTexture(canvas), transparent: true, depthWrite: false });
  const mesh = new Mesh(new PlaneGeometry(size, size), material);
  mesh.position.z = 0.012;
  mesh.renderOrder = 1;
  return mesh;
}

function partOf(part) {
  const material = new MeshLambertMaterial({ side: part.shape === "mesh" ? DoubleSide : 0, flatShading: part.shape === "mesh" });
  let mesh;
  if (part.shape === "mesh") mesh = meshOf(part, material);
  else {
    mesh = new Mesh(shapes[part.shape](), material);
    mesh.scale.fromArray(part.size);
    material.color.copy(new Color().setRGB(...part.color.slice(0, 3).map((value) => value / 255), SRGBColorSpace));
  }
  if ((part.color[3] ?? 255) < 250) Object.assign(material, { transparent: true, opacity: part.color[3] / 255 });
  const [x, y, z, qw, qx, qy, qz] = part.pose;
  mesh.position.set(x, y, z);
  mesh.quaternion.set(qx, qy, qz, qw);
  return mesh;
}

// A mark on each wheel, so that its turning can be seen.
function spokeOf(part) {
  const [radius, , width] = part.size;
  const spoke = new Mesh(shapes.box(), new MeshLambertMaterial({ color: 0xe8eaef }));
  spoke.scale.set(radius * 1.5, radius * 0.22, width * 1.04);
  return spoke;
}

export class Robot {
  constructor(robot) {
    this.group = new Group();
    this.wheels = [];
    const reach = Math.max(0.2, ...robot.footprint.map(([x, y]) => Math.hypot(x, y)));
    this.group.add(shadow(reach * 2.5));
    for (const part of robot.parts ?? []) {
      const mesh = partOf(part);
      this.group.add(mesh);
      if (!part.wheel) continue;
      const marks = new Group();
      if (part.shape === "cylinder") {
        marks.position.copy(mesh.position);
        marks.quaternion.copy(mesh.quaternion);
        marks.add(spokeOf(part));
        this.group.add(marks);
      }
      const axis = new Vector3(...(part.axis ?? [0, 1, 0])).normalize();
      this.wheels.push({ meshes: [mesh, marks], rest: mesh.quaternion.clone(), axis, side: part.wheel });
    }
  }

  place([x, y, yaw], [left, right]) {
    this.group.position.set(x, y, 0);
    this.group.rotation.z = yaw;
    const turn = new Quaternion();
    for (const { meshes, rest, axis, side } of this.wheels) {
      turn.setFromAxisAngle(axis, side === "left" ? left : right);
      for (const mesh of meshes) mesh.quaternion.multiplyQuaternions(turn, rest);
    }
  }
}
