"""Small readers for the benchmark: CARMEN logs with corrected poses, and Intel's MRPT log with raw odometry."""

from __future__ import annotations

import gzip
import math
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt


@dataclass(frozen=True)
class Log:
    """Scans with odometry and a reference.

    Attributes:
        name: Of the log.
        ranges: Of each scan [m].
        angles: Of the beams [rad].
        range_max: Longest range [m].
        odometry: Pose at each scan, shape (N, 3).
        reference: Corrected pose of each scan, NaN where there is none, shape (N, 3).
    """

    name: str
    ranges: list[npt.NDArray[np.float64]]
    angles: npt.NDArray[np.float64]
    range_max: float
    odometry: npt.NDArray[np.float64]
    reference: npt.NDArray[np.float64]


def read_carmen(path: Path) -> tuple[list[npt.NDArray[np.float64]], npt.NDArray[np.float64]]:
    """Return the ranges and poses of the FLASER lines."""
    ranges, poses = [], []
    with gzip.open(path, "rt", errors="replace") as lines:
        for line in lines:
            if not line.startswith("FLASER "):
                continue
            words = line.split()
            count = int(words[1])
            ranges.append(np.array(words[2 : 2 + count], dtype=np.float64))
            poses.append([float(word) for word in words[2 + count : 5 + count]])
    return ranges, np.array(poses)


def read_corrected(path: Path, seed: int, share: float, per_metre: float) -> Log:
    """Return a log with odometry that drifts by a share of the way and by radians per metre."""
    ranges, poses = read_carmen(path)
    count = len(ranges[0])
    angles = -0.5 * math.pi + np.arange(count) * (math.pi / count if count in (180, 360) else math.pi / (count - 1))
    odometry = drifting(poses, seed, share, per_metre)
    return Log(path.name.split("-corrected")[0], ranges, angles, 40.0, odometry, poses)


def drifting(poses: npt.NDArray[np.float64], seed: int, share: float, per_metre: float) -> npt.NDArray[np.float64]:
    """Odometry of a path: each step is off by a share of its length, and by an angle per metre; one seed, one wheel."""
    rng = np.random.default_rng(seed)
    scale = 1.0 + share * rng.choice((-1.0, 1.0))
    bend = per_metre * rng.choice((-1.0, 1.0))
    out = [poses[0].copy()]
    for a, b in zip(poses[:-1], poses[1:], strict=True):
        cos, sin = math.cos(a[2]), math.sin(a[2])
        dx, dy = b[0] - a[0], b[1] - a[1]
        x, y = scale * (cos * dx + sin * dy), scale * (-sin * dx + cos * dy)
        turn = math.remainder(b[2] - a[2], 2.0 * math.pi) + bend * math.hypot(x, y)
        x += 0.3 * share * math.hypot(x, y) * rng.normal()
        y += 0.3 * share * math.hypot(x, y) * rng.normal()
        turn += 0.3 * per_metre * math.hypot(x, y) * rng.normal()
        at = out[-1]
        cos, sin = math.cos(at[2]), math.sin(at[2])
        out.append(np.array((at[0] + cos * x - sin * y, at[1] + sin * x + cos * y, at[2] + turn)))
    return np.array(out)


def added(steps: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
    """Poses before each of some steps, each seen from the pose before it."""
    out = [np.zeros(3)]
    for x, y, turn in steps.tolist():
        at = out[-1]
        cos, sin = math.cos(at[2]), math.sin(at[2])
        out.append(np.array((at[0] + cos * x - sin * y, at[1] + sin * x + cos * y, at[2] + turn)))
    return np.array(out)


def read_intel(folder: Path) -> Log:
    """Return Intel's raw log, with the reference at scans that match those of the corrected log exactly."""
    data = gzip.decompress((folder / "intel.rawlog").read_bytes())
    ranges, at = [], 0
    while (at := data.find(b"CObservation2DRangeScan", at)) >= 0:
        at = data.find(b"CMatrixD", at) + 8 + 1 + 8 + 128
        while data[at] == 0x88:
            at += 1
        count = struct.unpack_from("<I", data, at)[0]
        ranges.append(np.frombuffer(data, "<f4", count, at + 4).astype(np.float64))
        at += 4 + 4 * count
    odometry = added(np.loadtxt(folder / "intel_ODO.txt"))  # the motion after each scan
    corrected, poses = read_carmen(folder / "intel-corrected.log.gz")
    known = {np.round(one, 2).tobytes(): i for i, one in enumerate(corrected)}
    reference = np.full((len(ranges), 3), np.nan)
    for i, one in enumerate(ranges):
        match = known.get(np.round(one, 2).tobytes())
        if match is not None:
            reference[i] = poses[match]
    count = min(len(ranges), len(odometry))
    angles = -0.5 * math.pi + np.arange(180) * math.pi / 180.0
    return Log("intel", ranges[:count], angles, 30.0, odometry[:count], reference[:count])
