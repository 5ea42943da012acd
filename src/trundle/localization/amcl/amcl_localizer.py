"""`AmclLocalizer`: an adaptive particle filter whose mean is refined by scan matching, and which says when it is lost.

Particles after Fox (KLD sampling, 2001) and Thrun, Burgard and Fox (Probabilistic Robotics, 2005, chapter 8), with the
motion model and the names of Nav2's amcl. The pose comes from Gauss-Newton on a signed distance field, with the
odometry as prior; particles, a search round the pose and a search of the whole map find better ones, which are
followed beside it until it is clear which is right.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np

from trundle.errors import InputError, SensorWarning
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.localization.amcl.amcl_settings import AmclSettings
from trundle.localization.amcl.beams import BeamPicker, Beams
from trundle.localization.amcl.hypotheses import Hypotheses
from trundle.localization.amcl.map_field import MapField, SeenSurfaces
from trundle.localization.amcl.motion import Motion, OdometryBias
from trundle.localization.amcl.particle_cloud import ParticleCloud
from trundle.localization.amcl.scene import Scene
from trundle.localization.amcl.search import search_map, search_near
from trundle.localization.blind_driving import BlindDriving
from trundle.localization.localizer import Localizer, check_covariance
from trundle.maps import OccupancyGrid
from trundle.maps.cells import OCCUPIED_FROM
from trundle.observation import Estimate, Hypothesis, Observation
from trundle.robots import Robot
from trundle.values import check_kind, check_seed

_EXACT = np.diag((0.01**2, 0.01**2, 0.005**2))
"""A start pose that is said to be exact is taken as this, so that scans may correct it."""

_NEAR_M, _NEAR_RAD = 0.8, math.radians(23.0)
_START_M, _START_RAD = 1.3, math.radians(30.0)
"""How far round a pose it is searched, while driving and at the start."""

_NEAR_EVERY_S = 0.5
_MAP_EVERY_S, _MAP_SELDOM_S = 1.0, 6.0
_WORSE = 0.7  # agreement below which a better pose nearby is searched for
_LEARN_EVERY = 3  # scans: the robot has moved a little by then
_LEARN_AFTER = 5  # scans: the start has been corrected by then
_LOST_M, _LOST_RAD = 1.0, 0.5
"""Least deviations of an estimate that is lost."""

_UNEVEN_SHARE = 0.45
"""Of how unevenly walls are seen beside their place on the map, which the estimate may be off by. Where racks are seen
up to 15 cm behind it, the 95 % ellipse covered 0.6 of the true places without (condition D), and 0.8 with this. With a
map error of 12 mm it covers 0.98, 0.97 and 0.92 in A, B and D; with 0.4 and 14 mm it was 0.99 in A."""

_FEW_BEAMS = 10
_BLIND_M = 0.1
_JUMP = np.diag((0.5**2, 0.5**2, 0.35**2))
_ANYWHERE = np.diag((10.0**2, 10.0**2, 2.0**2))


class AmclLocalizer(Localizer):
    """Finds the robot on its map by odometry and the scans of all its lidars; see the module.

    Args:
        grid: The map.
        robot: The robot.
        settings: Any field of `AmclSettings`.

    Raises:
        InputError: If there is no map, all of it is unknown, free or occupied, or a setting is out of range.
    """

    def __init__(self, grid: OccupancyGrid | None, robot: Robot, **settings: Any) -> None:
        check_kind(robot, Robot, "a localizer's robot", "Robot.load(name) makes one")
        self.settings = AmclSettings(**settings)
        self._field = MapField(grid, self.settings)
        self._picker = BeamPicker(robot, self.settings.max_beams, self.settings.laser_max_range)
        self._cloud = ParticleCloud(self._field, self.settings)
        self._bias = OdometryBias()
        self._blind = BlindDriving(robot, "amcl")
        self._surfaces = SeenSurfaces(self._field)
        longest = self.settings.laser_max_range
        self._scene = Scene(math.inf if longest is None else longest)
        self._tracks = Hypotheses(self._field, self.settings)
        rows, cols = self._field.shape
        middle = Pose2D(0.5 * cols * self._field.resolution, 0.5 * rows * self._field.resolution)
        self._begin(middle, _EXACT, confirmed=True, seed=0)

    def reset(self, pose: Pose2D | None, *, covariance: FloatArray | None = None, seed: int = 0) -> None:
        """Start over with the robot at a pose of the map frame, or anywhere on the map (None).

        Args:
            pose: Where the robot is, or None.
            covariance: Of (x, y, yaw) [m², rad²], shape (3, 3); None for a pose that is exact.
            seed: Of the random numbers; the same one and observations give the same estimates.

        Raises:
            InputError: If the pose is outside of the map, or the covariance is none.

        Warns:
            SensorWarning: If the pose is in a wall.
        """
        if pose is None:
            self._begin(Pose2D(0.0, 0.0), _ANYWHERE, confirmed=False, seed=seed)
            self.reinitialize_global()
            return
        placed = self._field.from_map(Pose2D.of(pose))
        spread = (
            _EXACT
            if covariance is None
            else self._field.covariance_from_map(check_covariance(covariance, "the start pose")) + _EXACT
        )
        value = self._field.cell_value(placed)
        if value is None:
            raise InputError(
                f"the start ({pose.x:g}, {pose.y:g}) lies outside of the map; correct the pose, or reset(None) to "
                "search the whole map"
            )
        if value >= OCCUPIED_FROM:
            warnings.warn(
                f"the start ({pose.x:g}, {pose.y:g}) lies in a wall of the map: it is corrected by the scans",
                SensorWarning,
                stacklevel=2,
            )
        self._begin(placed, spread, confirmed=True, seed=seed)

    def _begin(self, pose: Pose2D, covariance: FloatArray, *, confirmed: bool, seed: int) -> None:
        self._cloud.seed(check_seed(seed))
        self._picker.reset()
        self._blind.reset()
        self._scene.reset()
        self._tracks.start(pose, covariance, confirmed=confirmed)
        self._cloud.spread([pose], [covariance], [1.0])
        self._started = _deviations(covariance)
        self._odometry: Pose2D | None = None  # up to which tracks and particles are moved
        self._matched: Pose2D | None = None  # odometry at the last scan that was used
        self._time = 0.0  # of the last update
        self._surfaces.clear()
        self._bias.clear()
        self._uneven = 0.0  # deviation of where walls are seen beside their place on the map [m]
        self._settled = False  # whether the start has been looked at
        self._next_near = self._next_map = -math.inf
        self._map_wait = _MAP_EVERY_S
        self._last: tuple[FloatArray, tuple[Hypothesis, ...]] | None = None

    def reinitialize_global(self) -> None:
        """Forget where the robot is: it is searched on the whole map at the next scan."""
        track = self._tracks.main
        self._tracks.start(track.pose, _ANYWHERE, confirmed=False)
        self._cloud.spread_everywhere(self._field.is_free, self._field.resolution)
        self._settled = True
        self._next_map = -math.inf
        self._map_wait = _MAP_EVERY_S

    def update(self, observation: Observation) -> Estimate:
        """Return where the robot is after one more observation; see `Localizer`.

        Warns:
            SensorWarning: If the robot drives without scans, or its scans or its odometry cannot be used.
        """
        return self._blind.judge(observation, self._follow(observation))

    def _follow(self, observation: Observation) -> Estimate:
        if self._picker.follow(observation):
            self._bridge_jump(observation)
        if self._odometry is None:
            self._odometry, self._time = observation.odometry, observation.time
        motion = self._bias.corrected(Motion.between(self._odometry, observation.odometry))
        due = observation.scans and self._is_due(observation.odometry)
        beams = self._picker.pick(observation) if due else None
        if beams is None or len(beams) < _FEW_BEAMS:
            if motion.travel > _BLIND_M:  # the next scan is far: a long motion is no single turn and distance
                self._tracks.follow(motion)
                self._cloud.move(motion)
                self._odometry = observation.odometry
                return self._report(observation, None)
            return self._report(observation, motion)
        self._take(beams, motion, observation)
        self._odometry, self._time = observation.odometry, observation.time
        self._matched = observation.odometry
        return self._report(observation, None)

    def _is_due(self, odometry: Pose2D) -> bool:
        """Whether the robot has moved enough since the last scan that was used, by the settings."""
        settings, last = self.settings, self._matched
        if settings.update_min_d == settings.update_min_a == 0.0 or not self._settled or last is None:
            return True
        turned = abs(wrap_angle(odometry.yaw - last.yaw))
        return odometry.distance_to(last) >= settings.update_min_d or turned >= settings.update_min_a

    def _bridge_jump(self, observation: Observation) -> None:
        """Go on where the robot was, less certain: how it moved is not known."""
        self._odometry = observation.odometry
        for track in self._tracks.tracks:
            track.covariance = track.covariance + _JUMP
        self._next_near = -math.inf

    def _take(self, beams: Beams, motion: Motion, observation: Observation) -> None:
        """Correct the tracks and the particles by a scan."""
        tracks, cloud, time = self._tracks, self._cloud, observation.time
        tracks.follow(motion)
        before, expected = tracks.main, tracks.main.pose
        cloud.move(motion)
        cloud.weigh(beams)
        seconds = time - self._time
        wide = not self._settled or tracks.main.agreement < _WORSE
        if tracks.confirmed or tracks.main.scans:
            targets = self._surfaces.targets(beams, tracks.main.pose) if tracks.confirmed else None
            self._uneven = 0.0 if targets is None else float(targets.std())
            idea = cloud.best() if tracks.confirmed else None
            tracks.compare(beams, seconds, idea=idea, targets=targets, wide=wide)
        if self._scene.is_another(observation.scans, observation.odometry, surprising=tracks.is_surprised):
            tracks.doubt()
            self._next_map, self._map_wait = -math.inf, _MAP_EVERY_S
        self._search(beams, time)
        if tracks.decide() or not tracks.confirmed:
            self._spread_particles()
        else:
            cloud.resample(tracks.main.pose)
        main = tracks.main
        if tracks.confirmed and main is before and main.scans > _LEARN_AFTER and tracks.state == "localized":
            self._bias.learn(motion, expected.inverse() @ main.pose)
            if main.scans % _LEARN_EVERY == 0:
                self._surfaces.learn(beams, main.pose, main.distance, main.independent)

    def _search(self, beams: Beams, time: float) -> None:
        tracks, field = self._tracks, self._field
        main = tracks.main
        if tracks.confirmed and time >= self._next_near and (not self._settled or main.agreement < _WORSE):
            metres, radians = (_NEAR_M, _NEAR_RAD) if self._settled else self._start_window()
            found = search_near(field, beams, main.pose, metres, radians)
            tracks.propose(beams, found, is_far=False)
            self._settled = True
            self._next_near = time + _NEAR_EVERY_S
        is_open = main.scans == 0 or tracks.is_carried or tracks.state == "lost"
        wanted = tracks.is_doubtful if tracks.confirmed else is_open
        if not wanted:
            self._map_wait = _MAP_EVERY_S
        elif self.settings.recovery and time >= self._next_map:
            found = search_map(field, beams)
            if not tracks.confirmed and not tracks.is_carried and found:
                tracks.start(found[0], _JUMP, confirmed=False)
                tracks.compare(beams, 0.0, idea=None, targets=None, wide=True)
            tracks.propose(beams, found, is_far=True)
            tracks.note_search()
            self._next_map = time + self._map_wait
            self._map_wait = min(_MAP_SELDOM_S, 1.3 * self._map_wait)

    def _start_window(self) -> tuple[float, float]:
        metres, radians = self._started
        return min(5.0, max(_START_M, 3.0 * metres)), max(_START_RAD, 3.0 * radians)

    def _spread_particles(self) -> None:
        tracks = self._tracks
        shown = [tracks.main] if tracks.confirmed else tracks.tracks
        if shown[0].scans == 0:
            return
        scores = np.array([max(track.score, 1e-3) for track in shown])
        self._cloud.spread(
            [track.pose for track in shown],
            [track.covariance + 0.25 * _EXACT for track in shown],
            (scores / scores.sum()).tolist(),
        )

    def _report(self, observation: Observation, motion: Motion | None) -> Estimate:
        """The estimate now; `motion` is what the robot moved since the tracks were updated, None without."""
        field, tracks = self._field, self._tracks
        main = tracks.main
        if motion is None:
            placed, spread = main.pose, main.covariance
        else:
            ahead = type(main)(main.pose, main.covariance)
            ahead.follow(motion, self.settings)
            placed, spread = ahead.pose, ahead.covariance
        state = tracks.state
        error = math.hypot(self.settings.map_error, _UNEVEN_SHARE * self._uneven)
        spread = spread + np.diag((error**2, error**2, (0.25 * error) ** 2))
        if state != "localized":
            spread = spread + np.diag((_LOST_M**2, _LOST_M**2, _LOST_RAD**2))
        pose = field.to_map(placed)
        spread = field.covariance_to_map(spread)
        spread.flags.writeable = False
        T_map_odom = pose @ observation.odometry.inverse()
        particles, hypotheses = self._shown(motion)
        return Estimate(
            observation.time,
            T_map_odom @ observation.odometry,
            spread,
            T_map_odom,
            state=state,
            hypotheses=hypotheses,
            particles=particles,
        )

    def _shown(self, motion: Motion | None) -> tuple[FloatArray, tuple[Hypothesis, ...]]:
        """Particles and hypotheses in the map frame, of the last scan."""
        if motion is not None and self._last is not None:
            return self._last
        cloud, field = self._cloud, self._field
        particles = np.empty((len(cloud.poses), 4))
        origin = field.grid.origin
        cos, sin = math.cos(origin.yaw), math.sin(origin.yaw)
        x, y = cloud.poses[:, 0], cloud.poses[:, 1]
        particles[:, 0] = origin.x + cos * x - sin * y
        particles[:, 1] = origin.y + sin * x + cos * y
        particles[:, 2] = cloud.poses[:, 2] + origin.yaw
        particles[:, 3] = cloud.weights
        particles.flags.writeable = False
        hypotheses = tuple(
            Hypothesis(field.to_map(track.pose), share, field.covariance_to_map(track.covariance))
            for track, share in self._tracks.places()
        )
        self._last = particles, hypotheses
        return self._last


def _deviations(covariance: FloatArray) -> tuple[float, float]:
    """The largest deviation of the position [m], and that of the yaw [rad]."""
    return math.sqrt(float(np.linalg.eigvalsh(covariance[:2, :2])[-1])), math.sqrt(float(covariance[2, 2]))
