// Several shapes as one geometry with a colour for each vertex: one draw call for what moves as one.
import { BufferAttribute, BufferGeometry, Color, Matrix4, Quaternion, SRGBColorSpace, Vector3 } from "three";
import { array } from "../decode.js";
import { shapes } from "./solids.js";

function geometryOf(part) {
  if (part.shape !== "mesh") return shapes[part.shape]().toNonIndexed();
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(array(part.vertices), 3));
  geometry.setIndex(new BufferAttribute(array(part.triangles), 1));
  const flat = geometry.toNonIndexed();
  flat.computeVertexNormals();
  return flat;
}

/** Parts {"shape", "pose", "size", "color"} as one geometry, relative to the point `origin`. */
export function merged(parts, origin = [0, 0, 0]) {
  const built = parts.map((part) => {
    const [x, y, z, qw, qx, qy, qz] = part.pose;
    const size = part.shape === "mesh" ? [1, 1, 1] : part.size;
    const place = new Vector3(x - origin[0], y - origin[1], z - origin[2]);
    return geometryOf(part).applyMatrix4(new Matrix4().compose(place, new Quaternion(qx, qy, qz, qw), new Vector3(...size)));
  });
  const count = built.reduce((sum, one) => sum + one.attributes.position.count, 0);
  const [positions, normals, colors] = [0, 1, 2].map(() => new Float32Array(3 * count));
  let from = 0;
  built.forEach((geometry, i) => {
    const [r, g, b] = parts[i].color.map((value) => value / 255);
    const tint = new Color().setRGB(r, g, b, SRGBColorSpace).toArray();
    const size = geometry.attributes.position.count;
    positions.set(geometry.attributes.position.array, 3 * from);
    normals.set(geometry.attributes.normal.array, 3 * from);
    for (let k = 0; k < size; k++) colors.set(tint, 3 * (from + k));
    from += size;
    geometry.dispose();
  });
  const out = new BufferGeometry();
  out.setAttribute("position", new BufferAttribute(positions, 3));
  out.setAttribute("normal", new BufferAttribute(normals, 3));
  out.setAttribute("color", new BufferAttribute(colors, 3));
  return out;
}
