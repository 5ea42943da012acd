// The replay's bar: play, time slider, pace.
import { button, h, icon, takesKeys } from "../dom.js";
import { clockText } from "../panels.js";
import { onLanguage, say, t } from "../strings.js";

const PACES = [1, 2, 5, 10, 20];

export class ReplayBar {
  constructor(app, player) {
    this.app = app;
    this.player = player;
    this.play = button("play", say("play"), () => player.play(!player.playing), { id: "play", class: "main" });
    this.slider = h("input", { type: "range", id: "time", min: 0, step: 0.05, value: 0, "aria-label": say("seek"), oninput: () => player.seek(Number(this.slider.value)) });
    this.text = h("output", { class: "time-text", htmlFor: "time" });
    this.pace = h("select", { id: "pace", "aria-label": say("pace"), onchange: () => (player.pace = Number(this.pace.value)) },
      ...PACES.map((value) => h("option", { value }, `× ${value}`)));
    this.element = h("div", { class: "replay-bar", role: "toolbar", "aria-label": say("replay") }, this.play, this.slider, this.text, this.pace);
    app.on("seek", () => this.show());
    app.on("log", () => {
      this.slider.max = player.duration;
      this.show();
    });
    const showPlay = (playing) => {
      this.play.replaceChildren(icon(playing ? "pause" : "play"));
      for (const name of ["title", "aria-label"]) this.play.setAttribute(name, t(playing ? "pause" : "play"));
    };
    app.on("play", showPlay);
    onLanguage(() => showPlay(player.playing));
    document.addEventListener("keydown", (event) => {
      if (event.key !== " " || takesKeys(event.target) || event.target.closest?.("button, a, summary")) return;
      event.preventDefault();
      this.play.click();
    });
  }

  show() {
    this.slider.value = this.player.time;
    const text = `${clockText(this.player.time)} / ${clockText(this.player.duration)}`;
    this.text.value = text;
    this.slider.setAttribute("aria-valuetext", text);
  }
}
