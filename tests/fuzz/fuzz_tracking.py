"""Scans of scenes and of nothing sensible, several lidars, any order: the tracks are those of the tracker in NumPy."""

from __future__ import annotations

import math
import random
from typing import Any

import numpy as np

from fuzz.loop import attempt, rng_of, spoil
from support.scan_scenes import scan_scene
from support.tracking_oracle import Evidence, Followed, Sweep
from trundle._core import ScanTracker
from trundle.geometry import FloatArray, Pose2D
from trundle.observation import Scan
from trundle.tracking import TrackerSettings

BODY = np.array([(-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)])
ROOM = [(-6, -6, 6, -6), (6, -6, 6, 6), (6, 6, -6, 6), (-6, 6, -6, -6)]
CLOSE = 1e-8


def settings_of(generator: random.Random) -> TrackerSettings:
    if generator.random() < 0.5:
        return TrackerSettings()
    return TrackerSettings(
        max_range=generator.choice((2.0, 15.0)),
        max_size=generator.choice((0.08, 0.5, 3.0)),
        min_points=generator.choice((2, 5)),
        same_surface=generator.choice((0.01, 0.2)),
        min_speed=generator.choice((0.0, 0.5)),
        confirm_scans=generator.choice((1, 4)),
        hidden_s=generator.choice((0.0, 2.0)),
        aside_s=generator.choice((0.0, 2.0)),
    )


def scan_of(
    generator: random.Random, rng: np.random.Generator, name: str, time: float, base: Pose2D, discs: Any
) -> Scan:
    """A scan of some discs in a room, or of things everywhere, with holes."""
    mount = (0.2, 0.0, 0.3) if name == "front" else (-0.4, 0.1, math.pi)
    beams, fov = generator.choice((0, 1, 2, 3, 30, 180, 360)), generator.choice((1.0, 4.7, 2.0 * math.pi))
    angles = np.linspace(-fov / 2.0, fov / 2.0, beams, endpoint=False)
    kind = generator.random()
    if kind < 0.7 and beams:
        place = {"base": base.as_tuple(), "mount": mount}
        scene = scan_scene(discs, ROOM, **place, beams=beams, fov=fov, time=time, noise=0.01, name=name)
        ranges = scene.ranges.copy()
    else:
        ranges = rng.uniform(0.0, 16.0, beams)
    if kind > 0.5:
        ranges[rng.random(beams) < generator.choice((0.02, 0.5))] = generator.choice((math.nan, math.inf, -math.inf))
    if kind > 0.9:
        order = generator.choice((slice(None, None, -1), rng.permutation(beams)))
        angles, ranges = angles[order], ranges[order]
    increment = generator.choice((0.0, 0.0, 1e-4))
    return Scan(name, time, Pose2D(*mount), 0.4, angles, ranges, generator.choice((0.0, 0.3)), 15.0, increment)


def poses_of(scan: Scan, base: Pose2D, rng: np.random.Generator) -> FloatArray:
    """Of the sensor, which moves a little where its beams are measured one after the other."""
    pose = np.array((base @ scan.mount).as_tuple())
    if scan.time_increment == 0.0 or len(scan.angles) == 0:
        return pose[None]
    return pose + np.linspace(0.0, 1.0, len(scan.angles))[:, None] * rng.uniform(-0.02, 0.02, 3)


def one_round(generator: random.Random) -> None:
    rng, settings = rng_of(generator), settings_of(generator)
    numbers = np.array(
        [
            *(settings.max_range, settings.max_size, settings.min_points, settings.same_surface),
            *(settings.acceleration, settings.min_speed, settings.confirm_scans, settings.hidden_s, settings.aside_s),
        ],
        dtype=np.float64,
    )
    kernel, followed, evidence = ScanTracker(numbers, BODY), Followed(settings), dict[str, Evidence]()
    starts, velocities = rng.uniform(-4.0, 4.0, (4, 2)), rng.uniform(-2.0, 2.0, (4, 2))
    time, (v, w) = 1.0, rng.uniform(-1.0, 1.0, 2)
    for _ in range(generator.choice((3, 30))):
        time += generator.choice((0.05, 0.05, 0.05, 0.2, -0.03))
        name = generator.choice(("front", "front", "back"))
        discs = [(*(start + time * velocity), 0.3) for start, velocity in zip(starts, velocities, strict=True)]
        base = Pose2D(v * time, 0.0, w * time)
        scan = scan_of(generator, rng, name, time, base, discs)
        poses = poses_of(scan, base, rng)
        sensor = np.array([*scan.mount.as_tuple(), scan.range_min, scan.range_max])
        arguments = (int(name == "back"), scan.time, scan.ranges, scan.angles, poses, sensor)
        if generator.random() < 0.02:
            attempt(kernel.see, spoil(generator, arguments))
            return
        kernel.see(*arguments)
        sweep = Sweep(scan, poses, settings.max_range, BODY)
        known = evidence.setdefault(name, Evidence(settings))
        others = [other.latest for lidar, other in evidence.items() if lidar != name and other.latest]
        followed.see(sweep, known, others)
        known.add(sweep)
        compare(kernel, followed, time + generator.choice((-0.1, 0.0, 0.3)))


def compare(kernel: Any, followed: Followed, now: float) -> None:
    ids, flags, states, covariances = kernel.tracks(now)
    expected = followed.tracks(now)
    assert ids.tolist() == [track.id for track in expected]
    assert flags.tolist() == [[track.confirmed, track.moving] for track in expected]
    for state, covariance, track in zip(states, covariances, expected, strict=True):
        assert np.allclose(state, (track.x, track.y, track.vx, track.vy, track.radius), rtol=CLOSE, atol=CLOSE)
        assert np.allclose(covariance, track.covariance, rtol=CLOSE, atol=CLOSE)
