"""`Mapper`: makes a map from scans and odometry, and says where the robot is on it.

The front end matches each scan with the last key frames. Key frames are the nodes of a pose graph; places that the
robot comes back to become loops in it, and its corrected poses are the map. Every choice follows from the data alone,
so the same observations give the same map.
"""

from __future__ import annotations

import math
import os
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from trundle.errors import InputError
from trundle.geometry import FloatArray, Pose2D, wrap_angle
from trundle.localization.amcl.beams import BeamPicker
from trundle.mapping.carried_away import CarriedAway
from trundle.mapping.live_map import LiveMap
from trundle.mapping.loops import Loop, LoopFinder
from trundle.mapping.motion import motion_spread, turned
from trundle.mapping.moving_things import MovingThings
from trundle.mapping.nodes import MOST_POINTS, Floating, Nodes, Surface, make_surface, step_length
from trundle.mapping.optimizer import component_of, fits, optimize
from trundle.mapping.pose_graph import FARTHEST_M, FOLLOWS, LOOP, PoseGraph
from trundle.mapping.pose_graph_file import load_pose_graph, save_pose_graph
from trundle.mapping.recent_surfaces import RecentSurfaces
from trundle.mapping.submaps import Submaps
from trundle.mapping.window import Match, ScanWindow
from trundle.maps import OccupancyGrid
from trundle.observation import Estimate, Observation, Scan
from trundle.robots import Robot
from trundle.values import check_kind

_LEAST_M, _LEAST_RAD = 0.02, math.radians(0.5)  # less motion than that is not worth a match
_KEPT_M, _KEPT_RAD = 0.10, math.radians(5.0)  # scans that the map is drawn from
_KEY_M, _KEY_RAD = 0.4, math.radians(20.0)
_EDGE_FLOOR = np.diag((0.008**2, 0.008**2, math.radians(0.1) ** 2))
_LOST_FIT, _GOOD_FIT, _MOST_DOUBT = 0.2, 0.8, 100.0
_LOOP_EVERY, _LAST_EVERY = 2, 8  # key frames that are compared with old ones: while it drives, and at the end
_LEAP_M = 100.0  # what was seen before and after a step of this length has nothing in common
_TRUE_M, _TRUE_RAD, _MOST_LATE = 0.03, math.radians(0.3), 10
# So many key frames from one place and in one direction are enough; a robot that circles adds no more.
_PLACE_M, _SECTORS, _ENOUGH = 1.0, 8, 8


class Mapper:
    """Maps while the robot drives.

    Args:
        robot: The robot; beams that end on its own body are left out.
        seed: Of random choices; there are none now, and the map follows from the observations alone.
        max_range: The longest beams that are used [m]; None for as long as each lidar measures.

    Attributes:
        revision: How often the poses of the graph were corrected.
    """

    def __init__(self, robot: Robot, *, seed: int = 0, max_range: float | None = None) -> None:
        check_kind(robot, Robot, "a mapper's robot", "Robot.load(name) makes one")
        if max_range is not None and not max_range > 0.0:
            raise InputError(f"max_range must be above 0 m, got {max_range:g}; use None for the lidar's own")
        self.robot = robot
        self.seed = seed
        self._max_range = max_range
        self.revision = 0
        self._begin(Nodes(robot), Pose2D(0.0, 0.0))

    def _begin(self, nodes: Nodes, start: Pose2D) -> None:
        self._nodes = nodes
        self._submaps = Submaps(nodes)
        self._loops = LoopFinder(nodes, self._submaps)
        self._live: LiveMap | None = None
        self._picker = BeamPicker(self.robot, MOST_POINTS, min(self._max_range or FARTHEST_M, FARTHEST_M))
        self._start = start
        self._key_frames = 0
        self._late = 0  # loops since the graph was solved
        self._seen_from: dict[tuple[int, int, int], int] = {}
        for node in range(len(nodes)):
            place = _place_of(nodes.pose(node))
            self._seen_from[place] = self._seen_from.get(place, 0) + 1
        self._part = max(nodes.parts, default=-1)
        self._begin_part()

    def _begin_part(self) -> None:
        self._part += 1
        self._is_apart = len(self._nodes) > 0  # what joins it to the first part has not been seen yet
        self._window = ScanWindow()
        self._moving = MovingThings(self.robot)
        self._recent = RecentSurfaces()
        self._carried = CarriedAway(min(self._max_range or FARTHEST_M, FARTHEST_M))
        self._floats: Floating | None = None  # the last node, where it stands for many
        self._key: tuple[int, Pose2D] | None = None  # the last node, and its pose in the frame of the window
        self._last: tuple[Pose2D, Pose2D] | None = None  # the last match: odometry, and pose in the frame of the window
        self._kept: Pose2D | None = None
        self._before: tuple[Pose2D, Pose2D] | None = None  # the first odometry, and pose in the frame of the window
        self._spread: FloatArray = np.diag((1e-6, 1e-6, 1e-6))
        self._poor = 0
        self._worst = 1.0  # fit since the last node
        self._travelled = self._nodes.travelled[-1] if len(self._nodes) else 0.0

    @classmethod
    def from_graph(cls, graph: PoseGraph, robot: Robot, *, seed: int = 0, max_range: float | None = None) -> Mapper:
        """Continue a pose graph with a new part, which is joined when it recognises something."""
        mapper = cls(robot, seed=seed, max_range=max_range)
        mapper._begin(Nodes.from_graph(graph, robot), Pose2D(0.0, 0.0))
        return mapper

    @classmethod
    def load(
        cls, path: str | os.PathLike[str], robot: Robot, *, seed: int = 0, max_range: float | None = None
    ) -> Mapper:
        """Continue the pose graph of a `.posegraph` file; see `from_graph`.

        Raises:
            InputError: If the file cannot be read, or is no pose graph of this version.
        """
        return cls.from_graph(load_pose_graph(path), robot, seed=seed, max_range=max_range)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write all that it knows to a `.posegraph` file, whole or not at all.

        Raises:
            OutputError: If the file cannot be written.
        """
        save_pose_graph(self.graph(), path)

    def reset(self, pose: Pose2D | None = None) -> None:
        """Forget everything, and start with the robot at a pose of the map frame; None for its origin."""
        self.revision += 1
        self._begin(Nodes(self.robot), Pose2D(0.0, 0.0) if pose is None else Pose2D.of(pose))

    def new_part(self) -> None:
        """Say that the robot was carried away: what follows is joined when it recognises something."""
        if self._key is not None:
            self._picker.reset()
            self._begin_part()

    @property
    def anchor(self) -> tuple[int, Pose2D] | None:
        """A node, and the robot's pose seen from it: so a path can be corrected later. None before the first node."""
        if self._key is None or self._last is None:
            return None
        seen = self._key[1].inverse() @ self._local
        if self._floats is None:
            return self._key[0], seen
        stays = self._floats.anchor if self._floats.anchor is not None else self._floats.before[0]
        return stays, self._nodes.pose(stays).inverse() @ self._nodes.pose(self._key[0]) @ seen

    @property
    def joined(self) -> bool:
        """Whether the robot's part of the map hangs together with the first one."""
        if self._key is None:
            return self._part == 0
        roots = component_of(len(self._nodes), self._nodes.edges)
        return roots[self._key[0]] == roots[0]

    def update(self, observation: Observation) -> Estimate:
        """Take an observation; return where the robot is.

        Raises:
            InputError: If the time is not after that of the last one.
        """
        odometry = observation.odometry
        leapt = self._last is not None and self._last[0].distance_to(odometry) > _LEAP_M
        if (self._picker.follow(observation) or leapt) and self._key is not None:
            self._begin_part()
        if self._before is None:
            self._before = odometry, self._start if not len(self._nodes) else Pose2D(0.0, 0.0)
        known, local = self._before if self._last is None else self._last
        self._local = local @ (known.inverse() @ odometry)
        if observation.scans and self._has_moved(odometry):
            self._see(observation)
        return self._estimate(observation)

    def _has_moved(self, odometry: Pose2D) -> bool:
        if self._last is None:
            return True
        moved = self._last[0].inverse() @ odometry
        return math.hypot(moved.x, moved.y) >= _LEAST_M or abs(moved.yaw) >= _LEAST_RAD

    def _see(self, observation: Observation) -> None:
        beams = self._picker.pick(observation)
        if beams is None:
            return
        surface = make_surface(beams.points, beams.sensors)
        surface = self._moving.leave_out(surface, observation)
        odometry = observation.odometry
        if self._key is None or self._last is None:
            self._add_key(observation, surface, None)
            self._last = odometry, self._local
            return
        moved = self._last[0].inverse() @ odometry
        prior = motion_spread(moved)
        match = self._window.match(surface, self._local, prior)
        answer = self._carried.judge(observation, moved, match.fit, len(surface.points))
        if answer == "carried away":
            self._picker.warn(
                "carried",
                f"the scans at {observation.time:g} s show nothing that was seen before: "
                "the robot was carried away, or its odometry has failed; another part begins",
            )
            self._begin_part()
            self._before = odometry, Pose2D(0.0, 0.0)
        if answer != "here":
            return
        self._poor = self._poor + 1 if match.fit < _LOST_FIT else 0
        self._worst = min(self._worst, match.fit)
        self._local, self._spread = match.pose, match.covariance
        self._travelled += step_length(np.array(moved.as_tuple()))
        self._last = odometry, match.pose
        since = self._key[1].inverse() @ match.pose
        if math.hypot(since.x, since.y) >= _KEY_M or abs(since.yaw) >= _KEY_RAD:
            self._add_key(observation, surface, match)
            return
        kept = since if self._kept is None else self._kept.inverse() @ since
        if self._floats is None and (math.hypot(kept.x, kept.y) >= _KEPT_M or abs(kept.yaw) >= _KEPT_RAD):
            self._kept = since
            self._add_scans(observation, since)

    def _add_key(self, observation: Observation, surface: Surface, match: Match | None) -> None:
        nodes, local = self._nodes, self._local
        pose, covariance = local, _EDGE_FLOOR
        if match is not None and self._key is not None:
            pose = nodes.pose(self._key[0]) @ (self._key[1].inverse() @ local)
            # What fits badly may be wrong by far more than its covariance says.
            doubt = min(_MOST_DOUBT, max(1.0, _GOOD_FIT / max(self._worst, 1e-3)) ** 4)
            covariance = doubt * (turned(match.covariance, -self._key[1].yaw) + _EDGE_FLOOR)
        known = self._is_known(pose)
        if known and self._floats is not None and self._key is not None:
            covariance = covariance + self._floats.covariance
            before = self._floats.before
            self._remove_key()
        else:
            before = self._key
        node = nodes.add_node(observation.time, self._part, pose, observation.odometry, self._travelled)
        if before is not None:
            nodes.add_edge(before[0], node, FOLLOWS, before[1].inverse() @ local, covariance)
        self._floats = Floating(before, covariance, None) if known and before is not None else None
        self._key, self._kept, self._worst = (node, local), None, 1.0
        if self._floats is None:
            place = _place_of(pose)
            self._seen_from[place] = self._seen_from.get(place, 0) + 1
            self._add_scans(observation, Pose2D(0.0, 0.0))
        self._window.add(surface, local)
        self._recent.add(local, surface)
        self._submaps.add(node)
        self._key_frames += 1
        if self._key_frames % _LOOP_EVERY == 0:
            self._close_loops(node, surface)

    def _is_known(self, pose: Pose2D) -> bool:
        """Whether a place was seen from here often enough: the map does not get better by more of the same."""
        return self._seen_from.get(_place_of(pose), 0) >= _ENOUGH

    def _remove_key(self) -> None:
        node = len(self._nodes) - 1
        self._loops.forget(node)
        self._submaps.remove_last()
        self._nodes.remove_last()

    def _add_scans(self, observation: Observation, since: Pose2D) -> None:
        for scan in observation.scans:
            first, last = self._scan_poses(scan, observation)
            self._nodes.add_scan(scan, since @ first, since @ last)

    def _scan_poses(self, scan: Scan, observation: Observation) -> tuple[Pose2D, Pose2D]:
        """Base_link at the first and at the last beam, seen from where it is now."""
        placed = self._picker.scan_poses(scan, observation)
        return placed if placed is not None else (Pose2D(0.0, 0.0), Pose2D(0.0, 0.0))

    def _close_loops(self, node: int, surface: Surface) -> None:
        loops = self._loops.search(node, surface, self._recent.together())
        if loops:
            self._take(loops)

    def _take(self, loops: list[Loop]) -> None:
        """Add loops to the graph, and correct its poses; take them out again if they do not fit."""
        nodes = self._nodes
        first = len(nodes.edges)
        self._join(loops[-1])
        for loop in loops:
            nodes.add_edge(loop.a, loop.b, LOOP, loop.transform, loop.covariance)
        new = list(range(first, len(nodes.edges)))
        if self._late < _MOST_LATE and all(self._is_true(loop) for loop in loops):
            self._late += 1
            self._note(loops)
            return
        self._late = 0
        poses, errors = optimize(nodes, free=new)
        if not fits(errors[new]):
            del nodes.edges[first:], nodes.transforms[first:], nodes.covariances[first:]
            return
        self._note(loops)
        self._correct(poses)

    def _note(self, loops: list[Loop]) -> None:
        for loop in loops:
            self._submaps.tie(loop.a, loop.b)
        self._is_apart = self._is_apart and not self.joined
        if self._floats is not None:
            self._floats = replace(self._floats, anchor=loops[-1].a)

    def _is_true(self, loop: Loop) -> bool:
        """Whether a loop says what the poses say already: then the graph need not be solved again."""
        seen = self._nodes.pose(loop.a).inverse() @ self._nodes.pose(loop.b)
        turn = abs(wrap_angle(seen.yaw - loop.transform.yaw))
        return seen.distance_to(loop.transform) < _TRUE_M and turn < _TRUE_RAD

    def _join(self, loop: Loop) -> None:
        """Move the part of a key frame to where a loop says, if nothing joined it to the old place before."""
        nodes = self._nodes
        if nodes.parts[loop.a] == nodes.parts[loop.b]:
            return
        roots = component_of(len(nodes), nodes.edges)
        if roots[loop.a] == roots[loop.b]:
            return
        # What holds the first node stays.
        stays, moves = (loop.a, loop.b) if roots[loop.a] < roots[loop.b] else (loop.b, loop.a)
        T_a_b = loop.transform if stays == loop.a else loop.transform.inverse()
        shift = nodes.pose(stays) @ T_a_b @ nodes.pose(moves).inverse()
        for i, root in enumerate(roots):
            if root == roots[moves]:
                nodes.poses[i] = np.array((shift @ nodes.pose(i)).as_tuple())

    def _correct(self, poses: FloatArray) -> None:
        self._nodes.poses = list(poses)
        self.revision += 1

    def finish(self) -> None:
        """Look for loops once more, from all key frames, and correct all poses."""
        nodes = self._nodes
        if not len(nodes):
            return
        roots = component_of(len(nodes), nodes.edges)
        apart = next((node for node, root in enumerate(roots) if root != roots[0]), None)
        if apart is not None:
            self.seek_loops(apart)
        known = {(a, b) for a, b, _ in nodes.edges}
        for node in range(0, len(nodes), _LAST_EVERY):
            surface = nodes.key_surface(node)
            if not len(surface.points):
                continue
            for loop in self._loops.search(node, surface, surface, tries=0):
                if (loop.a, loop.b) not in known:
                    nodes.add_edge(loop.a, loop.b, LOOP, loop.transform, loop.covariance)
                    self._note([loop])
        poses, _ = optimize(nodes, iterations=30)
        self._correct(poses)
        self._live = None  # small corrections are not drawn while the robot drives

    def seek_loops(self, first: int) -> None:
        """Look for loops from all key frames from a node on, as if the robot had just come there."""
        nodes, recent = self._nodes, self._recent
        self._recent = RecentSurfaces()
        for node in range(first, len(nodes)):
            if node > first and nodes.parts[node] != nodes.parts[node - 1]:
                self._recent.clear()
            surface = nodes.key_surface(node)
            if not len(surface.points):
                continue
            self._recent.add(nodes.pose(node), surface)
            if node % _LOOP_EVERY == 0:
                self._close_loops(node, surface)
        self._recent = recent

    def _estimate(self, observation: Observation) -> Estimate:
        if self._key is None:
            pose, covariance = self._local, self._spread
        else:
            node, local = self._key
            T_map_local = self._nodes.pose(node) @ local.inverse()
            pose, covariance = T_map_local @ self._local, turned(self._spread, T_map_local.yaw)
            if self._last is not None:
                covariance = covariance + motion_spread(self._last[0].inverse() @ observation.odometry) * 0.25
        T_map_odom = pose @ observation.odometry.inverse()
        state = "lost" if self._poor >= 10 or self._is_apart else "localized"
        return Estimate(observation.time, pose, covariance, T_map_odom, state)

    def grid(self, *, resolution: float = 0.05) -> OccupancyGrid:
        """Return the map as far as it is known; only what is new or was corrected is drawn."""
        if self._live is None or self._live.resolution != resolution:
            self._live = LiveMap(resolution, self.robot)
        return self._live.draw(self._nodes)

    def graph(self) -> PoseGraph:
        """Return all that it knows."""
        return self._nodes.to_graph()

    def track(self) -> tuple[FloatArray, npt.NDArray[np.int32]]:
        """Return the poses of the nodes, and the loops among them; see `Nodes.track`."""
        return self._nodes.track()


def _place_of(pose: Pose2D) -> tuple[int, int, int]:
    sector = round(pose.yaw / (2.0 * math.pi) * _SECTORS) % _SECTORS
    return math.floor(pose.x / _PLACE_M), math.floor(pose.y / _PLACE_M), sector
