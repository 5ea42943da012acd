"""The pictures of docs/browser.md: before a run, driving, in an aisle, at a goal, on a phone, a report, and a loop.

Those in Korean need a font that has it, such as NanumGothic.

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
AISLE = 0.74, 0.5
"""Where in the map's picture the goal of the loop is clicked: in the second aisle."""


SERVE = ["-m", "trundle", "serve", "warehouse", "--seed", "4", "--no-open", "--port", "0"]
LOOP = Path(__file__).parents[2] / "examples" / "10_own_loop_in_the_browser.py"


@contextmanager
def serve(folder: Path, *arguments: str):
    """The address of the page of a command, in a process that ends with the block."""
    command = [sys.executable, "-u", *arguments]
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True) as server:
        yield next(word for line in server.stdout for word in line.split() if word.startswith("http"))
        server.terminate()


def save(tab: Page, file: Path) -> None:
    tab.evaluate("() => scrollTo(0, 0)")
    tab.wait_for_timeout(1500)
    Image.open(io.BytesIO(tab.screenshot())).convert("RGB").save(file, quality=82, method=6)
    print(f"{file}: {file.stat().st_size / 1000:.0f} kB")


def open_tab(browser, address: str, width: int, height: int, *, ready: str = "#go:not([disabled])", **look) -> Page:
    context = browser.new_context(viewport={"width": width, "height": height}, **look)
    context.add_init_script(SHARP)
    tab = context.new_page()
    tab.goto(address)
    tab.wait_for_selector(ready)
    return tab


def drive_until(tab: Page, time: str) -> None:
    """Begin a run, and pause it at this time."""
    tab.click("#go")
    tab.wait_for_selector(".state[data-state=running]")
    tab.wait_for_function("() => document.querySelector('#status dd').textContent < '0:05'", timeout=180_000)
    tab.wait_for_function(f"() => document.querySelector('#status dd').textContent >= '{time}'", timeout=180_000)
    tab.click("#pause")
    tab.wait_for_selector(".state[data-state=paused]")


def end(tab: Page) -> None:
    tab.click("#end")
    tab.wait_for_selector(".outcome:not([hidden])")
    tab.context.close()


def set_speed(tab: Page, index: int) -> None:
    tab.locator("#speed").evaluate(f"s => {{ s.value = {index}; s.dispatchEvent(new Event('input')); }}")


def live(browser, address: str, out: Path) -> None:
    tab = open_tab(browser, address, 1280, 720, locale="en-US", color_scheme="light")
    tab.click("#set-goal")
    box = tab.locator("#map").bounding_box()
    tab.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + box["height"] / 2)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.3 * box["height"], steps=3)
    save(tab, out / "browser_setup.webp")
    tab.mouse.up()
    drive_until(tab, "0:13")
    save(tab, out / "browser.webp")
    x, y = 500, 250
    for dx, dy in ((-120, 0), (-140, -20)):
        tab.mouse.move(x, y)
        tab.mouse.down()
        tab.mouse.move(x + dx, y + dy, steps=4)
        tab.mouse.up()
    tab.wait_for_timeout(1500)
    picture = Image.open(io.BytesIO(tab.locator("#scene").screenshot())).convert("RGB")
    picture.save(out / "browser_aisle.webp", quality=70, method=6)
    end(tab)


def tablet(browser, address: str, out: Path) -> None:
    tab = open_tab(browser, address, 768, 1024, locale="en-US", color_scheme="dark")
    drive_until(tab, "0:08")
    set_speed(tab, 10)
    tab.click("#pause")
    tab.wait_for_selector(".state[data-state=waiting]", timeout=180_000)
    set_speed(tab, 3)
    save(tab, out / "browser_goal.webp")
    end(tab)


def phone(browser, address: str, out: Path) -> None:
    tab = open_tab(browser, address, 390, 844, locale="ko-KR", color_scheme="dark", has_touch=True)
    drive_until(tab, "0:08")
    save(tab, out / "browser_phone.webp")
    end(tab)


def loop(browser, address: str, out: Path) -> None:
    tab = open_tab(browser, address, 1280, 760, ready="#goal:not([disabled])", locale="en-US", color_scheme="light")
    tab.click("#goal")
    box = tab.locator("#map").bounding_box()
    tab.mouse.click(box["x"] + AISLE[0] * box["width"], box["y"] + AISLE[1] * box["height"])
    far = "() => parseFloat(document.querySelectorAll('#status dd')[1].textContent) > -4.5"
    tab.wait_for_function(far, timeout=180_000)
    save(tab, out / "browser_show.webp")
    tab.context.close()


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
        with serve(folder, *SERVE, f"--start={START}", f"--goal={GOAL}") as address:
            live(browser, address, out)
            tablet(browser, address, out)
            phone(browser, address, out)
        report(browser, folder, out)
        with serve(folder, str(LOOP), "--no-open") as address:
            loop(browser, address, out)
        browser.close()


if __name__ == "__main__":
    main()
