"""CPU time of the kernel of `mppi`, and of the same samples and critics in the layout of Nav2's controller.

    python -m benchmarks.control.kernels [--rounds 200]

2000 samples of 56 steps of 0.05 s, Nova Carter in three discs, all critics on, a window of 8 x 8 m at 5 cm with few and
many boxes in it, without movers and with ten. Each call is a whole `step`: shifted controls, rollouts, costs,
temperature, mean, and the mean's own rollout.

The peer (`nav2_layout.cpp`, with the C++ compiler at hand, -O3 -mavx2 -mfma -ffast-math) keeps every quantity in arrays
of samples x steps, and makes a pass for each critic. It is given its noise and its temperature, and has no rollout of
the mean. Contestants take turns on one core. That both cost the same is checked first, sample by sample, for those that
touch nothing.
"""

from __future__ import annotations

import argparse
import ctypes
import math
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from benchmarks.timing import describe_machine, interleaved_times, print_table

from trundle import _core
from trundle._core import Mppi, inflate

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from support import mppi_oracle as oracle

SAMPLES, STEPS, KNOT_STEPS = 2000, 56, 7
SIDE, CELL, UNIT = 160, 0.05, 0.01
DISCS = np.array([(-0.455, 0.295), (-0.234, 0.295), (-0.012, 0.295)])
FLAGS = ("-std=c++17", "-O3", "-mavx2", "-mfma", "-ffast-math", "-shared", "-fPIC")
COUNTS = ("samples", "steps", "knot_steps", "rows", "cols", "disc_count", "mover_count", "has_goal", "has_yaw")
NUMBERS = (
    *("x", "y", "yaw", "v", "w", "v_change", "w_change"),
    *("dt", "v_min", "v_max", "w_max", "faster", "slower", "turn", "half_step"),
    *("goal_x", "goal_y", "goal_yaw", "reach", "fade", "direction"),
    *("collision", "contact", "to_go", "to_go_end", "heading", "goal_yaw_weight", "overshoot", "obstacle"),
    *("obstacle_speed", "against", "twirl", "v_acceleration", "w_acceleration", "v_jerk", "w_jerk", "speed"),
    *("near_scale", "heading_free", "speed_limit", "stop_scale", "resolution", "rear", "front", "temperature", "far"),
)


class PeerRequest(ctypes.Structure):
    """`Request` of nav2_layout.cpp."""

    _fields_ = [(name, ctypes.c_int32) for name in COUNTS] + [(name, ctypes.c_float) for name in NUMBERS]


def make_request(boxes: int, movers: int) -> oracle.Request:
    """Nova Carter on its way to a goal 4 m ahead, between boxes of 0.4 m."""
    rng = np.random.default_rng(0)
    occupied = np.zeros((SIDE, SIDE), np.int8)
    for row, col in rng.integers(0, SIDE - 8, (boxes, 2)):
        if max(abs(row + 4 - SIDE // 2), abs(col + 4 - SIDE // 2)) > 28:
            occupied[row : row + 8, col : col + 8] = 100
    squares = np.arange(50 * 50 + 1)
    near = inflate(occupied, np.clip(254 - np.round(np.sqrt(squares) * CELL / UNIT), 1, 254).astype(np.uint8))
    rows, cols = np.mgrid[:SIDE, :SIDE]
    to_go = np.hypot((cols + 0.5) * CELL - 7.2, (rows + 0.5) * CELL - 6.4).astype(np.float32)
    to_go[near >= 254 - round(0.295 / UNIT)] = np.inf
    return oracle.Request(
        samples=SAMPLES,
        steps=STEPS,
        knot_steps=KNOT_STEPS,
        state=np.array([4.0, 4.0, 0.3, 0.5, 0.0, 0.0, 0.0]),
        controls=np.tile(np.array([0.6, 0.1], np.float32), (STEPS, 1)),
        model=np.array([0.05, -0.4, 0.8, 0.7, 2.5, 2.5, 3.2]),
        noise=np.array([0.3, 0.35, 0.05, 1.0, 1.0]),
        discs=DISCS,
        nearness=near,
        to_go=to_go,
        resolution=CELL,
        unit=UNIT,
        goal=np.array([7.2, 6.4, 0.0, 1.0, 0.5, 0.5, 1.0]),
        movers=np.column_stack(
            [
                rng.uniform(0.0, 8.0, (movers, 2)),
                rng.uniform(-1.0, 1.0, (movers, 2)),
                np.full(movers, 0.3),
                np.full(movers, 0.01),
                np.full(movers, 0.02),
            ]
        ).reshape(-1, 7),
        weights=np.array([1000, 50, 1, 1, 3, 8, 5, 0.3, 0.3, 5, 4, 0.05, 0.1, 0.1, 1], float),
        bounds=np.array([0.3, 0.3, 2.0, 0.3, 0.7]),
    )


def mover_table(request: oracle.Request) -> npt.NDArray[np.float32]:
    """x, y, peak, slope, weight, what a contact costs by step and mover, as the kernel makes them."""
    cell, dt = request.resolution, request.model[0]
    radius = request.discs[:, 1].max()
    rows: list[list[float]] = []
    for step in range(request.steps):
        t, soon = dt * (step + 1), 1.0 - 0.5 * step / request.steps
        for x, y, vx, vy, own, place, velocity in request.movers:
            variance = place + velocity * t * t
            touch = (own + radius) / cell
            reach = touch + (request.bounds[1] + request.bounds[2] * math.sqrt(variance)) / cell
            slope = 1.0 / (reach**2 - touch**2)
            certainty = touch**2 / (touch**2 + 2.0 * variance / cell**2)
            weight = request.weights[9] * certainty * dt
            rows.append([(x + vx * t) / cell, (y + vy * t) / cell, reach**2 * slope, slope, weight, certainty * soon])
    return np.array(rows, np.float32).reshape(-1, 6)


def peer_request(request: oracle.Request, temperature: float) -> PeerRequest:
    """The same request in the peer's units: cells, and changes of one step."""
    dt, v_min, v_max, w_max, faster, slower, turn = request.model.tolist()
    x, y, yaw, v, w, a, alpha = request.state.tolist()
    goal_x, goal_y, goal_yaw, has_yaw, reach, fade, direction = request.goal.tolist()
    weight, cell = request.weights.tolist(), request.resolution
    offsets = request.discs[:, 0] / cell
    changes = STEPS * (faster * dt) ** 2, STEPS * (turn * dt) ** 2
    counts = (SAMPLES, STEPS, KNOT_STEPS, *request.nearness.shape, len(request.discs), len(request.movers))
    numbers = (
        *(x / cell, y / cell, yaw, v, w, a * dt, alpha * dt),
        *(dt, v_min, v_max, w_max, faster * dt, slower * dt, turn * dt, 0.5 * dt / cell),
        *(goal_x / cell, goal_y / cell, goal_yaw, reach / cell, fade / cell, direction),
        *(*weight[:9], weight[10] * dt, weight[11] * dt, weight[12] / changes[0], weight[12] / changes[1]),
        *(weight[13] / changes[0], weight[13] / changes[1], weight[14] * dt),
        *(UNIT / request.bounds[0], math.cos(request.bounds[3] / 2.0), request.bounds[4], 0.5 / slower, cell),
        *(offsets.min(), offsets.max(), temperature, oracle.read_to_go(request)[1]),
    )
    return PeerRequest(*counts, int(reach > 0.0), int(has_yaw), *numbers)


class Peer:
    """The layout of Nav2's controller."""

    def __init__(self, library: ctypes.CDLL, request: oracle.Request, temperature: float) -> None:
        nominal = oracle.shifted(request)
        noise = oracle.targets_of(request) - nominal
        self.costs, self.answer = np.zeros(SAMPLES, np.float32), np.zeros((STEPS, 2), np.float32)
        discs = np.column_stack([request.discs[:, 0] / CELL, 254.0 - request.discs[:, 1] / UNIT])
        arrays: tuple[npt.NDArray[Any], ...] = (
            *(nominal, noise[..., 0].T, noise[..., 1].T, discs.astype(np.float32), request.nearness),
            *(oracle.read_to_go(request)[0].astype(np.float32), mover_table(request), self.costs, self.answer),
        )
        self._arrays = [np.ascontiguousarray(array) for array in arrays]
        self._request = peer_request(request, temperature)
        library.nav2_layout_make.restype = ctypes.c_void_p
        self._memory = ctypes.c_void_p(library.nav2_layout_make(ctypes.byref(self._request)))
        pointers = [ctypes.c_void_p(array.ctypes.data) for array in self._arrays]
        self._arguments = (self._memory, ctypes.byref(self._request), *pointers)
        self._step = library.nav2_layout_step
        self._step.restype = None

    def step(self) -> None:
        self._step(*self._arguments)


def build_peer(folder: str) -> ctypes.CDLL:
    source, library = Path(__file__).with_name("nav2_layout.cpp"), Path(folder) / "nav2_layout.so"
    subprocess.run(["c++", *FLAGS, "-o", str(library), str(source)], check=True)
    return ctypes.CDLL(str(library))


def kernel_call(request: oracle.Request, level: str) -> tuple[Mppi, Callable[[], Any]]:
    """The kernel, and a call of it that begins with the same controls each time."""
    kernel = _core.Mppi(SAMPLES, STEPS, KNOT_STEPS, level)
    state, controls, *others = request.arguments()
    first = controls.copy()

    def call() -> Any:
        controls[:] = first
        return kernel.step(state, controls, *others)

    return kernel, call


def check(kernel: Mppi, peer: Peer, request: oracle.Request) -> int:
    """How many samples are free; ends where they do not cost the same in both."""
    peer.step()
    free = oracle.drive(request, oracle.targets_of(request)).hit_step == STEPS
    differences = np.abs(kernel.costs() - peer.costs)[free]
    if differences.max() > 1e-3:
        raise SystemExit(f"the peer costs something else: differences up to {differences.max():.3g}")
    return int(free.sum())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=200, help="calls of each contestant")
    rounds = parser.parse_args().rounds
    levels = ("base", "avx2") if Mppi(128, 2, 1).level == "avx2" else ("base",)
    print(describe_machine())
    rows: list[tuple[str, ...]] = []
    with tempfile.TemporaryDirectory() as folder:
        library = build_peer(folder)
        for boxes, movers in ((15, 0), (15, 10), (40, 0), (40, 10)):
            request = make_request(boxes, movers)
            kernels = {level: kernel_call(request, level) for level in levels}
            temperature = kernels["base"][1]()[9]
            peer = Peer(library, request, temperature)
            free = check(kernels["base"][0], peer, request)
            contestants = {level: call for level, (_, call) in kernels.items()} | {"Nav2's layout": peer.step}
            times = interleaved_times(contestants, rounds, time.thread_time)
            slow = times["Nav2's layout"]
            for name, own in times.items():
                ratio = statistics.median(a / b for a, b in zip(own, slow, strict=True))
                spread = f"{1e3 * statistics.median(own):.2f}", f"{1e3 * float(np.percentile(own, 99)):.2f}"
                rows.append((f"{free} of {SAMPLES}", str(movers), name, *spread, f"{ratio:.2f}"))
    print()
    print_table(("free samples", "movers", "what", "median [ms]", "p99 [ms]", "ratio to Nav2's layout"), rows)


if __name__ == "__main__":
    main()
