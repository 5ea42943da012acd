// Light and dark, by the system's choice or the reader's; colours that canvases draw with.
import { remember, recall } from "./dom.js";

export const theme = { dark: false, listeners: [] };
const system = matchMedia("(prefers-color-scheme: dark)");

function apply() {
  const chosen = recall("theme");
  theme.dark = chosen ? chosen === "dark" : system.matches;
  document.documentElement.dataset.theme = theme.dark ? "dark" : "light";
  for (const listener of theme.listeners) listener();
}

export function startTheme() {
  apply();
  system.addEventListener("change", apply);
}

export function switchTheme() {
  remember("theme", theme.dark ? "light" : "dark");
  apply();
}

export const onTheme = (listener) => theme.listeners.push(listener);

export function palette() {
  return theme.dark
    ? {
        free: [32, 36, 43], taken: [205, 211, 222], unknown: [52, 57, 66], outside: "#171a1f", ink: "#e8eaef",
        soft: "#9aa3b2", line: "#3a414d", robot: "#f5f7fa", goal: "#38d39f", path: "#58a6ff", scan: "#ff7a70",
        mover: "#ffb454", contact: "#ff4d4f", sky: "#20252d", cost: [255, 122, 61],
        belief: "#2bd0e0",
      }
    : {
        free: [255, 255, 255], taken: [41, 46, 58], unknown: [223, 227, 233], outside: "#eceff3", ink: "#1b2230",
        soft: "#5d6675", line: "#d4d9e1", robot: "#1b2230", goal: "#0b9a66", path: "#1468d8", scan: "#d8343f",
        mover: "#c96f00", contact: "#d4002a", sky: "#dfe6ee", cost: [240, 96, 20],
        belief: "#00879b",
      };
}

// Speed from standing to the robot's limit: violet, red, amber.
const RAMP = [[92, 45, 145], [214, 64, 98], [250, 168, 26]];

/** The colour of a share of the top speed, 0 to 1, as [r, g, b] of 0 to 255. */
export function speedColor(share) {
  const s = Math.min(1, Math.max(0, share)) * 2;
  const i = Math.min(1, Math.floor(s));
  return RAMP[i].map((value, k) => value + (RAMP[i + 1][k] - value) * (s - i));
}
