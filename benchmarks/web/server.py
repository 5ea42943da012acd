"""What the page's server costs: at real time, at full speed, and from a key to the first motion.

python benchmarks/web/server.py [cost|speed|latency] [--seconds 20] [--rounds 3]
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
import sys
import threading
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from pages import open_pages, socket_options, welcome

from trundle.mission import LiveRun, Scenario, Session, Steering
from trundle.serve.choosing import Choices
from trundle.serve.hub import Hub
from trundle.serve.run_feed import Watch
from trundle.serve.server import Page, PageServer
from trundle.serve.steerer import Steerer

SCENARIO = {"world": "warehouse", "seed": 4, "lidar": True, "start": (-13.0, 0.0, 0.0), "goal": (13.0, 0.0, 1.57)}


@contextmanager
def serving(steerer: Steerer):
    hub = Hub(choices=Choices(None))
    hub.controls = steerer
    with PageServer(hub, Page("<!doctype html>", "default-src 'none'"), port=0) as server:
        yield hub, server


class Until:
    """An observer that ends the run at a simulated time, and counts CPU and wall time from another."""

    def __init__(self, begin_s: float, end_s: float) -> None:
        self._begin_s, self._end_s = begin_s, end_s
        self.began = self.ended = (0.0, 0.0, 0.0)

    def on_start(self, run: object) -> None:
        pass

    def on_step(self, step) -> None:
        now = time.process_time(), time.perf_counter(), step.state.time
        if step.state.time <= self._begin_s:
            self.began = now
        if step.state.time <= self._end_s:
            self.ended = now

    def on_end(self, episode: object) -> None:
        pass

    @property
    def cpu_share(self) -> float:
        return (self.ended[0] - self.began[0]) / (self.ended[1] - self.began[1])

    @property
    def factor(self) -> float:
        return (self.ended[2] - self.began[2]) / (self.ended[1] - self.began[1])


def drive(speed: float, until: Until, end_s: float, *, pages: int | None) -> tuple[int, int]:
    """Drive for a while, with so many pages, or without a server; returns bytes and frames."""
    scenario = Scenario.make(**SCENARIO, time_limit_s=end_s)
    got = (0, 0)
    with scenario.build() as mission:
        if pages is None:
            steering = Steering()
            LiveRun(lambda _: mission.session(observers=[until], steering=steering), steering, speed=speed).run()
            return got
        steerer = Steerer(speed=speed)

        with ExitStack() as opened:
            hub, server = opened.enter_context(serving(steerer))
            close = opened.enter_context(open_pages(server.address, pages)) if pages else None

            def make(_: int | None) -> Session:
                return mission.session(observers=[Watch(hub, 1, None), until], steering=steerer.steering)

            steerer.drive(make)
            return got if close is None else close()


def cost(seconds: float, rounds: int) -> None:
    """CPU of the process at real time, in shares of a core."""
    cases: dict[str, int | None] = {"no server": None, "no page": 0, "1 page": 1, "8 pages": 8}
    shares: dict[str, list[float]] = {name: [] for name in cases}
    for _ in range(rounds):
        for name, pages in cases.items():
            until = Until(2.0, 2.0 + seconds)
            size, frames = drive(1.0, until, 2.0 + seconds, pages=pages)
            shares[name].append(until.cpu_share)
            note = (
                f", {frames / pages / seconds:.1f} frames/s, {size / pages / seconds / 1e3:.0f} kB/s each"
                if pages
                else ""
            )
            print(f"{name}: {until.cpu_share:.2%} of a core{note}", flush=True)
    base = statistics.median(shares["no server"])
    for name in list(cases)[1:]:
        print(f"{name}: {statistics.median(shares[name]) - base:+.2%} of a core more than without a server")


def speed(rounds: int) -> None:
    """Simulated seconds per second at full speed, with a page and without a server, in turns."""
    factors: dict[str, list[float]] = {"unwatched": [], "1 page": []}
    for _ in range(rounds):
        for name, pages in (("unwatched", None), ("1 page", 1)):
            until = Until(2.0, 32.0)
            drive(math.inf, until, 32.0, pages=pages)
            factors[name].append(until.factor)
    ratios = [one / two for one, two in zip(factors["1 page"], factors["unwatched"], strict=True)]
    print(f"unwatched {statistics.median(factors['unwatched']):.1f} x real time")
    watched = statistics.median(factors["1 page"])
    print(f"1 page {watched:.1f} x; ratio, median of {rounds}: {statistics.median(ratios):.3f}")


def latency(rounds: int) -> None:
    """From a manual command to the first message with a pose that has moved, at real time."""
    from websockets.sync.client import connect

    scenario = Scenario.make(**SCENARIO, time_limit_s=600.0)
    steerer = Steerer()
    waits: list[float] = []

    def page(address: str) -> None:
        with connect(**socket_options(*welcome(address))) as socket:

            def pose() -> tuple[float, ...]:
                while True:
                    message = json.loads(socket.recv(timeout=30.0))
                    if message["type"] == "frame":
                        return tuple(message["row"][1:4])

            pose()  # it runs
            for _ in range(rounds):
                stand(socket, pose)
                before = pose()
                began = time.perf_counter()
                socket.send('{"type":"manual","v":0.0,"w":0.8}')
                while math.dist(pose(), before) < 1e-3:
                    pass
                waits.append(1e3 * (time.perf_counter() - began))
            socket.send('{"type":"end"}')

    def stand(socket, pose) -> None:
        socket.send('{"type":"manual","v":0,"w":0}')
        before, still = pose(), 0
        while still < 10:
            now = pose()
            still = still + 1 if math.dist(now, before) < 1e-4 else 0
            before = now
        time.sleep(0.037 * (len(waits) % 7))  # at any phase of the control period

    with scenario.build() as mission, serving(steerer) as (hub, server):
        thread = threading.Thread(target=page, args=(server.address,))
        thread.start()
        steerer.drive(lambda _: mission.session(observers=[Watch(hub, 1, None)], steering=steerer.steering))
        thread.join()
    waits.sort()
    high = waits[int(0.95 * len(waits))]
    print(f"input to motion: median {statistics.median(waits):.0f} ms, 95 % {high:.0f} ms, {rounds} tries")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", nargs="*", choices=["cost", "speed", "latency"], default=["cost", "speed", "latency"])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--rounds", type=int, default=3)
    given = parser.parse_args()
    if "cost" in given.what:
        cost(given.seconds, given.rounds)
    if "speed" in given.what:
        speed(given.rounds)
    if "latency" in given.what:
        latency(10 * given.rounds)
