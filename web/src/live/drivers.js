// Who drives: one client; the others watch and may ask, which everyone sees.
import { h } from "../dom.js";
import { onLanguage, say, t } from "../strings.js";

export class Drivers {
  constructor(app, live) {
    this.app = app;
    this.live = live;
    this.who = h("span", { class: "who" });
    this.ask = h("button", { type: "button", id: "drive", onclick: () => live.send("drive", { answer: null }) });
    this.element = h("div", { class: "drivers" }, this.who, this.ask);
    this.text = h("span");
    this.grant = h("button", { type: "button", id: "grant", class: "main", onclick: () => live.send("drive", { answer: "grant" }) }, say("grant"));
    this.refuse = h("button", { type: "button", id: "refuse", onclick: () => live.send("drive", { answer: "refuse" }) }, say("refuse"));
    this.request = h("div", { class: "banner request", role: "alert", hidden: true }, this.text, this.grant, this.refuse);
    app.on("drivers", () => this.show());
    app.on("link", () => this.show());
    onLanguage(() => live.link && this.show());
  }

  show() {
    const { live } = this;
    const online = live.link?.isOpen;
    const watching = live.clients > 1 ? ` · ${t("watchers", { n: live.clients - 1 })}` : "";
    this.who.textContent = online && live.client !== null ? t(live.youDrive ? "youDrive" : live.driver === null ? "noDriver" : "youWatch") + watching : "";
    this.ask.hidden = !online || live.client === null || live.youDrive;
    this.ask.disabled = live.asking === live.client;
    this.ask.textContent = t(live.asking === live.client ? "asked" : live.driver === null ? "take" : "ask");
    this.request.hidden = live.asking === null || !online;
    this.text.textContent = live.asking === null ? "" : t("asks", { id: live.asking });
    this.grant.hidden = this.refuse.hidden = !live.youDrive;
  }
}
