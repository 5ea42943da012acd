"""Logs of the benchmark: CARMEN logs with corrected poses, and Intel's MRPT log with raw odometry."""

from __future__ import annotations

import gzip
import itertools
import math
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from trundle import Scan
from trundle.recordings import open_drive


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


def read_corrected(path: Path, seed: int, share: float, per_metre: float) -> Log:
    """Return a log with odometry that drifts by a share of the way and by radians per metre."""
    scans, poses = _read(path)
    odometry = drifting(poses, seed, share, per_metre)
    one = scans[0]
    return Log(
        path.name.split("-corrected")[0], [scan.ranges for scan in scans], one.angles, one.range_max, odometry, poses
    )


def _read(path: Path) -> tuple[list[Scan], npt.NDArray[np.float64]]:
    """Return the scans of a log, and the robot's pose at each of them, shape (N, 3)."""
    drive = open_drive(path)
    scans, poses = [], []
    for stretch, scan in drive.scans_in_order():
        scans.append(scan)
        poses.append(drive.tracks[stretch].at(scan.time)[0].as_tuple())
    return scans, np.array(poses)


def drifting(poses: npt.NDArray[np.float64], seed: int, share: float, per_metre: float) -> npt.NDArray[np.float64]:
    """Odometry of a path: each step is off by a share of its length, and by an angle per metre; one seed, one wheel."""
    rng = np.random.default_rng(seed)
    scale = 1.0 + share * rng.choice((-1.0, 1.0))
    bend = per_metre * rng.choice((-1.0, 1.0))
    out = [poses[0].copy()]
    for a, b in itertools.pairwise(poses):
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


def _key(ranges: npt.NDArray[np.float64], far: float) -> bytes:
    with np.errstate(invalid="ignore"):
        return np.round(np.where((ranges >= 0.02) & (ranges < far), ranges, 0.0), 2).tobytes()


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
    scans, poses = _read(folder / "intel-corrected.log.gz")
    # The reader leaves out beams that met nothing: they do not count where scans are compared.
    far = scans[0].range_max
    known = {_key(scan.ranges, far): pose for scan, pose in zip(scans, poses, strict=True)}
    reference = np.full((len(ranges), 3), np.nan)
    for i, one in enumerate(ranges):
        reference[i] = known.get(_key(one, far), np.nan)
    count = min(len(ranges), len(odometry))
    angles = -0.5 * math.pi + np.arange(180) * math.pi / 180.0
    return Log("intel", ranges[:count], angles, 30.0, odometry[:count], reference[:count])
