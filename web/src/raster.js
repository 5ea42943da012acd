// Pictures of grids as canvases: the map in the theme's colours, costs as a veil of one colour.
import { picture } from "./decode.js";
import { palette } from "./theme.js";

// Greys of cells, as in ROS maps.
const UNKNOWN = 205;
const FREE = 254;

/** The colours [r, g, b, alpha] of the 256 values of a cell, each as one number in the order of a canvas's bytes. */
function table(colorOf) {
  const bytes = new Uint8ClampedArray(1024);
  for (let value = 0; value < 256; value++) bytes.set(colorOf(value), 4 * value);
  return new Uint32Array(bytes.buffer);
}

/** The values of a grey picture's cells. */
function valuesOf({ data }) {
  const values = new Uint8Array(data.length / 4);
  for (let i = 0; i < values.length; i++) values[i] = data[4 * i];
  return values;
}

// A map may have millions of cells: a look into a table for each keeps the page at ease.
function fill(made, values, colors) {
  const cells = new Uint32Array(made.pixels.data.buffer);
  for (let i = 0; i < cells.length; i++) cells[i] = colors[values[i]];
  made.context.putImageData(made.pixels, 0, 0);
}

/** The map with occupied, free and unknown cells in the theme's colours. */
export async function mapRaster(map) {
  const made = await picture(map.png);
  const values = valuesOf(made.pixels);
  const raster = { ...map, canvas: made.canvas };
  raster.paint = () => {
    const { free, taken, unknown } = palette();
    const between = (share) => taken.map((value, k) => value + (free[k] - value) * share);
    fill(made, values, table((value) => [...(value === UNKNOWN ? unknown : between(Math.min(1, value / FREE))), 255]));
  };
  raster.paint();
  return raster;
}

/** A costmap's picture as an overlay: nothing where it is free, stronger where it costs more.
 * Without a map below it, it shows obstacles and unknown cells itself. Where there is a `base`, the picture holds the
 * differences from that, modulo 256. */
export async function costRaster(costmap, alone, base = null) {
  const made = await picture(costmap.png);
  const values = valuesOf(made.pixels);
  if (base) {
    const below = valuesOf((await picture(base.png)).pixels);
    for (let i = 0; i < values.length; i++) values[i] += below[i];
  }
  const { cost, taken, unknown } = palette();
  const opaque = { 254: [...taken, alone ? 255 : 90], 255: [...unknown, alone ? 255 : 0] };
  fill(made, values, table((value) => opaque[value] ?? [...cost, value === 253 ? 130 : Math.round(value * 0.45)]));
  return { ...costmap, canvas: made.canvas };
}
