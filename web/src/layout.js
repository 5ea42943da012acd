// The frame of the page: header, the two views, the side with figures, and what lies over them.
import { button, h } from "./dom.js";
import { CAMERAS } from "./scene/cameras.js";
import { layerSwitches } from "./layers.js";
import { onLanguage, say, switchLanguage, t, told } from "./strings.js";
import { switchTheme } from "./theme.js";

/** The header: what runs, its state, and the choices of the reader. */
export function header(app, ...parts) {
  const name = h("h1", {}, say("title"));
  const state = h("span", { class: "state", role: "status" });
  app.on("scene", (scene) => {
    name.textContent = [scene.name, scene.robot?.name].filter(Boolean).join(" · ") || t("title");
  });
  const show = () => {
    const live = app.mode === "live" || (app.mode === "view" && app.state === "ended");
    const { end } = app.run;
    state.textContent = app.mode === "live" && app.state === "ended" && end ? told(end.outcome.replaceAll("_", " ")) : t(live ? app.state : app.mode);
    state.dataset.state = live ? app.state : app.mode === "view" ? "running" : "ended";
    if (closed) {
      state.textContent = t("offline");
      state.dataset.state = "offline";
    }
  };
  let closed = false;
  onLanguage(show);
  app.on("state", show);
  app.on("link", ({ state: link }) => {
    closed = link === "closed";
    show();
  });
  app.on("tool", (tool) => (document.documentElement.dataset.tool = tool ? "on" : "off"));
  show();
  return h("header", {}, name, state, h("span", { class: "grow" }), ...parts,
    h("button", { type: "button", id: "language", onclick: switchLanguage }, say("language")),
    button("theme", say("theme"), switchTheme, { id: "theme" }));
}

/** The 3D view with its cameras; a note instead where the browser has no WebGL. */
export function sceneBox(app, stage, ...over) {
  if (!stage) return h("div", { id: "scene", class: "scene none" }, h("p", { class: "note" }, say("nowebgl")), ...over);
  const cameras = CAMERAS.map((mode) =>
    h("button", { type: "button", "aria-pressed": String(mode === stage.cameras.mode), "data-camera": mode, onclick: () => stage.cameras.choose(mode) }, say(mode)),
  );
  app.on("camera", (mode) => {
    for (const element of cameras) element.setAttribute("aria-pressed", String(element.dataset.camera === mode));
  });
  const loading = h("p", { class: "note", role: "status" }, say("noscene"));
  app.on("scene", () => loading.remove());
  stage.element.append(h("div", { class: "cameras", role: "group", "aria-label": say("cameras") }, ...cameras), loading, ...over);
  return stage.element;
}

/** Short notes at the foot of the views: lost connections, refusals, remarks. */
export function notes(app) {
  const link = h("p", { class: "banner", role: "status", hidden: true });
  const error = h("p", { class: "banner error", role: "alert", hidden: true });
  const remark = h("p", { class: "banner", role: "status", hidden: true });
  let timer;
  app.on("link", ({ state, wait }) => {
    link.hidden = state === "open";
    link.textContent = t("reconnecting", { s: (wait / 1000).toFixed(1) });
  });
  app.on("error", (text) => {
    error.textContent = told(text);
    error.hidden = false;
    clearTimeout(timer);
    timer = setTimeout(() => (error.hidden = true), 8000);
  });
  app.on("remark", (text) => {
    remark.textContent = text;
    remark.hidden = false;
  });
  return h("div", { class: "notes" }, link, error, remark);
}

export function layout(app, { head, scene, map, under, side, below }) {
  const views = h("div", { class: "views" }, scene, under);
  const aside = h("aside", { class: "side" }, map, layerSwitches(app), ...side);
  const main = h("main", { class: "bench" }, views, aside);
  document.getElementById("app").replaceChildren(head, main, ...(below ? [below] : []));
}

