// The keys that are held, told to the loop ten times a second while there are any; none once the page loses them.
import { takesKeys } from "../dom.js";

const PERIOD_MS = 90; // The loop counts them as let go 300 ms after they were told.
const MOST = 16;
const OWN = new Set(["Tab", "Escape", "Shift", "Control", "Alt", "Meta", "g"]); // What the page takes itself.

const nameOf = (event) => (event.key.length === 1 ? event.key.toLowerCase() : event.key);

export class Keys {
  constructor(app, live) {
    this.app = app;
    this.live = live;
    this.held = new Set();
    document.addEventListener("keydown", (event) => this.press(event));
    document.addEventListener("keyup", (event) => this.held.delete(nameOf(event)) && this.tell());
    addEventListener("blur", () => this.letGo());
    document.addEventListener("visibilitychange", () => document.hidden && this.letGo());
    for (const name of ["drivers", "tool"]) app.on(name, () => (!live.youDrive || app.tool) && this.letGo());
  }

  press(event) {
    const name = nameOf(event);
    const onButton = event.target.closest?.("button, a, summary, input") && (name === " " || name === "Enter");
    if (OWN.has(name) || event.ctrlKey || event.altKey || event.metaKey || event.defaultPrevented || onButton) return;
    if (takesKeys(event.target) && event.target.type !== "checkbox") return;
    if (this.app.tool || !this.live.youDrive || this.held.size >= MOST) return;
    event.preventDefault();
    if (this.held.has(name)) return;
    this.held.add(name);
    this.tell();
  }

  letGo() {
    if (!this.held.size) return;
    this.held.clear();
    this.tell();
  }

  tell() {
    const held = [...this.held];
    this.app.emit("keys", held);
    this.live.send("keys", { held });
    clearInterval(this.timer);
    if (held.length) this.timer = setInterval(() => this.live.send("keys", { held }), PERIOD_MS);
  }
}
