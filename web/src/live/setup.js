// The form before a run: what to drive, where from and where to.
import { h } from "../dom.js";
import { onLanguage, say, t } from "../strings.js";

const FIELDS = ["world", "robot", "planner", "controller"];

const written = (pose) => (pose ? `${pose[0].toFixed(2)}, ${pose[1].toFixed(2)}${pose[2] === null ? "" : `, ${Math.round((pose[2] * 180) / Math.PI)}°`}` : t("auto"));

export class Setup {
  constructor(app, live) {
    this.app = app;
    this.live = live;
    this.selects = Object.fromEntries(FIELDS.map((name) => [name, h("select", { id: name, onchange: () => this.changed(name) })]));
    this.seed = h("input", { id: "seed", type: "number", min: 0, step: 1, placeholder: say("auto0"), inputMode: "numeric" });
    this.values = { start: h("output"), goal: h("output") };
    this.buttons = Object.fromEntries(
      ["start", "goal"].map((name) => [
        name,
        h("button", { type: "button", id: `set-${name}`, "aria-pressed": "false", onclick: () => app.setTool(app.tool === name ? null : name) }, say(name)),
      ]),
    );
    this.go = h("button", { type: "submit", id: "go", class: "main" }, say("go"));
    const places = ["start", "goal"].map((name) => h("div", { class: "place" }, this.buttons[name], this.values[name]));
    this.element = h(
      "form",
      { class: "panel setup", onsubmit: (event) => this.submit(event), "aria-label": say("newRun") },
      h("h2", {}, say("newRun")),
      ...FIELDS.map((name) => h("label", {}, h("span", {}, say(name)), this.selects[name])),
      h("label", {}, h("span", {}, say("seed")), this.seed),
      this.go,
      h("p", { class: "soft" }, say("choose")),
      ...places,
    );
    app.on("hello", (hello) => this.fill(hello));
    app.on("placed", (placed) => this.placed(placed));
    app.on("tool", (tool) => {
      for (const [name, element] of Object.entries(this.buttons)) element.setAttribute("aria-pressed", String(tool === name && app.isSettingUp));
    });
    for (const name of ["state", "drivers"]) app.on(name, () => this.show());
    onLanguage(() => this.show());
    this.show();
  }

  fill({ choices = {} }) {
    for (const name of FIELDS) {
      const select = this.selects[name];
      const chosen = select.value;
      const options = choices[`${name}s`] ?? [];
      select.replaceChildren(...options.map((value) => h("option", { value }, value)));
      if (options.includes(chosen)) select.value = chosen;
    }
  }

  changed(name) {
    if (name !== "world" && name !== "robot") return;
    if (name === "world") this.app.placed = {};
    this.live.send("preview", { world: this.selects.world.value, robot: this.selects.robot.value });
    this.show();
  }

  placed({ tool, pose }) {
    if (!this.app.isSettingUp || (tool !== "start" && tool !== "goal")) return;
    this.app.placed[tool] = tool === "start" ? [pose[0], pose[1], pose[2] ?? 0] : pose;
    this.app.setTool(tool === "start" && !this.app.placed.goal ? "goal" : null);
    this.show();
  }

  show() {
    this.element.hidden = !this.app.isSettingUp;
    for (const name of ["start", "goal"]) this.values[name].value = written(this.app.placed[name]);
    for (const element of this.element.querySelectorAll("button, select, input")) element.disabled = !this.live.youDrive;
  }

  submit(event) {
    event.preventDefault();
    const chosen = Object.fromEntries(FIELDS.map((name) => [name, this.selects[name].value || null]));
    const seed = Number.parseInt(this.seed.value, 10);
    const { start, goal } = this.app.placed;
    this.app.setTool(null);
    this.live.send("setup", { ...chosen, seed: Number.isNaN(seed) ? null : seed, start: start ?? null, goal: goal ?? null });
  }
}
