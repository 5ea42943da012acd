// What the map shows, layer by layer, in metres with y up.
import { array } from "../decode.js";
import { otherPlaces, particleDashes } from "../belief.js";
import { C, isApart } from "../run.js";
import { palette, speedColor } from "../theme.js";
import { poseGraph } from "./graph.js";

const JUMP = 0.5; // An estimate that moves by more [m] in a row was corrected: a line there would look like a path.

function polyline(context, points, stride = 2) {
  context.beginPath();
  for (let i = 0; i + 1 < points.length; i += stride) context.lineTo(points[i], points[i + 1]);
}

function grid(context, raster, opacity = 1) {
  const [x, y, yaw] = raster.origin;
  context.save();
  context.globalAlpha = opacity;
  context.translate(x, y);
  context.rotate(yaw ?? 0);
  context.scale(raster.resolution, -raster.resolution);
  context.imageSmoothingEnabled = false;
  context.drawImage(raster.canvas, 0, -raster.height);
  context.restore();
}

/** The trail in stretches of one colour, from the rows up to the one shown. */
function trail(context, rows, index, top, pixel) {
  context.lineWidth = 2.6 * pixel;
  context.lineCap = "round";
  const colorOf = (i) => Math.round(Math.min(1, Math.abs(rows[i][C.v]) / top) * 12);
  let from = 0;
  while (from < index) {
    const bin = colorOf(from);
    let to = from + 1;
    while (to < index && colorOf(to) === bin) to++;
    context.strokeStyle = `rgb(${speedColor(bin / 12).map(Math.round)})`;
    context.beginPath();
    for (let i = from; i <= to; i++) context.lineTo(rows[i][C.x], rows[i][C.y]);
    context.stroke();
    from = to;
  }
}

function marker(context, pose, color, pixel, label) {
  if (!pose) return;
  const radius = 8 * pixel;
  context.strokeStyle = context.fillStyle = color;
  context.lineWidth = 2.4 * pixel;
  context.beginPath();
  context.arc(pose[0], pose[1], radius, 0, 2 * Math.PI);
  context.stroke();
  if (pose[2] !== null && pose[2] !== undefined) {
    const [c, s] = [Math.cos(pose[2]), Math.sin(pose[2])];
    const at = (along, across) => [pose[0] + radius * (c * along - s * across), pose[1] + radius * (s * along + c * across)];
    context.beginPath();
    context.moveTo(...at(2.1, 0));
    context.lineTo(...at(1.2, 0.7));
    context.lineTo(...at(1.2, -0.7));
    context.fill();
  }
  if (!label) return;
  context.save();
  context.translate(pose[0], pose[1]);
  context.scale(pixel, -pixel);
  context.font = "600 10px system-ui, sans-serif";
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(label, 0, 0.5);
  context.restore();
}

function robot(context, scene, state, layers, look, pixel) {
  const [x, y, yaw] = state.pose;
  const corners = scene.robot?.footprint ?? [];
  context.save();
  context.translate(x, y);
  context.rotate(yaw);
  context.beginPath();
  for (const [px, py] of corners) context.lineTo(px, py);
  context.closePath();
  const clearance = state.row?.[C.clearance];
  if (layers.clearance && clearance > 0) {
    context.lineJoin = "round";
    context.lineWidth = 2 * clearance;
    context.globalAlpha = 0.16;
    context.strokeStyle = look.goal;
    context.stroke();
    context.globalAlpha = 1;
  }
  context.fillStyle = look.robot;
  context.globalAlpha = 0.85;
  context.fill();
  context.globalAlpha = 1;
  if (layers.footprint) {
    context.lineWidth = 1.6 * pixel;
    context.strokeStyle = look.goal;
    context.stroke();
  }
  const reach = Math.max(...corners.map(([px]) => px), 0.1);
  context.beginPath();
  context.moveTo(Math.max(reach, 9 * pixel), 0);
  context.lineTo(0, Math.max(reach * 0.45, 4.5 * pixel));
  context.lineTo(0, -Math.max(reach * 0.45, 4.5 * pixel));
  context.fillStyle = look.goal;
  context.fill();
  context.restore();
}

function outline(context, scene, [x, y, yaw], pixel) {
  const corners = scene.robot?.footprint ?? [];
  const reach = Math.max(...corners.map(([px]) => px), 0.1);
  context.save();
  context.translate(x, y);
  context.rotate(yaw);
  context.beginPath();
  for (const [px, py] of corners) context.lineTo(px, py);
  context.closePath();
  context.moveTo(Math.max(reach, 9 * pixel) * 0.8, 0);
  context.lineTo(0, Math.max(reach * 0.36, 3.6 * pixel));
  context.lineTo(0, -Math.max(reach * 0.36, 3.6 * pixel));
  context.closePath();
  context.restore();
}

/** What the robot believes of its pose: its estimate and where that has been, particles, and other places. */
function belief(context, app, state, look, pixel) {
  const { layers, run, scene, frame } = app;
  const believed = frame?.belief;
  context.strokeStyle = context.fillStyle = look.belief;
  if (layers.particles && believed?.particles) {
    const ends = particleDashes(believed, Math.max(0.12, 5 * pixel));
    context.lineWidth = Math.max(1.2 * pixel, 0.012);
    context.globalAlpha = 0.55;
    context.beginPath();
    for (let i = 0; i < ends.length; i += 4) {
      context.moveTo(ends[i], ends[i + 1]);
      context.lineTo(ends[i + 2], ends[i + 3]);
    }
    context.stroke();
  }
  if (layers.estimate) {
    const estimate = state.estimate ?? believed?.pose;
    if (layers.trail && state.estimate) {
      context.globalAlpha = 0.8;
      context.lineWidth = 1.4 * pixel;
      context.setLineDash([5 * pixel, 3 * pixel]);
      context.beginPath();
      let before = null;
      for (let i = 0; i <= state.index; i++) {
        const at = [run.rows[i][C.ex] ?? run.rows[i][C.x], run.rows[i][C.ey] ?? run.rows[i][C.y]];
        const jumps = !before || Math.hypot(at[0] - before[0], at[1] - before[1]) > JUMP;
        if (jumps) context.moveTo(...at);
        else context.lineTo(...at);
        before = at;
      }
      context.stroke();
      context.setLineDash([]);
    }
    if (believed?.ellipse && estimate) {
      const [a, b, angle] = believed.ellipse;
      context.beginPath();
      context.ellipse(estimate[0], estimate[1], a, b, angle, 0, 2 * Math.PI);
      context.lineWidth = 1.6 * pixel;
      context.globalAlpha = 0.16;
      context.fill();
      context.globalAlpha = 0.9;
      context.stroke();
    }
    const shown = otherPlaces(believed).map((place) => [place, 0.2 + 0.5 * place[3]]);
    if (estimate && (isApart(state.pose, estimate) || !state.pose)) shown.push([estimate, 0.75]);
    for (const [place, strength] of shown) {
      outline(context, scene, place, pixel);
      context.globalAlpha = strength * 0.5;
      context.fill();
      context.globalAlpha = Math.min(1, strength + 0.25);
      context.lineWidth = 1.6 * pixel;
      context.stroke();
    }
    context.globalAlpha = 1;
    if (otherPlaces(believed).length) for (const [x, y, , weight] of believed.places) label(context, `${Math.round(100 * weight)} %`, x, y, look, pixel);
  }
  context.globalAlpha = 1;
}

/** A robot beside the first one, of a loop of one's own: its path, its trail, itself and its name. */
function others(context, scene, other, layers, look, pixel) {
  context.lineWidth = 2 * pixel;
  if (layers.path && other.path) {
    context.strokeStyle = look.path;
    polyline(context, other.path);
    context.stroke();
  }
  if (layers.trail) {
    context.strokeStyle = look.mover;
    polyline(context, other.rows.flatMap((row) => [row[C.x], row[C.y]]));
    context.stroke();
  }
  robot(context, scene, other, layers, look, pixel);
  name(context, other, look, pixel);
}

const name = (context, { name: text, pose }, look, pixel) => label(context, text, pose[0], pose[1], look, pixel);

function label(context, text, x, y, look, pixel) {
  context.save();
  context.translate(x, y);
  context.scale(pixel, -pixel);
  context.font = "600 11px system-ui, sans-serif";
  context.textAlign = "center";
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeStyle = look.outside;
  context.strokeText(text, 0, -14); // Words lie over occupied cells, too.
  context.fillStyle = look.ink;
  context.fillText(text, 0, -14);
  context.restore();
}

function frameLayers(context, app, look, pixel) {
  const { layers, frame } = app;
  const { scans = [], movers = [], tracks = [], rollouts = [], contacts = [] } = frame ?? {};
  if (layers.scan) {
    context.fillStyle = look.scan;
    const size = Math.max(2.2 * pixel, 0.03);
    for (const { pose: [x, y, , yaw], points } of scans) {
      const local = array(points);
      const [c, s] = [Math.cos(yaw) / 100, Math.sin(yaw) / 100];
      for (let i = 0; i + 1 < local.length; i += 2) {
        context.fillRect(x + c * local[i] - s * local[i + 1] - size / 2, y + s * local[i] + c * local[i + 1] - size / 2, size, size);
      }
    }
  }
  if (layers.rollouts) {
    context.strokeStyle = look.path;
    context.globalAlpha = 0.35;
    context.lineWidth = pixel;
    for (const line of rollouts) {
      polyline(context, line.flatMap((point) => point.slice(0, 2)));
      context.stroke();
    }
    context.globalAlpha = 1;
  }
  if (layers.movers) {
    context.fillStyle = look.mover;
    for (const [, x, y] of movers) {
      context.beginPath();
      context.arc(x, y, Math.max(0.22, 4 * pixel), 0, 2 * Math.PI);
      context.fill();
    }
  }
  if (layers.tracks) {
    context.strokeStyle = look.mover;
    context.lineWidth = 1.6 * pixel;
    for (const [x, y, vx, vy, r] of tracks) {
      context.beginPath();
      context.arc(x, y, r, 0, 2 * Math.PI);
      context.moveTo(x, y);
      context.lineTo(x + vx, y + vy);
      context.stroke();
    }
  }
  if (layers.contacts) {
    context.strokeStyle = look.contact;
    context.lineWidth = 2.4 * pixel;
    for (const [x, y] of contacts) {
      const arm = 6 * pixel;
      context.beginPath();
      context.moveTo(x - arm, y - arm);
      context.lineTo(x + arm, y + arm);
      context.moveTo(x - arm, y + arm);
      context.lineTo(x + arm, y - arm);
      context.stroke();
    }
  }
}

function goals(context, app, look, pixel) {
  const poses = app.goalsShown;
  poses.forEach((pose, i) => marker(context, pose, look.goal, pixel, poses.length > 1 ? String(i + 1) : ""));
  if (app.isSettingUp) marker(context, app.placed.start, look.path, pixel);
}

function draft(context, pose, color, pixel) {
  marker(context, pose, color, pixel);
  context.strokeStyle = color;
  context.lineWidth = pixel;
  const arm = 18 * pixel;
  context.beginPath();
  context.moveTo(pose[0] - arm, pose[1]);
  context.lineTo(pose[0] + arm, pose[1]);
  context.moveTo(pose[0], pose[1] - arm);
  context.lineTo(pose[0], pose[1] + arm);
  context.stroke();
}

export function drawMap(context, app, state, view) {
  const look = palette();
  const { layers, run, scene } = app;
  context.fillStyle = look.outside;
  context.fillRect(0, 0, view.width, view.height);
  context.save();
  context.translate(view.width / 2, view.height / 2);
  context.scale(view.scale, -view.scale);
  context.translate(-view.x, -view.y);
  const pixel = 1 / view.scale;
  if (layers.map && app.grid) grid(context, app.grid);
  if (layers.costmap && app.costmap) grid(context, app.costmap, 0.8);
  if (layers.graph && app.mapped) poseGraph(context, app.mapped, look, pixel, label);
  if (layers.path && state.path) {
    context.strokeStyle = look.path;
    context.lineWidth = 2 * pixel;
    polyline(context, state.path);
    context.stroke();
  }
  for (const other of state.others ?? []) others(context, scene, other, layers, look, pixel);
  if (layers.trail) trail(context, run.rows, state.index, scene.robot?.limits?.v || 1, pixel);
  frameLayers(context, app, look, pixel);
  if (layers.goals) goals(context, app, look, pixel);
  belief(context, app, state, look, pixel);
  if (state.pose && run.rows.length) robot(context, scene, state, layers, look, pixel);
  if (state.pose && state.name) name(context, state, look, pixel);
  if (app.draft) draft(context, app.draft, app.tool === "pose" ? look.belief : look.goal, pixel);
  context.restore();
}
