// Switches of the layers that both views show.
import { h, icon } from "./dom.js";
import { LAYERS, OF_LOCALIZER } from "./app.js";
import { say } from "./strings.js";

export function layerSwitches(app) {
  const boxes = LAYERS.map((name) =>
    h("label", { class: "check" },
      h("input", {
        type: "checkbox", id: `layer-${name}`, checked: app.layers[name],
        onchange: (event) => {
          app.layers[name] = event.target.checked;
          app.dirty = true;
        },
      }),
      say(`l_${name}`)),
  );
  const show = () => {
    for (const name of OF_LOCALIZER) boxes[LAYERS.indexOf(name)].hidden = !(name === "graph" ? app.mapped : app.run.isLocalized);
  };
  for (const name of ["run", "frame", "scene_map"]) app.on(name, show);
  show();
  return h("details", { class: "layers" }, h("summary", {}, icon("layers"), say("layers")), h("div", { class: "layer-list" }, ...boxes));
}
