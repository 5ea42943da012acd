"""Chromium, the page in it, and a server that a test plays itself."""

from __future__ import annotations

import contextlib
import json
import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path as FilePath
from typing import Any

import pytest

from trundle import page
from trundle.geometry import Pose3D
from trundle.geometry.solids import Box, Solid
from trundle.maps import OccupancyGrid
from trundle.mission import Session
from trundle.navigation import Navigator
from trundle.page.encoding import pack_json
from trundle.robots import Robot
from trundle.sim.kinematic import KinematicSimulator
from trundle.worlds import World

FLAGS = (
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--no-sandbox",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--disable-quic",
)
WAIT_MS = 60_000
ADDRESS = "http://127.0.0.1:9/"
WITHOUT_WEBGL = """
const get = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, ...rest) {
  return kind.startsWith("webgl") ? null : get.call(this, kind, ...rest);
};
"""


def until(tab: Any, true: Callable[[], Any], say: Callable[[], str] = lambda: "waited in vain") -> Any:
    """Wait until something is true, and return it."""
    for _ in range(WAIT_MS // 20):
        if found := true():
            return found
        tab.wait_for_timeout(20)
    raise AssertionError(say())


def draw(tab: Any, count: int = 5) -> None:
    """Let the page draw so many pictures."""
    tab.evaluate(
        """count => new Promise(done => {
          const next = () => count-- > 0 ? requestAnimationFrame(next) : done();
          next();
        })""",
        count,
    )


def still(tab: Any, selector: str) -> bytes:
    """A part of the page once it looks the same twice, some pictures apart."""
    before = b""
    while (now := tab.locator(selector).screenshot()) != before:
        before = now
        draw(tab)
    return now


@pytest.fixture(scope="session")
def chromium() -> Iterator[Any]:
    path = shutil.which("chromium")
    if path is None:
        pytest.skip("chromium is not installed")
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=list(FLAGS))
        yield browser
        browser.close()


@dataclass
class Seen:
    """What a page has said and asked for."""

    problems: list[str] = field(default_factory=list)
    requests: list[str] = field(default_factory=list)


@pytest.fixture
def open_page(chromium: Any) -> Iterator[Callable[..., tuple[Any, Seen]]]:
    """A page in a context of its own, which is closed after the test; without WebGL, which is slow in software."""
    with contextlib.ExitStack() as opened:

        def open_(
            address: str, *, webgl: bool = False, prepare: Callable[[Any], None] | None = None, **options: Any
        ) -> tuple[Any, Seen]:
            options = {"viewport": {"width": 1100, "height": 720}, "locale": "en-US", **options}
            context = opened.enter_context(contextlib.closing(chromium.new_context(**options)))
            context.set_default_timeout(WAIT_MS)
            if not webgl:
                context.add_init_script(WITHOUT_WEBGL)
            tab, seen = context.new_page(), Seen()
            tab.on("console", lambda message: seen.problems.append(message.text) if message.type == "error" else None)
            tab.on("pageerror", lambda error: seen.problems.append(str(error)))
            tab.on("request", lambda request: seen.requests.append(request.url))
            if prepare is not None:
                prepare(tab)
            tab.goto(address)
            tab.wait_for_selector("html[data-drawn=yes]")
            return tab, seen

        yield open_


@pytest.fixture(scope="session")
def hall() -> World:
    """A room of 10 m x 8 m with a crate."""

    def wall(name: str, x: float, y: float, size: tuple[float, float, float]) -> Solid:
        return Solid(name, Box(size), Pose3D((x, y, 1.0)), (0.9, 0.9, 0.9, 1.0), "wall")

    return World(
        "hall",
        (
            wall("south", 0.0, -4.0, (10.2, 0.2, 2.0)),
            wall("north", 0.0, 4.0, (10.2, 0.2, 2.0)),
            wall("west", -5.0, 0.0, (0.2, 8.2, 2.0)),
            wall("east", 5.0, 0.0, (0.2, 8.2, 2.0)),
            Solid("crate", Box((1.0, 1.0, 0.8)), Pose3D((0.0, 1.5, 0.4)), (0.7, 0.5, 0.3, 1.0), "crate"),
        ),
        seeds=((0.0, 0.0),),
    )


@dataclass(frozen=True)
class Recorded:
    """A run through the hall as the page gets it."""

    scene: dict[str, Any]
    run: dict[str, Any]

    @property
    def duration(self) -> float:
        return self.run["rows"][-1][0]


@pytest.fixture(scope="session")
def recorded(hall: World) -> Recorded:
    robot = Robot.load("nova_carter")
    grid = OccupancyGrid.from_world(hall)
    data = page.RunData()
    with KinematicSimulator(hall, robot, lidar=True) as sim:
        Session(sim, Navigator(grid, robot), (-3.0, 0.0, 0.0), (3.0, 0.0, 0.0), observers=[data], name="hall").run()
    return Recorded(page.scene_of(hall, robot, grid), data.run_dict())


@pytest.fixture(scope="session")
def report(recorded: Recorded, tmp_path_factory: pytest.TempPathFactory) -> FilePath:
    """A report as a file."""
    episode = {name: recorded.run[name] for name in ("rows", "paths", "events", "frames", "costmaps")}
    boot = {
        "mode": "report",
        "scene": pack_json(recorded.scene),
        "run": recorded.run["info"],
        "episode": pack_json(episode),
        "verdict": {"outcome": "arrived", "message": "arrived after 9 s", "figures": [["distance", "6.0 m"]]},
        "contacts": [{"t": 3.0, "what": "base touches </script><b>crate", "x": 0.0, "y": 1.0}],
        "settings": {"world": "hall", "navigation": {"controller": "regulated_pure_pursuit"}},
        "versions": {"trundle": "0.1.0"},
        "command": "trundle run hall.yaml",
    }
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(page.render(boot, title="hall"), encoding="utf-8")
    return path


class Played:
    """A server that a test plays: what the page sends is kept, and the test sends what it likes."""

    def __init__(self, recorded: Recorded) -> None:
        self.recorded = recorded
        self.got: list[dict[str, Any]] = []
        self.sockets: list[Any] = []
        self.opening: Callable[[], None] = self.begin
        self.tab: Any = None

    def attach(self, tab: Any) -> None:
        self.tab = tab
        html = page.render({"mode": "live"}, title="trundle")
        headers = {"Content-Security-Policy": page.csp(), "Content-Type": "text/html; charset=utf-8"}
        tab.route("**/*", lambda route: route.fulfill(body=html, headers=headers))
        tab.route_web_socket("**/ws", self._accept)

    def _accept(self, socket: Any) -> None:
        self.sockets.append(socket)
        socket.on_message(lambda text: self.got.append(json.loads(text)))
        self.opening()

    def send(self, kind: str, **fields: Any) -> None:
        self.sockets[-1].send(json.dumps({"type": kind, **fields}))

    def begin(self, *, driver: int | None = 1, state: str = "idle", lacks: Sequence[str] = ()) -> None:
        choices = {
            "worlds": ["hall", "office"],
            "robots": ["nova_carter", "jackal"],
            "planners": ["auto", "jps"],
            "controllers": ["regulated_pure_pursuit", "mppi"],
        }
        self.send(
            "hello",
            client=1,
            driver=driver,
            clients=2,
            you_drive=driver == 1,
            choices=choices,
            state=state,
            source="hall",
            lacks=list(lacks),
        )
        self.send("scene", scene=self.recorded.scene)

    def run(self, *, rows: int = 40, **frame: Any) -> None:
        """A run that goes: its start, the first rows, and a frame."""
        run = self.recorded.run
        self.send("run", info=run["info"], n=1)
        self.send("log", **{"from": 0, "rows": run["rows"][:rows], "paths": run["paths"], "events": run["events"][:2]})
        self.frame(**frame)

    def frame(self, **fields: Any) -> None:
        shown = {**self.recorded.run["frames"][0], "doing": "driving to the goal", "factor": 0.98, "speed": 1.0}
        self.send("frame", **{**shown, "paused": False, "manual": None, "held_back": None, **fields})

    def wait_for(self, kind: str, count: int = 1, **least: float) -> list[dict[str, Any]]:
        """The messages of a kind, and with more than these values, once there are so many."""

        def enough() -> list[dict[str, Any]]:
            found = [
                message
                for message in self.got
                if message["type"] == kind and all(message[key] > value for key, value in least.items())
            ]
            return found if len(found) >= count else []

        return until(self.tab, enough, lambda: f"the page sent {self.got}, not {count} of {kind!r}")


@pytest.fixture
def played(recorded: Recorded) -> Played:
    return Played(recorded)


@pytest.fixture
def idle(open_page: Any, played: Any) -> Any:
    tab, _ = open_page(ADDRESS, prepare=played.attach)
    tab.wait_for_selector("#world option", state="attached")
    return tab


@pytest.fixture
def driving(idle: Any, played: Any) -> Any:
    played.run()
    idle.wait_for_selector("#pause:not([disabled])")
    return idle
