// What the robot believes of its pose: particles, the ellipse around its estimate, other places, and the state in words.
import { array } from "./decode.js";
import { t } from "./strings.js";

/** The particles of a frame's belief as line ends [x, y, x, y, …]: each is a dash of this length [m] along its heading. */
export function particleDashes(belief, length) {
  const packed = belief?.particles ? array(belief.particles) : [];
  const [x0, y0] = belief?.pose ?? [0, 0];
  const ends = new Float32Array((packed.length / 3) * 4);
  for (let i = 0, k = 0; i + 2 < packed.length; i += 3, k += 4) {
    const [x, y, yaw] = [x0 + packed[i] / 100, y0 + packed[i + 1] / 100, packed[i + 2] / 1000];
    ends[k] = x;
    ends[k + 1] = y;
    ends[k + 2] = x + length * Math.cos(yaw);
    ends[k + 3] = y + length * Math.sin(yaw);
  }
  return ends;
}

/** The places where the robot may be besides its estimate, [x, y, yaw, weight]; none where it is sure. */
export function otherPlaces(belief) {
  if (!belief || belief.places.length < 2) return [];
  const [x, y, yaw] = belief.pose;
  return belief.places.filter(([px, py, pyaw]) => Math.hypot(px - x, py - y) > 0.1 || Math.cos(pyaw - yaw) < 0.98);
}

/** The state in words: "localized", "ambiguous: 3 places", "lost". */
export function stateText(state, belief) {
  const places = belief?.state === "ambiguous" ? belief.places.length : 0;
  return state === "ambiguous" && places > 1 ? t("ambiguousOf", { n: places }) : t(state);
}
