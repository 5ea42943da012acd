// The page of a loop of one's own: what it shows, a goal to click, and the keys that it gets.
import { h, icon, takesKeys } from "../dom.js";
import { header, layout, notes, sceneBox } from "../layout.js";
import { stateText } from "../belief.js";
import { Drivers } from "../live/drivers.js";
import { clockText } from "../panels.js";
import { onLanguage, say, t } from "../strings.js";
import { Keys } from "./keys.js";
import { ViewLive } from "./live.js";
import { Others } from "./robots.js";

/** What the loop says, for the bar, and where its robots are. */
class Headline {
  constructor(app) {
    this.app = app;
    this.text = h("p", { class: "doing", role: "status" });
    this.figures = h("dl", { class: "figures poses" });
    this.located = h("p", { class: "located", role: "status", hidden: true });
    this.element = h("section", { id: "status", class: "panel", "aria-label": say("status") }, this.located, this.figures);
  }

  show(state) {
    const text = this.app.frame?.text ?? "";
    if (this.text.textContent !== text) this.text.textContent = text;
    const belief = this.app.frame?.belief;
    const located = belief ? `${t("position")}: ${stateText(belief.state, belief)}` : "";
    if (this.located.textContent !== located) this.located.textContent = located;
    this.located.hidden = !located;
    this.located.dataset.state = belief?.state ?? "";
    const robots = state.pose ? [state, ...state.others] : [];
    const rows = [[t("time"), clockText(state.t)], ...robots.map(({ name, pose: [x, y, yaw] }) => [name || t("robot"), `${x.toFixed(2)}, ${y.toFixed(2)}, ${Math.round((yaw * 180) / Math.PI)}°`])];
    while (this.figures.childElementCount > rows.length) this.figures.lastElementChild.remove();
    while (this.figures.childElementCount < rows.length) this.figures.append(h("div", {}, h("dt"), h("dd")));
    rows.forEach((row, i) => {
      for (const [k, cell] of [...this.figures.children[i].children].entries()) if (cell.textContent !== row[k]) cell.textContent = row[k];
    });
  }
}

/** The bar below the 3D view: the headline, the goal, and the keys that are held. */
class Bar {
  constructor(app, live, headline) {
    this.app = app;
    this.live = live;
    this.goal = h("button", { type: "button", id: "goal", class: "main wide", onclick: () => this.toggle("goal"), "aria-pressed": "false" }, icon("goal"), say("goal"));
    this.pose = h("button", { type: "button", id: "set-pose", onclick: () => this.toggle("pose"), "aria-pressed": "false", title: say("setPoseHint") }, icon("pose"), say("setPose"));
    this.hint = h("p", { class: "hint", role: "status" });
    this.held = h("output", { id: "keys", "aria-label": say("keysHeld") });
    this.element = h("div", { class: "steering", role: "toolbar", "aria-label": say("goal") }, headline, h("div", { class: "row" }, this.goal, this.pose, this.held), this.hint);
    for (const name of ["drivers", "link", "state", "tool"]) app.on(name, () => this.show());
    app.on("frame", () => (this.pose.hidden = !app.run.isLocalized));
    app.on("placed", ({ tool, pose }) => {
      const known = tool === "pose" ? [pose[0], pose[1], pose[2] ?? app.frame?.belief?.pose[2] ?? 0] : pose;
      live.send(tool, { pose: known.map((value) => (value === null ? null : Number(value.toFixed(3)))) });
      app.setTool(null);
      document.activeElement?.blur(); // Keys are for the loop again.
    });
    app.on("keys", (held) => (this.held.value = held.map((name) => (name === " " ? "Space" : name)).join(" ")));
    onLanguage(() => this.show());
    document.addEventListener("keydown", (event) => this.key(event));
    this.show();
  }

  toggle(tool) {
    this.app.setTool(this.app.tool === tool ? null : tool);
    if (this.app.tool) this.app.emit("wants_point");
  }

  key(event) {
    if (event.ctrlKey || event.altKey || event.metaKey || event.repeat || takesKeys(event.target)) return;
    if (event.key === "Escape" && this.app.tool) this.app.setTool(null);
    else if (event.key.toLowerCase() === "g" && !this.goal.disabled) {
      event.preventDefault();
      this.toggle("goal");
    }
  }

  show() {
    const { app, live } = this;
    this.pose.hidden = !app.run.isLocalized;
    this.goal.disabled = this.pose.disabled = !(live.youDrive && live.link?.isOpen && app.state === "running");
    this.goal.setAttribute("aria-pressed", String(app.tool === "goal"));
    this.pose.setAttribute("aria-pressed", String(app.tool === "pose"));
    this.hint.textContent = app.tool ? `${t(app.tool === "pose" ? "hintPose" : "hintGoal")} ${t("mapKeys")}` : t(app.state === "ended" ? "ended" : live.youDrive ? "viewKeys" : "youWatch");
    if (this.goal.disabled && app.tool) app.setTool(null);
  }
}

export function startView(app, views) {
  const live = new ViewLive(app);
  const status = new Headline(app);
  const bar = new Bar(app, live, status.text);
  new Keys(app, live);
  const drivers = new Drivers(app, live);
  const others = views.stage ? new Others(app, views.stage) : null;
  let begun = null;
  app.on("frame", ({ robots }) => {
    if (begun !== app.run && robots.length === 1) views.stage?.cameras.startRun(); // It follows one robot, as in a run.
    begun = app.run;
  });
  app.on("wants_point", () => views.map.canvas.focus({ preventScroll: true }));
  layout(app, {
    head: header(app, drivers.element),
    scene: sceneBox(app, views.stage, drivers.request, notes(app)),
    map: views.map.element,
    under: bar.element,
    side: [status.element],
  });
  return {
    status,
    plots: { show() {} },
    advance(seconds) {
      const time = app.clock.advance(app.run.duration, seconds, app.state === "ended");
      if (app.scene) others?.show(app.run.at(time).others ?? []);
      return time;
    },
  };
}
