// The page's start: reads what it was given, builds what its mode needs, and draws while something changes.
import { App } from "./app.js";
import { unpack } from "./decode.js";
import { header, layout, notes, sceneBox } from "./layout.js";
import { Drivers } from "./live/drivers.js";
import { Live } from "./live/live.js";
import { Setup } from "./live/setup.js";
import { Steering } from "./live/steering.js";
import { Teleop } from "./live/teleop.js";
import { MapView } from "./map/map.js";
import { EventLog, Outcome, Status } from "./panels.js";
import { Placing } from "./placing.js";
import { Plots } from "./plots.js";
import { mapRaster } from "./raster.js";
import { ReplayBar } from "./replay/bar.js";
import { Player } from "./replay/player.js";
import { buildReport } from "./replay/report.js";
import { Stage } from "./scene/stage.js";
import { onLanguage, startLanguage, t } from "./strings.js";
import { onTheme, startTheme } from "./theme.js";
import { startView } from "./view/view.js";

function makeStage(app, placing) {
  try {
    const stage = new Stage(app);
    placing.attach(stage.canvas, (event) => stage.pick(event));
    return stage;
  } catch {
    return null; // No WebGL: the map alone.
  }
}

function startLive(app, views) {
  const live = new Live(app);
  const steering = new Steering(app, live);
  const teleop = new Teleop(app, live);
  const drivers = new Drivers(app, live);
  const setup = new Setup(app, live);
  const parts = { status: new Status(app), outcome: new Outcome(app), log: new EventLog(app), plots: new Plots(app) };
  app.on("wants_point", () => views.map.canvas.focus({ preventScroll: true }));
  layout(app, {
    head: header(app, drivers.element),
    scene: sceneBox(app, views.stage, teleop.stick, drivers.request, notes(app)),
    map: views.map.element,
    under: steering.element,
    side: [parts.outcome.element, setup.element, parts.status.element, parts.plots.element, parts.log.element],
  });
  const showPlots = () => (parts.plots.element.hidden = !app.run.rows.length);
  for (const name of ["run", "log"]) app.on(name, showPlots);
  showPlots();
  return { ...parts, advance: (seconds) => app.clock.advance(app.run.duration, seconds, app.state !== "running") };
}

async function startReplay(app, views, boot) {
  const player = new Player(app);
  const seek = (time) => player.seek(time);
  const parts = { status: new Status(app), log: new EventLog(app, seek), plots: new Plots(app, { seek, height: boot.mode === "report" ? 150 : 110 }) };
  const bar = new ReplayBar(app, player);
  const report = boot.mode === "report";
  const below = report ? document.createElement("div") : null;
  layout(app, {
    head: header(app),
    scene: sceneBox(app, views.stage, notes(app)),
    map: views.map.element,
    under: bar.element,
    side: [parts.status.element, ...(report ? [] : [parts.plots.element]), parts.log.element],
    below,
  });
  app.state = "ended";
  const scene = await unpack(boot.scene);
  app.scene = scene;
  app.emit("scene", scene);
  if (scene.note) app.emit("remark", scene.note);
  await player.load(boot.episode, boot.run ?? {}, boot.verdict);
  below?.replaceWith(buildReport(boot, app, player, parts.plots));
  if (scene.map) {
    app.grid = await mapRaster(scene.map);
    app.emit("scene_map", app.grid);
  }
  return { ...parts, advance: (seconds) => player.advance(seconds) ?? player.time };
}

async function start() {
  const boot = JSON.parse(document.getElementById("boot").textContent);
  startLanguage(boot.lang);
  startTheme();
  const app = new App(boot.mode);
  const placing = new Placing(app);
  const stage = makeStage(app, placing);
  const map = new MapView(app, placing);
  app.on("scene_map", () => map.fitted && map.fit());
  onTheme(() => app.grid?.paint());
  onLanguage(() => (app.dirty = true));
  const begin = { live: startLive, view: startView }[boot.mode] ?? startReplay;
  const parts = await begin(app, { stage, map }, boot);

  let before = performance.now();
  let shown = -1;
  function tick(now) {
    const seconds = (now - before) / 1000;
    before = now;
    const time = parts.advance(seconds);
    if (app.dirty || time !== shown) {
      shown = time;
      app.dirty = false;
      const state = app.run.at(time);
      if (stage?.draw(state, seconds)) app.dirty = true;
      map.draw(state);
      parts.status.show(state);
      parts.plots.show(state, now);
      document.documentElement.dataset.drawn = "yes";
    } else if (parts.plots.stale) parts.plots.show(app.run.at(time), now);
    requestAnimationFrame(tick);
  }
  requestAnimationFrame(tick);
}

start().catch((error) => {
  document.getElementById("app").textContent = `${t("title")}: ${error.message}`;
  throw error;
});
