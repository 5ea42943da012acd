// Driving by hand: keys, stick and gamepad give a share of the robot's limits, sent ten times a second while held.
import { h, takesKeys } from "../dom.js";
import { saying, t } from "../strings.js";

const PERIOD_MS = 90; // The server lets go 300 ms after the last command.
const KEYS = {
  w: [1, 0], s: [-1, 0], a: [0, 1], d: [0, -1],
  ArrowUp: [1, 0], ArrowDown: [-1, 0], ArrowLeft: [0, 1], ArrowRight: [0, -1],
};
const DEAD_ZONE = 0.15;

const clamp = (value) => Math.max(-1, Math.min(1, value));

export class Teleop {
  constructor(app, live) {
    this.app = app;
    this.live = live;
    this.held = new Set();
    this.thumb = null;
    this.timer = null;
    this.knob = h("span", { class: "knob" });
    this.stick = h("div", { class: "stick", role: "img", "aria-label": saying(() => `${t("stick")}. ${t("keys")}`) }, this.knob);
    this.listen();
    app.on("state", () => this.show());
    app.on("drivers", () => this.show());
    this.show();
  }

  get allowed() {
    return this.live.youDrive && this.app.isGoing;
  }

  listen() {
    document.addEventListener("keydown", (event) => this.press(event));
    document.addEventListener("keyup", (event) => this.lift(event));
    addEventListener("blur", () => this.letGo());
    document.addEventListener("visibilitychange", () => document.hidden && this.letGo());
    this.stick.addEventListener("pointerdown", (event) => {
      this.stick.setPointerCapture(event.pointerId);
      this.move(event);
      event.preventDefault();
    });
    this.stick.addEventListener("pointermove", (event) => this.stick.hasPointerCapture(event.pointerId) && this.move(event));
    for (const name of ["pointerup", "pointercancel", "lostpointercapture"]) this.stick.addEventListener(name, () => this.center());
    addEventListener("gamepadconnected", () => this.pollPads());
  }

  press(event) {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!KEYS[key] || event.ctrlKey || event.altKey || event.metaKey || event.shiftKey || takesKeys(event.target)) return;
    if (this.app.tool || !this.allowed || (event.defaultPrevented && key.startsWith("Arrow"))) return;
    event.preventDefault();
    this.held.add(key);
    this.update();
  }

  lift(event) {
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (this.held.delete(key)) this.update();
  }

  letGo() {
    this.held.clear();
    this.center();
  }

  move(event) {
    const box = this.stick.getBoundingClientRect();
    const reach = box.width / 2;
    let [dx, dy] = [(event.clientX - box.left) / reach - 1, (event.clientY - box.top) / reach - 1];
    const length = Math.hypot(dx, dy);
    if (length > 1) [dx, dy] = [dx / length, dy / length];
    this.thumb = [-dy, -dx];
    this.update();
  }

  center() {
    this.thumb = null;
    this.update();
  }

  pollPads() {
    const pad = navigator.getGamepads().find((one) => one?.connected);
    const shares = pad ? [-(pad.axes[1] ?? 0), -(pad.axes[0] ?? 0)] : null;
    const pushed = shares && Math.hypot(...shares) > DEAD_ZONE ? shares : null;
    if (pushed || this.pad) {
      this.pad = pushed;
      this.update();
    }
    if (pad) requestAnimationFrame(() => this.pollPads());
  }

  /** Shares of forward speed and of turning to the left, -1 to 1; null while nothing is held. */
  shares() {
    if (this.thumb) return this.thumb;
    if (this.pad) return this.pad;
    if (!this.held.size) return null;
    let [forward, left] = [0, 0];
    for (const key of this.held) {
      forward += KEYS[key][0];
      left += KEYS[key][1];
    }
    return [clamp(forward), clamp(left)];
  }

  update() {
    const shares = this.allowed ? this.shares() : null;
    const [forward, left] = shares ?? [0, 0];
    this.knob.style.transform = `translate(${-left * 38}px, ${-forward * 38}px)`;
    if (shares && !this.timer) {
      this.send();
      this.timer = setInterval(() => this.send(), PERIOD_MS);
    } else if (!shares && this.timer) {
      clearInterval(this.timer);
      this.timer = null;
      this.live.order("release");
    }
  }

  send() {
    const shares = this.allowed ? this.shares() : null;
    if (!shares) return this.update();
    const { v, v_min: back, w } = this.app.scene.robot.limits;
    const [forward, left] = shares;
    this.live.order("manual", { v: forward >= 0 ? forward * v : -forward * back, w: left * w * 0.6 });
  }

  show() {
    this.stick.hidden = !this.allowed;
    this.update();
  }
}
