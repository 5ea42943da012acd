"""Messages that no page sends, by several clients at once, against the server of a run in progress.

python benchmarks/web/attack.py [--messages 100000] [--attackers 8]

Prints the memory of the process that serves before and after, and how late the run's control periods came.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import resource
import sys
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))

from support.page_attack import attack
from support.page_visitor import Visitor
from trundle.mission import Scenario
from trundle.serve.choosing import Choices
from trundle.serve.hub import Hub
from trundle.serve.run_feed import Watch
from trundle.serve.server import Page, PageServer
from trundle.serve.steerer import Steerer


def resident_mb() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize() / 1e6


class Lateness:
    """How much wall time passed between two control periods."""

    def __init__(self) -> None:
        self.gaps: list[float] = []
        self._last = 0.0

    def on_start(self, run: object) -> None:
        self._last = time.perf_counter()

    def on_step(self, step: object) -> None:
        now = time.perf_counter()
        self.gaps.append(now - self._last)
        self._last = now

    def on_end(self, episode: object) -> None:
        pass


def besiege(address: str, count: int, seed: int) -> None:
    attack(Visitor.of_address(address), count, seed=seed)


def main(messages: int, attackers: int) -> None:
    scenario = Scenario.make(
        world="warehouse", seed=4, lidar=True, start=(-13.0, 0.0, 0.0), goal=(13.0, 0.0, 1.57), time_limit_s=3600.0
    )
    hub, steerer, lateness = Hub(choices=Choices(None)), Steerer(), Lateness()
    hub.controls = steerer
    figures: list[str] = []

    def part(server: PageServer) -> None:
        with Visitor(server).open() as page:
            page.wait("frame")
            page.send("goal", pose=[-13.0, 0.0, None], append=True)
            context = multiprocessing.get_context("spawn")
            share = messages // attackers
            besiegers = [
                context.Process(target=besiege, args=(server.address, share, seed)) for seed in range(attackers)
            ]
            for one in besiegers:
                one.start()
            time.sleep(2.0)
            before, began, peak, there = resident_mb(), time.perf_counter(), 0.0, False
            while any(one.is_alive() for one in besiegers):
                message = json.loads(page.socket.recv(timeout=30.0))
                if message["type"] == "drivers" and message["request"] is not None:
                    page.send("drive", answer="refuse")
                if message["type"] == "frame":
                    peak = max(peak, resident_mb())
                    if len(message["goals"]) < 2:  # keep it driving to and fro
                        there = not there
                        page.send("goal", pose=[13.0 if there else -13.0, 0.0, None], append=True)
            took = time.perf_counter() - began
            figures.append(
                f"{share * attackers} messages in {took:.0f} s by {attackers} clients; resident memory {before:.0f} MB "
                f"before, {peak:.0f} MB at most, {resident_mb():.0f} MB after"
            )
            page.send("end")

    with scenario.build() as mission, PageServer(hub, Page("", "default-src 'none'"), port=0) as server:
        thread = threading.Thread(target=part, args=(server,))
        thread.start()
        steerer.drive(lambda _: mission.session(observers=[Watch(hub, 1, None), lateness], steering=steerer.steering))
        thread.join()
    gaps = sorted(lateness.gaps[1:])
    print(*figures)
    print(
        f"{len(gaps)} control periods of 50 ms: median {1e3 * gaps[len(gaps) // 2]:.1f} ms, "
        f"99 % {1e3 * gaps[int(0.99 * len(gaps))]:.0f} ms, longest {1e3 * gaps[-1]:.0f} ms"
    )


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--messages", type=int, default=100_000)
    parser.add_argument("--attackers", type=int, default=8)
    given = parser.parse_args()
    main(given.messages, given.attackers)
