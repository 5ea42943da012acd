// What is going on in words and numbers: status, event log, outcome.
import { h } from "./dom.js";
import { stateText } from "./belief.js";
import { C } from "./run.js";
import { say, saying, t, told, toldEnd } from "./strings.js";

const MOST_EVENTS = 300;

// Without the sign of what rounds to zero.
const number = (value, digits, unit) => (Number.isFinite(value) ? `${value.toFixed(digits).replace(/^-(0\.?0*)$/, "$1")} ${unit}` : "–");

/** Minutes and seconds, to so many decimals. */
export function clockText(seconds, digits = 1) {
  const rounded = Number(seconds.toFixed(digits));
  return `${Math.floor(rounded / 60)}:${(rounded % 60).toFixed(digits).padStart(3 + digits, "0")}`;
}

export class Status {
  constructor(app) {
    this.app = app;
    this.cells = {};
    const figures = ["time", "speedNow", "turning", "clearance", "crossTrack", "planning", "tick", "goalNow", "offBy"].map((name) => {
      this.cells[name] = h("dd");
      return h("div", {}, h("dt", {}, say(name)), this.cells[name]);
    });
    this.doing = h("p", { class: "doing", role: "status" });
    this.located = h("p", { class: "located", role: "status", hidden: true });
    this.held = h("p", { class: "held", role: "alert", hidden: true });
    this.element = h("section", { id: "status", class: "panel", "aria-label": say("status") }, this.doing, this.located, this.held, h("dl", { class: "figures" }, ...figures));
  }

  /** What the robot does; after the end, how it ended. */
  headline(state, { doing }) {
    const { app } = this;
    const { end } = app.run;
    if (app.state === "idle") return t("idle");
    if (end && (app.mode === "live" || state.t >= app.run.duration)) return toldEnd(end);
    const said = told(doing ?? state.row?.[C.status].replaceAll("_", " ") ?? "");
    if (app.state === "paused") return said ? `${t("paused")} · ${said}` : t("paused");
    return app.state === "waiting" ? `${said} · ${t("waitsGoal")}` : said;
  }

  show(state) {
    const { app, cells } = this;
    const { row } = state;
    const frame = app.frame ?? {};
    const text = this.headline(state, frame);
    if (this.doing.textContent !== text) this.doing.textContent = text;
    const held = frame.held_back ? t("heldBack", { why: told(frame.held_back) }) : frame.manual ? t("manualBy", { id: frame.manual }) : "";
    if (this.held.textContent !== held) this.held.textContent = held;
    this.held.hidden = !held;
    this.held.classList.toggle("strong", Boolean(frame.held_back));
    this.showLocated(state, frame.belief);
    if (!row) return;
    const goals = app.run.goals.length;
    const values = {
      time: clockText(state.t, 2),
      speedNow: number(row[C.v], 2, "m/s"),
      turning: number(row[C.w], 2, "rad/s"),
      clearance: number(row[C.clearance], 2, "m"),
      crossTrack: number(row[C.cross_track], 2, "m"),
      planning: number(row[C.plan_ms], 1, "ms"),
      tick: number(row[C.tick_ms], 2, "ms"),
      goalNow: goals > 1 && Number.isInteger(row[C.goal]) ? `${Math.min(goals, row[C.goal] + 1)} / ${goals}` : goals ? "1 / 1" : "–",
      offBy: state.estimate ? number(Math.hypot(state.estimate[0] - state.pose[0], state.estimate[1] - state.pose[1]), 3, "m") : "–",
    };
    for (const [name, value] of Object.entries(values)) if (cells[name].textContent !== value) cells[name].textContent = value;
  }

  /** What the localizer says of its estimate, and the figure of how far that is from the truth. */
  showLocated({ row }, belief) {
    const said = row?.[C.state];
    const text = said ? `${t("position")}: ${stateText(said, belief)}` : "";
    if (this.located.textContent !== text) this.located.textContent = text;
    this.located.hidden = !text;
    this.located.dataset.state = said ?? "";
    this.cells.offBy.parentElement.hidden = !this.app.run.isLocalized;
  }
}

export class EventLog {
  constructor(app, seek = null) {
    this.app = app;
    this.seek = seek;
    this.shown = 0;
    this.list = h("ol", { class: "events", tabIndex: 0, "aria-label": say("events") });
    this.element = h("section", { class: "panel" }, h("h2", {}, say("events")), this.list);
    app.on("run", () => this.clear());
    app.on("log", ({ from }) => {
      if (from === 0) this.clear();
      this.show();
    });
  }

  clear() {
    this.list.replaceChildren();
    this.shown = 0;
  }

  show() {
    const { events } = this.app.run;
    const atEnd = this.list.scrollTop + this.list.clientHeight > this.list.scrollHeight - 20;
    this.list.append(...events.slice(Math.max(this.shown, events.length - MOST_EVENTS)).map((event) => this.line(event)));
    this.shown = events.length;
    while (this.list.childElementCount > MOST_EVENTS) this.list.firstElementChild.remove();
    if (atEnd) this.list.scrollTop = this.list.scrollHeight;
  }

  line({ t: time, kind, text }) {
    const when = clockText(time);
    const at = this.seek ? h("button", { type: "button", class: "link", onclick: () => this.seek(time) }, when) : h("time", {}, when);
    return h("li", { class: `kind-${kind}` }, at, h("span", {}, saying(() => told(text))));
  }
}

export class Outcome {
  constructor(app) {
    this.app = app;
    this.element = h("section", { class: "panel outcome", role: "alert", hidden: true });
    app.on("end", (end) => this.show(end));
    app.on("run", () => (this.element.hidden = true));
  }

  show({ outcome, message, folder, replay }) {
    const children = [h("h2", { class: "verdict", "data-good": String(/^(arrived|finished|succeeded)/.test(outcome)) }, saying(() => told(outcome.replaceAll("_", " "))))];
    if (message) children.push(h("p", {}, saying(() => told(message))));
    if (replay) children.push(h("p", {}, h("a", { href: replay, target: "_blank", rel: "noopener" }, say("openReplay"))));
    if (folder) children.push(h("p", { class: "soft" }, say("folder"), ": ", h("code", {}, folder)));
    this.element.replaceChildren(...children);
    this.element.hidden = false;
  }
}
