// Below the replay: verdict, plots, what the robot touched, plans, settings, versions, and how to repeat the run.
import { button, h } from "../dom.js";
import { clockText } from "../panels.js";
import { say, saying, t, told } from "../strings.js";

function section(name, ...children) {
  return h("section", { class: "report-part" }, h("h2", {}, say(name)), ...children);
}

function table(heads, rows) {
  return h("div", { class: "table" },
    h("table", {},
      heads.length ? h("thead", {}, h("tr", {}, ...heads.map((head) => h("th", { scope: "col" }, head)))) : null,
      h("tbody", {}, ...rows.map((row) => h("tr", {}, ...row.map((cell, i) => h(i || heads.length ? "td" : "th", {}, cell)))))));
}

/** The leaves of nested settings, with dotted names. */
function leaves(value, name = "") {
  if (value === null || typeof value !== "object") return [[name, String(value)]];
  if (Array.isArray(value) && value.every((item) => item === null || typeof item !== "object")) return [[name, value.join(", ")]];
  return Object.entries(value).flatMap(([key, inner]) => leaves(inner, name ? `${name}.${key}` : key));
}

function at(player, time) {
  const show = () => {
    player.seek(time);
    scrollTo({ top: 0 });
  };
  return h("button", { type: "button", class: "link", onclick: show }, clockText(time));
}

function verdict({ verdict: { outcome, message, figures } }) {
  const good = /^(arrived|succeeded|success|reached)/.test(outcome);
  return h("section", { class: "report-part" },
    h("h2", { class: "verdict", "data-good": String(good) }, saying(() => told(outcome.replaceAll("_", " ")))),
    message ? h("p", {}, saying(() => told(message))) : null,
    h("dl", { class: "tiles" }, ...(figures ?? []).map(([label, text]) => h("div", {}, h("dt", {}, saying(() => told(label))), h("dd", {}, text)))));
}

function contactsPart(contacts, player) {
  if (!contacts.length) return section("contacts", h("p", {}, say("noContacts")));
  const rows = contacts.map(({ t: time, what, x, y }) => [at(player, time), what, `${x.toFixed(2)}, ${y.toFixed(2)}`]);
  return section("contacts", table([say("when"), say("what"), saying(() => `${t("where")} [m]`)], rows));
}

function plansPart(run, player) {
  if (!run.paths.length) return null;
  const length = (points) => {
    let sum = 0;
    for (let i = 2; i + 1 < points.length; i += 2) sum += Math.hypot(points[i] - points[i - 2], points[i + 1] - points[i - 1]);
    return sum;
  };
  const rows = run.paths.slice(0, 200).map(({ t: time, points }) => [at(player, time), `${length(points).toFixed(2)} m`, String(points.length / 2)]);
  return section("plans", table([say("when"), say("length"), say("points")], rows));
}

function commandPart(command) {
  const copy = button("copy", say("copy"), async () => {
    try {
      await navigator.clipboard.writeText(command);
      copy.title = t("copied");
    } catch {
      getSelection().selectAllChildren(text); // Where the browser allows no copying, it is ready to be copied by hand.
    }
  });
  const text = h("code", {}, command);
  return section("repeat", h("div", { class: "command" }, h("pre", { tabIndex: 0 }, text), copy));
}

export function buildReport(boot, app, player, plots) {
  const parts = [
    boot.verdict ? verdict(boot) : null,
    section("plots", plots.element),
    boot.contacts ? contactsPart(boot.contacts, player) : null,
    plansPart(app.run, player),
    boot.command ? commandPart(boot.command) : null,
    boot.settings ? section("settings", typeof boot.settings === "string" ? h("pre", { tabIndex: 0 }, boot.settings) : table([], leaves(boot.settings))) : null,
    boot.versions ? section("versions", table([], Object.entries(boot.versions).map(([name, version]) => [name, String(version)]))) : null,
  ];
  return h("div", { class: "report" }, ...parts.filter(Boolean));
}
