// What the map of a robot that makes its own comes from: poses, the loops that were closed, and the largest corrections.

const RING = 10; // Of a correction, in pixels.

export function poseGraph(context, mapped, look, pixel, label) {
  const { poses, loops, corrections } = mapped;
  context.lineWidth = pixel;
  context.strokeStyle = look.path;
  context.globalAlpha = 0.4; // There may be hundreds, and the walls below them are to be seen.
  context.beginPath();
  for (let i = 0; i + 3 < loops.length; i += 4) {
    context.moveTo(loops[i], loops[i + 1]);
    context.lineTo(loops[i + 2], loops[i + 3]);
  }
  context.stroke();
  context.globalAlpha = 1;
  context.fillStyle = look.belief;
  const size = Math.max(3 * pixel, 0.05);
  for (let i = 0; i + 1 < poses.length; i += 2) context.fillRect(poses[i] - size / 2, poses[i + 1] - size / 2, size, size);
  context.strokeStyle = look.contact;
  context.lineWidth = 2.4 * pixel;
  for (const [x, y, metres] of corrections) {
    context.beginPath();
    context.arc(x, y, RING * pixel, 0, 2 * Math.PI);
    context.stroke();
    label(context, `${metres.toFixed(2)} m`, x, y, look, pixel);
  }
}
