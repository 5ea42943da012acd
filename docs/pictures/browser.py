"""The pictures of docs/browser.md: the page live, before a run, on a phone, and the report of a run.

python docs/pictures/browser.py [--out docs/images]
"""

from __future__ import annotations

import argparse
import io
import shutil
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

FLAGS = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--no-sandbox"]
# With GL in software the page draws fewer pixels, because pictures come slowly; here they may.
SHARP = """
const next = requestAnimationFrame;
let time = 0;
window.requestAnimationFrame = (draw) => next(() => draw((time += 16)));
const ask = WebGL2RenderingContext.prototype.getExtension;
WebGL2RenderingContext.prototype.getExtension = function (name) {
  return name === "WEBGL_debug_renderer_info" ? null : ask.call(this, name);
};
"""
START, GOAL = "-13,0,0", "13,0,1.57"


@contextmanager
def serve(folder: Path):
    """The address of a page on the warehouse, in a process that ends with the block."""
    command = [sys.executable, "-m", "trundle", "serve", "warehouse", "--seed", "4", "--no-open", "--port", "0"]
    with subprocess.Popen(
        [*command, f"--start={START}", f"--goal={GOAL}"], cwd=folder, stdout=subprocess.PIPE, text=True
    ) as server:
        yield next(line for line in server.stdout if line.startswith("http")).strip()
        server.terminate()


def save(tab: Page, file: Path) -> None:
    tab.wait_for_timeout(1500)
    Image.open(io.BytesIO(tab.screenshot())).convert("RGB").save(file, quality=82, method=6)
    print(f"{file}: {file.stat().st_size / 1000:.0f} kB")


def wait_for_time(tab: Page, time: str) -> None:
    tab.wait_for_function(f"() => document.querySelector('#status dd').textContent >= '{time}'", timeout=180_000)


def live(browser, address: str, out: Path) -> None:
    context = browser.new_context(viewport={"width": 1280, "height": 720}, locale="en-US", color_scheme="light")
    context.add_init_script(SHARP)
    tab = context.new_page()
    tab.goto(address)
    tab.wait_for_selector("#world option", state="attached")
    tab.click("#set-goal")
    box = tab.locator("#map").bounding_box()
    tab.mouse.move(box["x"] + 0.85 * box["width"], box["y"] + box["height"] / 2)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 0.85 * box["width"], box["y"] + 0.3 * box["height"], steps=3)
    save(tab, out / "browser_setup.webp")
    tab.mouse.up()
    tab.click("#go")
    wait_for_time(tab, "0:13")
    tab.click("#pause")
    save(tab, out / "browser.webp")
    tab.click("#pause")
    tab.click("#end")
    tab.wait_for_selector(".outcome")
    context.close()


def phone(browser, address: str, out: Path) -> None:
    context = browser.new_context(
        viewport={"width": 390, "height": 844}, locale="ko-KR", color_scheme="dark", has_touch=True
    )
    context.add_init_script(SHARP)
    tab = context.new_page()
    tab.goto(address)
    tab.wait_for_selector("#go:not([disabled])")
    tab.click("#go")
    wait_for_time(tab, "0:08")
    tab.click("#pause")
    save(tab, out / "browser_phone.webp")
    tab.click("#end")
    tab.wait_for_selector(".outcome")
    context.close()


def report(browser, folder: Path, out: Path) -> None:
    command = [
        sys.executable,
        "-m",
        "trundle",
        "run",
        "warehouse",
        "--seed",
        "4",
        "--lidar",
        "--no-video",
        "--out",
        "run",
    ]
    subprocess.run([*command, f"--start={START}", f"--goal={GOAL}"], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    context = browser.new_context(viewport={"width": 1180, "height": 1080}, locale="en-US", color_scheme="light")
    context.add_init_script(SHARP)
    tab = context.new_page()
    tab.goto((folder / "run" / "report.html").as_uri())
    tab.wait_for_selector(".report")
    tab.evaluate("() => { document.querySelector('.bench').style.height = '500px'; }")
    tab.click("[data-camera=orbit]")
    tab.evaluate(
        "() => { const s = document.querySelector('#time'); s.value = 24; s.dispatchEvent(new Event('input')); }"
    )
    save(tab, out / "browser_report.webp")
    context.close()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, default=Path("docs/images"))
    out = parser.parse_args().out.resolve()
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=FLAGS)
        with serve(folder) as address:
            live(browser, address, out)
            phone(browser, address, out)
        report(browser, folder, out)
        browser.close()


if __name__ == "__main__":
    main()
