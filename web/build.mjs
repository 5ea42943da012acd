// Builds the page's script, style sheet and licences into src/trundle/page/assets, which is committed.
import { build } from "esbuild";
import { readFile, writeFile, mkdir } from "node:fs/promises";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2] ?? join(here, "..", "src", "trundle", "page", "assets");
const shared = {
  absWorkingDir: here,
  bundle: true,
  charset: "utf8",
  legalComments: "none",
  logLevel: "warning",
  minify: true,
  target: "es2022",
  write: false,
};

const script = await build({ ...shared, entryPoints: ["src/main.js"], format: "iife" });
const style = await build({ ...shared, entryPoints: ["src/page.css"] });
// The page holds the script inline, where these would end or comment out its element.
const js = script.outputFiles[0].text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");

let licences = "page.js and page.css contain the following libraries.\n";
for (const name of ["three", "uplot"]) {
  const folder = join(here, "node_modules", name);
  const { version } = JSON.parse(await readFile(join(folder, "package.json"), "utf8"));
  const text = await readFile(join(folder, "LICENSE"), "utf8");
  licences += `\n---- ${name} ${version} ----\n\n${text.replaceAll("\r\n", "\n").trim()}\n`;
}

await mkdir(out, { recursive: true });
await writeFile(join(out, "page.js"), js);
await writeFile(join(out, "page.css"), style.outputFiles[0].text);
await writeFile(join(out, "LICENSES.txt"), licences);
