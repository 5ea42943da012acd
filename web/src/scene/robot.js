// The robot: its parts as they are, wheels that turn, and a soft shadow that grounds it.
import { CanvasTexture, Group, Mesh, MeshBasicMaterial, MeshLambertMaterial, PlaneGeometry, Vector3 } from "three";
import { merged } from "./merge.js";

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

// A bar across each wheel, so that its turning can be seen.
function spokesOf(part) {
  if (part.shape !== "cylinder") return [];
  const [radius, , width] = part.size;
  return [{ ...part, shape: "box", size: [radius * 1.5, radius * 0.22, width * 1.04], color: [226, 230, 238] }];
}

/** The parts that turn together: those of one wheel, which lie around one point. */
function wheelsOf(parts) {
  const wheels = new Map();
  for (const part of parts) {
    if (!part.wheel) continue;
    const key = `${part.wheel} ${part.pose.slice(0, 3).map((value) => value.toFixed(3))}`;
    if (!wheels.has(key)) wheels.set(key, { side: part.wheel, origin: part.pose.slice(0, 3), axis: part.axis ?? [0, 1, 0], parts: [] });
    wheels.get(key).parts.push(part, ...spokesOf(part));
  }
  return [...wheels.values()];
}

export class Robot {
  constructor(robot) {
    const parts = robot.parts ?? [];
    const material = new MeshLambertMaterial({ vertexColors: true });
    const reach = Math.max(0.2, ...robot.footprint.map(([x, y]) => Math.hypot(x, y)));
    this.group = new Group();
    this.body = merged(parts.filter((part) => !part.wheel));
    this.group.add(shadow(reach * 2.5), new Mesh(this.body, material));
    this.wheels = wheelsOf(parts).map(({ side, origin, axis, parts: turning }) => {
      const mesh = new Mesh(merged(turning, origin), material);
      mesh.position.fromArray(origin);
      this.group.add(mesh);
      return { mesh, side, axis: new Vector3(...axis).normalize() };
    });
  }

  /** A faint copy of it in one colour, for a place where it may be. */
  ghost(color) {
    const mesh = new Mesh(this.body, new MeshLambertMaterial({ color, transparent: true, opacity: 0.4, depthWrite: false }));
    mesh.renderOrder = 2;
    return mesh;
  }

  place([x, y, yaw], [left, right]) {
    this.group.position.set(x, y, 0);
    this.group.rotation.z = yaw;
    for (const { mesh, side, axis } of this.wheels) mesh.quaternion.setFromAxisAngle(axis, side === "left" ? left : right);
  }
}
