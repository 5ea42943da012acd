// Points or lines that are filled anew with each frame.
import { BufferAttribute, BufferGeometry, DynamicDrawUsage } from "three";

/** A buffer of points or line ends that is filled anew with each frame. */
export class Buffer {
  constructor(Kind, material, capacity = 512) {
    this.object = new Kind(new BufferGeometry(), material);
    this.object.frustumCulled = false;
    this.capacity = 0;
    this.filled = false;
    this.reserve(capacity);
  }

  reserve(capacity) {
    if (capacity <= this.capacity) return;
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    const positions = new BufferAttribute(new Float32Array(capacity * 3), 3).setUsage(DynamicDrawUsage);
    this.object.geometry.setAttribute("position", positions);
    this.object.geometry.setDrawRange(0, 0);
    this.capacity = capacity;
  }

  set(points) {
    this.reserve(2 ** Math.ceil(Math.log2(Math.max(2, points.length / 3))));
    const { position } = this.object.geometry.attributes;
    position.array.set(points);
    position.needsUpdate = true;
    this.object.geometry.setDrawRange(0, points.length / 3);
    this.filled = points.length > 0;
  }
}
