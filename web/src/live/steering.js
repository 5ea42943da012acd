// The bar that steers a run: pause, step, speed, goal, queue, restart, box, end.
import { h, icon, namedButton, takesKeys } from "../dom.js";
import { C } from "../run.js";
import { onLanguage, say, t } from "../strings.js";

const SPEEDS = [0.1, 0.2, 0.5, 1, 2, 3, 5, 10, 20, 50, "max"];
const COVARIANCE = [[0.25, 0, 0], [0, 0.25, 0], [0, 0, 0.0685]]; // RViz's, of x, y [m²] and yaw [rad²].
const BOX = [0.4, 0.4, 0.6];

const named = (factor) => (factor === "max" ? t("max") : `× ${factor}`);

export class Steering {
  constructor(app, live) {
    this.app = app;
    this.live = live;
    this.pause = namedButton("pause", say("pause"), say("pauseHint"), () => this.togglePause(), { id: "pause", class: "named main" });
    this.step = namedButton("step", say("step"), say("stepHint"), () => live.order("step"), { id: "step" });
    this.goal = namedButton("goal", say("goal"), say("goalHint"), () => this.toggle("goal"), { id: "goal", class: "named main wide", "aria-pressed": "false" });
    this.pose = namedButton("pose", say("setPose"), say("setPoseHint"), () => this.toggle("pose"), { id: "set-pose", "aria-pressed": "false" });
    this.find = namedButton("search", say("findPose"), say("findPoseHint"), () => live.order("reinitialize"), { id: "find-pose" });
    this.queue = h("input", { type: "checkbox", id: "queue" });
    this.box = namedButton("box", say("box"), say("boxHint"), () => this.toggle("box"), { "aria-pressed": "false", id: "box" });
    this.restart = namedButton("restart", say("restart"), say("restartHint"), () => live.order("restart", { seed: null }), { id: "restart" });
    this.next = namedButton("next", say("next"), say("nextHint"), () => live.order("restart", { seed: "next" }), { id: "next" });
    this.end = namedButton("stop", say("stop"), say("stopHint"), () => live.order("end"), { id: "end" });
    this.speed = h("input", {
      type: "range", id: "speed", min: 0, max: SPEEDS.length - 1, step: 1, value: SPEEDS.indexOf(1), oninput: () => this.setSpeed(),
    });
    this.speedText = h("output", { htmlFor: "speed", class: "speed-text" });
    this.hint = h("p", { class: "hint", role: "status" });
    this.element = h(
      "div",
      { class: "steering", role: "toolbar", "aria-label": say("drive") },
      h("div", { class: "row" }, this.pause, this.step, this.goal,
        h("label", { class: "check", title: say("queueHint") }, this.queue, say("queue")), this.pose, this.find, this.box, this.restart, this.next, this.end),
      h("label", { class: "row speed" }, h("span", {}, say("speed")), this.speed, this.speedText),
      this.hint,
    );
    app.on("tool", (tool) => this.showTool(tool));
    app.on("placed", (placed) => this.placed(placed));
    for (const name of ["state", "drivers", "link", "run"]) app.on(name, () => this.show());
    app.on("frame", (frame) => this.showSpeed(frame));
    document.addEventListener("keydown", (event) => this.key(event));
    onLanguage(() => {
      this.show();
      this.showTool(app.tool);
    });
    this.showText();
    this.show();
  }

  togglePause() {
    this.live.order("pause", { paused: !this.app.paused });
  }

  toggle(tool) {
    this.app.setTool(this.app.tool === tool ? null : tool);
    if (this.app.tool) this.app.emit("wants_point");
  }

  placed({ tool, pose, append }) {
    if (tool === "goal" && this.going) {
      const queued = append || this.queue.checked;
      this.live.order("goal", { pose, append: queued });
      if (!queued) this.app.setTool(null);
    }
    if (tool === "pose" && this.going) {
      const yaw = pose[2] ?? this.app.run.rows.at(-1)?.[C.eyaw] ?? 0;
      this.live.order("pose", { pose: [pose[0], pose[1], yaw], covariance: COVARIANCE });
      this.app.setTool(null);
    }
    if (tool === "box") {
      this.live.order("box", { x: pose[0], y: pose[1], yaw: pose[2] ?? 0, size: BOX });
      this.app.setTool(null);
    }
  }

  setSpeed() {
    this.wanted = performance.now();
    this.live.order("speed", { factor: SPEEDS[this.speed.value] });
    this.showText();
  }

  // Another client's choice moves the slider, but not while it is being moved here.
  showSpeed({ speed }) {
    const index = SPEEDS.indexOf(speed);
    const mine = this.wanted && performance.now() - this.wanted < 1000;
    if (index >= 0 && !mine) this.speed.value = index;
    this.showText();
  }

  showText() {
    const wanted = named(SPEEDS[this.speed.value]);
    const { factor, state } = this.app;
    const real = factor && state === "running" ? t("real", { x: factor < 10 ? factor.toFixed(2) : factor.toFixed(0) }) : "";
    this.speed.setAttribute("aria-valuetext", wanted);
    this.speedText.value = real ? `${wanted} · ${real}` : wanted;
  }

  showTool(tool) {
    for (const [name, element] of [["goal", this.goal], ["pose", this.pose], ["box", this.box]]) element.setAttribute("aria-pressed", String(tool === name && !element.disabled));
    const hint = { goal: "hintGoal", start: "hintStart", box: "hintBox", pose: "hintPose" }[tool];
    this.hint.textContent = hint ? `${t(hint)} ${t("mapKeys")}` : "";
  }

  show() {
    const { state } = this.app;
    const drives = this.live.youDrive && this.live.link?.isOpen;
    const going = drives && this.app.isGoing;
    this.going = going;
    for (const element of [this.pause, this.goal, this.pose, this.find, this.box, this.end, this.queue]) element.disabled = !going;
    this.pause.disabled = !going || state === "waiting";
    this.step.disabled = !going || state !== "paused";
    for (const element of [this.pause, this.step, this.goal, this.queue.parentElement, this.box, this.end]) element.hidden = this.app.isSettingUp;
    for (const element of [this.pose, this.find]) element.hidden = this.app.isSettingUp || !this.app.run.isLocalized;
    this.find.hidden ||= this.app.lacks.has("find") || !this.app.run.canSearch;
    for (const element of [this.restart, this.next]) element.hidden = state === "idle" || this.app.lacks.has("restart");
    this.box.hidden ||= this.app.lacks.has("box");
    this.speed.parentElement.hidden = this.app.lacks.has("speed");
    this.speed.disabled = !drives;
    for (const element of [this.restart, this.next]) element.disabled = !drives || state === "idle";
    const paused = state === "paused";
    const label = t(paused ? "resume" : "pause");
    this.pause.replaceChildren(icon(paused ? "play" : "pause"), h("span", { class: "name" }, label));
    this.pause.setAttribute("aria-label", label);
    this.pause.setAttribute("aria-pressed", String(paused));
    if ((!going && (this.app.tool === "box" || this.app.tool === "pose")) || (going && this.app.tool === "start")) this.app.setTool(null);
    this.showText();
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.repeat) return;
    if (event.key === "Escape" && this.app.tool) return this.app.setTool(null);
    if (takesKeys(event.target)) return;
    const onButton = event.target.closest?.("button, a, summary");
    const press = { " ": onButton ? null : this.pause, n: this.step, g: this.goal, b: this.box.hidden ? null : this.box, p: this.pose.hidden ? null : this.pose }[event.key];
    if (!press || press.disabled) return;
    event.preventDefault();
    press.click();
  }
}
