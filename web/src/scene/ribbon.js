// A line on the floor as a flat ribbon: as wide as it should look in metres, but never too thin to see; one draw call.
import { BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Mesh, MeshBasicMaterial, Vector2 } from "three";

const PARTS = ["position", "side", "color"];

/** How many metres a pixel covers one metre from the camera; set by the stage. */
export const perPixel = { value: 0.001 };

function widened(material, width, pixels) {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.perPixel = perPixel;
    shader.uniforms.halves = { value: new Vector2(width / 2, pixels / 2) };
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nattribute vec2 side; uniform float perPixel; uniform vec2 halves;")
      .replace(
        "#include <project_vertex>",
        `float away = -(modelViewMatrix * vec4(transformed, 1.0)).z;
        transformed.xy += side * max(halves.x, halves.y * perPixel * away);
        #include <project_vertex>`,
      );
  };
  material.customProgramCacheKey = () => "ribbon";
  return material;
}

export class Ribbon {
  constructor({ width, pixels, height, order }) {
    this.height = height;
    this.count = 0;
    this.capacity = 0;
    const material = new MeshBasicMaterial({ vertexColors: true, side: DoubleSide, transparent: true, opacity: 0.95 });
    material.depthWrite = false;
    this.mesh = new Mesh(new BufferGeometry(), widened(material, width, pixels));
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = order;
    this.reserve(64);
  }

  reserve(points) {
    const old = this.mesh.geometry;
    const geometry = new BufferGeometry();
    for (const part of PARTS) {
      const size = part === "side" ? 2 : 3;
      const attribute = new BufferAttribute(new Float32Array(points * 2 * size), size).setUsage(DynamicDrawUsage);
      if (this.count) attribute.array.set(old.attributes[part].array.subarray(0, this.count * 2 * size));
      geometry.setAttribute(part, attribute);
    }
    const index = new Uint32Array((points - 1) * 6);
    for (let i = 0; i < points - 1; i++) index.set([2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 1, 2 * i + 3, 2 * i + 2], 6 * i);
    geometry.setIndex(new BufferAttribute(index, 1));
    geometry.setDrawRange(0, 0);
    old.dispose();
    this.mesh.geometry = geometry;
    this.capacity = points;
  }

  clear() {
    this.count = 0;
    this.last = null;
    this.show(0);
  }

  /** Shows the first so many points. */
  show(points) {
    this.mesh.geometry.setDrawRange(0, Math.max(0, Math.min(points, this.count) - 1) * 6);
  }

  /** Adds a point; `color` is [r, g, b] of 0 to 1, linear. */
  add(x, y, color) {
    if (this.count === this.capacity) this.reserve(this.capacity * 2);
    const { last } = this;
    let normal = last?.normal ?? [0, 0];
    if (last) {
      const length = Math.hypot(x - last.x, y - last.y);
      if (length > 1e-4) normal = [-(y - last.y) / length, (x - last.x) / length];
      if (this.count === 1) this.write(0, last.x, last.y, normal, last.color);
    }
    this.write(this.count, x, y, normal, color);
    this.last = { x, y, color, normal };
    this.count += 1;
    for (const part of PARTS) this.mesh.geometry.attributes[part].needsUpdate = true;
  }

  write(i, x, y, [nx, ny], color) {
    const { position, side, color: tint } = this.mesh.geometry.attributes;
    position.array.set([x, y, this.height, x, y, this.height], 6 * i);
    side.array.set([nx, ny, -nx, -ny], 4 * i);
    tint.array.set([...color, ...color], 6 * i);
  }

  /** Sets all points from a flat array [x, y, x, y, …]. */
  set(points, color) {
    this.clear();
    if (points) for (let i = 0; i + 1 < points.length; i += 2) this.add(points[i], points[i + 1], color);
    this.show(this.count);
  }
}
