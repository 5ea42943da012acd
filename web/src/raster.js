// Pictures of grids as canvases: the map in the theme's colours, costs as a veil of one colour.
import { picture } from "./decode.js";
import { palette } from "./theme.js";

// Greys of cells, as in ROS maps.
const UNKNOWN = 205;
const FREE = 254;

/** The map with occupied, free and unknown cells in the theme's colours. */
export async function mapRaster(map) {
  const made = await picture(map.png);
  const grey = Uint8Array.from({ length: made.pixels.data.length / 4 }, (_, i) => made.pixels.data[4 * i]);
  const raster = { ...map, canvas: made.canvas };
  raster.paint = () => {
    const { free, taken, unknown } = palette();
    const { data } = made.pixels;
    for (let i = 0; i < grey.length; i++) {
      const share = Math.min(1, grey[i] / FREE);
      for (let k = 0; k < 3; k++) data[4 * i + k] = grey[i] === UNKNOWN ? unknown[k] : taken[k] + (free[k] - taken[k]) * share;
      data[4 * i + 3] = 255;
    }
    made.context.putImageData(made.pixels, 0, 0);
  };
  raster.paint();
  return raster;
}

/** A costmap's picture as an overlay: nothing where it is free, stronger where it costs more.
 * Without a map below it, it shows obstacles and unknown cells itself. Where there is a `base`, the picture holds the
 * differences from that, modulo 256. */
export async function costRaster(costmap, alone, base = null) {
  const made = await picture(costmap.png);
  const { data } = made.pixels;
  if (base) {
    const below = (await picture(base.png)).pixels.data;
    for (let i = 0; i < data.length; i += 4) data[i] = (data[i] + below[i]) & 255;
  }
  const { cost: [r, g, b], taken, unknown } = palette();
  const opaque = { 254: [...taken, alone ? 255 : 90], 255: [...unknown, alone ? 255 : 0] };
  for (let i = 0; i < data.length; i += 4) {
    const cost = data[i];
    data.set(opaque[cost] ?? [r, g, b, cost === 253 ? 130 : Math.round(cost * 0.45)], i);
  }
  made.context.putImageData(made.pixels, 0, 0);
  return { ...costmap, canvas: made.canvas };
}
