// Choosing a pose: press, drag for the heading, release; or move a cross with keys. Shared by both views.

const DRAG = 0.15; // A drag shorter than this [m] sets no heading.

export class Placing {
  constructor(app) {
    this.app = app;
    this.from = null;
  }

  /** Lets presses on `element` choose poses, where `pick(event)` gives a point of the floor. */
  attach(element, pick) {
    element.addEventListener("pointerdown", (event) => {
      if (!this.app.tool || event.button > 0) return;
      const point = pick(event);
      if (!point) return;
      this.from = point;
      this.pointer = event.pointerId;
      element.setPointerCapture(event.pointerId);
      this.show([...point, null]);
      event.preventDefault();
    });
    element.addEventListener("pointermove", (event) => {
      if (!this.from || event.pointerId !== this.pointer) return;
      const point = pick(event);
      if (!point) return;
      const [dx, dy] = [point[0] - this.from[0], point[1] - this.from[1]];
      this.show([...this.from, Math.hypot(dx, dy) > DRAG ? Math.atan2(dy, dx) : null]);
    });
    element.addEventListener("pointerup", (event) => {
      if (!this.from || event.pointerId !== this.pointer) return;
      this.from = null;
      this.done(this.app.draft, event.shiftKey);
    });
    element.addEventListener("pointercancel", () => this.cancel());
  }

  /** A key press on a view while a pose is chosen; true where it was one of ours. */
  key(event, center, step) {
    if (!this.app.tool) return false;
    if (event.key === "Escape") {
      this.app.setTool(null);
      return true;
    }
    const draft = this.app.draft ?? [...center, null];
    const move = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const turn = { q: 1, e: -1 }[event.key.toLowerCase()];
    if (move) this.show([draft[0] + move[0] * step, draft[1] + move[1] * step, draft[2]]);
    else if (turn) this.show([draft[0], draft[1], (draft[2] ?? 0) + (turn * Math.PI) / 12]);
    else if (event.key === "Enter") this.done(draft, event.shiftKey);
    else return false;
    return true;
  }

  show(pose) {
    this.app.draft = pose;
    this.app.dirty = true;
  }

  cancel() {
    this.from = null;
    this.show(null);
  }

  done(pose, append) {
    const tool = this.app.tool;
    this.app.draft = null;
    this.app.emit("placed", { tool, pose, append });
  }
}
