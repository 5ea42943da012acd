// What the server and the run folder encode: arrays in base64, and blocks in gzip and base64.

const TYPES = { f4: Float32Array, u4: Uint32Array, u1: Uint8Array, i2: Int16Array };

export function bytes(base64) {
  const text = atob(base64);
  const out = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) out[i] = text.charCodeAt(i);
  return out;
}

/** The typed array of {"b64", "dtype", "shape"}; a plain list of lists is flattened. */
export function array(value) {
  if (!value) return new Float32Array(0);
  if (ArrayBuffer.isView(value)) return value;
  if (Array.isArray(value)) return Float32Array.from(value.flat());
  const type = TYPES[value.dtype];
  if (!type) throw new Error(`unknown type of array ${value.dtype}`);
  return new type(bytes(value.b64).buffer);
}

/** Points [x, y, x, y, …] from the differences of each to the one before. */
export function summed(deltas) {
  const out = Int16Array.from(deltas);
  for (let i = 2; i < out.length; i++) out[i] += out[i - 2];
  return out;
}

/** The JSON value of {"gzip": base64}; any other value as it is. */
export async function unpack(value) {
  if (!value || typeof value.gzip !== "string") return value;
  const stream = new Blob([bytes(value.gzip)]).stream().pipeThrough(new DecompressionStream("gzip"));
  return JSON.parse(await new Response(stream).text());
}

/** A canvas with the picture of a PNG in base64, and its pixels. */
export async function picture(base64) {
  const bitmap = await createImageBitmap(new Blob([bytes(base64)], { type: "image/png" }), { colorSpaceConversion: "none" });
  const canvas = document.createElement("canvas");
  canvas.width = bitmap.width;
  canvas.height = bitmap.height;
  const context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(bitmap, 0, 0);
  return { canvas, context, pixels: context.getImageData(0, 0, bitmap.width, bitmap.height) };
}
