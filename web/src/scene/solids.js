// The world's solids: one instanced mesh for each shape, whatever their number.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DoubleSide, Group, InstancedBufferAttribute,
  InstancedMesh, Matrix4, Mesh, MeshLambertMaterial, Quaternion, SphereGeometry, SRGBColorSpace, Vector3,
} from "three";
import { array } from "../decode.js";

export const shapes = {
  box: () => new BoxGeometry(1, 1, 1),
  cylinder: () => new CylinderGeometry(1, 1, 1, 20).rotateX(Math.PI / 2),
  sphere: () => new SphereGeometry(1, 20, 12),
};

/** Where the robot is and how far a wall is cut away: shared by every material of the world. */
export const cutaway = { robot: { value: new Vector3(0, 0, -1e6) }, on: { value: 1 } };

const WALL_REACH = 0.7; // A wall is an outer one within this distance [m] of the world's bounds.

// What stands between camera and robot is cut away so far around the robot [m], as it looks from the camera; what is
// nearer to the camera, and hides more, farther.
const CUT_M = "1.3";

// Fades outer walls seen from outside, and cuts away what hides the robot from the camera, with an edge that fades:
// a grain without a visible pattern (interleaved gradient noise, Jimenez 2014) needs no sorting, as blending would.
function patch(material, wall) {
  material.onBeforeCompile = (shader) => {
    shader.uniforms.robotAt = cutaway.robot;
    shader.uniforms.cutOn = cutaway.on;
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", `#include <common>\n${wall ? "attribute vec3 outward; varying float seen;" : ""} varying vec3 at;`)
      .replace(
        "#include <project_vertex>",
        `#include <project_vertex>
        vec4 inWorld = vec4(transformed, 1.0);
        #ifdef USE_INSTANCING
          inWorld = instanceMatrix * inWorld;
        #endif
        at = (modelMatrix * inWorld).xyz;
        ${wall ? "seen = length(outward.xy) < 0.5 ? 0.0 : smoothstep(-0.2, 0.4, dot(cameraPosition.xy, outward.xy) - outward.z);" : ""}`,
      );
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", `#include <common>\nuniform vec3 robotAt; uniform float cutOn; varying vec3 at; ${wall ? "varying float seen;" : ""}`)
      .replace(
        "#include <opaque_fragment>",
        `#include <opaque_fragment>
        vec3 sight = robotAt - cameraPosition;
        float along = dot(at - cameraPosition, sight) / dot(sight, sight);
        if (cutOn > 0.5 && along > 0.0 && along < 0.97 && at.z > 0.08) {
          float off = length((at - cameraPosition) / along - sight);
          float cut = ${CUT_M} * (2.4 - 1.4 * along);
          float grain = fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
          if (grain >= smoothstep(0.7 * cut, cut, off)) discard;
        }
        ${wall ? "gl_FragColor.a *= mix(1.0, 0.1, seen);" : ""}`,
      );
  };
  material.customProgramCacheKey = () => `solids-${wall}`;
  return material;
}

// The outward normal (x, y) of an outer wall and its distance from the origin; zeros for a wall inside.
function outward(pose, size, i, bounds) {
  const [x, y] = [pose[7 * i], pose[7 * i + 1]];
  const yaw = 2 * Math.atan2(pose[7 * i + 6], pose[7 * i + 3]);
  const turn = size[3 * i] < size[3 * i + 1] ? yaw : yaw + Math.PI / 2;
  let [nx, ny] = [Math.cos(turn), Math.sin(turn)];
  const [cx, cy] = [(bounds[0] + bounds[3]) / 2, (bounds[1] + bounds[4]) / 2];
  if (nx * (x - cx) + ny * (y - cy) < 0) [nx, ny] = [-nx, -ny];
  const reach = Math.abs(nx) * (bounds[3] - cx) + Math.abs(ny) * (bounds[4] - cy) + nx * cx + ny * cy;
  const distance = nx * x + ny * y;
  return reach - distance < WALL_REACH ? [nx, ny, distance] : [0, 0, 0];
}

function instanced(shape, chosen, pose, size, color, kind, bounds) {
  const geometry = shapes[shape]();
  const clear = kind !== "solid";
  const material = patch(new MeshLambertMaterial({ transparent: clear, opacity: kind === "glass" ? 0.45 : 1 }), kind === "wall");
  const mesh = new InstancedMesh(geometry, material, chosen.length);
  const [matrix, place, turn, scale, tint] = [new Matrix4(), new Vector3(), new Quaternion(), new Vector3(), new Color()];
  const normals = kind === "wall" ? new Float32Array(3 * chosen.length) : null;
  chosen.forEach((i, k) => {
    place.fromArray(pose, 7 * i);
    turn.set(pose[7 * i + 4], pose[7 * i + 5], pose[7 * i + 6], pose[7 * i + 3]);
    mesh.setMatrixAt(k, matrix.compose(place, turn, scale.fromArray(size, 3 * i)));
    tint.setRGB(color[4 * i] / 255, color[4 * i + 1] / 255, color[4 * i + 2] / 255, SRGBColorSpace);
    mesh.setColorAt(k, tint);
    normals?.set(outward(pose, size, i, bounds), 3 * k);
  });
  if (normals) geometry.setAttribute("outward", new InstancedBufferAttribute(normals, 3));
  mesh.computeBoundingSphere();
  return mesh;
}

/** Meshes of {"shape", "pose", "size", "color", "wall"}: solids, walls and glass apart. */
function instances(group, encoded, bounds) {
  const [pose, size, color, wall] = ["pose", "size", "color", "wall"].map((key) => array(encoded[key]));
  const kinds = { solid: [], wall: [], glass: [] };
  for (let i = 0; i < pose.length / 7; i++) {
    kinds[wall[i] ? "wall" : color[4 * i + 3] < 250 ? "glass" : "solid"].push(i);
  }
  for (const [kind, chosen] of Object.entries(kinds)) {
    if (chosen.length) group.add(instanced(encoded.shape, chosen, pose, size, color, kind, bounds));
  }
}

function meshOf({ vertices, triangles, color }, material) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(array(vertices), 3));
  geometry.setIndex(new BufferAttribute(array(triangles), 1));
  material.color.setRGB(color[0] / 255, color[1] / 255, color[2] / 255, SRGBColorSpace);
  return new Mesh(geometry, material);
}

/** The group of a scene's solids and meshes. */
export function buildSolids(scene) {
  const group = new Group();
  for (const encoded of scene.instances ?? []) instances(group, encoded, scene.bounds);
  for (const encoded of scene.meshes ?? []) {
    group.add(meshOf(encoded, patch(new MeshLambertMaterial({ flatShading: true, side: DoubleSide }), false)));
  }
  return group;
}

export function dispose(group) {
  group.traverse((item) => {
    item.geometry?.dispose();
    item.material?.map?.dispose();
    item.material?.dispose();
    item.dispose?.();
  });
  group.removeFromParent();
}
